"""Site response against the closed transfer function of a uniform layer, and against pystrata."""

import json
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from tests.support import command_line
from tests.support.borings import bored
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.earthquake.site_response import (
    ColumnLayer,
    HalfSpace,
    Response,
    response,
    stiffness_and_damping,
    warning,
    waves,
)
from workflow.estimates.comparison import estimates
from workflow.report.console import response_sentences
from workflow.results.site_response import SiteResponseAnswer
from workflow.run.store import Store

STEP = 0.01
TIME = np.arange(0.0, 20.48, STEP)
# 0.6 m/s² at about 1.7 Hz, swelling and ebbing.
RECORD = 0.6 * np.exp(-(((TIME - 6.0) / 3.0) ** 2)) * np.sin(2.0 * np.pi * 1.7 * TIME + 3.0 * np.sin(0.7 * TIME))


@pytest.mark.parametrize("damping", [0.01, 0.1])
def test_uniform_layer_on_rigid_rock(damping: float) -> None:
    """Surface over rock is 1/cos(k* H), k* = ω/(V √(1 + 2iD)), however the layer is divided."""
    layer = ColumnLayer(5.0, 1900.0, 200.0, 50e3, damping=damping)
    omega = 2.0 * np.pi * np.array([0.5, 2.5, 5.0, 12.0])
    for parts in (1, 4):
        divided = [ColumnLayer(5.0 / parts, 1900.0, 200.0, 50e3, damping=damping)] * parts
        up, down, _ = waves(divided, HalfSpace(1e9, 5000.0), omega)
        expected = 1.0 / np.cos(omega * layer.thickness / (200.0 * np.sqrt(1.0 + 2j * damping)))
        np.testing.assert_allclose(2.0 / (up[-1] + down[-1]), expected, rtol=1e-9)


def test_uniform_layer_on_rock_that_gives() -> None:
    """Surface over outcrop is 1/(cos kH + i α sin kH), α the ratio of impedances (Kramer 1996, Sec. 7.2.1.4)."""
    omega = 2.0 * np.pi * np.array([1.0, 5.0, 9.0])
    up, _, _ = waves([ColumnLayer(10.0, 1800.0, 200.0, 50e3, damping=0.0)], HalfSpace(2200.0, 800.0, 0.0), omega)
    angle, ratio = omega * 10.0 / 200.0, 1800.0 * 200.0 / (2200.0 * 800.0)
    np.testing.assert_allclose(1.0 / up[-1], 1.0 / (np.cos(angle) + 1j * ratio * np.sin(angle)), rtol=1e-9)


def test_curves_are_pystratas() -> None:
    """pystrata 0.5.4, DarendeliSoilType(plas_index 0, ocr 1, stress_mean 50 kPa, freq 1, num_cycles 10)."""
    strains = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
    result = np.array([stiffness_and_damping(strain, 50e3, 0.0) for strain in strains]).T
    np.testing.assert_allclose(result[0], [0.9943058, 0.95463205, 0.71716545, 0.23404119, 0.03551268], rtol=2e-5)
    np.testing.assert_allclose(result[1], [0.01030415, 0.01456948, 0.04836007, 0.15126968, 0.21082933], rtol=3e-4)


def layers() -> list[ColumnLayer]:
    """20 layers of 1 m: 2, 3, 5 and 10 m of ever stiffer sand."""
    soils = ((2, 1800.0, 150.0, 20e3), (3, 1900.0, 180.0, 40e3), (5, 1900.0, 220.0, 70e3), (10, 2000.0, 300.0, 130e3))
    return [ColumnLayer(1.0, *soil) for count, *soil in soils for _ in range(int(count))]


def test_equivalent_linear_layers_are_pystratas() -> None:
    """pystrata 0.5.4, EquivalentLinearCalculator(strain_ratio 0.65, tolerance 0.002), the same layers and curves: peak
    accelerations 0.8607, 0.8105, 0.7210, 0.5701 m/s² at 0, 5, 10, 20 m; G/Gmax 0.9225, 0.6509, 0.7181. Its complex
    modulus differs from SHAKE's by D², and its curves are interpolated."""
    result = response(layers(), HalfSpace(2200.0, 760.0), STEP, RECORD)
    np.testing.assert_allclose(result.acceleration[[0, 5, 10, 20]], [0.8607, 0.8105, 0.7210, 0.5701], rtol=5e-3)
    np.testing.assert_allclose([result.layers[j].stiffness for j in (0, 9, 19)], [0.9225, 0.6509, 0.7181], rtol=1e-2)
    np.testing.assert_allclose(result.strain[[0, 4, 9, 19]], [2.073e-5, 1.674e-4, 2.416e-4, 2.135e-4], rtol=2e-2)


def test_the_average_acceleration_is_the_shear_stress_over_the_weight() -> None:
    """It ends at the surface's where the mass is thin, and is below the largest acceleration anywhere above."""
    result = response(layers(), HalfSpace(2200.0, 760.0), STEP, RECORD)
    weight = 9.80665 * np.cumsum([layer.density for layer in layers()])
    np.testing.assert_allclose(result.k_max, result.stress / weight, rtol=1e-12)
    assert result.k_max[0] * 9.80665 == pytest.approx(result.acceleration[0], rel=0.01)
    assert np.all(np.diff(result.k_max) < 0.0)


def at_rest(outcome: Response, base: HalfSpace, outcrop: np.ndarray) -> float:
    """The largest change that a round makes of the answer: by a transfer function of its own, 0.65 of each strain."""
    omega = 2.0 * np.pi * np.fft.rfftfreq(4 * len(outcrop), STEP)
    up, down, number = waves(outcome.layers, base, omega)
    change = 0.0
    for j, layer in enumerate(outcome.layers):
        turn = np.exp(0.5j * number[j] * layer.thickness)
        with np.errstate(divide="ignore", invalid="ignore"):
            transfer = np.where(
                omega > 0, -1j * number[j] * (up[j] * turn - down[j] / turn) / (2 * up[-1] * omega**2), 0
            )
        strain = np.abs(np.fft.irfft(transfer * np.fft.rfft(outcrop, len(omega) * 2 - 2))[: len(outcrop)]).max()
        ratio, damping = stiffness_and_damping(0.65 * strain, layer.mean_stress, layer.plasticity)
        change = max(change, abs(ratio / layer.stiffness - 1.0), abs(damping / layer.damping - 1.0))
    return change


def sine(rate: float) -> np.ndarray:
    """10 s of 1 g."""
    return np.where(TIME < 10.0, 9.80665 * np.sin(2.0 * np.pi * rate * TIME), 0.0)


PULSE = 9.80665 * np.exp(-((TIME - 5.0) ** 2)) * np.sin(2.0 * np.pi * (TIME - 5.0))  # of a fault nearby


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 3))])
@pytest.mark.parametrize("name", ["record", "sine", "pulse"])
def test_strong_motions_have_an_answer_that_is_at_rest(name: str, seed: int) -> None:
    """Random columns under 0.2 and 0.6 g, strains from 0.1 to some per cent, of which 60 rounds refused a third."""
    generator = np.random.default_rng(seed)
    count = int(generator.integers(5, 20))
    soils = zip(generator.uniform(1600, 2100, count), np.sort(generator.uniform(100, 350, count)), strict=True)
    column = [ColumnLayer(1.0, d, v, 20e3 + 9e3 * j, float(15 * (j % 2))) for j, (d, v) in enumerate(soils)]
    base = HalfSpace(2200.0, 760.0)
    motion = {"record": 9.80665 * RECORD / np.abs(RECORD).max(), "sine": sine(1.0), "pulse": PULSE}[name]
    for peak in (0.2, 0.6):
        result = response(column, base, STEP, peak * motion)
        assert result.change <= 0.01
        assert at_rest(result, base, peak * motion) <= result.change + 0.02


@pytest.mark.parametrize(
    ("strain", "message"),
    [
        (0.004, ""),
        (0.007, "0.7 %, above 0.5 %: equivalent linear layers have one stiffness"),
        (0.165, "16.5 %, above 1.5 %: equivalent linear layers are not valid there"),
    ],
)
def test_large_strains_are_doubted(strain: float, message: str) -> None:
    """0.7 % is answered with a warning; 16.5 % was answered without a word."""
    assert message in warning(strain)
    assert bool(warning(strain)) == bool(message)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = "\n".join(f"{t:.2f},{a:.6f}" for t, a in zip(TIME, RECORD, strict=True))
    (tmp_path / "rock.csv").write_text(f"time (s),a (m/s^2)\n{rows}\n")
    data = bored()
    data["site_response"] = {"record": "rock.csv", "x": 50.0, "velocities": {"loose": 160.0}, "slip_depth": "6 m"}
    path = tmp_path / "bored.toml"
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("response", path, "--out", tmp_path / "run") == 0
    answer = json.loads((tmp_path / "run/site_response.json").read_text())
    assert answer["layers"][0]["velocity_m_s"] == 160.0
    assert answer["layers"][-1]["bottom_m"] == pytest.approx(20.0)
    assert answer["peak_rock_gal"] == pytest.approx(60.0, abs=1.0)
    assert "average acceleration over g of the ground above a depth" in capsys.readouterr().out
    result = SiteResponseAnswer.read(Store(tmp_path / "run"))
    between = [layer for layer in result.layers if abs(layer.bottom_m - 5.0 * round(layer.bottom_m / 5.0)) > 0.3]
    *_, messages = response_sentences(result.model_copy(update={"layers": between}))
    assert messages.count(" m)") == 3  # nearest to 5, 10 and 15 m, whatever the layers are; it named none of these
    assert command_line.run("report", tmp_path / "run", "--quiet") == 0
    assert "<h3>Site response</h3>" in (tmp_path / "run/report.html").read_text(encoding="utf-8")
    assert answer["change"] < 0.002
    assert answer["warning"] == ""
    strong = {"--set": "site_response.scale=12.0"}
    assert command_line.run("response", path, "--out", tmp_path / "strong", *next(iter(strong.items()))) == 0
    assert "%, above 1.5 %: equivalent linear layers are not valid there" in " ".join(capsys.readouterr().out.split())
    k_max = next(layer["k_max"] for layer in answer["layers"] if layer["bottom_m"] == pytest.approx(6.0))
    data["slide"] = {"kh": "k_max"}
    path.write_text(tomli_w.dumps(data))
    config = config_after_triggering(Config.load(path))
    assert config.slide.kh == pytest.approx(k_max, abs=1e-4)
    assert f"kh = {config.slide.kh}" in config.to_toml()  # what was used
    del data["site_response"]["slip_depth"]
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("response", path, "--out", tmp_path / "run") == 2
    assert 'slide, kh = "k_max": expected record and slip_depth in [site_response]' in capsys.readouterr().err
    del data["slide"]
    path.write_text(tomli_w.dumps(data))
    config, surface = Config.load(path), np.array([[30.0, 0.0], [40.0, -6.0], [60.0, -6.0], [80.0, 0.0]])
    result = estimates(config.section, config, 0.02, surface)
    messages = [item.description for item in result if "under the average" in item.method]
    assert len(messages) == 1
    assert f"k_max = {k_max:.3f} above 6 m" in messages[0]  # the slip surface of the finite elements serves
    deeper = estimates(config.section, config, 0.02, surface - np.array([0.0, 0.29034]) * (surface[:, 1:] < 0.0))
    (text,) = [item.description for item in deeper if "under the average" in item.method]
    assert " above 6.29 m, " in text  # "above 13.2903 m"
    data["site_response"]["velocities"] = {"clay": 100.0}
    path.write_text(tomli_w.dumps(data))
    assert command_line.run("response", path, "--out", tmp_path / "run") == 2
    assert 'there is no stratum "clay"' in capsys.readouterr().err


def test_a_response_needs_a_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bored.toml").write_text(tomli_w.dumps(bored()))
    assert command_line.run("response", tmp_path / "bored.toml", "--out", tmp_path / "run") == 2
    assert "site_response, record: missing; expected a file with a record of the rock" in capsys.readouterr().err
