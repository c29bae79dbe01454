"""Material points of ground with a tension cut-off: closed forms of one point."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fem.kernels import point_stress as law
from fem.mpm.points import MaterialPoints, PointSoil

COHESION, FRICTION, LIMIT, YOUNG, POISSON = 20e3, np.radians(30.0), 5e3, 2e7, 0.3  # Pa, rad, Pa, Pa
MODULUS = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))  # λ + 2 G of plane strain (Pa)
SIDE = POISSON / (1.0 - POISSON)  # λ / (λ + 2 G)


def point(limit: float = LIMIT) -> MaterialPoints:
    """A point without stress."""
    soil = PointSoil(1900.0, YOUNG, POISSON, COHESION, FRICTION, limit)
    return MaterialPoints.of(np.zeros((1, 2)), np.ones(1), soil)


def strain(points: MaterialPoints, xx: float = 0.0, zz: float = 0.0, xz: float = 0.0, spin: float = 0.0) -> float:
    """Strain a point; what is dissipated (J)."""
    return float(
        law.update_stress(points.stress, points.state, points.properties, 0, xx, zz, xz, spin, 0.0, 0.0, 1.0)
    )  # fmt: skip


def opened(points: MaterialPoints) -> float:
    """The strain of the cracks of a point."""
    return float(points.state[0, law.OPENED_STRAIN])


def test_a_stretched_point_cracks_at_its_limit() -> None:
    """It has the stress T across the crack and λ / (λ + 2 G) T along it; the rest of the strain is the crack."""
    points = point()
    lost = sum(strain(points, xx=1e-5) for _ in range(100))
    assert points.stress[0] == pytest.approx([LIMIT, SIDE * LIMIT, 0.0], rel=1e-9)
    assert opened(points) == pytest.approx(1e-3 - LIMIT / MODULUS, rel=1e-9)
    assert lost == pytest.approx(LIMIT * opened(points), rel=2e-4)  # in a volume that has grown
    assert points.state[0, law.VOLUME] == pytest.approx(1.0 + LIMIT / MODULUS, abs=1e-7)


def test_ground_beside_an_open_crack_carries_loads_along_it_and_no_cycle_opens_it() -> None:
    """The modulus along the crack is λ + 2 G - λ² / (λ + 2 G)."""
    points = point()
    strain(points, xx=1e-3)
    before, crack = points.stress[0].copy(), opened(points)
    strain(points, zz=-2e-4)
    along = -2e-4 * MODULUS * (1.0 - SIDE**2)
    assert points.stress[0] == pytest.approx(before + np.array([0.0, along, 0.0]), rel=1e-9)
    for _ in range(20):
        strain(points, zz=2e-4)
        strain(points, zz=-2e-4)
    strain(points, zz=2e-4)
    assert points.stress[0] == pytest.approx(before, rel=1e-9)
    assert opened(points) == pytest.approx(crack, rel=1e-9)


def test_a_crack_closes_before_the_ground_is_compressed() -> None:
    points = point()
    strain(points, xx=1e-3)
    strain(points, xx=-opened(points))
    assert points.stress[0] == pytest.approx([LIMIT, SIDE * LIMIT, 0.0], rel=1e-9)
    assert opened(points) == pytest.approx(0.0, abs=1e-15)
    strain(points, xx=-(LIMIT + 10e3) / MODULUS)
    assert points.stress[0] == pytest.approx([-10e3, -SIDE * 10e3, 0.0], rel=1e-9)


def test_a_wide_crack_bears_nothing_until_it_has_closed() -> None:
    points = point()
    for _ in range(300):
        strain(points, xx=1e-4)
    assert points.stress[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    strain(points, zz=-0.5 * opened(points), xz=1e-3)
    assert points.stress[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    while opened(points) > 0.0:
        strain(points, xx=-1e-5)
    strain(points, xx=-10e3 / MODULUS)
    assert points.stress[0, 0] < -9e3


def test_ground_that_is_pulled_and_sheared_has_the_stress_of_both_limits() -> None:
    """With t = c cos φ - σ_m sin φ and σ_m + t = T the mean stress is (T - c cos φ) / (1 - sin φ), but for what the
    crack closes as its direction turns."""
    points = point()
    for _ in range(2500):
        strain(points, xx=1e-5, zz=-5e-6, xz=1e-5)
    xx, zz, xz = points.stress[0]
    mean = (LIMIT - COHESION * np.cos(FRICTION)) / (1.0 - np.sin(FRICTION))
    assert 0.5 * (xx + zz) == pytest.approx(mean, rel=0.02)
    assert np.hypot(0.5 * (xx - zz), xz) == pytest.approx(LIMIT - mean, rel=0.02)
    assert opened(points) > 0.0


def test_without_a_cut_off_the_apex_of_the_cone_limits_the_tension() -> None:
    """Uniaxial tension of 2 c cos φ / (1 + sin φ): ground without dilation stretches at this stress for ever."""
    points = point(np.inf)
    for _ in range(1000):
        strain(points, xx=1e-5, zz=-1e-5)
    assert opened(points) == 0.0
    assert points.stress[0, 0] == pytest.approx(COHESION * np.cos(FRICTION), rel=1e-6)


@given(
    steps=st.lists(st.tuples(*[st.floats(-3e-3, 3e-3)] * 3), min_size=1, max_size=40),
    limit=st.sampled_from([0.0, 2e3, 15e3]),
)
@settings(deadline=None, max_examples=60)
def test_no_stress_exceeds_its_limits_and_no_path_gains_energy(
    steps: list[tuple[float, float, float]], limit: float
) -> None:
    """Each strain is applied in small parts, whose mean stress is that of the path."""
    points, lost, size = point(limit), 0.0, 0.0
    for xx, zz, xz in steps:
        for _ in range(50):
            lost += strain(points, xx / 50, zz / 50, xz / 50)
        size += YOUNG * (xx**2 + zz**2 + xz**2)
        stress_xx, stress_zz, stress_xz = points.stress[0]
        mean, radius = 0.5 * (stress_xx + stress_zz), np.hypot(0.5 * (stress_xx - stress_zz), stress_xz)
        assert mean + radius <= limit + 1e-6
        assert radius <= COHESION * np.cos(FRICTION) - mean * np.sin(FRICTION) + 1e-6
        assert opened(points) >= 0.0
    assert lost >= -0.02 * size
