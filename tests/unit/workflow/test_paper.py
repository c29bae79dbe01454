"""The paper's numbers against ours: which rows agree, and that no other section is compared with it."""

from pathlib import Path
from typing import Any

import pytest

from tests.support import SECTIONS, dem_fixture
from tests.support.answers import bounds, fem, results
from tests.support.sections import slope
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.estimates.comparison import is_s13
from workflow.report.paper import rows
from workflow.report.uncertainty import sources_of_uncertainty
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import Variant, VariantsAnswer
from workflow.results.results import Results
from workflow.results.summary import PaperRow
from workflow.run.record import Entry
from workflow.run.store import Store
from workflow.stages import sliding

S13 = SECTIONS / "s13.toml"


def table(outcome: Results) -> dict[str, PaperRow]:
    return {row.quantity: row for row in rows(outcome)}


@pytest.fixture(scope="module")
def s13() -> Config:
    return Config.load(S13)


def test_only_the_papers_section_is_compared(s13: Config) -> None:
    other = Config.parse({**slope(), "name": "s13"})
    assert is_s13(s13.section)
    assert not is_s13(other.section)
    assert rows(results(other, fem=fem(other))) == []


def test_before_anything_is_computed_only_the_smooth_block_agrees(s13: Config) -> None:
    result = table(results(s13))
    assert {row.agrees for name, row in result.items() if "smooth" not in name} == {None}
    assert result["block on a smooth plane of 2.6°"].agrees is True


def test_what_agrees_says_no_more_and_what_does_not_says_why(s13: Config) -> None:
    for kc, agrees in ((0.24, True), (0.2749, True), (0.2751, False), (0.2, False)):
        row = table(results(s13, fem=fem(s13, kc)))["FEM: critical Kh"]
        assert row.agrees is agrees
        assert bool(row.reason) is not agrees


def test_the_continuum(s13: Config) -> None:
    result = table(results(s13, fem=fem(s13)))
    assert result["FEM: stands at Kh = 0.2, Asd layers below water at failure"].agrees is True
    assert result["FEM: failure surface in the Asd layers"].ours == "100 % of its length"
    assert result["FEM: Kh = 0.3 is past equilibrium, failure zone from Asd to the surface"].agrees is True
    strong = table(results(s13, fem=fem(s13, 0.35)))
    row = strong["FEM: Kh = 0.3 is past equilibrium, failure zone from Asd to the surface"]
    assert row.agrees is False
    assert row.ours.startswith("stands")


def test_an_undecided_path_is_no_critical_kh(s13: Config) -> None:
    result = results(s13, fem=fem(s13, verdict="undecided"))
    assert result.kc is None
    assert table(result)["FEM: critical Kh"].agrees is None


def test_slides_and_settlements_within_thirty_percent(s13: Config) -> None:
    """The hand-made cases: settlements 0.1, 0.5, 1.0 m; slides 0.6, 3.0, 4.8 m, over 10, 51, 81 % of the surface."""
    cases = CasesAnswer(sets={"calibrated": dem_fixture.CASES}, random=None)
    result = table(results(s13, fem=fem(s13), cases=cases))
    springs = ", calibrated springs"
    for number in "123":
        assert result[f"settlement uphill, case {number}{springs}"].agrees is True
    assert result[f"largest slide, case 2{springs}"].agrees is True  # 3.0 for 3.3
    assert result[f"largest slide, case 3{springs}"].agrees is True  # 4.8 for 4.9
    assert result[f"slide, case 1{springs}"].agrees is True
    assert result[f"slide, case 3{springs}"].agrees is True
    assert result["slide measured in the field"].ours == "3.0 to 4.8 m in cases 2 and 3"
    wrong = {**dem_fixture.CASES, 2: dem_fixture.case(0.02, 2.3)}  # 30 % less than 3.3 is 2.31
    result = table(results(s13, fem=fem(s13), cases=CasesAnswer(sets={"calibrated": wrong}, random=None)))
    assert result[f"largest slide, case 2{springs}"].agrees is False
    assert "docs/theory/paper.md" in result[f"largest slide, case 2{springs}"].reason


def test_states_of_the_discs(s13: Config) -> None:
    critical = dem_fixture.critical(s13, 0.24)
    result = table(results(s13, fem=fem(s13), dem=critical))
    for springs in (", before calibration", ", calibrated"):
        assert result[f"DEM: stands at Kh = 0.2{springs}"].agrees is True
        assert result[f"DEM: pore springs broken along the Asd layers at Kh = 0.3{springs}"].agrees is True
    critical = dem_fixture.critical(s13, 0.24, {"8 As1": 0.9})
    result = table(results(s13, fem=fem(s13), dem=critical))
    row = result["DEM: pore springs broken along the Asd layers at Kh = 0.3, calibrated"]
    assert row.agrees is False
    assert "90 % of 8 As1" in row.reason


@pytest.mark.parametrize(
    ("lower", "upper", "flow", "words"),
    [
        (0.22, 0.26, "associated", "contradicts these bounds"),
        (0.25, 0.26, "associated", "below the strict lower bound"),
        (0.22, 0.23, "associated", "above the strict upper bound"),
        (0.25, 0.26, "davis", "contradicts these bounds"),
        (0.22, 0.23, "davis", "no smaller ψ can exceed"),
        (0.22, 0.23, "non-associated", "no smaller ψ can exceed"),
    ],
)
def test_upper_bounds_judge_every_smaller_dilation_and_lower_ones_their_own(
    lower: float, upper: float, flow: str, words: str
) -> None:
    """The critical Kh is 0.24; the bounds are those of ψ = φ."""
    run = Config.parse({**slope(), "fem": {"flow": flow}})
    answer = fem(run).model_copy(update={"flow": flow})
    messages = dict(sources_of_uncertainty(results(run, fem=answer, bounds=bounds(run, lower, upper))))
    assert words in messages["Strict bounds"]


def test_variants_stand_beside_what_they_show(s13: Config) -> None:
    change = "sides fixed instead of free-field"
    variant = Variant(name="sides", change=change, kc=0.3, kc_upper=0.31, verdict="plateau", reason="", seconds=1.0)
    messages = dict(sources_of_uncertainty(results(s13, fem=fem(s13), variants=VariantsAnswer(variants=(variant,)))))
    assert "sides fixed instead of free-field, the critical Kh is 0.300 (+25.0 %)" in messages["Side condition"]
    none = Variant(name="sides", change=change, kc=None, kc_upper=None, verdict="undecided", reason="slow", seconds=1.0)
    silent = dict(sources_of_uncertainty(results(s13, fem=fem(s13), variants=VariantsAnswer(variants=(none,)))))
    assert "undecided, slow" in silent["Side condition"]


def test_no_answer_is_told_as_such(s13: Config) -> None:
    ended = Entry({}, "no answer", reason="it fails under its own weight")
    result = Results(s13, Store("nowhere"), {"fem": ended}, {})
    assert table(result)["FEM: critical Kh"].ours == "no answer: it fails under its own weight"


@pytest.mark.parametrize(("springs", "kh", "cycles"), [("table2", 0.1, None), ("calibrated", 0.166, 17.5)])
def test_the_papers_own_discs_keep_its_kh_beside_an_earthquake(
    s13: Config, springs: str, kh: float, cycles: float | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Kh = 0.1 for ever (Sec. 4(3)); discs of soil have 0.65 of 250 gal in the cycles of M 7.7."""
    loaded: list[Any] = []

    class StoppedError(Exception):
        pass

    def slider(*arguments: Any, free_sides: bool, by_weight: bool) -> None:
        loaded.extend(arguments)
        raise StoppedError

    monkeypatch.setattr(sliding, "Slider", slider)
    config = config_after_triggering(s13)
    planned = sliding.PlannedSlide(springs, 2, None, None, [3, 5], config.cases[1])  # type: ignore[arg-type]
    with pytest.raises(StoppedError):
        sliding.slide_of_discs(sliding.SlideTask(config, Store(tmp_path), planned), lambda _: None)
    settings, shaking = loaded[4], loaded[6]
    assert (settings.kh, settings.kh_cycles) == (pytest.approx(kh, abs=5e-4), cycles)
    assert (shaking is None) == (cycles is None)
