"""A compliant base of material points, beside an elastic layer on an elastic half-space."""

import numpy as np
import pytest

from fem.kernels import grid_motion
from fem.mpm import PointSlider, ground_of
from meshes.section.base_impedance import base_impedance
from workflow.config import Config

HEIGHT, WIDTH, DENSITY, SPEED = 10.0, 8.0, 1900.0, 100.0  # m, m, kg/m³, m/s
SHAKING, CYCLES, RISES = 0.05, 14, 2.0  # m/s²; cycles, and those in which they come on


def column(threads: int = 1) -> PointSlider:
    """Level elastic ground at rest whose sides are periodic."""
    soil = {
        "name": "soil",
        "density_ordinary": DENSITY,
        "density_seismic": DENSITY,
        "youngs_modulus": 2.0 * 1.3 * DENSITY * SPEED**2,
        "poissons_ratio": 0.3,
        "cohesion": 1e7,
        "friction_angle": "30 deg",
    }
    surface = [[0.0, 0.0], [WIDTH, 0.0]]
    data = {"name": "column", "surface": surface, "base": {"elevation": -HEIGHT}, "strata": [soil]}
    slider = PointSlider(ground_of(Config.parse(data).section, 320, "periodic"), 1, threads)
    slider.settle()
    return slider


OMEGA = 2.0 * np.pi * SPEED / (4.0 * HEIGHT)


def shaking(t: np.ndarray) -> np.ndarray:
    """Cycles of the natural period of the layer, 4 H / V_s."""
    return SHAKING * np.minimum(1.0, OMEGA * t / (2.0 * np.pi * RISES)) * np.sin(OMEGA * t)


@pytest.mark.parametrize("ratio", [0.5, pytest.param(1.0, marks=pytest.mark.slow)])
def test_resonance_of_a_layer_on_a_half_space(ratio: float) -> None:
    """At the period 4 H / V_s the top accelerates by A / α in the frame that does not move, α = (ρ V_s of the layer) /
    (ρ V_s of the half-space): waves leave, where on a rigid base they would build up without end."""
    slider = column()
    engine, top = slider.engine, slider.ground.surface
    engine.base[grid_motion.IMPEDANCE] = DENSITY * SPEED * WIDTH / ratio
    speeds = []
    while engine.time < 2.0 * np.pi * CYCLES / OMEGA:
        engine.run(0.01, shaking)
        speeds.append(engine.original(engine.points.v)[top, 0].mean())
    # the frame moves by -A, whose integral is A/omega cos(omega t)
    time = 0.01 * (np.arange(len(speeds)) + 1.0)
    absolute = np.array(speeds) + SHAKING / OMEGA * np.cos(OMEGA * time)
    last = time > time[-1] - 4.0 * 2.0 * np.pi / OMEGA
    swing = np.ptp(absolute[last]) / 2.0
    assert swing * OMEGA / SHAKING == pytest.approx(1.0 / ratio, rel=0.04)
    assert abs(engine.energy.imbalance_share) < 0.02


def test_two_threads_and_a_checkpoint_give_the_same_bits() -> None:
    states = []
    for threads in (1, 2):
        engine = column(threads).engine
        engine.base[grid_motion.IMPEDANCE] = DENSITY * SPEED * WIDTH
        engine.run(0.3, shaking)
        if threads == 2:
            stored = {name: array.copy() for name, array in engine.snapshot().items()}
            engine.run(0.1, shaking)
            engine.restore(stored)
        engine.run(0.3, shaking)
        states.append((engine.original(engine.points.x), engine.base[grid_motion.NEW_VELOCITY]))
    assert states[0][1] != 0.0
    assert np.array_equal(states[0][0], states[1][0])
    assert states[0][1] == states[1][1]


def test_impedance_of_a_section_is_that_of_the_travel_time_of_its_waves() -> None:
    """10 m of soil with 100 m/s on 10 m of rock with 900 m/s, of one density: 1 / (0.5/100 + 0.5/900) = 180 m/s."""
    soil = {"density": f"{DENSITY} kg/m^3", "poissons_ratio": 0.25, "cohesion": "10 kPa", "friction_angle": "30 deg"}
    strata = [
        soil | {"name": "soil", "youngs_modulus": 2.5 * DENSITY * 100.0**2, "bottom": {"depth": 10.0}},
        soil | {"name": "rock", "youngs_modulus": 2.5 * DENSITY * 900.0**2},
    ]
    data = {"name": "two", "surface": [[0.0, 0.0], [40.0, 0.0]], "base": {"depth": 20.0}, "strata": strata}
    assert base_impedance(Config.parse(data).section) == pytest.approx(DENSITY * 180.0 * 40.0)
