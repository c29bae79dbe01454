"""Columns of material points that are let go, beside closed forms and published experiments."""

import numpy as np
import pytest

from docs.verify.slides.point_columns import PointColumn, front, toe
from fem.kernels import point_stress as law
from fem.mpm.slide import DECAY_RATES
from tests.support.material_points import UNIT_WEIGHT, slump


@pytest.mark.parametrize(("stability", "stands"), [(3.5, True), (4.5, False)])
def test_vertical_cut_stands_below_its_stability_number(stability: float, stands: bool) -> None:
    """γ H / s_u = 3.78 (Kammoun et al. 2010): 3.5 stands, 4.5 fails."""
    height = 10.0
    engine = PointColumn(15.0, height, UNIT_WEIGHT * height / stability, 0.0, 1.0, 24.0).engine(1.0)
    engine.run(5.0)
    ground = engine.points.stratum == 0
    sheared = engine.points.state[ground, law.PLASTIC_STRAIN]
    assert (np.quantile(sheared, 0.99) < 0.1) == stands


@pytest.mark.slow
@pytest.mark.parametrize(("aspect", "low", "high"), [(1.0, 1.0, 1.45), (2.0, 2.4, 3.0)])
def test_dry_columns_run_out_as_in_a_channel(aspect: float, low: float, high: float) -> None:
    """(L - L0)/L0 of sand of 33°: 1.2 a below 1.8, 1.9 a^(2/3) above 2.8 (Lube et al. 2005); band of authors at 2."""
    engine = PointColumn(1.0, aspect, 0.0, np.radians(33.0), 0.05, 1.0 + 3.4 * aspect).engine(np.inf)
    engine.run(4.0)
    assert low <= front(engine) - 1.0 <= high


@pytest.mark.slow
@pytest.mark.parametrize("cell", [1.5, 0.75])
def test_a_low_dry_column_runs_out_as_in_a_channel(cell: float) -> None:
    """(L - L0)/L0 = 0.71 for a = 0.5 by another continuum, 1.2 a = 0.6 by experiments (Lube et al. 2005), where the
    deposit is L0/40 thick, by the transfer of slides; 0.60 in cells of 1.5 m, 0.675 in half of them. APIC loses 20 % of
    the energy in the coarse cells: 0.45."""
    half_width = 30.0
    engine = PointColumn(half_width, 15.0, 0.0, np.radians(33.0), cell, 81.0).engine(DECAY_RATES[0])
    engine.run(4.0 * np.sqrt(half_width))
    run_out = toe(engine, half_width / 40.0) / half_width - 1.0
    assert 0.6 - 1e-9 <= run_out <= 0.72
    assert engine.energy.transfer_loss_share < 0.06


@pytest.mark.slow
def test_clay_runs_out_as_a_thin_plastic_layer() -> None:
    """Clay of γH/su = 10 in ten cells that becomes heavy slowly: 99 % of it lie within 0.83 H of where its front stood,
    by the thin plastic layer (γh - π su/2) dh/dx = -su. A slow slump of Bingham material rests in the same shape: its
    yield stress bears it, whatever its viscosity (Dubash et al. 2009, J. Non-Newtonian Fluid Mech. 158, 91)."""
    assert slump(10.0, 10, steps=96).within == pytest.approx(0.83, rel=0.10)


@pytest.mark.slow
def test_clay_let_go_at_once_runs_out_as_by_another_transfer() -> None:
    """In twenty cells 2.13 H, by affine FLIP with a slip base in cells of the same size."""
    assert slump(10.0, 20, steps=1).front == pytest.approx(2.13, rel=0.10)


@pytest.mark.parametrize("decay", DECAY_RATES)
def test_ground_without_strength_creates_no_energy(decay: float) -> None:
    """A column that nothing holds bursts: it has what weight gave it, but for some that transfers lose."""
    engine = PointColumn(4.0, 4.0, 1.0, 0.0, 0.5, 20.0).engine(decay)
    engine.points.set_strength(1.0, 0.0, 1.0, engine.points.stratum == 0)
    engine.run(0.6)
    energy = engine.energy
    assert energy.kinetic > 0.5 * energy.external
    assert -0.005 < energy.imbalance_share < 0.15
