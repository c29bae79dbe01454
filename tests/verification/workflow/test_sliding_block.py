"""The rigid block against closed forms, and what must hold under every record."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.section.quantity import GRAVITY
from workflow.estimates.sliding_block import SmoothPlane, newmark, rectangular_pulse


def pulse(k: float, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """k g for a duration, nothing before and after; the corners are steps."""
    time = np.array([0.0, 0.5, 0.5, 0.5 + duration, 0.5 + duration, 0.6 + duration])
    return time, GRAVITY * np.array([0.0, 0.0, k, k, 0.0, 0.0])


@pytest.mark.parametrize(
    ("kc", "k", "duration"), [(0.1, 0.3, 0.5), (0.05, 0.5, 0.2), (0.2345, 0.25, 2.0), (0.02, 1.0, 0.1)]
)
def test_rectangular_pulse_of_newmark_1965(kc: float, k: float, duration: float) -> None:
    """u = V² / (2 g kc) (1 - kc / k) with V = k g t, although the record ends before the block stops."""
    slide = newmark(*pulse(k, duration), kc)
    speed = k * GRAVITY * duration
    assert slide.permanent == pytest.approx(speed**2 / (2 * GRAVITY * kc) * (1 - kc / k), rel=1e-12)
    assert rectangular_pulse(kc, k, duration) == pytest.approx(slide.permanent, rel=1e-12)
    # it is fastest at the end of the pulse, and stops when the ground's impulse is used up: t k / kc after its start
    assert slide.velocity.max() == pytest.approx((k - kc) * GRAVITY * duration, rel=1e-12)
    assert slide.time[-1] == pytest.approx(max(0.5 + duration * k / kc, 0.6 + duration), rel=1e-12)


def test_pulse_in_numbers() -> None:
    """0.3 g for 0.5 s, resisted by 0.1 g: V = 1.471 m/s; 1.1032 m / s² x (1 - 1/3) = 0.7355 m."""
    assert rectangular_pulse(0.1, 0.3, 0.5) == pytest.approx(0.73550, abs=5e-6)
    assert rectangular_pulse(0.3, 0.3, 0.5) == 0.0


@pytest.mark.parametrize("kc", [0.05, 0.1, 0.19])
def test_triangular_pulse(kc: float) -> None:
    """Rise to k g and fall back to 0, each over T: closed form by piecewise integration.

    It sets out at t1 = T kc / k; up to the peak the excess is g k (t - t1) / T, after it g (k - kc) - g k s / T; the
    block is fastest where the excess is 0 again, then slows down by the same law, and stops while the pulse lasts
    if T (k - kc) / k (1 + √2) is not above 2 T - t1.
    """
    k, span = 0.2, 1.0
    slide = newmark(np.array([0.0, span, 2 * span]), GRAVITY * np.array([0.0, k, 0.0]), kc)
    a, slope = GRAVITY * (k - kc), GRAVITY * k / span  # excess at the peak, and how fast it grows and falls
    half = a / slope
    fastest = a * half
    assert slide.velocity.max() == pytest.approx(fastest, rel=1e-12)
    rise = slope * half**3 / 6  # from the start to the peak
    fall = 0.5 * a * half * half + 0.5 * a * half**2 - slope * half**3 / 6  # from there to the largest speed
    slow = min(math.sqrt(2 * fastest / slope), span - half)  # then until it stops, or until the pulse is over
    braking = fastest * slow - slope * slow**3 / 6
    left = fastest - slope * slow**2 / 2
    rest = left**2 / (2 * kc * GRAVITY)
    assert slide.permanent == pytest.approx(rise + fall + braking + rest, rel=1e-9, abs=1e-15)


def test_a_harmonic_record_by_brute_force() -> None:
    """Four periods of a sine, sampled finely, against a hundred thousand explicit steps."""
    time = np.linspace(0.0, 4.0, 401)
    acceleration = 3.0 * np.sin(2 * np.pi * time)
    fine = np.linspace(0.0, 4.0, 100_001)
    excess, step = np.interp(fine, time, acceleration) - 0.1 * GRAVITY, fine[1]
    speed = path = 0.0
    for e in 0.5 * (excess[1:] + excess[:-1]):
        after = max(speed + e * step, 0.0)
        path += 0.5 * (speed + after) * step
        speed = after
    slide = newmark(time, acceleration, 0.1)
    at_the_end = float(np.interp(4.0, slide.time, slide.displacement))
    assert at_the_end == pytest.approx(path, rel=1e-6)


records = st.lists(st.floats(-8.0, 8.0), min_size=3, max_size=40)


@settings(deadline=None)
@given(records, st.floats(0.02, 0.6), st.floats(0.1, 3.0))
def test_what_holds_under_every_record(values: list[float], kc: float, stretch: float) -> None:
    time, acceleration = 0.1 * np.arange(len(values)), np.array(values)
    slide = newmark(time, acceleration, kc)
    assert (slide.velocity >= 0.0).all()
    assert (np.diff(slide.displacement) >= -1e-12).all()
    assert (np.diff(slide.time) >= 0.0).all()
    assert slide.velocity[-1] == pytest.approx(0.0, abs=1e-9)
    if acceleration.max() <= kc * GRAVITY:
        assert slide.permanent == 0.0
    # more strength, less slide; a record stretched in time slides by the square; points in between change nothing
    assert newmark(time, acceleration, 1.2 * kc).permanent <= slide.permanent + 1e-12
    assert newmark(stretch * time, acceleration, kc).permanent == pytest.approx(
        stretch**2 * slide.permanent, rel=1e-6, abs=1e-9
    )
    halved = np.interp(0.05 * np.arange(2 * len(values) - 1), time, acceleration)
    finer = newmark(0.05 * np.arange(len(halved)), halved, kc)
    assert finer.permanent == pytest.approx(slide.permanent, rel=1e-6, abs=1e-9)


def test_a_block_without_strength_is_refused() -> None:
    with pytest.raises(ValueError, match="above 0"):
        newmark(np.array([0.0, 1.0]), np.array([1.0, 1.0]), 0.0)


def test_the_smooth_block_of_the_papers_section_5() -> None:
    """2.6 degrees: 0.44 m/s², 4 m/s after 9 s; its 3 m take 3.7 s, and 9 s give 18 m (paper-notes)."""
    plane = SmoothPlane(math.radians(2.6))
    assert plane.acceleration == pytest.approx(0.4449, abs=1e-4)
    assert plane.speed(9.0) == pytest.approx(4.0, abs=0.01)
    assert plane.distance(9.0) == pytest.approx(18.0, abs=0.05)
    assert plane.time_for(3.0) == pytest.approx(3.67, abs=0.01)
