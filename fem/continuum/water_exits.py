"""Strengthens bare sand at the points of a face where the water in the ground comes out of it.

At such a point two bodies of sand meet at the surface, one with pore pressure and one without. Sand without cohesion
has no stress there, and the ground around the point has no length of its own: a failure of any small size is possible
at one Kh, which neither of the two faces has (`shallow_failure`). The few triangles that meet at the point have lower
bounds far below that Kh, however small they are. As at the ends of loads, the ground within the least depth of the
point is given an apparent cohesion; a larger failure that passes the point cuts through this strengthened
ground.
"""

from collections.abc import Sequence
from itertools import pairwise

from fem.continuum.face_reinforcement import apparent_cohesion
from fem.continuum.loads import direction_of
from fem.continuum.shallow_failure import ShallowFailure, shallow_failures
from fem.settings import FemSettings
from meshes.section.cutting import BELOW_WATER
from meshes.section.section import Section


def water_exits(section: Section, faces: Sequence[ShallowFailure], depth: float) -> dict[float, float]:
    """Find the points where water comes out of faces.

    Parameters
    ----------
    section : the ground
    faces : its faces without cohesion, as `shallow_failures` finds them
    depth : the least depth (m)

    Returns
    -------
    The apparent cohesion (Pa) of the sand around the points, by their x (m).
    """
    soils = {stratum.name: stratum for stratum in section.strata}
    cohesion: dict[float, float] = {}
    for left, right in pairwise(sorted(faces, key=lambda face: face.start)):
        alike = left.stratum.removesuffix(BELOW_WATER) == right.stratum.removesuffix(BELOW_WATER)
        if left.end != right.start or not alike or left.stratum == right.stratum:
            continue
        for face in (left, right):
            soil = soils[face.stratum]
            needed = apparent_cohesion(face, soil, soil.friction_angle, depth)
            cohesion[left.end] = max(needed, cohesion.get(left.end, 0.0))
    return cohesion


def exits_of_directions(section: Section, fem: FemSettings) -> tuple[dict[float, float], dict[float, float]]:
    """Return the exits of water on faces inclined in the direction of the seismic force, and on those against it.

    On faces against the force the few triangles at the exit may have no stress in equilibrium with the weight at any
    Kh.

    Parameters
    ----------
    section : the ground
    fem : settings of the finite elements, with one direction of the seismic force and the least depth (m)

    Returns
    -------
    Two tables of apparent cohesion (Pa) by the x (m) of the exit, for faces in the direction of the force and against
    it.
    """
    exits, opposite = (
        water_exits(section, shallow_failures(section, fem.changed(direction=direction)), fem.least_depth)
        for direction in (direction_of(fem), direction_of(fem, opposite=True))
    )
    return exits, opposite
