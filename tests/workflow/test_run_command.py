"""`noshiro run` as a person types it, from a section to the report."""

import json
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib.image import imread

from tests.support import dem_fixture
from tests.support.browser import executable, page
from tests.support.command_line import run
from tests.support.small_run import numbers, written


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder in which everything has run, the discs by hand-made files."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        dem_fixture.stand_in(patch)
        assert run("run", written(folder), "--out", folder / "out", tasks="in another", painted=True) == 0
        yield folder


# --- What it leaves -----------------------------------------------------------------------------------------------


def test_all_that_the_contract_names(whole: Path) -> None:
    out = whole / "out"
    for name in (
        "section.toml", "mesh/section.msh", "mesh/section.vtu", "fem/critical.json", "fem/fields.pvd",
        "dem/critical.json", "dem/calibration.json", "dem/case1.pvd", "dem/history.csv", "report.html", "summary.json",
        "log.txt", "figures/curves.png", "figures/slip_surfaces.png", "figures/calibration.png",
        "figures/sliding_block.png",
    ):  # fmt: skip
        assert (out / name).stat().st_size > 0, name
    for name in ("curves", "slip_surfaces", "calibration", "sliding_block"):
        assert imread(out / f"figures/{name}.png").shape[1] == 1600
    summary = json.loads((out / "summary.json").read_text())
    fem = json.loads((out / "fem/critical.json").read_text())
    assert summary["section"]["sha256"] == fem["section"]["sha256"]
    assert summary["fem"]["kc"] == fem["kc"] == fem["kc_lower"] <= summary["fem"]["kc_upper"]
    assert summary["mesh"]["quadrilaterals"] == fem["mesh"]["quadrilaterals"]
    assert summary["dem"] == {
        "model": "paper", "elements": 320, "boundary_elements": 50, "sides": "free-field", "kc_uncalibrated": 0.31,
        "kc_target": fem["kc"], "strength_factor": None, "slip_surface_distance_m": 1.25, "layers": [],
        "kc_table2": 0.31, "kc": fem["kc"], "kc_lower": fem["kc"] - 0.005,
        "kc_upper": fem["kc"] + 0.005, "calibrated": {"parameter": "stiffness", "value": 0.0075},
        "verdict": "calibrated",
    }  # fmt: skip
    assert {number: case["slide_max_m"] for number, case in summary["cases"].items()} == {"1": 0.6, "2": 3.0, "3": 4.8}
    assert summary["no_answer"] == {}
    assert set(summary["seconds"]) == {
        "mesh",
        "fem",
        "variants",
        "bounds",
        "slices",
        "liquefied",
        "calibrate",
        "slide",
        "report",
    }
    assert summary["fem_variants"]["step"]["kc"] == pytest.approx(fem["kc"], rel=0.02)
    assert "paper" not in summary  # it is not the paper's section


def test_the_estimates_beside_the_slide(whole: Path) -> None:
    """Slope of 10 % with 4 m of liquefied ground: 0.75 √4 ∛10 = 3.232 m; the mean of both ways is their mean."""
    summary = json.loads((whole / "out/summary.json").read_text())
    values = {estimate["method"]: estimate for estimate in summary["comparison"]}
    assert values["Hamada et al., D = 0.75 √H ∛θ"]["displacement_m"] == pytest.approx(3.232, abs=1e-3)
    ways = [values[f"rigid block under the accelerogram, {way}"]["displacement_m"] for way in ("positive", "negative")]
    assert min(ways) > 0.0
    assert ways[0] != ways[1]
    mean = values["rigid block under the accelerogram, mean"]["displacement_m"]
    assert mean == pytest.approx(sum(ways) / 2)
    assert values["rigid block on the slip surface, Kh = 0.1"]["displacement_m"] == 0.0
    assert all(estimate["source"] and estimate["validity"] for estimate in summary["comparison"])


def test_nothing_changed_nothing_runs(whole: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = whole / "out"
    before = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    capsys.readouterr()
    assert run("run", whole / "slope.toml", "--out", out) == 0
    output = capsys.readouterr()
    assert output.err.count("no input has changed: the result of") == 9
    assert len(output.out.splitlines()) <= 12
    after = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    assert {path.name for path in after if after[path] != before.get(path)} == {"log.txt", "lock"}
    # the folder knows its own input, the record with it
    shutil.copytree(out, whole / "moved")
    assert run("report", whole / "moved", "-q") == 0
    assert numbers(whole / "moved") == numbers(out)
    assert capsys.readouterr().out == ""
    refuses_an_empty_report(whole / "moved", capsys)


def refuses_an_empty_report(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """After the program had another key of sections, `noshiro report` replaced a report by one without any number."""
    page, section = folder / "report.html", folder / "section.toml"
    before = page.read_bytes()
    text = section.read_text(encoding="utf-8")
    section.write_text(text.replace("poissons_ratio = 0.3", "poissons_ratio = 0.31"), encoding="utf-8")
    assert run("report", folder) == 2
    assert "no result belongs to its section.toml and this program (inputs changed: section)" in capsys.readouterr().err
    assert page.read_bytes() == before


def test_a_dry_run_only_says_what_it_would_do(whole: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("run", whole / "slope.toml", "--out", whole / "none", "--dry-run") == 0
    assert not (whole / "none").exists()
    assert ["mesh", "run", "not", "run"] in [text.split() for text in capsys.readouterr().out.splitlines()]
    changed = ("--set", "sliding_block.scale=2")
    assert run("run", whole / "slope.toml", "--out", whole / "out", "--dry-run", *changed) == 0
    messages = [text.split() for text in capsys.readouterr().out.splitlines() if text.strip()]
    assert ["slide", "be", "reused", "nothing", "has", "changed"] in messages
    assert ["report", "run", "inputs", "changed:", "[sliding_block]"] in messages


def test_plot_draws_again_without_computing(whole: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(whole / "out", whole / "plot")
    before = {path.name: path.read_bytes() for path in (whole / "plot/figures").glob("*.png")}
    for path in (whole / "plot/figures").glob("*.png"):
        if not path.name.startswith(("bounds", "case", "dem", "history")):
            path.unlink()
    fields = (whole / "plot/fem/critical.json").stat().st_mtime_ns
    assert run("plot", whole / "plot", painted=True) == 0
    assert "slide: its pictures are drawn only when it runs" in capsys.readouterr().out
    assert {path.name: path.read_bytes() for path in (whole / "plot/figures").glob("*.png")} == before
    assert (whole / "plot/fem/critical.json").stat().st_mtime_ns == fields
    assert run("plot", whole / "plot", "--field", "shear_strain", "--at", "0.2", painted=True) == 0
    assert imread(whole / "plot/figures/field_shear_strain_kh_0.200.png").shape[1] == 1600
    for options, words in (
        (("--field", "strain"), "expected one of displacement, displacement_x"),
        (("--at", "0.77"), "no state is stored at this Kh; expected one of 0.200"),
    ):
        capsys.readouterr()
        assert run("plot", whole / "plot", *options) == 2
        assert words in capsys.readouterr().err


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a screen")
@pytest.mark.parametrize(
    ("display", "words"), [("", "DISPLAY is not set"), (":5555", "nothing answers at DISPLAY=:5555")]
)
def test_view_needs_a_screen_and_says_so(
    display: str, words: str, whole: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DISPLAY", display)
    assert run("view", whole / "out") == 2
    text = " ".join(capsys.readouterr().err.split())
    assert words in text
    assert "noshiro plot" in text


@pytest.mark.parametrize("command", ["plot", "view", "report"])
def test_a_folder_without_a_run(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(command, tmp_path) == 2
    assert "holds no run: there is no section.toml" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


# --- The report ---------------------------------------------------------------------------------------------------


@pytest.mark.skipif(executable() is None, reason="there is no Chromium and it could not be installed")
def test_the_report_in_a_browser(whole: Path) -> None:
    """No broken picture, nothing on the console, nothing fetched; and it prints."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, page(Path(profile)) as tab:
        tab.open((whole / "out/report.html").as_uri())
        requested = [event["request"]["url"] for event in tab.named("Network.requestWillBeSent")]
        assert [url for url in requested if not url.startswith("data:")] == [(whole / "out/report.html").as_uri()]
        assert tab.named("Log.entryAdded") == []
        assert tab.named("Runtime.consoleAPICalled") == []
        assert tab.named("Runtime.exceptionThrown") == []
        widths = tab.value("[...document.images].map(image => image.naturalWidth)")
        assert len(widths) >= 16
        assert min(widths) > 0
        assert tab.value("document.title").startswith("A <small> slope & more")
        text = tab.value("document.body.innerText")
        kc = json.loads((whole / "out/summary.json").read_text())["fem"]["kc"]
        assert f"{kc:.3f}" in text
        heads = tab.value("[...document.querySelectorAll('h2')].map(head => head.textContent)")
        assert [head.split(" ", 1)[1] for head in heads] == [
            "Parameters", "Results", "Sensitivity", "Checks", "Methods", "Figures", "Further figures",
        ]  # fmt: skip
        assert "0.40 m, 0.60 m" in text  # on random packings
        # nothing is wider than the page, nor narrower than can be read
        assert tab.value("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
        assert tab.pdf().startswith(b"%PDF")
    assert (whole / "out/report.html").stat().st_size < 3_000_000


def test_the_browser_test_would_see_what_is_wrong(tmp_path: Path) -> None:
    """A page with a broken picture, a complaint, and a request."""
    if executable() is None:
        pytest.skip("there is no Chromium and it could not be installed")
    bad = tmp_path / "bad.html"
    bad.write_text('<img src="data:image/png;base64,AAAA"><img src="missing.png"><script>console.error("no")</script>')
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, page(Path(profile)) as tab:
        tab.open(bad.as_uri())
        assert any(event["request"]["url"].endswith("missing.png") for event in tab.named("Network.requestWillBeSent"))
        assert tab.named("Runtime.consoleAPICalled")
        assert tab.value("[...document.images].map(image => image.naturalWidth)") == [0, 0]


# --- No answer ----------------------------------------------------------------------------------------------------


def test_without_an_answer_the_report_says_why(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The calibration is out of reach: exit code 3, no slides, and a report all the same."""
    shutil.copytree(whole / "out", tmp_path / "out")
    dem_fixture.stand_in(monkeypatch, calibrate=dem_fixture.out_of_reach)
    assert run("run", whole / "slope.toml", "--out", tmp_path / "out", "--from", "calibrate") == 3
    output = capsys.readouterr()
    assert "No answer: the range of stiffness does not reach it; widen [dem] range" in output.err
    assert "slide: not run: calibrate has no answer" in output.err
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["no_answer"]["calibrate"]["remedy"] == "widen [dem] range"
    assert summary["dem"]["verdict"] == "out of reach"
    text = (tmp_path / "out/report.html").read_text()
    assert "The stage calibrate ended without an answer:</b> the range of stiffness does not reach it." in text


@pytest.mark.slow
def test_ground_that_does_not_stand_has_a_report_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    weak = written(tmp_path)
    text = weak.read_text().replace('"15 kPa"', '"0.1 kPa"').replace('"25 deg"', '"0 deg"')
    weak.write_text(text)
    assert run("run", weak, "--out", tmp_path / "out") == 3
    assert "fails under its own weight" in capsys.readouterr().err
    summary = json.loads((tmp_path / "out/summary.json").read_text())
    assert summary["fem"] is None
    assert "fails under its own weight" in summary["no_answer"]["fem"]["reason"]
    assert "fails under its own weight" in (tmp_path / "out/report.html").read_text()


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (("fem.sidez=fixed",), 'fem, sidez: unknown key; did you mean "sides"'),
        (("figures.report_width=99999",), "figures, report_width = 99999"),
        (("sliding_block.accelerogram=none.AT2",), "there is no such file"),
        (("name=x",), "expected a setting of mesh, fem"),
    ],
)
def test_settings_that_are_refused(
    settings: tuple[str, ...], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = [part for setting in settings for part in ("--set", setting)]
    assert run("run", written(tmp_path), "--out", tmp_path / "out", *options) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out").exists()


def test_init_writes_a_section_that_runs_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    assert run("init", path) == 0
    assert run("check", path, "--out", tmp_path / "out") == 0
    before = path.read_text()
    assert run("init", path) == 2
    assert "exists already" in capsys.readouterr().err
    assert path.read_text() == before
