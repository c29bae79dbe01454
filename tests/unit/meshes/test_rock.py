"""The strength of rock as the page on sections computes it, by the equations that the page shows."""

import math
import re

import pytest

from tests.support import TOP
from tests.support.docs import blocks

PAGE = TOP / "docs/how-to/section.md"
FUNCTIONS = {"exp": math.exp, "sqrt": math.sqrt, "asin": math.asin}
TOKEN = re.compile(r"\d+\.?\d*|σcm|σci|GSI|exp|sqrt|asin|mb|mi|[aknsDHγ]|[-+*/^()]")


def value(formula: str, values: dict[str, float]) -> float:
    """The value of a formula as textbooks write it, in which two factors side by side are multiplied."""
    written, before = "", ""
    for token in TOKEN.findall(formula):
        factor = before == ")" or (before[-1:].isalnum() and before not in FUNCTIONS)
        written += "*" if factor and (token == "(" or token[0].isalnum()) else ""
        written, before = written + token.replace("^", "**"), token
    return float(eval(written, {**FUNCTIONS, **values}))


def test_the_equations_of_the_page_give_the_strength_of_its_rock() -> None:
    """433 kPa and 34.0° by Hoek, Carranza-Torres & Corkum (2002)."""
    (equations,) = (block for block in blocks("text", PAGE.read_text(encoding="utf-8")) if "GSI" in block)
    values = {"σci": 30e6, "GSI": 50.0, "mi": 10.0, "D": 0.7, "γ": 25e3, "H": 100.0}
    for line in re.split(r"\n|\s{3,}", equations.strip()):
        name, _, formula = line.partition("=")
        values[name.strip()] = value(formula, values)
    assert values["cohesion"] / 1e3 == pytest.approx(433.0, abs=0.5)
    assert math.degrees(values["friction angle"]) == pytest.approx(34.0, abs=0.05)
