"""The command `check`: its table of strata, and what it tells of a section."""

from pathlib import Path

import pytest
import tomli_w
from rich.console import Console

from tests.support.command_line import run
from tests.support.sections import slope


def test_the_table_of_strata_wraps_names_and_no_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In 80 columns a levee's fill below water went "57.67-79.…"."""
    data = slope()
    data["surface"] = [[0.0, 30.0], [57.6667, 20.0], [1140.0, 20.0]]
    data["strata"][0] |= {"name": "Fill of the levee with a long name", "bottom": {"elevation": 22.3456},
                          "cohesion": "40 kPa", "cohesion_increase": "1.5 kPa/m", "cohesion_from": 30.0}  # fmt: skip
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    monkeypatch.setattr("workflow.cli.terminal.out", Console(width=70, highlight=False))
    assert run("check", path, "--out", tmp_path / "out") == 0
    table = capsys.readouterr().out.partition("The section is sound")[0]
    assert "…" not in table
    assert "40 + 1.5 z" in table


@pytest.mark.parametrize(
    ("past", "shown"),
    [({"ocr": 1.6}, "0.23 σ'v 1.6^0.85,"), ({"pre_overburden_pressure": "20 kPa"}, "(1+20/σ'v)^0.85,")],
)
def test_a_long_formula_of_cohesion_leaves_room_for_names_and_densities(
    past: dict, shown: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In 80 columns SHANSEP clay with a minimum pushed names, densities or friction angles out of the table."""
    data = slope()
    data["strata"][0] |= {"strength_ratio": 0.23, "ocr_exponent": 0.85, "cohesion_minimum": "8 kPa",
                          "friction_angle": "0 deg", "cohesion": "0 kPa"} | past  # fmt: skip
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    monkeypatch.setattr("workflow.cli.terminal.out", Console(width=80, highlight=False))
    assert run("check", path, "--out", tmp_path / "out") == 0
    table = capsys.readouterr().out.partition("The section is sound")[0]
    for text in ("upper", "lower", shown, "≥ 8", "ρ", "φ/ψ"):
        assert text in table


@pytest.mark.parametrize("width", [80, 50])
def test_a_table_of_strata_wider_than_the_screen_loses_no_number(
    width: int, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In 80 columns a tailings dam had the heading "φ/" and friction angles of "33/"."""
    data = slope()
    data["surface"] = [[0.0, 30.0], [57.6667, 20.0], [1140.0, 20.0]]
    data["strata"][0] |= {"name": "Tailings", "bottom": {"elevation": 22.3456}}
    data["strata"][1] |= {"name": "Slimes", "strength_ratio": 0.253, "ocr": 1.55, "ocr_exponent": 0.85,
                          "cohesion_minimum": "15 kPa", "friction_angle": "0 deg", "cohesion": "0 kPa"}  # fmt: skip
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    monkeypatch.setattr("workflow.cli.terminal.out", Console(width=width, highlight=False))
    assert run("check", path, "--out", tmp_path / "out") == 0
    table = capsys.readouterr().out.partition("The section is sound")[0]
    for text in ("φ/ψ", "deg", "0/–", "25/–", "σ'v", "1.55^0.85,", "15", "Slimes", "Tailings"):
        assert text in table


def test_check_tells_what_is_not_as_it_was_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A layer of 0.2 mm at x = 40 m, and one that thins out at 3 deg: both are told of a section that is sound."""
    data = slope()
    data["surface"] = [[0.0, 20.0], [100.0, 20.0]]
    data["strata"][0]["bottom"] = {"depth": [[0.0, 3.0], [40.0, 0.0002], [100.0, 3.0]]}
    path = tmp_path / "slope.toml"
    path.write_text(tomli_w.dumps({**data, "beyond": "30 m"}))
    assert run("check", path, "--out", tmp_path / "out") == 0
    text = " ".join(capsys.readouterr().out.split())
    assert 'Warning: geometry: stratum "upper" is 0.2 mm thick at x = 40 m: less than 10 mm is neglected.' in text
    assert 'Note: mesh: stratum "upper" thins out to nothing at 2 tips, x = 40 m; in the mesh the tips end' in text
    assert "Note: beyond: ground, layers and water continue for 30 m past x = 0 and 100 m, level." in text
    assert text.rindex("Warning:") < text.index("Note:"), "what may ask for something comes first"
    assert "The section is sound." in text
