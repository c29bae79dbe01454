"""Describes the external acceleration of the discs in time, and gravity in a tilted frame."""

from dataclasses import dataclass, field

import numpy as np

from meshes.section.quantity import GRAVITY

HALF_COSINE_POINTS = 65  # points in time


@dataclass(frozen=True)
class Acceleration:
    """Holds the external acceleration of the discs as a function of time, linear between given times.

    The acceleration acts on the full mass of all discs. Before the first and after the last time it is constant. A
    constant seismic coefficient Kh is the constant acceleration Kh g.

    Attributes
    ----------
    times (times,) : times (s), increasing; a single 0 by default
    x, z (times,) : acceleration along the axes of the discs at these times (m/s2), positive to the right and up; no
        acceleration by default

    Raises
    ------
    ValueError
        If the times do not increase, x or z has another length, or a value is not finite.
    """

    times: np.ndarray = field(default_factory=lambda: np.zeros(1))
    x: np.ndarray = field(default_factory=lambda: np.zeros(1))
    z: np.ndarray = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        for name in ("times", "x", "z"):
            values = np.atleast_1d(np.asarray(getattr(self, name), float))
            object.__setattr__(self, name, values)
        if not (len(self.times) == len(self.x) == len(self.z) and np.all(np.diff(self.times) > 0.0)):
            raise ValueError("acceleration: times must increase, and x and z must have one value for each time")
        if not all(np.isfinite(v).all() for v in (self.times, self.x, self.z)):
            raise ValueError("acceleration: a time or value is not finite")

    @classmethod
    def seismic(
        cls, kh: float, *, tilt: float = 0.0, ramp: tuple[float, float] | None = None, g: float = GRAVITY
    ) -> "Acceleration":
        """Return the constant acceleration of a seismic coefficient in axes whose x axis dips by `tilt` (rad) below the
        horizontal; a positive Kh acts downslope.

        ramp (start, end) in s: times between which Kh rises from zero to its value along a half cosine.
        kh: seismic coefficient (-); g: gravity (m/s2).
        """
        ax, az = g * (kh * np.cos(tilt)), g * (kh * np.sin(tilt))
        if ramp is None:
            return cls(np.zeros(1), np.array([ax]), np.array([az]))
        s, share = half_cosine()
        return cls(ramp[0] + s * (ramp[1] - ramp[0]), ax * share, az * share)

    def with_level(self, gravity: tuple[float, float]) -> np.ndarray:
        """Return three components (3, times) of the acceleration in m/s2: along x, along z, and horizontally
        (perpendicular to gravity), positive to the right.
        """
        right = right_of(gravity)
        return np.array([self.x, self.z, right[0] * self.x + right[1] * self.z])

    def mean(self, begin: float, end: float) -> np.ndarray:
        """Return the mean acceleration along x and z (2,) from one time (s) to a later time."""
        part = self.between(begin, end)
        values = np.array([part.x, part.z])
        return np.asarray(0.5 * (values[:, 1:] + values[:, :-1]) @ np.diff(part.times) / (end - begin))

    def between(self, begin: float, end: float) -> "Acceleration":
        """Return the part of the acceleration from one time (s) to a later time."""
        first, last = self.times.searchsorted(begin, "right"), self.times.searchsorted(end, "left")
        inside = self.times[first:last]
        times = np.concatenate([[begin], inside, [end]]) if len(inside) else np.array([begin, end])
        return _unchecked(times, np.interp(times, self.times, self.x), np.interp(times, self.times, self.z))

    def at(self, time: float) -> "Acceleration":
        """Return the acceleration at one time (s), as a constant acceleration."""
        x, z = (np.interp(time, self.times, values) for values in (self.x, self.z))
        return _unchecked(np.array([time]), np.array([x]), np.array([z]))

    def plus(self, x: float | np.ndarray, z: float | np.ndarray) -> "Acceleration":
        """Return the sum with further accelerations (m/s2) along x and z, constant or at the same times."""
        return _unchecked(self.times, self.x + x, self.z + z)


def half_cosine() -> tuple[np.ndarray, np.ndarray]:
    """Return a smooth rise from 0 to 1 along a half cosine.

    Returns
    -------
    Times (n,) as shares of the duration of the rise (-), and values (n,) at these times (-).
    """
    s = np.linspace(0.0, 1.0, HALF_COSINE_POINTS)
    return s, 0.5 - 0.5 * np.cos(np.pi * s)


def _unchecked(times: np.ndarray, x: np.ndarray, z: np.ndarray) -> Acceleration:
    """Return an acceleration that is made of a checked one, without the checks: there are some thousand in a slide."""
    acceleration = object.__new__(Acceleration)
    for name, values in (("times", times), ("x", x), ("z", z)):
        object.__setattr__(acceleration, name, values)
    return acceleration


def right_of(gravity: tuple[float, float]) -> tuple[float, float]:
    """Return the horizontal direction to the right, perpendicular to gravity.

    Parameters
    ----------
    gravity (2,) : gravity along x and z (m/s2)

    Returns
    -------
    Unit vector (2,): gravity rotated by 90° counter-clockwise; the x axis without gravity.
    """
    size = float(np.hypot(*gravity))
    return (-gravity[1] / size, gravity[0] / size) if size > 0.0 else (1.0, 0.0)


def tilted_gravity(tilt: float, g: float = GRAVITY) -> tuple[float, float]:
    """Return gravity (m/s2) in axes whose x axis dips by `tilt` (rad) below the horizontal."""
    return g * float(np.sin(tilt)), -g * float(np.cos(tilt))
