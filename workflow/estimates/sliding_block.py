"""Computes the slide of a rigid block on the slip surface (Newmark 1965), for comparison with the slide of the
discs."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshes.section.quantity import GRAVITY


@dataclass(frozen=True)
class RigidSlide:
    """Holds the motion of a block: ``time`` (n,) in s, ``velocity`` in m/s and ``displacement`` in m, relative to the
    ground."""

    time: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray

    @property
    def permanent(self) -> float:
        """Return the displacement at the end (m)."""
        return float(self.displacement[-1])

    @property
    def moving(self) -> bool:
        """Return whether the block still moves when the record ends."""
        return bool(self.velocity[-1] > 0.0)


def newmark(time: np.ndarray, acceleration: np.ndarray, kc: float | np.ndarray) -> RigidSlide:
    """Compute the slide of a rigid block that resists kc g, under a record of the ground's acceleration (Newmark 1965).

    N. M. Newmark, Effects of earthquakes on dams and embankments, Géotechnique 15 (1965) 139-160: from the moment when
    the ground acceleration exceeds kc g, the relative acceleration of the block is the excess over kc g, until both
    have the same velocity again; the block does not slide back. The motion is integrated in closed form from corner to
    corner of the record, so that there is no time step. If the record ends while the block slides, the block slides on,
    with no acceleration of the ground, until it stops.

    Parameters
    ----------
    time : times (n,) in s, which must not fall; two equal times make a step of the acceleration
    acceleration : acceleration (n,) of the ground in m/s², linear between the times, positive where it drives the block
    kc : yield coefficient (-), above 0; an array (n,) of values at the times, linear between them, if strength is lost

    Returns
    -------
    The motion of the block relative to the ground.

    Raises
    ------
    ValueError : ``kc`` is not above 0.
    """
    least, last = float(np.min(kc)), float(np.ravel(kc)[-1])
    if not least > 0.0:
        raise ValueError(
            f"kc = {least:g}: expected a critical Kh above 0, since a block without resistance does not stop"
        )
    excess = np.asarray(acceleration, dtype=float) - kc * GRAVITY
    t, v, u = [float(time[0])], [0.0], [0.0]
    for i in range(len(time) - 1):
        span = float(time[i + 1] - time[i])
        if span <= 0.0:
            continue
        # where the excess changes its sign the block may set out
        a, b = float(excess[i]), float(excess[i + 1])
        cuts = [0.0, span * a / (a - b), span] if a * b < 0.0 else [0.0, span]
        for start, end in pairwise(cuts):
            _slide_on(t, v, u, a + (b - a) * start / span, (b - a) / span, end - start)
    if v[-1] > 0.0:
        _slide_on(t, v, u, -last * GRAVITY, 0.0, v[-1] / (last * GRAVITY))
    return RigidSlide(np.array(t), np.array(v), np.array(u))


def _slide_on(t: list[float], v: list[float], u: list[float], a: float, slope: float, span: float) -> None:
    """Append time, speed and slide of the block at the end of a span of the record, and before it the stop of the
    block, if it stops. Within the span the excess acceleration is a + slope s after a time s."""
    speed = v[-1]
    if speed == 0.0 and a + 0.5 * slope * span <= 0.0:
        t.append(t[-1] + span)
        v.append(0.0)
        u.append(u[-1])
        return
    stop = _first_stop(speed, a, slope, span)
    moving = span if stop is None else stop
    v_end = 0.0 if stop is not None else speed + a * moving + 0.5 * slope * moving**2
    u_end = u[-1] + speed * moving + 0.5 * a * moving**2 + slope * moving**3 / 6.0
    t.append(t[-1] + moving)
    v.append(max(v_end, 0.0))
    u.append(u_end)
    if moving < span:
        t.append(t[-1] + span - moving)
        v.append(0.0)
        u.append(u_end)


def _first_stop(speed: float, a: float, slope: float, span: float) -> float | None:
    """Return the time within a span at which the speed + a s + slope s²/2 first falls to 0; None if it does not."""
    if speed == 0.0:
        return None  # it sets out: the excess is positive
    if slope == 0.0:
        roots = [-speed / a] if a != 0.0 else []
    else:
        inside = a * a - 2.0 * slope * speed
        if inside < 0.0:
            return None
        # q has no cancellation, whichever sign a has
        q = -(a + np.copysign(np.sqrt(inside), a))
        roots = [q / slope] + ([2.0 * speed / q] if q != 0.0 else [])
    within = [root for root in roots if 0.0 < root <= span]
    return float(min(within)) if within else None


def rectangular_pulse(kc: float, k: float, duration: float) -> float:
    """Return the slide (m) of a block with yield acceleration kc g under a constant k g of a duration (s).

    Newmark (1965), the closed form for a rectangular pulse: u = V² / (2 g kc) (1 - kc / k) with V = k g t.
    """
    if k <= kc:
        return 0.0
    speed = k * GRAVITY * duration
    return speed**2 / (2.0 * GRAVITY * kc) * (1.0 - kc / k)


@dataclass(frozen=True)
class SmoothPlane:
    """Describes a block without friction on a plane, as in Sec. 5 of the paper.

    Parameters
    ----------
    slope : inclination of the plane β (rad)
    """

    slope: float

    @property
    def acceleration(self) -> float:
        """Return the acceleration along the plane (m/s²): g sin β."""
        return GRAVITY * float(np.sin(self.slope))

    def speed(self, seconds: float) -> float:
        """Return the speed (m/s) of a block that has accelerated uniformly from rest for a time (s)."""
        return self.acceleration * seconds

    def distance(self, seconds: float) -> float:
        """Return the distance (m) after a time from rest."""
        return 0.5 * self.acceleration * seconds**2

    def time_for(self, distance: float) -> float:
        """Return the time (s) from rest for a distance (m)."""
        return float(np.sqrt(2.0 * distance / self.acceleration))
