"""Runs in intervals: walls that are moved while the contacts stay in the layout, and bonds without a strain
potential."""

import numpy as np
import pytest
from numba import njit

from dem.engine.engine import Engine
from dem.engine.forces import contact_forces, neighbour_forces
from dem.engine.packer import pack
from dem.engine.time_step import largest_step
from dem.kernels.layout import Layout
from dem.kernels.liquefied_bonds import fetch_strength, press_pairs_with_losses
from dem.kernels.liquefied_pairs import EXTRA_SHARE_AT, fetch_motion, look_at_discs, look_at_pairs
from dem.kernels.period import Period
from dem.model import DiscModel
from tests.unit.dem.test_liquefied_ground import heap, same

STEPS, EACH = 60, 20


@pytest.mark.parametrize("soft", [False, True])
def test_walls_that_move_in_one_run_have_the_bits_of_runs_of_their_own(soft: bool) -> None:
    """The wall is pushed with a velocity that follows from the force on it, as the sides of a slide are."""

    def move_wall(model: DiscModel, force_x: np.ndarray) -> None:
        model.vx = np.where(model.fixed, 1e-7 * force_x[model.fixed].sum(), model.vx)
        model.vx_half = np.where(model.fixed, model.vx, model.vx_half)

    together = heap(soft=soft)
    apart = together.copy()
    dt = 0.5 * largest_step(together).seconds
    Engine(dt=dt, balance=np.inf).run(together, steps=STEPS, every=EACH * dt, on_interval=move_wall)
    for _ in range(STEPS // EACH):
        move_wall(apart, neighbour_forces(apart, contact_forces(apart))[0])
        Engine(dt=dt, balance=np.inf).run(apart, steps=EACH)
    assert np.abs(together.vx[together.fixed]).max() > 0.0
    same(together, apart)
    assert together.energy_known == pytest.approx(apart.energy_known, rel=1e-12)
    assert together.energy_edited == pytest.approx(apart.energy_edited, rel=1e-9)


@njit(error_model="numpy")
def _press(layout: Layout, period: Period, linear: bool) -> tuple[float, float, float]:
    wet, slid, damped, work = layout.liquefied, 0.0, 0.0, 0.0
    for block in range(wet.start[-1]):
        fetch_motion(block, wet, layout.shared, 1e-3, True)
        look_at_pairs(block, wet, period, True)
    look_at_discs(0, len(wet.paired), wet, layout.shared, 1e-3, True)
    for block in range(wet.start[-1]):
        fetch_strength(block, wet)
        more = press_pairs_with_losses(block, wet, 1e-3, 0.98, linear)
        slid, damped, work = slid + more[0], damped + more[1], work + more[2]
    return slid, damped, work


def test_linear_bonds_have_the_forces_of_the_general_law() -> None:
    """Without a strain potential and extra strength, what the short form omits is exactly 0, 1 or a square."""
    model = heap()
    model.bonds[:, EXTRA_SHARE_AT] = 0.0
    Engine(dt=0.5 * largest_step(model).seconds, balance=np.inf).run(model, steps=STEPS)
    assert np.abs(model.bonds[:, :2]).max() > 0.9  # some bonds are near their limit
    short, general = pack(model), pack(model)
    first, second = _press(short, model.repeats, True), _press(general, model.repeats, False)
    assert short.liquefied.linear.all()
    assert len(short.liquefied.linear) == short.liquefied.start[-1]
    assert first[0] > 0.0
    assert first == pytest.approx(second, rel=1e-12)
    assert np.array_equal(short.liquefied.memory, general.liquefied.memory)
    assert np.array_equal(short.liquefied.working, general.liquefied.working)
    assert not pack(heap(soft=True)).liquefied.linear.all()
