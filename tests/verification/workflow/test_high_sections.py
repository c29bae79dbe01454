"""Slip circles of a part of a high section."""

from meshes.section.section import Section
from tests.support.sections import layer
from workflow.estimates.slices import LEFT
from workflow.estimates.slip_circles import critical_circle


def test_a_failure_of_one_bench_is_found_in_a_high_section() -> None:
    """Colluvium on the 63° face of a cut 160 m high has 0.67 by itself, in a section of 80 m. The smallest circle of
    the whole section, at least 2 % of its height deep (4 m), had 1.41."""
    ground = [[0, 100], [40, 100], [70, 160], [80, 160], [110, 220], [180, 250], [300, 262]]
    colluvium = layer(
        "colluvium", bottom={"depth": [[100, 0], [130, 12], [180, 15], [300, 6]]}, cohesion="5 kPa",
        friction_angle="33 deg",
    )  # fmt: skip
    rock = layer("rock", cohesion="433 kPa", friction_angle="34 deg")
    section = Section.parse({"name": "cut", "surface": ground, "base": {"elevation": 60}, "strata": [colluvium, rock]})
    circle = critical_circle(section, LEFT, 0.0)
    assert circle is not None
    assert circle.bishop < 0.75
    assert 100.0 < circle.surface[0][0] < circle.surface[-1][0] < 115.0
