"""Names in any script are drawn with fonts that have them, and never as boxes."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from tests.support.sections import slope
from workflow.config import Config
from workflow.figures import fonts
from workflow.figures.canvas import Sheet
from workflow.figures.ground import section_sheet

JAPANESE = "能代市の斜面"
needs_a_font = pytest.mark.skipif(
    bool(fonts.missing(JAPANESE)), reason="this machine has no Japanese font: apt install fonts-noto-cjk"
)


def drawn(title: str, path: Path) -> np.ndarray:
    """A sheet with a title as an image; matplotlib's warning of a glyph that is not there is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Sheet(title, [0.1]).save(path)
    image: np.ndarray = imread(path)[..., :3].mean(axis=2)
    return image


@needs_a_font
def test_every_glyph_of_a_japanese_title_is_its_own(tmp_path: Path) -> None:
    """A box in place of a glyph would be the same for each of them."""
    images = [drawn(letter, tmp_path / "one.png") for letter in dict.fromkeys(JAPANESE)]
    for number, image in enumerate(images):
        assert image.min() < 0.5
        assert all(not np.array_equal(image, other) for other in images[:number])


@needs_a_font
def test_japanese_stands_beside_latin_and_greek() -> None:
    files = fonts.files_for(f"S-13 {JAPANESE} φ = 35°")
    assert "DejaVuSans" in files[0]
    assert len(files) == 2
    assert fonts.families_for("φ = 35°") == [fonts.PLAIN]
    assert fonts.notice([JAPANESE, "φ"]) == ""


@needs_a_font
def test_a_section_with_japanese_names(tmp_path: Path) -> None:
    data = {**slope(), "title": JAPANESE}
    data["strata"][0]["name"] = "砂層"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        section_sheet(Config.parse(data).section).save(tmp_path / "section.png")


def test_what_no_font_has_is_told_and_drawn_as_a_question_mark(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fonts, "_others", lambda: ())
    assert fonts.missing("S-13 能代") == "能代"
    said = fonts.notice(["S-13", "能代"])
    assert said.startswith("no font on this machine has 能代, so pictures show ? in their place; ")
    assert "fonts-noto-cjk" in said
    assert np.array_equal(drawn("能代 1", tmp_path / "a.png"), drawn("?? 1", tmp_path / "b.png"))


def test_wide_numbers_at_ticks_do_not_push_a_label_off_the_picture(tmp_path: Path) -> None:
    """Settlements of millimetres had numbers such as -0.002, and half of their label was outside of the picture."""
    sheet = Sheet("Bank: slides in time", [0.26, 0.26])
    views = [sheet.plot(k, "time since the onset (s)", "settlement, upslope third (m)") for k in range(2)]
    views[0].plot([0.0, 1.0], [0.0, 0.4])
    views[1].plot([0.0, 1.0], [-0.00234, 0.00511])
    sheet.save(tmp_path / "history.png")
    boxes = [axes.yaxis.label.get_window_extent() for axes in views]
    assert min(box.x0 for box in boxes) >= 0.0
    first, second = (axes.get_position() for axes in views)
    assert (first.x0, first.x1) == (second.x0, second.x1)
