"""What the report asks for where the condition at the sides decides the critical Kh."""

from tests.support.answers import fem, results, variant, warned
from tests.support.sections import slope
from workflow.config import Config
from workflow.results.continuum import VariantsAnswer
from workflow.texts.report_texts import Texts

REMEDY = (
    'Take fem.sides = "smooth" if level ground continues beyond the right side, through which the failing ground '
    "slides out."
)


def warned_of_sides(kc_fixed: float | None) -> list[str]:
    """The warnings of a slope whose mechanism (kc 0.2345) ends at the right side, with kc between fixed sides."""
    run = Config.parse(slope())
    answer = fem(run, 0.2345).model_copy(update={"at_sides": ("right",)})
    variants_answer = VariantsAnswer(variants=(variant("sides", "sides fixed instead of free-field", kc_fixed),))
    return [text for text in warned(results(run, fem=answer, variants=variants_answer)) if "side" in text]


def test_sides_are_held_where_level_ground_slides_out_at_one() -> None:
    """Farther away the ground would slide out just so. Smooth sides were advised beside an endless slope, too, which
    they support."""
    [sides] = warned_of_sides(0.338)
    assert sides.startswith("With sides fixed")
    assert sides.endswith(REMEDY)
    japanese = 'すべりが抜け出る右側の外に水平な地盤が続く場合は、fem.sides = "smooth"とする。'
    assert Texts("ja").sentence(REMEDY) == japanese


def test_one_warning_tells_of_a_side_that_the_mechanism_reaches() -> None:
    """None where other sides were seen to change little, one where no others were computed."""
    assert warned_of_sides(0.24) == []
    what = "The ground that fails reaches the right side, so that the boundary condition there may govern."
    assert warned_of_sides(None) == [f"{what} {REMEDY}"]
    assert Texts("ja").sentence(what) != what


def test_points_behind_a_bank_with_a_sloping_bed_have_smooth_sides_unless_the_file_says_otherwise() -> None:
    bank = {**slope(), "surface": [[0.0, 18.0], [20.0, 18.0], [44.0, 6.0], [70.0, 4.0]]}
    bank.pop("fem", None)
    run = Config.parse(bank)
    assert (run.fem.sides, run.slide.mpm_sides) == ("free-field", "smooth")
    said = Config.parse({**bank, "fem": {"sides": "free-field"}})
    assert (said.fem.sides, said.slide.mpm_sides) == ("free-field", None)
    chosen = Config.parse({**bank, "slide": {"mpm_sides": "fixed"}})
    assert chosen.slide.mpm_sides == "fixed"
