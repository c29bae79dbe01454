"""The stress update against independent solvers and against stress paths with a closed form."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from fem.kernels import mohr_coulomb as mc
from fem.kernels import return_mapping as rm
from tests.support.stress_updates import REGIONS

YOUNG = 100.0
PAIRS = list(itertools.permutations(range(3), 2))


def returned(table, stress, strain=None):
    stress = np.ascontiguousarray(np.atleast_2d(stress), dtype=float)
    n = len(stress)
    strain = np.zeros((n, 4)) if strain is None else np.ascontiguousarray(np.broadcast_to(strain, (n, 4)), float)
    new, tangent, plastic, region = (
        np.empty((n, 4)),
        np.empty((n, 4, 4)),
        np.empty((n, 4)),
        np.empty(n, np.int8),
    )
    mc.update(strain, stress, np.zeros(n, int), table, new, tangent, plastic, region)
    return new, tangent, plastic, region


def planes(angle, tension):
    """Normals (or flow directions) of the six shear planes and, with a cut-off, the three tension planes."""
    rows = np.zeros((6, 3))
    for row, (i, j) in zip(rows, PAIRS, strict=True):
        row[i], row[j] = 1 + math.sin(angle), math.sin(angle) - 1
    return rows if math.isinf(tension) else np.vstack([rows, np.eye(3)])


def limits(cohesion, friction, tension):
    shear = [2 * cohesion * math.cos(friction)] * 6
    return np.array(shear if math.isinf(tension) else [*shear, *[tension] * 3])


def stiffness(poisson):
    return np.linalg.inv(((1 + poisson) * np.eye(3) - poisson) / YOUNG)


def random_states(seed, n, flows):
    """Parameters (nu, c, phi, psi, T) and trial principal stresses in any order."""
    random = np.random.default_rng(seed)
    for _ in range(n):
        friction = random.choice([0.0, 0.1, 0.5, 0.6, 0.9])
        yield (
            random.choice([0.0, 0.2, 0.3, 0.45]),
            random.choice([0.0, 1.0, 5.0]),
            friction,
            friction * random.choice(flows),
            random.choice([math.inf, 0.0, 0.3, 1.5]),
            4 * random.normal(size=3) + 6 * random.normal(),
        )


def returns(trial, D, normals, flows, bounds):
    """Multipliers and stress x - D sum(lambda m) on every set of planes that have a point in common."""
    yield np.zeros(0), trial
    for size in (1, 2, 3):
        for chosen in map(list, itertools.combinations(range(len(normals)), size)):
            matrix = normals[chosen] @ D @ flows[chosen].T
            if abs(np.linalg.det(matrix / YOUNG)) > 1e-10:
                multipliers = np.linalg.solve(matrix, normals[chosen] @ trial - bounds[chosen])
                yield multipliers, trial - D @ flows[chosen].T @ multipliers


def test_associated_return_is_the_closest_point_in_elastic_energy():
    """The closest point is the least far of the admissible projections onto all planes, edges and corners."""
    regions = set()
    for poisson, cohesion, friction, dilation, tension, trial in random_states(11, 180, flows=[1.0]):
        table = mc.table(YOUNG, poisson, cohesion, friction, dilation, tension)
        stress, _, _, region = returned(table, [*trial, 0])
        normals, bounds, D = (
            planes(friction, tension),
            limits(cohesion, friction, tension),
            stiffness(poisson),
        )
        projections = np.array([s for _, s in returns(trial, D, normals, normals, bounds)])
        admissible = projections[np.all(projections @ normals.T - bounds < 1e-9 * np.abs(trial).max(), axis=1)]
        energy = np.einsum("ni,ij,nj->n", admissible - trial, np.linalg.inv(D), admissible - trial)
        np.testing.assert_allclose(stress[0, :3], admissible[energy.argmin()], atol=1e-7)
        regions.add(region[0])
    assert regions == set(range(len(REGIONS)))


def test_non_associated_return_is_the_only_solution_of_the_flow_rule():
    regions, beyond = set(), 0
    for poisson, cohesion, friction, dilation, tension, trial in random_states(12, 300, flows=[0.0, 0.5]):
        table = mc.table(YOUNG, poisson, cohesion, friction, dilation, tension)
        stress, _, _, region = returned(table, [*trial, 0])
        normals, flows = planes(friction, tension), planes(dilation, tension)
        bounds, rounding = limits(cohesion, friction, tension), 1e-9 * np.abs(trial).max()
        solutions = [
            s
            for multipliers, s in returns(trial, stiffness(poisson), normals, flows, bounds)
            if np.all(multipliers * YOUNG > -rounding) and np.all(normals @ s - bounds < rounding)
        ]
        for solution in solutions:
            np.testing.assert_allclose(stress[0, :3], solution, atol=1e-7)
        if not solutions:
            apex = cohesion / math.tan(friction)
            assert dilation == 0
            assert trial.mean() > apex
            np.testing.assert_allclose(stress[0], [apex, apex, apex, 0])
            beyond += 1
        regions.add(region[0])
    assert regions == set(range(len(REGIONS)))
    assert beyond > 10


@pytest.mark.parametrize("dilation", [0.0, 0.2, 0.6])
@pytest.mark.parametrize("tension", [math.inf, 1.0])
def test_plastic_strain_is_flow_of_the_active_planes(dilation, tension):
    friction, cohesion = 0.6, 3.0
    table = mc.table(YOUNG, 0.3, cohesion, friction, dilation, tension)
    random = np.random.default_rng(13)
    angle = random.uniform(0, math.pi, 400)
    cos, sin = np.cos(angle), np.sin(angle)
    a, b, zz = (6 * random.normal(size=(3, 400)) + random.uniform(-12, 8, 400)).round(1)
    trial = np.column_stack([a * cos**2 + b * sin**2, a * sin**2 + b * cos**2, zz, (a - b) * sin * cos])
    stress, _, plastic, region = returned(table, trial)

    xx, yy, _, xy = stress.T
    principal = np.column_stack(
        [
            xx * cos**2 + yy * sin**2 + 2 * xy * sin * cos,
            xx * sin**2 + yy * cos**2 - 2 * xy * sin * cos,
            stress[:, 2],
        ]
    )
    xx, yy, _, xy = plastic.T
    flow = np.column_stack(
        [
            xx * cos**2 + yy * sin**2 + xy * sin * cos,
            xx * sin**2 + yy * cos**2 - xy * sin * cos,
            plastic[:, 2],
        ]
    )
    np.testing.assert_allclose((yy - xx) * 2 * sin * cos + xy * (cos**2 - sin**2), 0, atol=1e-12)

    beyond = (trial[:, :3].mean(axis=1) > cohesion / math.tan(friction)) & (region == rm.APEX) & (dilation == 0)
    for s, e in zip(principal[~beyond], flow[~beyond], strict=True):
        active = np.abs(planes(friction, tension) @ s - limits(cohesion, friction, tension)) < 1e-9
        if active.any():
            flows = planes(dilation, tension)[active].T
            assert lsq_linear(flows, e, (0, np.inf), method="bvls", tol=1e-14).cost < 1e-20
        else:
            assert not e.any()
    assert len(np.unique(region)) >= 5


# --- stress paths ---


def path(table, stress, strain, steps=40):
    """Stress after a strain that grows in equal steps."""
    stress = np.array([stress], dtype=float)
    for _ in range(steps):
        stress, *_ = returned(table, stress, np.array([strain]) / steps)
    return stress[0]


def fixed(table, stress, driven, prescribed, steps=20):
    """Stress after strain `prescribed` of the component `driven`; the other normal stress and the shear stay.

    Newton's method on the two strains that are free, with the consistent tangent; zz does not strain.
    """
    free = [1 - driven, 3]
    stress = np.array([stress], dtype=float)
    wanted = stress[0, free].copy()
    for _ in range(steps):
        strain = np.zeros(4)
        strain[driven] = prescribed / steps
        for _ in range(8):
            new, tangent, _, _ = returned(table, stress, strain)
            residual = wanted - new[0, free]
            if np.abs(residual).max() < 1e-12:
                break
            strain[free] += np.linalg.solve(tangent[0][np.ix_(free, free)], residual)
        assert np.abs(residual).max() < 1e-12, "eight iterations of Newton's method must do"
        stress = new
    return stress[0]


def test_oedometer_of_a_tresca_material():
    """After yield |s_yy - s_xx| = 2c and the mean stress stays elastic, K eps."""
    poisson, cohesion, strain = 0.25, 1.0, -0.2
    bulk = YOUNG / 3 / (1 - 2 * poisson)
    stress = path(mc.table(YOUNG, poisson, cohesion, 0, 0), [0, 0, 0, 0], [0, strain, 0, 0])
    lateral, axial = bulk * strain + 2 / 3 * cohesion, bulk * strain - 4 / 3 * cohesion
    np.testing.assert_allclose(stress, [lateral, axial, lateral, 0], rtol=1e-12)


@pytest.mark.parametrize("dilation", [0.0, 0.3])
def test_oedometer_of_sand_is_at_rankines_active_ratio(dilation):
    """Where nu/(1 - nu) < Ka = (1 - sin phi)/(1 + sin phi), sand yields at once and s_xx = s_zz = Ka s_yy."""
    friction = math.radians(30)
    stress = path(mc.table(YOUNG, 0.1, 0, friction, dilation), [0, 0, 0, 0], [0, -0.01, 0, 0])
    np.testing.assert_allclose(stress, stress[1] * np.array([1 / 3, 1, 1 / 3, 0]), rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("dilation", [0.0, 0.2, 0.5])
@pytest.mark.parametrize("driven", [0, 1])
def test_plane_strain_compression_ends_at_the_passive_stress(driven, dilation):
    """At constant side pressure p: s = -(p Kp + 2 c sqrt(Kp)), Kp = (1 + sin phi)/(1 - sin phi)."""
    cohesion, friction, pressure = 0.5, 0.5, 2.0
    table = mc.table(YOUNG, 0.3, cohesion, friction, dilation)
    passive = (1 + math.sin(friction)) / (1 - math.sin(friction))
    stress = fixed(table, [-pressure, -pressure, -pressure, 0], driven, -0.2)
    assert stress[driven] == pytest.approx(-(pressure * passive + 2 * cohesion * math.sqrt(passive)), rel=1e-12)


def test_unconfined_plane_strain_compression_of_a_tresca_material():
    """Elastic slope E/(1 - nu^2), then the limit 2c."""
    table = mc.table(YOUNG, 0.3, 1.0, 0, 0)
    elastic = fixed(table, [0, 0, 0, 0], 1, -1e-3)
    np.testing.assert_allclose(elastic[1], -1e-3 * YOUNG / (1 - 0.3**2), rtol=1e-12)
    assert fixed(table, [0, 0, 0, 0], 1, -0.1)[1] == pytest.approx(-2.0, rel=1e-12)


def test_simple_shear_without_dilation():
    """psi = 0 keeps the centre s of Mohr's circle, so the shear strength is c cos phi - s sin phi."""
    cohesion, friction, pressure = 1.0, 0.6, 7.0
    table = mc.table(YOUNG, 0.3, cohesion, friction, 0)
    stress = path(table, [-pressure, -pressure, -pressure, 0], [0, 0, 0, 0.5])
    strength = cohesion * math.cos(friction) + pressure * math.sin(friction)
    np.testing.assert_allclose(stress, [-pressure, -pressure, -pressure, strength], rtol=1e-12)


@pytest.mark.parametrize("tension", [math.nan, 0.25, 2.0])
@pytest.mark.parametrize("dilation", [0.0, 0.3, 0.6])
def test_expansion_ends_at_the_apex_or_at_the_cut_off(tension, dilation):
    """The apex is at c cot phi = 1.46; a cut-off beyond it never acts."""
    stress = path(mc.table(YOUNG, 0.3, 1.0, 0.6, dilation, tension), [-1, -2, -1, 0.5], [0.3, 0.3, 0.3, 0])
    end = np.fmin(tension, 1 / math.tan(0.6))
    np.testing.assert_allclose(stress, [end, end, end, 0], atol=1e-12)


def test_tresca_has_no_apex():
    stress = path(mc.table(YOUNG, 0.3, 1.0, 0, 0), [0, 0, 0, 0], [1e3, 1e3, 1e3, 0])
    np.testing.assert_allclose(stress, YOUNG / (1 - 0.6) * 1e3 * np.array([1, 1, 1, 0]), rtol=1e-12)


def test_a_liquid_keeps_its_pressure_only():
    """c = phi = 0: whatever the shear, the mean of the trial stress is left."""
    trial = np.array([[-3.0, -7.0, -4.0, 2.0], [5.0, 1.0, 9.0, -3.0], [0.0, 0.0, 0.0, 4.0]])
    stress, *_ = returned(mc.table(YOUNG, 0.3, 0, 0, 0), trial)
    np.testing.assert_allclose(stress, trial[:, :3].mean(axis=1)[:, None] * [1, 1, 1, 0], atol=1e-14)
