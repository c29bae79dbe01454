"""Newmark's block in closed form, and integrated where its base shakes both ways."""

import numpy as np

G = 9.81  # m/s2


def newmark_slide(angle: float, strength_ratio: float, kh: float, seconds: float) -> float:
    """Slide (m) of a rigid block under a constant Kh that acts for some seconds (Newmark 1965), on its plane.

    Parameters
    ----------
    angle
        Of the plane (rad).
    strength_ratio
        Shear strength over the normal stress of that moment.
    kh
        Seismic coefficient, downhill.
    seconds
        How long it acts (s).

    Returns
    -------
    float
        0 where it does not slide, infinite where it does not stop.
    """
    sine, cosine = float(np.sin(angle)), float(np.cos(angle))
    on = G * (sine + kh * cosine - strength_ratio * (cosine - kh * sine))
    off = G * (sine - strength_ratio * cosine)
    if on <= 0.0:
        return 0.0 if off <= 0.0 else float("inf")
    if off >= 0.0:
        return float("inf")
    return 0.5 * on * seconds**2 + (on * seconds) ** 2 / (-2.0 * off)


def newmark_slide_speed(angle: float, strength_ratio: float, time: np.ndarray, acceleration: np.ndarray) -> float:
    """Slide (m) of a rigid block on a plane that shakes; it slides uphill, too, where it is driven so (Newmark 1965).

    The plane resists either way with a constant strength, that of ground which does not drain: c = ratio times the
    normal stress at rest. The drive along the plane is g sin b + push cos b, the resistance g ratio cos b.

    Parameters
    ----------
    angle
        Of the plane (rad).
    strength_ratio
        Its shear strength over the normal stress at rest (-).
    time, push
        (n,) Times (s), rising, and what the block feels along the horizontal (m/s2), downhill positive.

    Returns
    -------
    float
        Downhill positive, after it has come to rest; infinite where it does not.
    """
    drive, holds = G * float(np.sin(angle)), G * strength_ratio * float(np.cos(angle))
    if drive >= holds:
        return float("inf")
    step = 1e-4 * max(1.0, float(time[-1] - time[0]) / 10.0)
    at = np.arange(time[0], time[-1] + step, step)
    speed, way = 0.0, 0.0
    for felt in drive + np.interp(at, time, acceleration, right=0.0) * float(np.cos(angle)):
        free = speed + step * float(felt)
        after = float(np.copysign(max(0.0, abs(free) - step * holds), free))
        way += 0.5 * step * (speed + after)
        speed = after
    return way + 0.5 * speed * abs(speed) / (holds - np.copysign(drive, speed))
