"""Divides strata where a strength that grows with depth or stress begins to exceed its least value.

At this place c = max(c_min, c0 + k d + S σ'v OCR^m) has a kink. Strict lower bounds use a linear cohesion between the
corners of a triangle that is nowhere above the true cohesion. In a triangle across the kink this would be either the
least value, or a cohesion that goes to zero at the ground. Triangles on either side of the kink lose nothing.
"""

import numpy as np

from meshes.section.cohesion_field import CohesionField
from meshes.section.cutting import LEAST_STRENGTH, divided_by_water
from meshes.section.polyline import without_repeats
from meshes.section.section import Section
from meshes.section.stratum import Stratum

# Halvings of a thickness until the kink is found in it, to rounding: points a millionth off a straight line make edges
# that nearly continue each other where they cross it, and there quadratic velocities without change of volume, of which
# one is then no longer a matter of the others (Scott & Vogelius 1985), are not found to rounding.
HALVINGS = 52
# Thinner parts (share of the height of the section) are left as they are: triangles would be as narrow.
THINNEST = 0.005


def cut_at_least_strength(section: Section) -> Section:
    """Return the section with strata divided where their cohesion begins to exceed its least value.

    Parameters
    ----------
    section : the section; strata with a ``cohesion_minimum`` may be divided

    Returns
    -------
    The section, in which both parts of a stratum have the same soil; the section itself if no stratum has such a place.
    """
    field = section.cohesion_field
    strata: list[Stratum] = []
    for k, stratum in enumerate(section.strata):
        if field.varies[k] and stratum.cohesion_minimum and stratum.cohesion < stratum.cohesion_minimum:
            parts = divided_by_water(section.layering, k, _kink(field, k))
            thinnest = THINNEST * float(np.ptp(section.outline()[:, 1]))
            if all(parts.thickness[part].max() > thinnest for part in (0, 1)):
                name, bottom = stratum.name + LEAST_STRENGTH, parts.line(*section.extent)
                strata.append(stratum.model_copy(update={"name": name, "bottom": bottom}))
        strata.append(stratum)
    return section if len(strata) == len(section.strata) else section.with_strata(strata)


def _kink(field: CohesionField, k: int) -> np.ndarray:
    """Return the line (n, 2) in m, from side to side, below which stratum k has more than its least cohesion.

    Along a vertical the cohesion grows with depth. Where it is above the least value throughout the stratum, or below
    it, the line continues above or below the stratum, as straight as strengths are there, so that it meets top and
    bottom of the stratum.
    """
    layers, least = field.water.layers, field.water.strata[k].cohesion_minimum or 0.0
    x = np.union1d(layers.x, field.kinks)
    middle = 0.5 * (x[1:] + x[:-1])
    levels = []
    for end in (x[:-1], x[1:]):
        top, bottom = layers.interfaces(end, near=middle)[:, k : k + 2].T
        over = [_excess(field, k, end, z, middle, 0.5 * (top + bottom), least) for z in (top, bottom)]
        upper, lower = top.copy(), bottom.copy()
        for _ in range(HALVINGS):
            half = 0.5 * (upper + lower)
            weak = _excess(field, k, end, half, middle, 0.5 * (top + bottom), least) <= 0.0
            upper, lower = np.where(weak, half, upper), np.where(weak, lower, half)
        growth = np.maximum(over[1] - over[0], 1e-9 * least)
        beyond = top - (top - bottom) * np.clip(-over[0] / growth, -1.0, 2.0)
        inside = (over[0] <= 0.0) & (over[1] >= 0.0)
        levels.append(np.where(inside, 0.5 * (upper + lower), beyond))
    ends = np.column_stack([np.column_stack([x[:-1], x[1:]]).ravel(), np.column_stack(levels).ravel()])
    return without_repeats(ends)


def _excess(
    field: CohesionField, k: int, x: np.ndarray, z: np.ndarray, inside: np.ndarray, level: np.ndarray, least: float
) -> np.ndarray:
    """Return the growing cohesion of stratum k less its ``least`` value (n,) in Pa, at x, z (n,) in m; negative where
    it is less. ``inside``, ``level`` (n,): x and z of points inside the stratum beside them (m)."""
    points, near = np.column_stack([x, z]), np.column_stack([inside, level])
    return field.growing(points, near, np.full(len(x), k)) - least
