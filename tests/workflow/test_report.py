"""The report of four runs, read in a browser: what it says is what was found, it plays, and it prints."""

import contextlib
import json
import re
import tempfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tests.support import RIVER_BANK, SECTIONS
from tests.support.browser import Page, executable, page
from tests.support.command_line import run
from tests.support.sections import slope
from tests.support.sentences import disagreements

COARSE = {"fem.element": "bilinear", "fem.tolerance": 1e-4, "fem.accuracy": 0.0, "fem.kh": [0.1], "variants.which": []}
FEW_DISCS = {
    "mesh.size": 6, "dem.elements": 50, "dem.parameter": "none", "dem.kh": [], "dem.resolution": 0.1,
    "dem.unbalanced": 1e-2, "dem.element_tests": False, "slide.kh": 0.1, "slide.duration": 2.0,
    "slide.seeds": [], "slide.frames": 5, "bounds.max_cells": 200, "bounds.gap": 0.3, "fem.direction": "downhill",
}  # fmt: skip
FEW_CELLS = {"mesh.columns": 12, "mesh.rows": 9, "fem.direction": "downhill", "fem.rigid_box": False}
CONTINUUM = ("--only", "mesh", "--only", "fem", "--only", "report")
WITH_DISCS = (*CONTINUUM, "--only", "bounds", "--only", "calibrate", "--only", "slide")
STRONG = {"cohesion": "900 kPa", "friction_angle": "40 deg"}
WEAK = {"cohesion": "0.1 kPa", "friction_angle": "0 deg"}
# Four runs: how they end, and a few words that each must say.
RUNS = {
    "s13": (0, "The section fails downslope, to the right, at Kh = "),
    "river_bank": (0, 'After liquefaction of "Loose sand"'),
    "stands": (0, "The section stands at every Kh up to 0."),
    "falls": (3, "No critical Kh:"),
}

pytestmark = pytest.mark.skipif(executable() is None, reason="there is no Chromium and it could not be installed")


def options(settings: dict[str, Any]) -> list[str]:
    return [word for key, value in settings.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def soil(folder: Path, **changes: str) -> Path:
    """The small slope of another soil, with a Japanese title."""
    data = {**slope(), "title": "能代市の斜面"}
    data["strata"] = [{**stratum, **changes} for stratum in data["strata"]]
    path = folder / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    return path


def objects(printed: bytes) -> bytes:
    """What a PDF says, its compressed objects with it."""
    results = [printed]
    for stream in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", printed, re.DOTALL):
        with contextlib.suppress(zlib.error):
            results.append(zlib.decompress(stream))
    return b"\n".join(results)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The folders of the four runs, coarse enough for seconds."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "strong").mkdir()
    requested = {
        "s13": (SECTIONS / "s13.toml", *CONTINUUM, *options(FEW_CELLS)),
        "river_bank": (RIVER_BANK, *WITH_DISCS, *options(FEW_DISCS)),
        "stands": (soil(folder / "strong", **STRONG), *CONTINUUM, *options({"mesh.size": 4, "fem.kh_limit": 0.3})),
        "falls": (soil(folder, **WEAK), *CONTINUUM),
    }
    for name, arguments in requested.items():
        wanted = (*arguments, *options(COARSE), "--out", folder / name, "-q")
        assert run("run", *wanted) == RUNS[name][0], name
    return {name: folder / name for name in requested}


@pytest.fixture(scope="module")
def tab() -> Iterator[Page]:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, page(Path(profile)) as opened:
        yield opened


@pytest.mark.parametrize("name", RUNS)
def test_what_is_read_is_what_was_found(name: str, runs: dict[str, Path], tab: Page) -> None:
    """Sentences agree with summary.json; no broken picture, nothing on the console, nothing fetched."""
    tab.events.clear()
    tab.open((runs[name] / "report.html").as_uri())
    summary = json.loads((runs[name] / "summary.json").read_text())
    read = tab.value("[...document.querySelectorAll('.short p')].map(p => p.textContent)")
    assert read == summary["in_short"]
    warned = tab.value("[...document.querySelectorAll('.warnings td:nth-child(2)')].map(cell => cell.textContent)")
    assert warned == [entry["observation"] for entry in summary["warnings"] if entry["weight"] < 3][:9]
    assert RUNS[name][1] in " ".join(read)
    assert disagreements([*read, *summary["findings"]], summary) == []
    numbers = tab.value("[...document.querySelectorAll('.answer b')].map(cell => cell.textContent)")
    assert numbers == [item["value"] for item in summary["headlines"]]
    requested = [event["request"]["url"] for event in tab.named("Network.requestWillBeSent")]
    assert [url for url in requested if not url.startswith(("data:", "blob:"))] == [
        (runs[name] / "report.html").as_uri()
    ]
    for event in ("Log.entryAdded", "Runtime.consoleAPICalled", "Runtime.exceptionThrown"):
        assert tab.named(event) == []
    assert min(tab.value("[...document.images].map(image => image.naturalWidth)"), default=1) > 0


def test_the_check_of_sentences_sees_what_is_wrong(runs: dict[str, Path]) -> None:
    summary = json.loads((runs["river_bank"] / "summary.json").read_text())
    said = summary["in_short"]
    assert len(disagreements([text.replace("at Kh = 0.", "at Kh = 0.9") for text in said], summary)) > 0
    assert disagreements(["It is 7 m high."], summary) == ["It is 7 m high."]


def state(tab: Page, kind: str) -> dict[str, str]:
    data: dict[str, str] = json.loads(tab.value(f"JSON.stringify(document.getElementById('play-{kind}').dataset)"))
    return data


def press(tab: Page, kind: str, label: str) -> dict[str, str]:
    tab.value(f"document.querySelector('#play-{kind} button[aria-label=\"{label}\"]').click()")
    return state(tab, kind)


def says(tab: Page, kind: str) -> str:
    text: str = tab.value(f"document.querySelector('#play-{kind} .says').textContent")
    return text


def wait(milliseconds: int) -> str:
    return f"new Promise(done => setTimeout(() => done(1), {milliseconds}))"


def until(tab: Page, true: Callable[[], bool]) -> None:
    """Wait, however busy the machine is, until something holds of the page; a minute at most, that it may fail."""
    for _ in range(600):
        if true():
            return
        tab.value(wait(100))
    assert true()


def opened(tab: Page, folder: Path, kind: str) -> None:
    """Open a report and wait until a player in it says something."""
    tab.open((folder / "report.html").as_uri())
    until(tab, lambda: "frame" in state(tab, kind) and says(tab, kind) != "")


def test_slides_are_played_paused_and_stepped(runs: dict[str, Path], tab: Page) -> None:
    opened(tab, runs["river_bank"], "slides")
    cases = json.loads((runs["river_bank"] / "summary.json").read_text())["cases"]
    last = int(state(tab, "slides")["frames"]) - 1
    assert last >= 3
    assert int(state(tab, "slides")["frame"]) == last
    assert f"largest slide {cases['1']['slide_max_m']:.2f} m" in says(tab, "slides")
    assert int(press(tab, "slides", "one step back")["frame"]) == last - 1
    assert int(press(tab, "slides", "one step on")["frame"]) == last
    assert press(tab, "slides", "play or pause")["playing"] == "yes"  # from the beginning, as it stood at the end
    assert int(state(tab, "slides")["frame"]) < last
    assert press(tab, "slides", "play or pause")["playing"] == "no"
    stopped = state(tab, "slides")["frame"]
    tab.value(wait(400))
    assert state(tab, "slides")["frame"] == stopped
    press(tab, "slides", "play or pause")
    ended = {"playing": "no", "frame": str(last)}
    until(tab, lambda: state(tab, "slides").items() >= ended.items())
    painted = "[...document.querySelector('#play-slides canvas').getContext('2d').getImageData(0, 0, 900, 200).data]"
    assert len(tab.value(f"[...new Set({painted})]")) > 10
    tab.value("(box => { box.selectedIndex = 2; box.dispatchEvent(new Event('change')) })"
              "(document.querySelector('#play-slides select'))")  # fmt: skip
    until(tab, lambda: f"largest slide {cases['3']['slide_max_m']:.2f} m" in says(tab, "slides"))


def test_kh_is_drawn_along_its_curve(runs: dict[str, Path], tab: Page) -> None:
    opened(tab, runs["s13"], "path")
    answer = json.loads((runs["s13"] / "fem/critical.json").read_text())
    path = [step for step in answer["curve"] if not step["at_rest"]]
    assert int(state(tab, "path")["frames"]) == len(path)
    slider = "document.querySelector('#play-path input')"
    move = "(box => {{ box.value = {}; box.dispatchEvent(new Event('input')) }})(" + slider + ")"
    for place in (0, len(path) // 2, len(path) - 1):
        tab.value(move.format(place))
        assert says(tab, "path").startswith(f"Kh = {path[place]['factor']:.3f}, mean displacement")
    assert "fields kept here" in says(tab, "path")


def test_without_script_the_players_stay_hidden_and_pictures_serve(runs: dict[str, Path], tab: Page) -> None:
    tab.ask("Emulation.setScriptExecutionDisabled", value=True)
    try:
        tab.open((runs["river_bank"] / "report.html").as_uri())
        assert tab.value("[...document.querySelectorAll('.player')].map(figure => figure.hidden)") == [True, True]
        assert tab.value("document.querySelectorAll('figure[id*=case] img').length") >= 3
    finally:
        tab.ask("Emulation.setScriptExecutionDisabled", value=False)


def test_it_prints_with_numbered_pages(runs: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    """A report without an answer, too."""
    code, folder = RUNS["falls"][0], runs["falls"]
    assert run("report", folder, "--pdf") == code
    assert f"printed as {folder / 'report.pdf'}" in capsys.readouterr().out
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b", (folder / "report.pdf").read_bytes())) <= 12
    assert run("report", folder, "-q") == code
    assert not (folder / "report.pdf").exists()  # it was of the report before


def test_weasyprint_prints_where_there_is_no_browser(runs: dict[str, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    """On few pages."""
    pytest.importorskip("weasyprint")
    monkeypatch.setattr("workflow.report.pdf.browser", lambda: None)
    assert run("report", runs["falls"], "--pdf", "-q") == RUNS["falls"][0]
    printed = objects((runs["falls"] / "report.pdf").read_bytes())
    assert b"WeasyPrint" in printed
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b", printed)) <= 12


def test_a_printer_that_crashes_is_told_and_ends_nothing_else(
    runs: dict[str, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crashes = tmp_path / "browser"
    crashes.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crashes.chmod(0o755)
    monkeypatch.setattr("workflow.report.pdf.browser", lambda: str(crashes))
    assert run("report", runs["stands"], "--pdf") == 2
    assert "could not print the report: exit code -11" in " ".join(capsys.readouterr().err.split())
    assert not (runs["stands"] / "report.pdf").exists()


def test_where_nothing_can_print_it_says_what_would(
    runs: dict[str, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("workflow.report.pdf.browser", lambda: None)
    monkeypatch.setattr("workflow.report.pdf.find_spec", lambda name: None)
    assert run("report", runs["stands"], "--pdf") == 2
    assert "needs Chromium or WeasyPrint" in capsys.readouterr().err
    assert (runs["stands"] / "report.html").is_file()
