"""The catalogue of the report's texts: each text has its Japanese, with the same values, and none is left over."""

import ast
import re
from collections.abc import Iterator

import pytest
from jinja2 import Environment
from jinja2.ext import extract_from_ast

from tests.support import TOP
from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, slope
from workflow.report import assumptions, uncertainty
from workflow.report.captions import CAPTIONS
from workflow.report.first_page import DIRECTION, FLOW, SIDES, headlines
from workflow.report.page import VARIED
from workflow.report.tables import STRATA_HEADS
from workflow.report.texts import Texts, catalogue
from workflow.tables import ReportSettings

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


def wanted() -> set[str]:
    fixed = [*DIRECTION.values(), *FLOW.values(), *SIDES.values(), *VARIED, "left", "right"]
    heads = [head.strip().replace("\n", ", ") for head in STRATA_HEADS]
    head = [name for name, field in ReportSettings.model_fields.items() if field.annotation is str and name != "logo"]
    machine = ["host", "system", "processor"]
    captions = [caption.words for caption in CAPTIONS]
    return {*of_templates(), *of_code(), *headings(), *fixed, *heads, *head, *machine, *captions}


def test_every_text_has_its_japanese() -> None:
    assert sorted(wanted() - set(catalogue("ja"))) == []


def test_no_text_is_left_over() -> None:
    assert sorted(set(catalogue("ja")) - wanted()) == []


@pytest.mark.parametrize("text", sorted(catalogue("ja")))
def test_a_translation_has_the_same_values(text: str) -> None:
    found = [sorted(re.findall(r"{\w*}|<[^>]+>", one)) for one in (text, catalogue("ja")[text])]
    assert found[0] == found[1]


def test_a_report_in_japanese_says_the_same_numbers() -> None:
    run = analysed(slope())
    found = results(run, fem=fem(run, 0.2345), bounds=bounds(run, 0.2293, 0.2349))
    english, japanese = headlines(found, Texts())[0], headlines(found, Texts("ja"))[0]
    assert japanese.value == english.value
    assert japanese.interval == "厳密な上下界で 0.229~0.235"
    assert re.findall(r"\d+\.\d+", japanese.conclusion) == re.findall(r"\d+\.\d+", english.conclusion)
    assert "下り斜面" in japanese.conclusion
