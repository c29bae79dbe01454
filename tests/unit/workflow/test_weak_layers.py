"""Layers that slip circles cannot follow are told beside the circles."""

import pytest

from meshes.section.section import Section
from tests.support.water import soil
from workflow.estimates.weak_layers import thin_weak_layers
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
        (bank(3.0, 12.0), ()),  # circles have room in it
    ],
)
def test_a_thin_and_weak_layer_is_found(section: Section, weak: tuple[str, ...]) -> None:
    assert thin_weak_layers(section) == weak


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
    assert warning.startswith(
        'Warning: Slip circles cut across "Seam", thin and weaker than the ground above and below'
    )
