"""Rigid lines with a strength of their own: smooth ones, rough ones, and both beside each other."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.acceleration import tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.model import DiscModel
from dem.springs import SMOOTH, Strength, soil_discs

G = 9.81
SAND = soil_discs("sand", 1e7, Strength(0.3), 2000.0, 2000.0, 0.5, 0.25)
FLOOR = np.array([0.0, 0.0, 0.0, 1.0, -1e4, 1e4])


def sliding(strength: Strength | None, tilt: float, seconds: float = 1.0) -> DiscModel:
    """A disc that does not turn, on a line that dips by `tilt` (rad)."""
    model = DiscModel.create(
        DiscGeometry([0.0], [0.5], 0.5),
        DiscMaterials([SAND], law="soil"),
        DiscBoundary(FLOOR, line_strength=strength),
        gravity=tilted_gravity(tilt, G),
    )
    Engine(dt=1e-4).run(model, 0.2)  # comes to rest across the line
    model.set_velocity(0.0, 0.0)
    Engine(dt=1e-4).run(model, seconds)
    return model


STRENGTHS = [(SMOOTH, 0.0), (Strength(0.1), 0.1), (None, 0.3), (Strength(0.5), 0.5)]


@pytest.mark.parametrize(("strength", "friction"), STRENGTHS)
def test_block_on_a_plane(strength: Strength | None, friction: float) -> None:
    """Coulomb: a = g (sin b - mu cos b), to a thousandth of g over a second."""
    tilt = np.radians(20.0)
    expected = max(0.0, G * (np.sin(tilt) - friction * np.cos(tilt)))
    assert sliding(strength, tilt).vx[0] == pytest.approx(expected, abs=1e-3 * G)


def test_cohesion_of_a_line_holds_what_it_says() -> None:
    """A disc of mass m on a slope of angle b slides with g sin b - C/m."""
    tilt, mass = np.radians(20.0), float(np.pi * 0.25 * SAND.density)
    fixed = 0.4 * mass * G * np.sin(tilt)
    assert sliding(Strength(0.0, fixed), tilt).vx[0] == pytest.approx(0.6 * G * np.sin(tilt), abs=1e-3 * G)


def two_lines(strengths: tuple[Strength | None, Strength | None]) -> DiscModel:
    lines = np.array([[0.0, 0.0, 0.0, 1.0, -1e4, 50.0], [0.0, 0.0, 0.0, 1.0, -100.0, 1e4]])
    lines[0, 4], lines[0, 5] = 50.0, 1e4  # the floor to the left of x = -50 m, along (-nz, nx) = (-1, 0)
    lines[1, 4], lines[1, 5] = -1e4, 50.0
    return DiscModel.create(
        DiscGeometry([-100.0, 100.0], [0.5, 0.5], 0.5),
        DiscMaterials([SAND], law="soil"),
        DiscBoundary(lines, line_strength=strengths),
        gravity=(0.0, -G),
    )


def test_a_smooth_and_a_rough_line_in_one_box() -> None:
    model = two_lines((SMOOTH, Strength(0.2)))
    Engine(dt=1e-4).run(model, 0.5)
    model.set_velocity(5.0, 0.0)
    Engine(dt=1e-4).run(model, 1.0)
    assert model.vx[0] == pytest.approx(5.0, abs=1e-6)
    assert model.vx[1] == pytest.approx(5.0 - 0.2 * G, abs=2e-2)


def test_other_springs_and_checkpoints_keep_what_lines_hold(tmp_path: Path) -> None:
    model = two_lines((SMOOTH, None))
    model.set_springs([replace(SAND, friction=0.4)])
    model.save(tmp_path / "state.npz")
    again = DiscModel.load(tmp_path / "state.npz")
    for item in (model, again):
        item.set_velocity(5.0, 0.0)
        Engine(dt=1e-4).run(item, 1.0)
    assert again.vx.tobytes() == model.vx.tobytes()
    assert model.vx[0] == pytest.approx(5.0, abs=1e-6)
    assert model.vx[1] == pytest.approx(5.0 - 0.4 * G, abs=2e-2)


def test_a_gate_that_opens_leaves_the_other_lines_as_they_were() -> None:
    model = two_lines((SMOOTH, Strength(0.2)))
    Engine(dt=1e-4).run(model, 0.5)
    model.remove_lines([0])
    assert model.line_strength == (Strength(0.2),)
    model.set_velocity(5.0, 0.0)
    Engine(dt=1e-4).run(model, 1.0)
    assert model.vz[0] < -0.5 * G
    assert model.vx[1] == pytest.approx(5.0 - 0.2 * G, abs=2e-2)
    with pytest.raises(ValueError, match="there is no rigid line"):
        model.remove_lines([1])


def test_strengths_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="3 strengths of rigid lines given, there are 1 lines"):
        DiscModel.create(
            DiscGeometry([0.0], [0.5], 0.5),
            DiscMaterials([SAND], law="soil"),
            DiscBoundary(FLOOR, line_strength=(None, SMOOTH, None)),
        )
    with pytest.raises(ValueError, match="expected friction of at least 0"):
        DiscModel.create(
            DiscGeometry([0.0], [0.5], 0.5),
            DiscMaterials([SAND], law="soil"),
            DiscBoundary(FLOOR, line_strength=Strength(-0.1, 5.0)),
        )
