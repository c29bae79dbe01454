"""Slip circles beside a vertical wall whose top is the crest of a structure."""

import pytest

from meshes.section.section import Section
from tests.support.sections import layer
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import face_circle, structures_of


def quay(is_mirrored: bool) -> Section:
    """Return a quay wall of concrete from x = 48 to 60 m, before it water bed 10 m lower."""
    surface = [[0, 4], [60, 4], [60, -6], [120, -6.01]]
    wall = [[48, 4], [60, 4], [60, -6.01], [48, -6.01]]
    ends = {"from": 44.0, "to": 64.0}
    if is_mirrored:
        surface, wall = ([[120 - x, z] for x, z in reversed(line)] for line in (surface, wall))
        ends = {"from": 56.0, "to": 76.0}
    soil = {"cohesion": "5 kPa", "friction_angle": "32 deg"}
    concrete = {**layer("Wall", cohesion="500 kPa", friction_angle="40 deg"), "points": wall}
    return Section.parse(
        {
            "name": "quay", "surface": surface, "base": {"elevation": -20.0}, "strata": [layer("Sand", **soil)],
            "zones": [concrete], "structures": [{"name": "quay", "kind": "quay", **ends}],
        }
    )  # fmt: skip


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_a_circle_in_the_ground_before_a_wall_is_none_of_its_crest(is_mirrored: bool) -> None:
    """It began at the edge of the crest, at the foot of the wall, and was told as the critical Kh of the quay towards
    the land."""
    section = quay(is_mirrored)
    seaward, landward = (LEFT, RIGHT) if is_mirrored else (RIGHT, LEFT)
    (structure,) = structures_of(section)
    out, back = (face_circle(section, structure, side, None, None, 0.5, 0.0) for side in (seaward, landward))
    assert out is not None
    x = out.surface[[0, -1], 0]
    assert x[0] < structure.crest.right
    assert x[1] > structure.crest.left
    assert max(x) - min(x) > 15.0
    if back is not None:  # in the level ground behind the wall
        x = back.surface[[0, -1], 0] if not is_mirrored else 120.0 - back.surface[[-1, 0], 0]
        assert x[0] < 59.0


def test_a_mirrored_wall_has_the_same_circles() -> None:
    values = []
    for is_mirrored, side in ((False, RIGHT), (True, LEFT)):
        section = quay(is_mirrored)
        circle = face_circle(section, structures_of(section)[0], side, None, 0.0, 0.5, 0.0)
        assert circle is not None
        values.append(circle.bishop)
    assert values[0] == pytest.approx(values[1], rel=0.01)
