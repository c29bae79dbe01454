"""The report as a page: what it refers to is there, and it holds whatever the stages found or did not."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from PIL import Image

from meshes.errors import InputError
from tests.support import SECTIONS, TOP, dem_fixture
from tests.support.answers import bounds, fem, results, variant
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.figures.displacements import slides
from workflow.report.captions import collect
from workflow.report.page import page
from workflow.report.player import _extent
from workflow.report.run_lines import run_lines
from workflow.report.summary import summary
from workflow.results.answer import SectionLabel
from workflow.results.cases import CasesAnswer, equal_cases
from workflow.results.continuum import VariantsAnswer
from workflow.results.results import Results
from workflow.results.slices import FacePart, FactorCircles, SlicesAnswer
from workflow.results.stability import LiquefiedAnswer, LiquefiedCase, LiquefiedStratum
from workflow.results.summary import NoAnswer, Summary
from workflow.results.verdicts import WarningPart
from workflow.run.store import Store
from workflow.texts.report_texts import Texts


def html(outcome: Results) -> str:
    """The page without the headings that narrow screens show beside the cells."""
    return re.sub(' data-label="[^"]*"', "", page(outcome, summary(outcome, 0.0)))


def whole(run: Config) -> Results:
    """All stages have an answer; one element test could not be done, and there are eleven cases."""
    cases = {number: dem_fixture.case(0.1, 0.5 * number) for number in range(1, 12)}
    return results(
        run, fem=fem(run), variants=VariantsAnswer(variants=(variant("sides", "sides fixed", 0.3),)),
        bounds=bounds(run, 0.22, 0.26),
        dem=dem_fixture.critical(run, 0.24),
        calibration=dem_fixture.calibration(0.24, True),
        cases=CasesAnswer(sets={"calibrated": cases, "table2": cases}, random=None),
    )  # fmt: skip


@pytest.fixture(scope="module")
def s13() -> Config:
    config = Config.load(SECTIONS / "s13.toml")
    return config.model_copy(update={"report": config.report.model_copy(update={"appendix": True})})


@pytest.mark.parametrize("answers", [{}, {"fem": True}])
def test_a_report_without_answers(answers: dict[str, Any], s13: Config) -> None:
    text = html(results(s13, fem=fem(s13)) if answers else results(s13))
    assert "The slide after liquefaction is not known" in text
    assert_refers_to_what_is_there(text)


def test_a_report_without_discs_does_not_describe_them(s13: Config, tmp_path: Path) -> None:
    """A dike in which nothing liquefies was told how discs are filled in, and of slip surfaces of discs."""
    clay = slope()["strata"][0] | {"strength_ratio": 0.25, "friction_angle": "0 deg", "cohesion": "0 kPa"}
    run = Config.parse(slope() | {"strata": [clay, slope()["strata"][1]]})
    text = html(results(run, fem=fem(run)))
    for words in ("The discs are filled in", "Cundall", "Hamada", "constant c and φ"):
        assert words not in text
    assert "Ratios of strength apply to the vertical effective stress before shaking." in text
    assert "The discs are " in html(whole(s13))
    for name in ("slip_surfaces", "dem_model"):
        Image.new("RGB", (9, 9)).save(tmp_path / f"{name}.png")
    assert collect(["slip_surfaces.png"], tmp_path, 9)[0].caption == "Slip surface of the continuum."
    both = collect(["slip_surfaces.png", "dem_model.png"], tmp_path, 9)
    assert both[0].caption.startswith("Slip surfaces of the continuum and of the discs.")


@pytest.mark.parametrize(("warnings", "height"), [(2, 92), (6, 72), (9, 60)])
def test_the_picture_of_the_first_page_leaves_room_for_its_warnings(
    warnings: int, height: int, s13: Config, tmp_path: Path
) -> None:
    """Two of nine warnings of the river bank, and its signature, stood alone on page 2."""
    outcome = results(s13, fem=fem(s13))
    parts = tuple(WarningPart(weight=2, observation=f"Number {k}.", remedy="Look.") for k in range(warnings))
    text = page(outcome, summary(outcome, 0.0).model_copy(update={"warnings": parts}))
    assert f".first figure img {{ max-height: {height}mm; }}" in text


def test_prints_have_flat_and_tall_pictures_in_their_size(s13: Config, tmp_path: Path) -> None:
    """All were as high, so that text of tall ones could not be read, and one sentence of S-13 stood on page 11."""
    (tmp_path / "figures").mkdir()
    for name, size in (("curves", (1600, 512)), ("slip_surfaces", (1600, 962)), ("displacements", (1600, 1123))):
        Image.new("RGB", size).save(tmp_path / f"figures/{name}.png")
    outcome = replace(results(s13, fem=fem(s13)), store=Store(tmp_path))
    shown = dict(
        re.findall(r'<figure id="figures/(\w+).png"><img(?: class="(\w+)")?', page(outcome, summary(outcome, 0.0)))
    )
    assert (shown["curves"], shown["slip_surfaces"], shown["displacements"]) == ("flat", "", "tall")


def test_a_face_that_fails_under_its_own_weight_has_a_row_and_no_block(s13: Config) -> None:
    """An embankment of normally consolidated clay ended the report with "No first item, sequence was empty"."""
    face = FacePart(
        structure="Bank", kind="levee", start_m=0.0, end_m=46.0, crest_m=(20.0, 26.0), towards="left",
        factors=(FactorCircles(kh=0.0, circles=()),), critical=None,
    )  # fmt: skip
    slices = SlicesAnswer(
        section=SectionLabel.of(s13.section), factors=(), critical=(), faces=(face,), least_depth=0.5, reason="none",
        source="",
    )  # fmt: skip
    text = html(results(s13, slices=slices))
    assert "Bank" in text
    assert "Block: " not in text
    assert_refers_to_what_is_there(text)


def test_all_that_is_referred_to_is_there_and_numbered_in_order(s13: Config) -> None:
    text = html(whole(s13))
    assert_refers_to_what_is_there(text)
    tables = [int(number) for number in re.findall(r"<caption[^>]*><b>Table (\d+)\.</b>", text)]
    assert tables == list(range(1, len(tables) + 1))
    assert len(tables) == len(re.findall(r'<table(?! class="(?:head|sign)")', text))
    heads = re.findall(r'<h2 id="(\w+)">(\d+) ', text)
    assert [int(number) for _, number in heads] == list(range(1, len(heads) + 1))
    contents = re.findall(r'<li[^>]*><a href="#(\w+)">', text)
    assert contents == [name for name, _ in heads]


def assert_refers_to_what_is_there(text: str) -> None:
    there = re.findall(r'\bid="([^"]+)"', text)
    assert len(there) == len(set(there))
    assert set(re.findall(r'href="#([^"]+)"', text)) <= set(there)


def test_an_element_test_that_could_not_be_done_says_why(s13: Config) -> None:
    assert "not tested: did not come to rest" in html(whole(s13))


def test_cases_stand_in_the_order_of_their_numbers_and_are_explained(s13: Config) -> None:
    text = html(whole(s13))
    rows = re.findall(r"<tr><td>(\d+)</td><td class=\"n\"><b>", text)
    assert rows == [str(number) for number in range(1, 12)] * 2
    assert "4 Asd, 6 As1: stiffness × 0.1" in text  # what liquefies in a case, and what is left of it
    assert text.index("4 Asd, 6 As1: stiffness") < text.index("largest slide</th>")


def test_cases_that_slide_alike_are_shown_once(s13: Config) -> None:
    """Whatever stiffness they leave: one row for cases 1 and 3, one for case 2, one bar in the picture of slides."""
    first = dem_fixture.case(0.1, 2.0)
    cases = {1: first, 2: dem_fixture.case(0.1, 3.0), 3: first.model_copy(update={"stiffness": 0.01})}
    assert {numbers: case.slide_max_m for numbers, case in equal_cases(cases).items()} == {(1, 3): 2.0, (2,): 3.0}
    result = results(s13, cases=CasesAnswer(sets={"calibrated": cases}, random=None))
    assert re.findall(r"<tr><td>([\d, ]+)</td><td class=\"n\"><b>", html(result)) == ["1, 3", "2"]
    assert [row.description for row in slides(result)][:2] == ["discs, cases 1, 3", "discs, case 2"]


def test_the_slides_of_a_case_stand_beside_its_stability(s13: Config) -> None:
    """Templates call functions with arguments that no other check sees."""
    stratum = LiquefiedStratum(name="4 Asd", cohesion_kPa=15.6, friction_deg=0.0, residual_strength_ratio=0.2)
    stands = [
        LiquefiedCase(
            cases=cases, names=(), strata=(stratum,), verdict="stands", reason="of a test", notes=(), kc=0.09,
            kc_lower=0.085, kc_upper=0.095, factor=4.7, factor_lower=4.6, factor_upper=4.8,
        )
        for cases in ((1, 3), (2,))
    ]  # fmt: skip
    liquefied = LiquefiedAnswer(section=SectionLabel.of(s13.section), sides="free-field", cases=tuple(stands))
    cases = {number: dem_fixture.case(0.1, far) for number, far in ((1, 2.0), (2, 3.0), (3, 2.0))}
    text = html(results(s13, liquefied=liquefied, cases=CasesAnswer(sets={"calibrated": cases}, random=None)))
    rows = re.findall(
        r"<tr><td>(1, 3|2)</td>\s*<td>4 Asd.*?0.085 to 0.095.*?([\d.]+ m)</td></tr>", text, flags=re.DOTALL
    )
    assert rows == [("1, 3", "2.0 m"), ("2", "3.0 m")]


def test_the_input_is_a_table_strata_first(s13: Config) -> None:
    text = html(results(s13))
    assert text.index("Layers as given in the section file.") < text.index("The lines of the section")
    assert "<td>1560 tf/m^2</td>" in text.replace(' class="n"', "")
    assert '<td>ground surface</td><td>elevation</td><td class="points">(0, 9.08)  (200, 0)</td>' in text
    assert "dem.springs" in text  # which S-13 sets
    assert "fem.kh_limit" not in text  # which it leaves as it is


def test_the_head_is_the_users(tmp_path: Path) -> None:
    Image.new("RGB", (4, 4)).save(tmp_path / "logo.png")
    head = {"project": "Dam <7>", "client": "能代市", "logo": str(tmp_path / "logo.png")}
    text = html(results(Config.parse({**slope(), "report": head})))
    assert "<td>Dam &lt;7&gt;</td>" in text
    assert "<td>能代市</td>" in text
    assert "<th>author</th>" not in text
    assert '<img class="logo" src="data:image/png;base64,' in text
    assert str(tmp_path) not in text
    wrong = Config.parse({**slope(), "report": {"logo": "logo.tiff"}})
    with pytest.raises(InputError, match="expected a picture"):
        html(results(wrong))


def test_a_logo_that_is_not_there_is_told_when_the_input_is_read(tmp_path: Path) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps({**slope(), "report": {"logo": "none.png"}}))
    with pytest.raises(InputError, match=r"report, logo = .*none\.png: there is no such file"):
        Config.load(path)


def test_no_markup_of_a_template_stands_raw_in_a_page() -> None:
    """A text in quotation marks is escaped as any other, so that one with tags in it has to say that it is safe."""
    raw = [
        (file.name, text)
        for file in (TOP / "workflow/report").glob("*.jinja")
        for expression in re.findall(r"{{(.*?)}}|{%(.*?)%}", file.read_text(encoding="utf-8"), flags=re.DOTALL)
        for text in re.findall(r'"[^"]*<[a-z]+>[^"]*"(?!\)?\s*\|\s*safe)', "".join(expression))
    ]
    assert raw == []


def test_a_summary_with_warnings_as_sentences_is_still_read(s13: Config) -> None:
    """Runs of version 0.1 are compared with those of today."""
    today = summary(whole(s13), 0.0)
    old = today.model_dump(mode="json", exclude={"warnings", "headlines", "findings"}) | {
        "doubtful": ["The base is near."]
    }
    read = Summary.model_validate(old)
    assert [(warning.weight, warning.observation) for warning in read.warnings] == [(2, "The base is near.")]
    assert read.in_short == today.in_short


def test_a_run_is_told_in_twelve_lines(s13: Config) -> None:
    """With the line of the report and that of the folder."""
    result = summary(whole(s13), 0.0)
    lines = run_lines(result)
    assert len(lines) <= 10
    assert lines[0].startswith("critical Kh: 0.2")
    many = result.model_copy(update={"warnings": result.warnings * 10})
    assert len(run_lines(many)) <= 9
    assert run_lines(many)[-1].endswith("more warnings are in the report.")
    known = WarningPart(
        weight=2, observation="The ground is a reconstruction.", remedy="Confirm the depths of the layers by borings."
    )
    japanese = run_lines(many.model_copy(update={"warnings": (known,) * 20}), Texts("ja"))
    assert "- 地盤は推定による復元である。 各層の深さをボーリングで確認する。" in japanese
    assert japanese[-1].startswith("報告書にはさらに警告が")
    failed = {"fem": NoAnswer(reason="the reason", remedy="")}
    without = result.model_copy(update={"no_answer": failed, "warnings": ()})
    assert run_lines(without)[-1] == "the stage fem has no answer: the reason"
    assert run_lines(without, Texts("ja"))[-1] == "計算段階「fem」の結果はない(the reason)"


def test_a_film_shows_ground_that_slides_out_of_its_section() -> None:
    """Discs of 1 m in 100 m of width: 4 m beyond the right side are shown; of a disc that flies away a tenth is."""
    start = np.linspace(1.0, 99.0, 50)
    assert _extent([start, start + 4.0], 1.0) == pytest.approx((0.0, 104.0))
    assert _extent([start, np.append(start, 900.0)], 1.0) == pytest.approx((0.0, 110.0))


def test_a_report_without_displacements_has_no_empty_table_of_them(s13: Config) -> None:
    """A block under a constant Kh above the critical one moves without end: heading, caption and head had no row."""
    run = analysed(slope())
    text = html(results(run, fem=fem(run, 0.05)))
    assert "Displacements by other methods" not in text
    assert "Displacements by other methods" in html(results(s13, fem=fem(s13)))
    for table in re.findall(r"<table>(.*?)</table>", text, re.DOTALL):
        assert "<td" in table
