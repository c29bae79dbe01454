"""Layers that slip circles cannot follow are told beside the circles."""

from pathlib import Path

import pytest

from meshes.section.section import Section
from tests.support.water import soil
from workflow.estimates.weak_layers import strong_blocks, thin_weak_layers
from workflow.report.slices import slices_sentences
from workflow.results.answer import SectionLabel
from workflow.results.slices import CirclePart, FactorCircles, SlicesAnswer


def bank(thick: float, degrees: float, table: float = -9.0) -> Section:
    """A bank 18 m high, on a seam of so many degrees that dips out of it over rock."""
    seam = {
        "cohesion": 0,
        "friction_angle": f"{degrees} deg",
        "bottom": {"elevation": [[0, 15 - thick], [110, 8 - thick]]},
    }
    return Section.parse(
        {
            "name": "flank",
            "surface": [[0, 30], [30, 30], [70, 12], [110, 12]],
            "base": {"elevation": 0},
            "water": {"table": table},
            "strata": [
                soil("Silt", bottom={"elevation": [[0, 15], [110, 8]]}),
                soil("Seam", **seam),
                soil("Rock", cohesion="100 kPa", friction_angle="38 deg"),
            ],
        }
    )


@pytest.mark.parametrize(
    ("section", "weak"),
    [
        (bank(0.4, 12.0), ("Seam",)),
        (bank(0.4, 12.0, table=11.0), ("Seam",)),  # water cuts it in two
        (bank(0.4, 30.0), ()),  # no weaker than the silt
        (bank(3.0, 12.0), ("Seam",)),  # 1.02 by circles, 0.98 by elements
        (bank(5.0, 12.0), ()),  # circles have room in it
    ],
)
def test_a_thin_and_weak_layer_is_found(section: Section, weak: tuple[str, ...]) -> None:
    assert thin_weak_layers(section) == weak


PUBLISHED = Path(__file__).parents[2] / "verification" / "published"


@pytest.mark.parametrize(
    ("name", "weak"),
    [
        ("griffiths_lane_3_02", ("Weak layer",)),  # 1.27 by circles, strict bounds of 0.487 to 0.496
        ("griffiths_lane_3_05", ("Weak layer",)),  # 1.36, and 1.147 to 1.169
        ("greco_4", ("Layer 3",)),  # 1.45, and 1.381 to 1.408
        ("zolfaghari_2", ("Layer 3",)),  # 1.45, and 1.359 to 1.385
    ],
)
def test_a_layer_of_up_to_a_fifth_of_the_relief_is_thin(name: str, weak: tuple[str, ...]) -> None:
    """Circles were given without a warning up to 2.6 times the factor of safety of published slopes."""
    assert thin_weak_layers(Section.read(PUBLISHED / f"{name}.toml")) == weak


def hillside(thick: float, degrees: float, fall: float = 30.0) -> Section:
    """A hillside, ``fall`` high over 60 m, with a mantle over rock, and rock bare at the left end."""
    top = 20.0 + fall
    mantle = {"depth": [[0, 0.0], [10, 0.0], [20, thick], [120, thick]]}
    return Section.parse(
        {
            "name": "hillside",
            "surface": [[0, top], [20, top], [80, 20], [120, 20]],
            "base": {"elevation": [[0, top], [10, top], [20, top - 15.0], [80, 5], [120, 5]]},
            "strata": [
                soil("Colluvium", bottom=mantle, cohesion="6 kPa", friction_angle=f"{degrees} deg"),
                soil("Rock", cohesion="100 kPa", friction_angle="38 deg"),
            ],
        }
    )


@pytest.mark.parametrize(
    ("section", "weak"),
    [
        (hillside(4.0, 28.0), ("Colluvium",)),
        (hillside(6.0, 28.0), ()),  # circles have room in it
        (hillside(1.0, 28.0, fall=5.0), ()),  # too level to slip along its bottom
    ],
)
def test_a_mantle_that_slips_along_the_rock_is_found_where_the_base_is_bare_elsewhere(
    section: Section, weak: tuple[str, ...]
) -> None:
    """Colluvium of 4 m at 1:2 over rock, water in it, stood at 1.11 by circles, and slips at 0.92 as an infinite slope.
    Columns without ground, where the base comes out, ended the command with a traceback."""
    assert thin_weak_layers(section) == weak


def quay(cohesion: str, mound: str, step: float = 0.0) -> Section:
    """A block 10 m high and 8 m wide on a mound over sand, with water on both sides; its face has a ``step``."""
    face = [[40, 0], [40, -5], [40 + step, -5], [40 + step, -10]]
    return Section.parse(
        {
            "name": "quay",
            "surface": [[0, 0], *(face if step else [face[0], face[-1]]), [90, -10]],
            "base": {"elevation": -25},
            "water": {"table": -3.0},
            "strata": [
                soil("Sand", cohesion="1 kPa", bottom={"elevation": -10}),
                soil("Mound", cohesion=mound, friction_angle="38 deg"),
            ],
            "zones": [
                {
                    **soil("Caisson", cohesion=cohesion, friction_angle="35 deg"),
                    "points": [[32, 0], [32, -10], [40 + step, -10], [40 + step, -5], [40, -5], [40, 0]],
                }
            ],
        }
    )


@pytest.mark.parametrize(
    ("section", "blocks"),
    [
        (quay("500 kPa", "5 kPa"), ("Caisson",)),
        (quay("500 kPa", "5 kPa", step=1.0), ("Caisson",)),
        (quay("20 kPa", "5 kPa"), ()),  # no stronger than a soil
        (quay("500 kPa", "800 kPa"), ()),  # it stands on rock
    ],
)
def test_a_block_at_a_steep_face_on_weaker_ground_is_found(section: Section, blocks: tuple[str, ...]) -> None:
    """A quay had a critical Kh of 0.140 by circles and 0.066 to 0.068 by bounds, without a warning."""
    assert strong_blocks(section) == blocks


def test_circles_that_cross_it_are_told_to_be_no_answer() -> None:
    section = bank(0.4, 12.0)
    circle = CirclePart.model_construct(
        surface_m=((28.0, 30.0), (72.0, 12.0)), towards="right", bishop=1.14, spencer=1.14
    )
    answer = SlicesAnswer.model_construct(
        section=SectionLabel.of(section), factors=(FactorCircles.model_construct(kh=0.0, circles=(circle,)),),
        critical=(), faces=(), least_depth=0.5, reason="", weak_layers=thin_weak_layers(section), source="",
    )  # fmt: skip
    [_, warning] = slices_sentences(answer)
    assert warning.startswith('Warning: Slip circles cut across "Seam", thin and weaker than the ground beside it')


def test_circles_around_a_block_are_told_to_be_no_answer() -> None:
    section = quay("500 kPa", "5 kPa")
    circle = CirclePart.model_construct(
        surface_m=((20.0, 0.0), (60.0, -10.0)), towards="right", bishop=1.35, spencer=1.35
    )
    answer = SlicesAnswer.model_construct(
        section=SectionLabel.of(section), factors=(FactorCircles.model_construct(kh=0.0, circles=(circle,)),),
        critical=(), faces=(), least_depth=0.5, reason="", strong_blocks=strong_blocks(section), source="",
    )  # fmt: skip
    [_, warning] = slices_sentences(answer)
    assert warning.startswith('Warning: Slip circles cannot follow the outline of "Caisson", much stronger than')
