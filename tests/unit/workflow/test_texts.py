"""The catalogue of the report's texts: each text has its Japanese, with the same values, and none is left over."""

import ast
import re
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
from jinja2 import Environment
from jinja2.ext import extract_from_ast
from markupsafe import escape
from pydantic import BaseModel

from dem.settings import SlideMethod
from meshes.shipped import file_of
from tests.support import TOP
from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.config.tables import ReportSettings
from workflow.estimates.slide_error import SlideError
from workflow.report import assumptions, uncertainty
from workflow.report.captions import CAPTIONS, WITHOUT_DISCS
from workflow.report.first_page import FLOW, IN_FULL, SIDES, headlines
from workflow.report.model_error import error_sentence
from workflow.report.page import VARIED
from workflow.report.tables import STRATA_HEADS
from workflow.report.warnings import split_warning
from workflow.results.accuracy import METHODS
from workflow.results.answer import FORCE
from workflow.results.governing import MethodSlides
from workflow.texts.catalogue import catalogue
from workflow.texts.report_texts import Texts

REPORT = TOP / "workflow/report"
# Of the reports of a study and of a comparison, which are in English alone.
ENGLISH = ("study.html.jinja", "side_by_side.html.jinja")


def of_templates() -> Iterator[str]:
    for path in REPORT.glob("*.jinja"):
        if path.name not in ENGLISH:
            tree = Environment().parse(path.read_text(encoding="utf-8"))
            for _, _, text in extract_from_ast(tree, gettext_functions=("_",)):
                yield from [text] if isinstance(text, str) else [part for part in text or () if part is not None]


def of_code() -> Iterator[str]:
    """Every literal that is asked for, and every literal that is given the name ``word`` first."""
    for path in REPORT.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in ("_", "texts", "self.texts") and node.args:
                text = node.args[0]
            elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "word":
                text = node.value
            else:
                continue
            if isinstance(text, ast.Constant) and isinstance(text.value, str):
                yield text.value


def headings() -> Iterator[str]:
    """Heads of rows, which the code yields with their sentences."""
    for module in (assumptions, uncertainty):
        source = ast.parse((REPORT / f"{module.__name__.rpartition('.')[2]}.py").read_text(encoding="utf-8"))
        for node in ast.walk(source):
            if isinstance(node, ast.Yield) and isinstance(node.value, ast.Tuple):
                head = node.value.elts[0]
                if isinstance(head, ast.Constant):
                    yield head.value


def warnings_of_report() -> Iterator[str]:
    """The sentences of the warnings that the report writes itself, with {} in the place of values."""
    for name in ("warnings.py", "contradictions.py"):
        for node in ast.walk(ast.parse((REPORT / name).read_text(encoding="utf-8"))):
            text = node.value.elts[-1] if isinstance(node, ast.Yield) and isinstance(node.value, ast.Tuple) else None
            text = node.value if isinstance(node, ast.Yield) and text is None else text
            if isinstance(text, ast.JoinedStr):
                parts = [part.value if isinstance(part, ast.Constant) else "{}" for part in text.values]
                yield from (item for item in split_warning("".join(map(str, parts))) if re.search("[a-z]{4}", item))
            elif isinstance(text, ast.Constant):
                yield from split_warning(str(text.value))


def wanted() -> set[str]:
    fixed = [*FORCE.values(), *FLOW.values(), *IN_FULL.values(), *SIDES.values(), *VARIED, *METHODS, "left", "right"]
    heads = [head.strip().replace("\n", ", ") for head in STRATA_HEADS]
    head = [name for name, field in ReportSettings.model_fields.items() if field.annotation is str and name != "logo"]
    machine = ["host", "system", "processor"]
    captions = [*(caption.description for caption in CAPTIONS), *WITHOUT_DISCS.values()]
    return {*of_templates(), *of_code(), *headings(), *fixed, *heads, *head, *machine, *captions}


def test_every_text_has_its_japanese() -> None:
    assert sorted(wanted() - set(catalogue("ja"))) == []


def test_every_description_of_a_setting_has_its_japanese() -> None:
    """But for those of [report], which the report does not describe."""
    described = {
        str(field.description)
        for table in Config.tables()
        if table != "report"
        for field in type(Config.model_fields[table].default).model_fields.values()
    }
    assert set(catalogue("ja", "settings")) == described


@pytest.mark.parametrize(("english", "japanese"), sorted(catalogue("ja", "settings").items()))
def test_a_description_in_japanese_has_the_same_choices(english: str, japanese: str) -> None:
    choices = [set(re.findall(r'"[^"]+"|\[\[?[a-z_.]+\]\]?', text)) for text in (english, japanese)]
    assert choices[0] == choices[1]


def test_every_warning_has_its_japanese() -> None:
    """But for words about the response of layers, and what cases say."""
    missing = {text for text in warnings_of_report() if text not in catalogue("ja", "sentences")}
    assert all(text.startswith(("In the response of", "{} ({}")) for text in missing)


def test_a_warning_is_translated_with_its_numbers() -> None:
    text = (
        "The surface falls by 6.1 to 6.9 m at x = 66 to 70 m in cases 1 and 2, far more than the median settlement "
        "of the upslope third."
    )
    assert Texts("ja").sentence(text) == (
        "ケース1、2で地表がx = 66~70 mにおいて6.1~6.9 m沈下し、上方1/3の沈下量の中央値を大きく上回る。"
    )
    mixed = "In cases 1 and 2 the layers keep 0.1 of the stiffness, and what nobody has translated."
    assert Texts("ja").page(f"<p>{mixed}</p>") == f"<p>{mixed}</p>"
    assert Texts("ja").sentence("What nobody has translated.") == "What nobody has translated."
    assert Texts().sentence(text) == text


@pytest.mark.parametrize(
    "sentence",
    [
        "On 3 random packings calibrated to the same critical Kh the largest slide is 0.94 m (0.74 to 1.1 m; 95 % "
        "interval of the mean of all packings: 0.51 to 1.4 m) in cases 1, 2 and 3.",
        "0.2801 &lt;= Kh &lt;= 0.2810, gap 0.31 %, force downslope (to the right), 8446 triangles, and the failing "
        "ground reaches the right side (free-field sides; associated, ψ = φ).",
        'Strata "A" (2.3 m), "B" (2.1 m) liquefy and are less than two disc diameters thick in the model (cases 1, 2 '
        "and 3).",
    ],
)
def test_values_within_a_sentence_are_japanese(sentence: str) -> None:
    japanese = Texts("ja").sentence(sentence)
    assert japanese.endswith("。")
    assert re.search("[a-z]{3}", japanese.replace("&lt;", "")) is None
    assert "充填" in japanese if "packings" in sentence else "充填" not in japanese


@pytest.mark.parametrize("factor", [2.0, 5.0, 10.0])
@pytest.mark.parametrize("kind", ["flow failures", "lateral spreads", "field slides"])
@pytest.mark.parametrize("method", ["discs", "mpm"])
def test_the_error_on_known_slides_has_its_japanese(factor: float, kind: str, method: SlideMethod) -> None:
    fixed = 3 if factor == 10.0 else 8
    error = SlideError(kind, factor, fixed, 9, 1.9, method)
    sentence = Texts("ja").sentence(error_sentence(MethodSlides(method, {}, (1.0, 2.0), error)))
    assert sentence.endswith("。")
    assert re.search("[a-z]{4}", sentence) is None


@pytest.mark.parametrize(("english", "japanese"), sorted(catalogue("ja", "sentences").items()))
def test_a_translated_sentence_has_as_many_values(english: str, japanese: str) -> None:
    used = {int(number) for number in re.findall(r"{(\d+)}", japanese)}
    assert used <= set(range(english.count("{}")))


def test_no_text_is_left_over() -> None:
    assert sorted(set(catalogue("ja")) - wanted()) == []


@pytest.mark.parametrize("text", sorted(catalogue("ja")))
def test_a_translation_has_the_same_values(text: str) -> None:
    values = [sorted(re.findall(r"{\w*}|<[^>]+>", item)) for item in (text, catalogue("ja")[text])]
    assert values[0] == values[1]


def test_a_report_in_japanese_says_the_same_numbers() -> None:
    run = analysed(slope())
    result = results(run, fem=fem(run, 0.2345), bounds=bounds(run, 0.2293, 0.2349))
    english, japanese = headlines(result, Texts())[0], headlines(result, Texts("ja"))[0]
    assert japanese.value == english.value
    assert japanese.interval == "厳密な上下界で 0.229~0.235"
    assert re.findall(r"\d+\.\d+", japanese.conclusion) == re.findall(r"\d+\.\d+", english.conclusion)
    assert "斜面下方" in japanese.conclusion


@pytest.mark.parametrize(
    "html",
    [
        "<p>剛体ブロックによる。 Elsewhere, from x = 41 to 46 m towards the left, critical Kh is 0.039: no "
        "crest is part of this failure. 全体のものである。</p>",
        "<sup>b</sup> Warning: 13 % of the energy is lost, so that the slide is a low estimate;<br><sup>c</sup>",
        "<td>In case 1 liquefaction leaves 砂 with a residual strength of 4.6 kPa and 4.2 kPa, a shear strain of 45 % "
        "before strength is regained and 3.8 % less of its volume, and none of its friction and cohesion.</td>",
        "<sup>a</sup> the ground has piled up by 2.6 m at the right side: take a longer section (setting beyond);<br>"
        "<sup>b</sup> the right side of the box stopped the slide: in a longer section it would continue.",
        "<sup>a</sup> the discs are softer than the soil, since their contact stiffness kn is at most 800 times the "
        "vertical effective stress of the layer;<br>",
        "<td>discs, cases 1, 2, 3</td><td>settlement, upslope third</td><td>0.65, seismic 1.65</td>",
        "<p>Discs slide 32 m and material points 33 m, and both agree, since a side of the model limits the slide of "
        "the discs (case 1).</p>",
        "<p>After liquefaction, in case 2 (low strength), the continuum does not stand without shaking: an upper bound "
        "proves a factor of safety below 0.20.</p>",
        "<td>not assessed: plasticity index 25 % is at least 7 %: behaves as clay; above the water table</td>",
    ],
)
def test_sentences_between_japanese_ones_and_notes_of_tables_are_japanese(html: str) -> None:
    translated = re.sub("<[^>]+>", "", Texts("ja").page(html))
    assert not re.search("[a-z]{4}", translated.replace("(beyond)", "")), translated
    assert all(number in translated for number in re.findall(r"\d+\.?\d*", re.sub("<[^>]+>", "", html)))


@pytest.mark.parametrize("name", ["s13", "river_bank", "natural_slope", "moss_landing"])
def test_assumptions_and_checks_of_a_report_are_japanese(name: str) -> None:
    """Sentences with values are not among the texts that are counted above: some were changed in English alone."""
    run = analysed(tomllib.loads(file_of(name).read_text(encoding="utf-8")))
    by_path = fem(run, 0.2345)
    for answer in (by_path, by_path.model_copy(update={"kc_lower": 0.22, "kc_upper": 0.2345})):
        rows = [*assumptions.assumptions(run), *uncertainty.sources_of_uncertainty(results(run, fem=answer))]
        for heading, words in rows:
            translated = Texts("ja").page(f"<td>{escape(words)}</td>")
            assert not re.search(r"[a-z)](?<! al)\.( |<)", translated), (heading, translated)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"kh": 0.2, "kh_cycles": 10.0, "kh_period": 0.6},
            "lose strength over 5 s, before the first cycle or, where borings give F_L, during the cycles. The "
            "ground slides under Kh = 0.2 in both directions (10 cycles, period 0.6 s): uniform cycles",
        ),
        (
            {"kh": 0.2, "kh_cycles": 10.0, "kh_period": 0.6, "liquefies_at": 2.0, "onset": 3.0},
            "lose strength over 3 s, from 2 s after the cycles begin. The ground slides under",
        ),
        (
            {"kh": 0.1, "kh_seconds": 9.0, "onset": 0.0},
            "lose strength at once, after the constant Kh has begun to act. The ground slides under a constant Kh = "
            "0.1 for 9 s, while",
        ),
        ({"kh": 0.0}, "lose strength over 5 s. The ground slides under its weight alone, as if"),
        ({"accelerogram": "a.csv"}, "lose strength over 5 s, during the record. The ground slides under the record"),
        ({"accelerogram": "a.csv", "liquefies_at": 4.0}, "lose strength over 5 s, from 4 s of the record. The ground"),
    ],
)
def test_the_report_states_when_layers_liquefy_relative_to_the_shaking(changes: dict[str, Any], sentence: str) -> None:
    """Layers without blow counts liquefied "under" cycles that begin only after their onset."""
    bank = analysed(tomllib.loads(file_of("river_bank").read_text(encoding="utf-8")))
    if "kh_cycles" not in changes:
        changes = {"kh_cycles": None, "kh_period": None, **changes}
    run = bank.model_copy(update={"slide": bank.slide.model_copy(update=changes)})
    words = dict(assumptions.assumptions(run))["Liquefaction"]
    assert sentence in words
    translated = Texts("ja").page(f"<td>{escape(words)}</td>")
    assert not re.search(r"[a-z)](?<! al)\.( |<)", translated), translated


def test_settings_that_texts_ask_for_are_settings() -> None:
    """ "fem.safety_factors = [0] asks for one" was told of a key that no file may have."""
    named = re.compile(rf"(?<![\w./])({'|'.join(Config.tables())})\.([a-z_]+) = ")
    requested = [match for text in catalogue("ja") for match in named.finditer(text)]
    assert requested
    for match in requested:
        table = Config.model_fields[match[1]].annotation
        assert issubclass(table, BaseModel)
        assert match[2] in table.model_fields, match[0]


def test_a_change_of_the_flow_rule_is_not_translated_as_a_change_of_the_sides() -> None:
    """The two changes stood in one sentence, of which the translation made one change of both."""
    of_flow = (
        "With the flow rule of the given ψ (equilibrium path) instead of Davis's estimate the critical Kh is 0.228, "
        "by the ratio of two results (both with the quadratic element)."
    )
    of_sides = "With sides fixed instead of free-field the critical Kh is 0.314."
    text = Texts("ja").page(f"<p>{of_flow} {of_sides}</p>")
    before, after = text.split("0.228")
    assert "Davisの推定でなく" in before
    assert "側方" not in before
    assert "自由地盤でなく側方固定とすると限界Khは0.314" in after


@pytest.mark.parametrize(
    "text",
    [
        "Critical Kh of 副堤, towards the left, by finite elements and bounds: the ground from x = 0 to 52 m and from "
        "x = 52 to 76 m down to 0.5 m is taken as too strong to fail, because failures there come first.",
        "Factor of safety of 本堤, towards the left, after shaking or liquefaction, by finite elements: other ground "
        "is taken as too strong to fail, because failures there come first.",
        "本堤, material points, case 2, 低強度",
        "In cases 1 and 2 (中央値, 低強度) liquefaction leaves 緩い砂 with a residual strength of 0.12, 0.07 of the "
        "vertical effective stress, and none of its friction and cohesion.",
        'Zones: of "粘土" there are 2 parts that lie one below another, "粘土" and "粘土 2".',
        "Zones: some of them raise the ground, by up to 9.5 m.",
        'Zones 1 "砂": 2.2 % of it lies past the sides or below the base, and is left out.',
        "Water: all of the ground lies below water, at most 120 m deep.",
        'Geometry: stratum "砂" is 0.25 mm thick at x = 51 m: less than 9.1 mm is neglected.',
        'Strata 1 "砂": it liquefies in [1], and lies above the water table.',
        "at least 2.0 m",
    ],
)
def test_notes_of_a_japanese_report_are_japanese_with_the_same_numbers(text: str) -> None:
    """They stood in English in the report of two embankments on a lens that liquefies."""
    japanese = Texts("ja").sentence(text)
    assert not re.search("[a-z]{3}", japanese), japanese
    assert sorted(re.findall(r"\d+\.?\d*", japanese)) == sorted(re.findall(r"\d+\.?\d*", text))
