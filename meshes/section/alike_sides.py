"""Compares the layers at both sides of a section, which periodic sides require to be the same."""

from collections.abc import Sequence

import numpy as np

from meshes.section.cutting import soil_of
from meshes.section.layering import Layering
from meshes.section.stratum import Stratum


def has_alike_sides(strata: Sequence[Stratum], layers: Layering) -> bool:
    """Return whether both sides have the same layers.

    Parameters
    ----------
    strata : strata of the section from the top down. Parts of one soil that a zone has parted count as one layer where
        they meet: beside the zone the soil may be another part at the left than at the right.
    layers : layers of the section, or of its mesh

    Returns
    -------
    True if layers of the same soils have the same thickness at both sides, at the same or at another height.
    """
    at_left, at_right = layers.thickness()
    soils = [soil_of(stratum.name) for stratum in strata]
    left, right = (_layers_of_side(soils, side, layers.tolerance) for side in (at_left[0], at_right[-1]))
    return [soil for soil, _ in left] == [soil for soil, _ in right] and all(
        abs(a - b) <= layers.tolerance for (_, a), (_, b) in zip(left, right, strict=True)
    )


def _layers_of_side(soils: Sequence[str], thickness: np.ndarray, tolerance: float) -> list[tuple[str, float]]:
    """Return soil and thickness (m) of every layer along a vertical side, from the top down."""
    layers: list[tuple[str, float]] = []
    for soil, length in zip(soils, thickness.tolist(), strict=True):
        if length <= tolerance:
            continue
        if layers and layers[-1][0] == soil:
            layers[-1] = soil, layers[-1][1] + length
        else:
            layers.append((soil, length))
    return layers
