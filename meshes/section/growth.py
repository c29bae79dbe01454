"""Cohesion that grows with depth: c = cohesion + cohesion_increase (cohesion_from - elevation)."""

from collections.abc import Sequence

import numpy as np

from meshes.section.cutting import in_file
from meshes.section.layering import Layering
from meshes.section.stratum import Stratum


def growth_problems(strata: Sequence[Stratum], layers: Layering) -> list[str]:
    """Strata that reach above the level from which their cohesion grows, where it would be smaller than given."""
    problems = []
    for k, soil in enumerate(strata):
        there = layers.present()[:, k]
        if soil.cohesion_from is None or not there.any():
            continue
        highest = float(max(layers.left[there, k].max(), layers.right[there, k].max()))
        if highest > soil.cohesion_from + layers.tolerance:
            problems.append(
                f"{in_file(strata, k)}, cohesion_from = {soil.cohesion_from:g}: expected an elevation that the "
                f"stratum does not reach above; it goes up to {highest:g} m"
            )
    return problems


def evened(strata: Sequence[Stratum], layers: Layering) -> tuple[Stratum, ...]:
    """The strata with one cohesion each, where it grows that at the elevation of their centroid."""
    if not any(soil.cohesion_increase for soil in strata):
        return tuple(strata)
    return tuple(
        soil.model_copy(
            update={"cohesion": float(soil.cohesion_at(z)), "cohesion_increase": 0.0, "cohesion_from": None}
        )
        if soil.cohesion_increase
        else soil
        for soil, z in zip(strata, _centroids(layers), strict=True)
    )


def _centroids(layers: Layering) -> np.ndarray:
    """Elevations (strata,) of the centroids of the strata (m)."""
    width = layers.width[:, None]
    thick = 0.5 * width * (layers.left[:, :-1] - layers.left[:, 1:] + layers.right[:, :-1] - layers.right[:, 1:])
    squares = layers.left**2 + layers.left * layers.right + layers.right**2
    moment = width / 6.0 * (squares[:, :-1] - squares[:, 1:])
    return np.asarray(moment.sum(axis=0) / np.maximum(thick.sum(axis=0), 1e-12))
