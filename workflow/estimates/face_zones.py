"""Chooses strong zones in which nothing fails, so that finite elements compute the failure of one face, and not an
earlier failure elsewhere."""

from collections.abc import Sequence

import numpy as np

from fem.search.strong_zones import StrongZone
from meshes.section.section import Section
from workflow.estimates.crest import LEAST_SLOPE
from workflow.estimates.slices import LEFT
from workflow.estimates.structures import CrestedStructure

Surface = Sequence[Sequence[float]] | np.ndarray
# Thickness of a face that moves as one body, over the height from the exit of a failure to the crest.
FACE_THICKNESS = 0.1


def is_of_face(structure: CrestedStructure, towards: int, surface: Surface, sides: Sequence[int] = ()) -> bool:
    """Return whether a failure is one of a face: part of the crest slides, towards the side of the face.

    Parameters
    ----------
    structure : structure with its crest
    towards : LEFT (-1) or RIGHT (1), the side to which the face slides
    surface : points (n, 2) of the slip surface from left to right (m); may be empty
    sides : sides to which the failure slides; if none are given, that of the lower end of the slip surface

    Returns
    -------
    False also for an empty slip surface.
    """
    points = [(float(x), float(z)) for x, z in surface]
    return bool(points) and structure.slides_with(points) and towards in (sides or _slides(points))


def _slides(surface: Surface) -> tuple[int]:
    """Return the side to which a failure slides by the lower end of its slip surface: LEFT (-1) or RIGHT (1)."""
    return (LEFT,) if surface[0][1] < surface[-1][1] else (-LEFT,)


def zones_against(
    section: Section,
    structure: CrestedStructure,
    towards: int,
    surface: Surface,
    circle: Surface,
    zones: Sequence[StrongZone],
    least_depth: float,
    sides: Sequence[int] = (),
) -> tuple[StrongZone, ...] | None:
    """Return the strong zones that exclude an earlier failure which does not belong to the face.

    A failure towards the other side, or behind the crest, is excluded by a strong zone behind the crest. A failure in
    front of the crest is excluded in one of two ways. If the critical circle of the face leaves the ground farther out,
    the strong zone reaches from the exit of the failure to the crest, down to a small depth: the zone moves as one
    body, and no part of it moves without the crest. If the circle leaves the ground nearer, the zone begins at the top
    of the slope in which the failure lies.

    Parameters
    ----------
    section : the ground
    structure : the structure, with its crest
    towards : LEFT or RIGHT, the side to which the face slides
    surface : the failure to exclude, from left to right (m)
    circle : critical circle of the face, from left to right (m); empty if there is none
    zones : the zones so far
    least_depth : smallest depth that a failure may have (m)
    sides : sides to which the failure slides, both if it spreads; if none are given, the side of the lower end of its
        slip surface. Both ends of a failure that carries a whole embankment away may be level with each other

    Returns
    -------
    The zones; None if no zone can be added.
    """
    first, last = section.extent
    crest, middle = structure.crest, 0.5 * (surface[0][0] + surface[-1][0])
    near_edge, far_edge = (crest.left, crest.right) if towards == LEFT else (crest.right, crest.left)
    if towards not in (sides or _slides(surface)) or (middle - far_edge) * towards < 0.0:
        zone = StrongZone(far_edge, last) if towards == LEFT else StrongZone(first, far_edge)
    else:
        end = 0 if towards == LEFT else -1
        exit_x = _snapped(section, surface[end][0], least_depth)
        if len(circle) and (circle[end][0] - exit_x) * towards >= -least_depth:
            low, high = np.interp([exit_x, near_edge], *section.ground.T)
            ends = sorted((exit_x, near_edge))
            zone = StrongZone(ends[0], ends[1], max(least_depth, FACE_THICKNESS * float(high - low)))
        else:
            top = _top_of_slope(section.ground, towards, surface)
            if top is None or (top - near_edge) * towards <= 0.0:
                return None
            zone = StrongZone(first, top) if towards == LEFT else StrongZone(top, last)
    if zone.end - zone.start <= 0.0 or any(zone.start < other.end and other.start < zone.end for other in zones):
        return None
    return (*zones, zone)


def _snapped(section: Section, x: float, near: float) -> float:
    """Return x, or the x of a point of the ground (m) if one is close."""
    points = section.ground[:, 0]
    closest = float(points[np.argmin(np.abs(points - x))])
    return closest if abs(closest - x) <= near else float(x)


def _top_of_slope(ground: np.ndarray, towards: int, surface: Surface) -> float | None:
    """Return x (m) of the top of the slope in which a failure lies; None if the ground does not fall towards the
    side."""
    points = ground if towards == LEFT else ground[::-1]  # from the lower end upwards
    run, rise = np.abs(np.diff(points[:, 0])), np.diff(points[:, 1])
    low, high = sorted((surface[0][0], surface[-1][0]))
    ends = np.sort(np.column_stack([points[:-1, 0], points[1:, 0]]), axis=1)
    share = np.clip(np.minimum(ends[:, 1], high) - np.maximum(ends[:, 0], low), 0.0, None)
    climbs = share * rise / np.maximum(run, 1e-9)
    if not len(climbs) or climbs.max() <= 0.0:
        return None
    k = int(np.argmax(climbs))
    while k + 1 < len(rise) and rise[k + 1] >= LEAST_SLOPE * run[k + 1]:
        k += 1
    return float(points[k + 1, 0])
