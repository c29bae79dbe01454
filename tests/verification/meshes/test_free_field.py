"""The ground beyond a free-field side is an endless slope: it slides as a block does, and level ground stays."""

from typing import Any

import numpy as np
import pytest

from dem.case import Case
from dem.slides.drive import cyclic_acceleration
from meshes.section.free_field import FreeField, FreeFieldMotion
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.strain_potential import soft_range
from tests.support.newmark import newmark_slide_speed

CRUST, LOOSE, FIRM = 3.0, 3.0, 2.0  # m
DENSITY = 1900.0  # kg/m³
ONSET = 2.0  # s


def field(slope: float, case: Case, right: bool = True, water: float | None = None) -> FreeField:
    """The free field of a uniform slope (-) that falls to the right; water: elevation of a water level (m)."""
    soil = {
        "density": f"{DENSITY} kg/m^3", "youngs_modulus": "30 MPa", "poissons_ratio": 0.33, "cohesion": "5 kPa",
        "friction_angle": "33 deg",
    }  # fmt: skip
    data: dict[str, Any] = {
        "name": "slope", "surface": [[0.0, 0.0], [60.0, -60.0 * slope]], "base": {"depth": CRUST + LOOSE + FIRM},
        "strata": [
            soil | {"name": "crust", "bottom": {"depth": CRUST}},
            soil | {"name": "loose", "bottom": {"depth": CRUST + LOOSE}, "liquefies_in": [1]},
            soil | {"name": "firm"},
        ],
    }  # fmt: skip
    if water is not None:
        data["water"] = {"table": water}
    section = Section.parse(data)
    return FreeField(section, right, {1: 0.0}, {1: case.remains_of(section, 1)}, ONSET)


def moved(of: FreeField, time: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Displacement (m) of the elevations of the column, from the base to the surface."""
    moves = of.velocities(lambda at: np.interp(at, time, acceleration), 90.0)
    return np.asarray(np.sum(0.5 * (moves.speeds[1:] + moves.speeds[:-1]) * np.diff(moves.times)[:, None], axis=0))


def pulse(kh: float, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Kh g (m/s²) from 5 s on, with a rise and a fall of 0.5 s."""
    time = np.array([0.0, 5.0, 5.5, 5.0 + seconds, 5.5 + seconds, 90.0])
    return time, GRAVITY * kh * np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize("right", [True, False])
@pytest.mark.parametrize("kh", [0.05, 0.1])
def test_free_field_slides_as_a_block(kh: float, right: bool) -> None:
    """Newmark's block on the foot of the layer, whose strength of 6 kPa is the least share of the normal stress there;
    the elastic ground above and below is within 5 %."""
    slope, loading = 0.035, pulse(kh, 4.0)
    top = moved(field(slope, Case(residual_strength=6e3), right), *loading)[-1]
    angle = np.arctan(slope)
    ratio = 6e3 / (DENSITY * GRAVITY * (CRUST + LOOSE) * np.cos(angle) ** 2)
    assert top == pytest.approx(newmark_slide_speed(angle, ratio, *loading) * np.cos(angle), rel=0.05)


def test_free_field_below_the_yield_acceleration_stays() -> None:
    loading = pulse(0.01, 10.0)  # the block yields at 0.018
    assert abs(moved(field(0.035, Case(residual_strength=6e3)), *loading)[-1]) < 0.03


def test_level_free_field_returns_after_cycles() -> None:
    """Cycles of 0.25 g, whose base has no mean velocity, leave level ground where it was."""
    time, acceleration = cyclic_acceleration(0.25, 8.0, 0.6)
    assert abs(moved(field(0.0, Case(residual_strength=6e3)), 2.0 * ONSET + time, acceleration)[-1]) < 0.01


def test_free_field_with_a_strain_potential_strains_by_its_first_line() -> None:
    """τ of the endless slope over the stiffness of soft ground, integrated over the layer."""
    slope, case = 0.01, Case(residual_strength=8e3, strain_potential=0.3)
    z = np.linspace(CRUST, CRUST + LOOSE, 200)
    vertical, angle = DENSITY * GRAVITY * z, np.arctan(slope)
    soft = soft_range(0.3, vertical, np.full(len(z), 8e3))
    wanted = np.mean(vertical * np.sin(angle) * np.cos(angle) * soft.strain / soft.stress) * LOOSE
    assert moved(field(slope, case), np.array([0.0, 90.0]), np.zeros(2))[-1] == pytest.approx(wanted, rel=0.05)


def test_water_on_the_ground_carries_its_part_of_the_weight() -> None:
    """The strain potential of a slope below free water is driven by the buoyant weight."""
    slope, case = 0.01, Case(residual_strength=8e3, strain_potential=0.3)
    z = np.linspace(CRUST, CRUST + LOOSE, 200)
    effective, angle = (DENSITY - 1000.0) * GRAVITY * z, np.arctan(slope)
    soft = soft_range(0.3, effective, np.full(len(z), 8e3))
    wanted = np.mean(effective * np.sin(angle) * np.cos(angle) * soft.strain / soft.stress) * LOOSE
    below = moved(field(slope, case, water=2.0), np.array([0.0, 90.0]), np.zeros(2))[-1]
    assert below == pytest.approx(wanted, rel=0.05)


def test_mean_velocity_of_a_strip_is_that_of_its_elevations() -> None:
    speeds = np.array([[0.0, 0.0, 0.0], [0.0, 2.0, 4.0]])
    motion = FreeFieldMotion(np.array([0.0, 1.0, 3.0]), np.array([0.0, 1.0]), speeds)
    assert motion.mean(np.array([0.5, 1.0, 2.0])) == pytest.approx([0.0, 2.0])


def test_a_side_where_nothing_liquefies_has_no_free_field() -> None:
    section = field(0.035, Case(residual_strength=6e3)).section
    with pytest.raises(ValueError, match="no stratum liquefies"):
        _ = FreeField(section, True, {}, {}, ONSET).foot


def test_passive_pressure_is_that_of_rankine_and_of_liquefied_ground() -> None:
    """σ'_v (1 + sin φ) / (1 - sin φ) + 2 c cos φ / (1 - sin φ) in the crust, σ'_v + 2 s_r in the liquefied layer."""
    of = field(0.0, Case(residual_strength=6e3))
    sine, weight = np.sin(np.radians(33.0)), DENSITY * GRAVITY
    crust = (weight * 1.5 * (1.0 + sine) + 2.0 * 5e3 * np.cos(np.radians(33.0))) / (1.0 - sine)
    assert of.passive_pressure(np.array([-1.5, -4.0])) == pytest.approx([crust, weight * 4.0 + 2.0 * 6e3], rel=1e-3)
