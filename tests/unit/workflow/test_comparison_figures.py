"""Pictures of several stages: what stands below the views does not cover each other."""

from types import SimpleNamespace
from typing import Any, cast

from tests.support import SECTIONS
from workflow.config import Config
from workflow.figures import comparison


def test_the_legend_of_the_load_curves_does_not_cover_the_note() -> None:
    """Seven curves in two columns were four rows; the fourth lay on the note, and a label was cut off at the right. The
    bracket of the discs had no label."""
    steps = [SimpleNamespace(displacement=0.1 * k, factor=0.08 * k, at_rest=k == 2, balanced=True) for k in range(1, 4)]
    trials = [SimpleNamespace(kh=0.1 * k, displacement_m=0.2 * k, verdict="stands") for k in range(4)]
    fem = SimpleNamespace(
        curve=steps, settings=SimpleNamespace(sides="free-field"), by_limit_analysis=True, kc=0.24, kc_upper=0.24
    )
    search = {"trials": trials, "kc": 0.34, "kc_lower": 0.33, "kc_upper": 0.35}
    discs = SimpleNamespace(
        model=SimpleNamespace(discs="soil"), before=SimpleNamespace(curve=(1,), **search),
        after=SimpleNamespace(curve=(2,), **search),
    )  # fmt: skip
    like = SimpleNamespace(
        terms="fixed sides, non-associated flow with the given ψ, failures deeper than 1.6 m",
        curve=steps,
        yielding_m=0.2,
        kc=0.34,
        kc_upper=0.34,
    )
    results = SimpleNamespace(
        config=Config.load(SECTIONS / "s13.toml"), fem=fem, dem=discs, dem_counterpart=like, kc=0.24
    )
    sheet = comparison._curves(cast(Any, results))
    assert sheet is not None
    (legend,), note = sheet.figure.legends, sheet.figure.texts[1]
    assert len(legend.get_texts()) == 8
    assert "Reconstruction" in note.get_text()
    sheet.figure.canvas.draw()
    assert legend.get_window_extent().y0 >= note.get_window_extent().y1
    assert legend.get_window_extent().x1 <= sheet.figure.bbox.x1
