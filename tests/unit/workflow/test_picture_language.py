"""Pictures of a run are in the language of its report; names stay as they are."""

import itertools
import re
from pathlib import Path
from typing import Any

import pytest

from dem.case import Case
from tests.support.sections import slope
from workflow.config import Config
from workflow.figures.canvas import Sheet
from workflow.figures.slides import left_by
from workflow.run.fingerprint import title
from workflow.texts.catalogue import catalogue
from workflow.texts.picture_texts import language_of, translated


@pytest.mark.parametrize(
    "text",
    [
        "distance x (m)",
        "FEM, plateau, Kh = 0.235",
        "free-field sides, ψ = φ, reduced element, seismic force downslope and upslope; the smaller\nKh counts. "
        "Black, dashed: slip surface. Blue, dashed: water table.",
        "slide of the surface, downslope",
        "after, cases 1, 2, 3",
        "bracket of the critical Kh of the discs",
        "free-field sides, ψ = φ, reduced element, seismic force downslope and upslope; the smaller\nKh counts. "
        "Dot: the ground fails first in a few cells.",
        "critical Kh: FEM 0.237; discs 0.343 (0.342 to 0.344) for 0.339 of the FEM (dashed)",
        "critical Kh: FEM 0.237; discs 0.342 (0.339 to 0.346) for 0.339 to 0.343 of the FEM (dashed)",
        "After 37.7 s: the right side of the box stopped the slide: in a longer section it would continue. Liquefied "
        "layers keep their stiffness and a residual strength of their own.",
        "case 2, low strength, calibrated discs: largest slide 38 m",
        "rigid block on the slip surface, $k_{\\mathrm{h}}$ = 0.1",
        "slip surfaces, discs and FEM 1.4 m apart vertically on average, in the\nsame layer along 49 % of their common "
        "extent",
    ],
)
def test_a_text_of_a_picture_has_its_japanese_with_the_same_numbers(text: str) -> None:
    japanese = translated(text, "ja")
    assert not re.search("[a-z]{3}", japanese), japanese
    assert sorted(re.findall(r"\d+\.?\d*", japanese)) == sorted(re.findall(r"\d+\.?\d*", text))
    assert translated(text, "en") == text


@pytest.mark.parametrize("residual", [{}, {"residual": 0.12}, {"residual_strength": 8e3}, {"residual": {"Sand": 0.1}}])
def test_what_liquefied_layers_keep_is_japanese(residual: dict[str, Any]) -> None:
    """ "Liquefied layers keep their stiffness and 0.12 of their vertical effective stress as strength" was English."""
    for stiffness, friction, cohesion in itertools.product((1.0, 0.1), (0.0, 1.0, 0.15), (0.0, 1.0, 0.2)):
        case = Case(stiffness=stiffness, friction=friction, cohesion=cohesion, **residual)
        text = f"After 28.0 s: the surface has come to rest. Liquefied layers keep {left_by(case)}."
        japanese = translated(text, "ja")
        assert not re.search("[a-z]{3}", japanese), japanese
        assert sorted(re.findall(r"\d+\.?\d*", japanese)) == sorted(re.findall(r"\d+\.?\d*", text))


def test_names_stay_and_a_title_keeps_them() -> None:
    assert translated("River bank, 8 m high, 1:3: layers", "ja") == "River bank, 8 m high, 1:3:地層"
    assert translated("Loose sand (liquefiable)", "ja") == "Loose sand(液状化)"
    words = "Reconstruction. The depths are from its text; its figures were not at hand."
    assert translated(words, "ja") == "復元断面。The depths are from its text; its figures were not at hand。"
    assert translated("Bray & Macedo (2019)", "ja") == "Bray & Macedo (2019)"


@pytest.mark.parametrize(("english", "japanese"), sorted(catalogue("ja", "pictures").items()))
def test_a_translated_text_has_as_many_values(english: str, japanese: str) -> None:
    assert {int(number) for number in re.findall(r"{(\d+)}", japanese)} == set(range(english.count("{}")))


def test_a_picture_is_written_in_the_language_of_its_run(tmp_path: Path) -> None:
    run = {}
    for language in ("ja", "en"):
        (tmp_path / language / "figures").mkdir(parents=True)
        (tmp_path / language / "section.toml").write_text(f'[report]\nlanguage = "{language}"\n', encoding="utf-8")
        picture = tmp_path / language / "figures/mesh.png"
        assert language_of(picture) == language
        sheet = Sheet("Bank: layers", [0.2])
        sheet.plot(0, "distance x (m)", "elevation (m)")
        sheet.save(picture)
        run[language] = (sheet.figure.texts[0].get_text(), sheet.views[0].get_xlabel())
    assert run["en"][1] == "distance x (m)"
    assert run["ja"] == ("Bank:地層", "距離x (m)")
    assert language_of(tmp_path / "alone.png") == "en"


def test_pictures_are_drawn_again_in_another_language() -> None:
    english, japanese = (Config.parse({**slope(), "report": {"language": language}}) for language in ("en", "ja"))
    assert title(japanese) != title(english)
