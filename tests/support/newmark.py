"""Computes the slide of Newmark's block in closed form, and by integration for a base that shakes in both
directions."""

import numpy as np

G = 9.81  # m/s2


def newmark_slide(angle: float, strength_ratio: float, kh: float, seconds: float) -> float:
    """Return the slide (m) of a rigid block along its plane under a constant Kh that acts for some seconds (Newmark
    1965).

    Parameters
    ----------
    angle : inclination of the plane (rad)
    strength_ratio : shear strength over the present normal stress (-)
    kh : seismic coefficient, positive downslope
    seconds : duration of Kh (s)

    Returns
    -------
    The slide; 0 if the block does not slide, infinite if it does not stop.
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
    """Return the slide (m) of a rigid block on a shaking plane, downslope or upslope (Newmark 1965).

    The plane resists in both directions with a constant strength, that of undrained ground: c = ratio times the normal
    stress at rest. The driving acceleration along the plane is g sin b + a cos b, the resistance g ratio cos b.

    Parameters
    ----------
    angle : inclination of the plane (rad)
    strength_ratio : shear strength over the normal stress at rest (-)
    time (n,) : increasing times (s)
    acceleration (n,) : horizontal acceleration of the block (m/s²), positive downslope

    Returns
    -------
    The slide after the block has come to rest, positive downslope; infinite if it does not.
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
