"""What must hold for every trial stress, and how the stress update behaves towards its caller."""

import math
import multiprocessing
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fem.kernels import mohr_coulomb as mc
from fem.kernels import return_mapping as rm
from tests.support import TOP
from tests.support.stress_updates import FLOWS, REGIONS, YOUNG, in_plane, many_trials, updated

every = settings(deadline=None, max_examples=2 * settings.default.max_examples, derandomize=True)


def friction_and_dilation():
    degrees = st.one_of(st.sampled_from([0.0, 1e-6, 30.0]), st.floats(0, 60))
    fraction = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0, 1))
    return st.tuples(degrees, fraction).map(lambda pair: (math.radians(pair[0]), math.radians(pair[0]) * pair[1]))


def size(largest):
    """A stress, often exactly zero or one, never so small that its square is lost."""
    return st.one_of(st.sampled_from([0.0, 1.0]), st.floats(1e-6, largest))


@st.composite
def parameters(draw):
    friction, dilation = draw(friction_and_dilation())
    poisson = draw(st.one_of(st.sampled_from([0.0, 0.3]), st.floats(0, 0.49)))
    return poisson, draw(size(10)), friction, dilation, draw(st.one_of(st.just(math.nan), size(10)))


component = st.one_of(st.sampled_from([0.0, 1.0, -1.0, -2.0]), st.floats(-100, 100).map(lambda v: round(v, 6)))
stresses = st.tuples(component, component, component, component).map(lambda s: np.array([s]))


def outside(stress: np.ndarray, table: np.ndarray) -> float:
    """How far outside the surface a stress is (Pa): t + s sin φ - c cos φ with centre s and radius t of the largest
    Mohr circle, or s1 - T if that is greater."""
    xx, yy, zz, xy = stress[0]
    principal = [*np.linalg.eigvalsh([[xx, xy], [xy, yy]]), zz]
    s, t = 0.5 * (max(principal) + min(principal)), 0.5 * (max(principal) - min(principal))
    return max(t + s * table[0, rm.SIN_PHI] - table[0, rm.STRENGTH], s + t - table[0, rm.TENSION])


@every
@given(parameters(), stresses)
def test_returned_stress_is_admissible(p, trial):
    table = mc.table(YOUNG, *p)
    stress, tangent, plastic, _ = updated(table, trial)
    scale = np.abs(trial).max() + p[1]
    assert all(np.isfinite(a).all() for a in (stress, tangent, plastic))
    assert outside(stress, table) <= 1e-11 * scale
    # The stress-free state is admissible, so flow dissipates.
    assert (stress * plastic).sum() >= -1e-11 * scale**2 / YOUNG


@every
@given(parameters(), stresses)
def test_what_is_admissible_is_left_alone(p, trial):
    table = mc.table(YOUNG, *p)
    stress, tangent, plastic, region = updated(table, trial)
    scale = np.abs(trial).max() + p[1]
    inside = outside(trial, table)
    if inside < -1e-10 * scale:
        assert region[0] == rm.ELASTIC
    if region[0] == rm.ELASTIC:
        assert inside <= 1e-11 * scale
        assert np.array_equal(stress, trial)
        assert not plastic.any()
        assert np.allclose(tangent[0, 3], [0, 0, 0, YOUNG / 2 / (1 + p[0])])
    again, *_ = updated(table, stress)
    assert np.abs(again - stress).max() <= 1e-11 * scale


@every
@given(parameters(), stresses)
def test_axes_and_order_of_principal_stresses_are_kept(p, trial):
    stress, *_ = updated(mc.table(YOUNG, *p), trial)
    scale = np.abs(trial).max() + p[1]
    (a,), (b,) = in_plane(trial)
    (a_new,), (b_new,) = in_plane(stress)
    ordered = np.argsort([-a, -b, -trial[0, 2]], kind="stable")
    assert np.all(np.diff(np.array([a_new, b_new, stress[0, 2]])[ordered]) <= 1e-11 * scale)
    half, half_new = (s[0, 0] - s[0, 1] for s in (trial, stress))
    assert abs(half * stress[0, 3] - half_new * trial[0, 3]) <= 1e-10 * scale**2
    assert half * half_new >= -1e-11 * scale**2
    assert trial[0, 3] * stress[0, 3] >= -1e-11 * scale**2


@every
@given(parameters(), stresses)
def test_a_quarter_turn_of_the_axes_changes_nothing(p, trial):
    table = mc.table(YOUNG, *p)
    turn = np.array([[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, -1.0]])
    stress, tangent, plastic, region = updated(table, trial)
    rotated = updated(table, trial @ turn)
    np.testing.assert_allclose(rotated[0], stress @ turn, rtol=1e-12)
    np.testing.assert_allclose(rotated[1][0], turn @ tangent[0] @ turn, rtol=1e-12, atol=1e-12 * YOUNG)
    np.testing.assert_allclose(rotated[2], plastic @ turn, rtol=1e-12)
    assert rotated[3] == region


@every
@given(parameters(), stresses, st.sampled_from([2.0**-10, 2.0**10]))
def test_scaling_all_stresses_scales_the_result(p, trial, factor):
    poisson, cohesion, friction, dilation, tension = p
    stress, tangent, plastic, region = updated(mc.table(YOUNG, *p), trial)
    larger = mc.table(YOUNG, poisson, factor * cohesion, friction, dilation, factor * tension)
    scaled = updated(larger, factor * trial)
    for new, old in zip(scaled, (factor * stress, tangent, factor * plastic, region), strict=True):
        assert np.array_equal(new, old)


@every
@given(parameters(), stresses, stresses)
def test_strain_and_stress_add_up(p, old, strain):
    """Elastic strain is what carries the stress change: C (new - old) + plastic = strain increment."""
    strain = strain / YOUNG
    stress, _, plastic, _ = updated(mc.table(YOUNG, *p), old, strain)
    change = stress - old
    elastic = ((1 + p[0]) * change - p[0] * change[:, :3].sum()) / YOUNG
    elastic[:, 3] = 2 * (1 + p[0]) * change[:, 3] / YOUNG
    # Close to nu = 0.5 the trial stress is far larger than the strain alone suggests.
    scale = np.abs(old).max() / YOUNG + np.abs(strain).max() / (1 - 2 * p[0])
    np.testing.assert_allclose(elastic + plastic, strain, atol=1e-11 * scale)


def test_nan_stays_where_it_is():
    trial = np.tile([-1.0, -9.0, -3.0, 2.0], (3, 1))
    trial[1, 0] = math.nan
    stress, *_ = updated(mc.table(YOUNG, 0.3, 1, 0.5, 0), trial)
    assert np.isnan(stress[1, 0])
    assert stress[1, 1:].tolist() == [-9, -3, 2]
    assert np.isfinite(stress[[0, 2]]).all()
    assert np.array_equal(stress[0], stress[2])


# --- mobilised strength ---


@every
@given(parameters(), stresses, st.integers(0, 2**31))
def test_mobilised_strength_is_that_of_the_worst_plane(p, stress, seed):
    _, cohesion, friction, _, _ = p
    scale = np.abs(stress).max() + cohesion
    (a,), (b,) = in_plane(stress)
    major, minor = max(a, stress[0, 2]), min(b, stress[0, 2])
    weakest = cohesion - major * math.tan(friction)
    factor = mc.mobilised_strength(stress, np.zeros(1, int), mc.table(YOUNG, *p))[0]
    if weakest <= 1e-6 * scale and (friction > 0.0 or cohesion == 0.0):  # an apex there is with friction only
        assert factor == math.inf or factor >= 1 - 1e-6
        return

    def greatest(normal, shear):
        return (shear / (cohesion - normal * math.tan(friction))).max()

    x = np.linspace(0, math.pi, 20_001)
    centre, radius = (major + minor) / 2, (major - minor) / 2
    worst = greatest(centre + radius * np.cos(x), radius * np.sin(x))
    if factor < 4:  # a sharper peak falls between the angles
        assert factor == pytest.approx(worst, rel=1e-6, abs=1e-12)

    normals = np.random.default_rng(seed).normal(size=(2000, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    xx, yy, zz, xy = stress[0]
    traction = normals @ np.array([[xx, xy, 0], [xy, yy, 0], [0, 0, zz]])
    normal = (traction * normals).sum(axis=1)
    shear = np.linalg.norm(traction - normal[:, None] * normals, axis=1)
    assert greatest(normal, shear) <= factor * (1 + 1e-9) + 1e-9 * scale


@pytest.mark.parametrize("flow", FLOWS)
def test_mobilised_strength_is_one_at_yield_and_less_inside(flow):
    table = mc.table(YOUNG, 0.3, 1.0, *FLOWS[flow])
    trial, _ = many_trials(seed=5, n=2000)
    stress, _, _, region = updated(table, trial)
    factor = mc.mobilised_strength(stress, np.zeros(len(trial), int), table)
    np.testing.assert_allclose(factor[region != rm.ELASTIC], 1, rtol=1e-7)
    assert np.all(factor[region == rm.ELASTIC] < 1)


def test_mobilised_strength_without_strength():
    table = mc.table(YOUNG, 0.3, [1.0, 0.0], [math.pi / 4, 0.0], 0.0)
    mean = np.array([[2], [1], [-1], [1], [-1], [-1]]) * [1, 1, 1, 0]
    stress = mean + np.array([[0], [0], [0], [0.5], [0.5], [0]]) * [1, -1, 0, 0]
    factor = mc.mobilised_strength(stress, np.array([0, 0, 0, 0, 1, 1]), table)
    assert factor.tolist() == [math.inf, 1, 0, math.inf, math.inf, 1]


# --- towards the caller ---

TWO_MATERIALS = mc.table(YOUNG, [0.3, 0.2], [1.0, 2.0], [0.6, 0.3], [0.1, 0.3], [math.nan, 0.5])


def mixed_case(n):
    trial, direction = many_trials(seed=6, n=n)
    return direction, trial, np.arange(n) % 2


def test_every_output_may_be_left_out():
    strain, old, material = mixed_case(500)
    whole = updated(TWO_MATERIALS, old, strain, material)
    names = ("tangent", "plastic_strain_increment", "region")
    for name, wanted in zip(names, whole[1:], strict=True):
        stress, output = np.empty_like(old), np.empty_like(wanted)
        mc.update(strain, old, material, TWO_MATERIALS, stress, **{name: output})
        assert np.array_equal(stress, whole[0])
        assert np.array_equal(output, wanted)
    mc.update(strain, old, material.astype(np.int32), TWO_MATERIALS, stress=old)
    assert np.array_equal(old, whole[0]), "the old stress may be overwritten"


@pytest.mark.parametrize("n", [0, 1, 2 * mc.SMALLEST_CHUNK, 3 * mc.SMALLEST_CHUNK + 5])
def test_threads_change_no_bit(n):
    strain, old, material = mixed_case(n)
    single = updated(TWO_MATERIALS, old, strain, material)
    for threads in (2, 3):
        out = tuple(np.empty_like(a) for a in single)
        mc.update(strain, old, material, TWO_MATERIALS, *out, threads=threads)
        assert all(a.tobytes() == b.tobytes() for a, b in zip(out, single, strict=True))


def _two_threads():
    strain, old, material = mixed_case(2 * mc.SMALLEST_CHUNK)
    mc.update(strain, old, material, TWO_MATERIALS, np.empty_like(old), threads=2)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_threads_work_in_a_forked_process():
    _two_threads()
    child = multiprocessing.get_context("fork").Process(target=_two_threads)
    child.start()
    child.join(20)
    alive = child.is_alive()
    child.kill()
    assert not alive, "the child waits for threads of its parent"
    assert child.exitcode == 0


def test_same_numbers_without_the_compiler(tmp_path):
    strain, old, material = mixed_case(2000)
    np.savez(tmp_path / "in.npz", strain=strain, old=old, material=material, table=TWO_MATERIALS)
    script = (
        "import sys, numpy as np; from fem.kernels import mohr_coulomb as mc, return_mapping as rm\n"
        "assert not hasattr(rm.update_points, 'py_func')\n"
        "a = np.load(sys.argv[1]); n = len(a['old'])\n"
        "out = np.empty((n, 4)), np.empty((n, 4, 4)), np.empty((n, 4)), np.empty(n, np.int8)\n"
        "mc.update(a['strain'], a['old'], a['material'], a['table'], *out)\n"
        "np.savez(sys.argv[2], *out)\n"
    )
    subprocess.run(
        [sys.executable, "-c", script, tmp_path / "in.npz", tmp_path / "out.npz"],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        cwd=TOP,
        check=True,
    )
    interpreted = np.load(tmp_path / "out.npz")
    compiled = updated(TWO_MATERIALS, old, strain, material)
    assert len(np.unique(compiled[3])) == len(REGIONS)
    for k, wanted in enumerate(compiled):
        np.testing.assert_allclose(interpreted[f"arr_{k}"], wanted, rtol=1e-14, atol=1e-14)


def test_every_bad_parameter_is_named():
    with pytest.raises(ValueError, match="material 0") as caught:
        mc.table([-1, 1e6], [0.5, 0.3], [-2, math.inf], [30, 0.5], [-0.1, 0.6], [-3, math.inf])
    for words in (
        "material 0: Young's modulus -1 Pa",
        "material 0: Poisson's ratio 0.5 must be in [0, 0.5)",
        "material 0: cohesion -2 Pa",
        "material 1: cohesion inf Pa",
        "material 0: friction angle 30 rad must be in [0, pi/2): in degrees?",
        "material 0: dilation angle -0.1 rad",
        "material 1: dilation angle 0.6 rad must not exceed the friction angle",
        "material 0: tensile strength -3 Pa must not be negative",
    ):
        assert words in str(caught.value)
    assert len(str(caught.value).split("; ")) == 9


@pytest.mark.parametrize("bad", [(math.nan, 0.3, 1, 0.5, 0), (1, math.nan, 1, 0.5, 0), (1, 0.3, 1, math.nan, 0)])
def test_nan_is_no_parameter(bad):
    with pytest.raises(ValueError, match="nan"):
        mc.table(*bad)


def test_wrong_arrays_are_refused():
    strain, old, material = mixed_case(8)
    good = {"strain_increment": strain, "stress_old": old, "material": material, "stress": np.empty((8, 4))}
    for name, array in (
        ("stress", np.empty((8, 3))),
        ("stress", np.empty((4, 8)).T),
        ("stress_old", old.astype(np.float32)),
        ("tangent", np.empty((8, 16))),
        ("plastic_strain_increment", np.empty((7, 4))),
        ("region", np.empty(8, np.int64)),
        ("material", material[:7]),
        ("material", material + 0.5),
        ("material", material + 1),
        ("material", material - 1),
        ("table", TWO_MATERIALS[:, :5]),
    ):
        with pytest.raises(ValueError, match=name):
            mc.update(**{"table": TWO_MATERIALS, **good, name: array})
