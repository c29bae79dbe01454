"""Finds blocks that stand at a steep face on weaker ground, such as the caisson of a quay or a wall. Such a block
slides or tips as a whole along its outline, which a slip circle cannot follow.
"""

import numpy as np

from meshes.section.cutting import whole_soil
from meshes.section.section import Section
from workflow.estimates.weak_layers import strength_as

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
