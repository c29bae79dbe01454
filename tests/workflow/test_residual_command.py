"""`noshiro residual`: peak strength first, then what is left of it."""

import json
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tests.support import command_line
from workflow.results.stability import AlongSurface, Bearing, BearingVerdict
from workflow.stages.residual import verdict_of

CLAY = {"youngs_modulus": "30 MPa", "poissons_ratio": 0.45, "density": "18 kN/m^3", "friction_angle": "0 deg"}


def written(place: Path, residual: str, **more: Any) -> Path:
    """A slope of 45° and 10 m in clay of 50 kPa, 2 m of which lie below its toe."""
    data = {
        "name": "clay",
        "surface": [[0.0, 10.0], [20.0, 10.0], [30.0, 0.0], [50.0, 0.0]],
        "base": {"elevation": -2.0},
        "strata": [
            {
                "name": "clay", **CLAY, "cohesion": "50 kPa",
                "residual_cohesion": residual, "residual_friction_angle": "0 deg", **more,
            }
        ],
    }  # fmt: skip
    path = place / "clay.toml"
    path.write_text(tomli_w.dumps(data))
    return path


@pytest.fixture(scope="module")
def softened(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("residual")
    assert command_line.run("residual", written(place, "25 kPa"), "--out", place / "run", "--quiet") == 0
    return place / "run"


def test_clay_with_half_its_strength_has_half_its_factor_of_safety(softened: Path) -> None:
    """With φ = 0 a factor of safety is proportional to the strength, on every surface."""
    steps = json.loads((softened / "fem/residual.json").read_text())["steps"]
    assert steps["verdict"] == "would continue"
    assert steps["everywhere"]["factor"] == pytest.approx(0.5 * steps["peak"], rel=0.02)
    assert steps["everywhere"]["factor_lower"] < 0.5 * steps["peak"] < 1.01 * steps["everywhere"]["factor_upper"]
    assert steps["along"]["residual"] == pytest.approx(0.5 * steps["along"]["peak"], rel=1e-3)
    assert steps["along"]["peak"] == pytest.approx(steps["peak"], rel=0.05)


def test_the_report_tells_both_steps(softened: Path) -> None:
    assert command_line.run("report", softened, "--quiet") == 0
    page = (softened / "report.html").read_text(encoding="utf-8")
    assert "with its residual strength it does not" in page
    assert "along the slip surface of peak strength" in page
    assert json.loads((softened / "summary.json").read_text())["residual"]["verdict"] == "would continue"


@pytest.mark.slow
def test_clay_that_keeps_enough_stands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line.run("residual", written(tmp_path, "40 kPa"), "--out", tmp_path / "run") == 0
    assert "in all strata that have one the ground still stands" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"residual_friction_angle": "5 deg"}, "residual_friction_angle above friction_angle"),
        ({"residual_cohesion": "60 kPa"}, "residual_cohesion above cohesion"),
        ({"residual_cohesion": "0 kPa"}, "residual_cohesion and residual_friction_angle are both 0"),
        ({"residual_cohesion": "25"}, "residual_cohesion"),
    ],
)
def test_residual_strength_that_cannot_be_meant_is_told(
    more: dict[str, str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command_line.run("check", written(tmp_path, "25 kPa", **more), "--out", tmp_path / "run") == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_one_of_both_is_not_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, "25 kPa")
    path.write_text(path.read_text().replace('residual_friction_angle = "0 deg"\n', ""))
    assert command_line.run("check", path, "--out", tmp_path / "run") == 2
    assert "expected both of them, or none" in " ".join(capsys.readouterr().err.split())


def test_ground_without_residual_strength_is_told_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, "25 kPa")
    stored = [line for line in path.read_text().splitlines() if not line.startswith("residual")]
    path.write_text("\n".join(stored))
    assert command_line.run("residual", path, "--out", tmp_path / "run") == 2
    assert "no stratum has a post-peak strength" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("factor", "along", "stands", "verdict"),
    [
        (1.4, 1.2, "stands", "stands"),
        (1.4, None, "flows", "would continue"),
        (1.4, 0.9, "flows", "would continue"),
        (1.9, 1.58, "flows", "would stop"),
        (0.9, 1.2, "flows", "fails"),
        (None, None, "flows", "undecided"),
    ],
)
def test_the_verdict_counts_peak_strength_and_the_slip_surface(
    factor: float | None, along: float | None, stands: BearingVerdict, verdict: str
) -> None:
    everywhere = Bearing(
        verdict=stands, reason="", kc=None, kc_lower=None, kc_upper=None, factor=None, factor_lower=None,
        factor_upper=None, notes=(),
    )  # fmt: skip
    surface = None if along is None else AlongSurface(surface_m=(), peak=factor, residual=along)
    assert verdict_of(factor, surface, everywhere) == verdict


@pytest.mark.slow
def test_a_dilation_angle_that_is_taken_as_given_is_followed_along_a_path(tmp_path: Path) -> None:
    """With flow = "non-associated" there is no limit load, and the peak has the factor of its path, no mechanism."""
    path = written(tmp_path, "5 kPa", cohesion="20 kPa", friction_angle="25 deg", dilation_angle="5 deg",
                   residual_friction_angle="15 deg")  # fmt: skip
    coarse = ("--set", "fem.flow=non-associated", "--set", "mesh.max_cells=150")
    assert command_line.run("residual", path, "--out", tmp_path / "run", "--quiet", *coarse) == 0
    steps = json.loads((tmp_path / "run/fem/residual.json").read_text())["steps"]
    assert steps["notes"] == []
    assert steps["everywhere"]["factor_upper"] < 1.0 < steps["peak"]
