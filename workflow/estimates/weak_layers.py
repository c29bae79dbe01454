"""Finds ground whose failure no slip circle can follow: thin layers that are weaker than the layers above and below,
thin mantles over stronger ground, and blocks at a steep face on weaker ground, such as the caisson of a quay or a wall,
which slide or tip as a whole along their outline.
"""

import numpy as np

from meshes.section.cutting import whole_soil
from meshes.section.layering import middles
from meshes.section.section import Section

# A layer is thin below this share of the relief of the ground, and weak below this share of the strength of the weaker
# of its neighbours; it counts where it is so over a length of the relief. Circles give 4 to 160 % more than strict
# bounds in published slopes with layers of 0.1 to 0.2 of the relief.
THIN_LAYER, WEAK_STRENGTH = 0.2, 0.8
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


# A face counts if it is steeper than this slope and higher than this share of the relief of the ground; its soil is a
# block if it has this multiple of the strength that the soil below has at its foot.
STEEP_FACE, HIGH_FACE, STRONG_SOIL = 2.0, 0.3, 2.0
POINTS = 20  # on a face, at which its soil is looked up
INSIDE = 1e-3  # of the height of a face, by which these points lie behind it


def strong_blocks(section: Section) -> tuple[str, ...]:
    """Return the soils of steep faces that are much stronger than the ground that they stand on.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    Names of the soils in the section file.
    """
    relief = float(np.ptp(section.ground[:, 1]))
    names = [
        whole_soil(section.strata[soil].name)
        for start, end in _steep_faces(section)
        if abs(end[1] - start[1]) > HIGH_FACE * relief
        for soil in [_block_behind(section, start, end)]
        if soil is not None
    ]
    return tuple(dict.fromkeys(names))


def _steep_faces(section: Section) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return both ends of every stretch of the ground that is steep and falls to one side."""
    faces: list[tuple[np.ndarray, np.ndarray]] = []
    for start, end in zip(section.ground[:-1], section.ground[1:], strict=True):
        rise = end[1] - start[1]
        if abs(rise) <= STEEP_FACE * abs(end[0] - start[0]):
            continue
        if faces and np.array_equal(faces[-1][1], start) and (faces[-1][1][1] - faces[-1][0][1]) * rise > 0.0:
            faces[-1] = (faces[-1][0], end)
        else:
            faces.append((start, end))
    return faces


def _block_behind(section: Section, start: np.ndarray, end: np.ndarray) -> int | None:
    """Return the stratum of which most of a face consists, if the stratum below is much weaker at its foot."""
    behind = INSIDE * (end[1] - start[1])  # to the right of a face that rises to the right, else to the left
    share = (np.arange(POINTS) + 0.5)[:, None] / POINTS
    points = start + share * (end - start) + [behind, 0.0]
    soils = section.stratum_at(*points.T)
    names = [whole_soil(section.strata[k].name) if k >= 0 else "" for k in soils]
    name = max(dict.fromkeys(names), key=names.count)
    if not name or 2 * names.count(name) < POINTS:
        return None
    x = float(np.mean(points[:, 0]))
    column = section.layering.interfaces(np.array([x]))[0]
    present = np.flatnonzero(column[:-1] - column[1:] > section.layering.tolerance).tolist()
    block = max((k for k in present if whole_soil(section.strata[k].name) == name), default=None)
    below = next((k for k in present if block is not None and k > block), None)
    if block is None or below is None:
        return None
    strong, weak = (strength_as(section, x, float(column[block + 1]), below, soil) for soil in (block, below))
    return block if strong > STRONG_SOIL * weak else None
