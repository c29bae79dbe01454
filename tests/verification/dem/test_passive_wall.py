"""Sand resists a smooth wall that is pushed into it by the weight of its passive wedge (Coulomb 1776; Rankine 1857).

The least force of all planes through the foot of the wall, W tan(α + φ'), where W is the weight above a plane that
rises at α. It is taken on the ground as it has heaved: at rest and level it is γ H²/2 (1 + sin φ')/(1 - sin φ'). Sand
without a peak does not dilate, so that planes of slip have the strength of ψ = 0, tan φ' = sin φ (Davis 1968): 0.92,
0.85 and 0.73 of the force with φ at 25, 33 and 40°.
"""

import numpy as np
import pytest

import dem
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces
from dem.engine.time_step import largest_step
from dem.slides.column import WALL

HEIGHT, LONG = 6.0, 6.0  # m; length of the bed over its height: a wedge is 1.6 to 2.1 heights long
ROWS = 6  # mean diameters in the height
DENSITY, G = 1900.0, 9.81
PACE = 0.003  # heights per sqrt(H/g): four times as slow changes the force by less than packings do
STEP = 0.05  # sqrt(H/g) between two moves of the wall
FROM, TO = 0.04, 0.10  # heights that the wall has moved, over which forces are averaged


def resistance_over_wedge(friction_angle: float, seed: int) -> float:
    """Force on the wall over the least force of all wedges (-), friction angle in rad."""
    on_planes = float(np.arctan(np.sin(friction_angle)))
    radius = 0.5 * HEIGHT / ROWS
    sand = dem.soil_contacts(0.0, friction_angle, 0.5 * DENSITY * G * HEIGHT)
    bed = dem.SoilColumn(
        LONG * HEIGHT, HEIGHT, radius, lambda voids: [sand.discs("sand", DENSITY, radius, voids)], seed=seed, reach=1.1
    )
    bed.settle()
    model, step = bed.model, STEP * bed.unit
    ratios = []
    for moved in np.arange(0.0, TO, PACE * STEP):
        Engine(dt=0.5 * largest_step(model).seconds, energies=False).run(model, step)
        if moved > FROM:
            force = contact_forces(model).line_fx[model.line_id == WALL].sum()
            ratios.append(force / least_wedge(model, on_planes))
        model.lines[WALL, 0] += PACE * STEP * HEIGHT
        model.make_list()
    return float(np.mean(ratios))


def least_wedge(model: dem.DiscModel, friction_angle: float) -> float:
    """The least W tan(α + φ) over all planes through the foot of the wall (N per metre)."""
    free = ~model.fixed
    x, z, weight = model.x[free] - model.lines[WALL, 0], model.z[free], G * model.mass[free]
    return min(
        float(weight[z > x * np.tan(rise)].sum() * np.tan(rise + friction_angle))
        for rise in np.radians(np.arange(8.0, 46.0))
    )


@pytest.mark.slow
@pytest.mark.parametrize("angle", [25.0, 33.0, 40.0])
def test_a_wall_meets_the_passive_wedge_of_the_sand(angle: float) -> None:
    """Means of four packings, of which one alone scatters by a third."""
    ratios = [resistance_over_wedge(np.radians(angle), seed) for seed in range(4)]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.2), ratios
