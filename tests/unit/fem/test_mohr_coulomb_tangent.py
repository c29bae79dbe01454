"""The consistent tangent of the stress update, where it is smooth and where it is not."""

import math

import numpy as np
import pytest

from fem.kernels import mohr_coulomb as mc
from fem.kernels import return_mapping as rm
from tests.support.stress_updates import FLOWS, REGIONS, YOUNG, in_plane, many_trials, updated

SHEAR_REGIONS = {rm.ELASTIC, rm.SHEAR_PLANE, rm.LEFT_EDGE, rm.RIGHT_EDGE}
TENSION_REGIONS = {rm.TENSION_PLANE, rm.TENSION_EDGE, rm.TENSION_APEX, rm.SHEAR_TENSION, rm.LEFT_CORNER}
STEPS = 4e-3 * 4.0 ** -np.arange(4)


@pytest.mark.parametrize("tension", [math.nan, 1.0])
@pytest.mark.parametrize("flow", FLOWS)
def test_taylor_remainder_of_the_tangent_is_of_second_order(flow, tension):
    friction, dilation = FLOWS[flow]
    table = mc.table(YOUNG, 0.3, 6.0, friction, dilation, tension)
    trial, direction = many_trials(seed=3, n=100_000)
    stress, tangent, _, region = updated(table, trial)
    steady = np.ones(len(trial), bool)
    remainder = np.empty((len(STEPS), len(trial)))
    predicted = np.einsum("nij,nj->ni", tangent, direction)
    for k, h in enumerate(STEPS):
        following, _, _, region_after = updated(table, trial, h * direction)
        steady &= region_after == region
        remainder[k] = np.linalg.norm(following - stress - h * predicted, axis=1)
    a, b = in_plane(trial)
    steady &= a - b > 1  # the closer they are, the smaller the steps must be
    place = np.where(trial[:, 2] >= a, 1, np.where(trial[:, 2] > b, 2, 3))

    last = {rm.APEX} if math.isnan(tension) and friction > 0 else set()
    expected = SHEAR_REGIONS | last | (set() if math.isnan(tension) else TENSION_REGIONS | {rm.RIGHT_CORNER})
    for r in expected:
        for z in (1, 2, 3):
            here = np.flatnonzero(steady & (region == r) & (place == z))[:200]
            assert here.size >= 10, f"{REGIONS[r]}, zz number {z}: {here.size} states"
            orders = np.polyfit(np.log(STEPS), np.log(remainder[:, here] + 1e-300), 1)[0]
            exact = remainder[0, here] < 1e-9  # of a change of 0.04; less is lost to rounding at the last step
            assert np.all(exact | (orders > 1.9)), f"{REGIONS[r]}, zz number {z}: {orders[~exact].min()}"
            if r in (rm.SHEAR_PLANE, rm.SHEAR_TENSION):
                assert not exact.all(), "the axes turn: something must be left over"


@pytest.mark.parametrize(
    ("trial", "region"),
    [
        ((-3, -3, -3.5, 0), rm.ELASTIC),
        ((-3, -3, -30, 0), rm.LEFT_EDGE),
        ((-30, -30, -3, 0), rm.RIGHT_EDGE),
        ((-1, -1, 1, 0), rm.TENSION_PLANE),
        ((3, 3, -1, 0), rm.TENSION_EDGE),
        ((9, 9, 9, 0), rm.TENSION_APEX),
        ((6, 6, -4, 0), rm.LEFT_CORNER),
        ((-4, -4, 8, 0), rm.RIGHT_CORNER),
    ],
)
@pytest.mark.parametrize("split", [0.0, 1e-12])
def test_tangent_where_the_in_plane_trial_stresses_coincide(trial, region, split):
    table = mc.table(YOUNG, 0.3, 2.0, 0.5, 0.2, 0.5)
    trial = np.add(trial, [split, 0, 0, split], dtype=float)
    _, tangent, _, result = updated(table, trial)
    assert result == region
    h = 1e-5 * np.eye(4)
    following, behind = updated(table, np.tile(trial, (4, 1)), h), updated(table, np.tile(trial, (4, 1)), -h)
    assert set(following[3]) | set(behind[3]) == {region}
    np.testing.assert_allclose(tangent[0], (following[0] - behind[0]).T / 2e-5, atol=1e-6 * YOUNG)


def test_associated_tangent_is_symmetric():
    table = mc.table(YOUNG, 0.2, 1.0, 0.6, 0.6, 0.5)
    _, tangent, _, region = updated(table, many_trials(seed=4, n=20_000)[0])
    assert np.abs(tangent - tangent.transpose(0, 2, 1)).max() < 1e-11 * YOUNG
    assert len(np.unique(region)) == len(REGIONS) - 1  # all but the apex, which the cut-off removes


def test_pure_shear_without_strength_is_not_a_toss_up():
    """With c = 0 and psi = 0 the plane's return ends at the apex; rounding must not choose between them."""
    angle = np.linspace(0, 2 * np.pi, 1001)
    trial = np.exp(np.linspace(-5, 15, 1001))[:, None] * np.column_stack(
        [np.cos(angle), -np.cos(angle), 0 * angle, np.sin(angle)]
    )
    for friction in (0.0, 0.3, 0.6):
        stress, _, _, region = updated(mc.table(YOUNG, 0.3, 0, friction, 0), trial)
        assert set(region) == {rm.SHEAR_PLANE}
        assert np.all(np.abs(stress) <= 1e-15 * np.abs(trial).max(axis=1)[:, None])
