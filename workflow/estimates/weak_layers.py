"""Finds thin layers that are weaker than the layers above and below, and thin mantles over stronger ground. A slip
circle cuts across a thin layer and cannot follow it.
"""

import numpy as np

from meshes.section.cutting import whole_soil
from meshes.section.layering import middles
from meshes.section.section import Section

# A layer is thin below this share of the relief of the ground, and weak below this share of the strength of the weaker
# of its neighbours; it counts where it is so over a length of the relief.
THIN_LAYER, WEAK_STRENGTH = 0.1, 0.8
# A mantle over stronger ground slips along its bottom. It is thin below this share of the relief, and counts where the
# ground and its bottom both fall by more than this slope to the same side.
THIN_MANTLE, MANTLE_SLOPE = 0.15, 0.1
COLUMNS = 200  # number of vertical lines on which layers are evaluated


def thin_weak_layers(section: Section) -> tuple[str, ...]:
    """Return the soils of a section that slip circles cannot follow, from the top down.

    The strength c + σ'v tan φ in the middle of a layer is compared with the strengths that the soils above and below
    would have there. The base counts as firm ground.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    Names of the soils in the section file.
    """
    layers = section.layering
    left, right = section.extent
    x, width = middles(left, right, COLUMNS), (right - left) / COLUMNS
    levels = layers.interfaces(x)
    soils = [whole_soil(stratum.name) for stratum in section.strata]
    relief = float(np.ptp(section.ground[:, 1]))
    lengths: dict[str, float] = {}
    for at, column in zip(x, levels, strict=True):
        present = [k for k in range(len(soils)) if column[k] - column[k + 1] > layers.tolerance]
        if not present:  # the base crops out
            continue
        for first, last in _runs([soils[k] for k in present]):
            inside = present[first : last + 1]
            thick = float(column[inside[0]] - column[inside[-1] + 1])
            if first == 0:
                if thick < THIN_MANTLE * relief and _mantle_slips(section, at, inside, present[last + 1 : last + 2]):
                    lengths[soils[inside[-1]]] = lengths.get(soils[inside[-1]], 0.0) + width
                continue
            if thick >= THIN_LAYER * relief:
                continue
            middle = float(column[inside[0]]) - 0.5 * thick
            weak = next(k for k in inside if column[k + 1] <= middle)
            neighbours = [present[first - 1], *present[last + 1 : last + 2]]
            strength, *others = (strength_as(section, at, middle, weak, k) for k in (weak, *neighbours))
            if strength < WEAK_STRENGTH * min(others):
                lengths[soils[weak]] = lengths.get(soils[weak], 0.0) + width
    return tuple(soil for soil in dict.fromkeys(soils) if lengths.get(soil, 0.0) > relief > 0.0)


def _mantle_slips(section: Section, x: float, mantle: list[int], below: list[int]) -> bool:
    """Return whether the bottom of a ``mantle`` at x (m) falls to the same side as the ground, and the mantle is weaker
    there than the stratum ``below``."""
    if not below:
        return False
    layers = section.layering
    k = int(np.searchsorted(layers.x, x, side="right")) - 1
    interfaces = [mantle[0], mantle[-1] + 1]
    ground, bottom = (layers.right[k, interfaces] - layers.left[k, interfaces]) / layers.width[k]
    if ground * bottom <= 0.0 or min(abs(ground), abs(bottom)) <= MANTLE_SLOPE:
        return False
    at_bottom = float(layers.interfaces(np.array([x]))[0, mantle[-1] + 1])
    weak, firm = (strength_as(section, x, at_bottom, mantle[-1], soil) for soil in (mantle[-1], below[0]))
    return weak < WEAK_STRENGTH * firm


def _runs(names: list[str]) -> list[tuple[int, int]]:
    """Return the first and last place of every run of equal names."""
    starts = [i for i, name in enumerate(names) if i == 0 or names[i - 1] != name]
    return [(start, end - 1) for start, end in zip(starts, [*starts[1:], len(names)], strict=True)]


def strength_as(section: Section, x: float, z: float, stratum: int, soil: int) -> float:
    """Return the shear strength (Pa) on a level plane at x, z (m) in ``stratum`` of a ``section``, if this stratum had
    the strength of ``soil``.
    """
    point, field = np.array([[x, z]]), section.cohesion_field
    stress = float(field.effective_stress(point, point, np.array([stratum]))[0])
    cohesion = float(field.at(point, point, np.array([soil]))[0])
    return cohesion + stress * float(np.tan(section.strata[soil].friction_angle))
