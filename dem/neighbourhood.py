"""Sums and means over the neighbours of discs of liquefied ground, for the pairs that are listed. Lengths are in m."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from dem.state import DiscState, nearest_image

SMALLEST_DISTANCE = 1e-9  # reaches: no pair counts as nearer


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """Holds the listed pairs of liquefied ground, with the kernels of `kernels.liquefied_laws` at their distances.

    Attributes
    ----------
    discs : number n of all discs
    i, j (pairs,) : numbers of the two discs of each pair
    nx, nz (pairs,) : unit vector from disc i to disc j
    apart (pairs,) : distance of the centres (m)
    width, slope (pairs,) : kernel W of the pore pressure (1/m2), and its slope (1/m3); zero beyond the reach
    share (pairs,) : kernel w of the bonds (-)
    at_zero : W at no distance (1/m2)
    """

    discs: int
    i: np.ndarray
    j: np.ndarray
    nx: np.ndarray
    nz: np.ndarray
    apart: np.ndarray
    width: np.ndarray
    slope: np.ndarray
    share: np.ndarray
    at_zero: float

    @classmethod
    def of(cls, state: DiscState, x: np.ndarray, z: np.ndarray) -> Self:
        """Return the neighbourhood of discs at the places x, z (n,), for the listed pairs of ``state``."""
        i, j = state.liquefied_i, state.liquefied_j
        dx, dz = nearest_image(x[j] - x[i], z[j] - z[i], state.repeats)
        apart = np.maximum(np.hypot(dx, dz), SMALLEST_DISTANCE * state.reach)
        q = np.minimum(apart / state.reach, 1.0)
        rest, at_zero = 1.0 - q, 7.0 / (np.pi * state.reach**2)
        width, slope = at_zero * rest**4 * (1.0 + 4.0 * q), -20.0 * at_zero * q * rest**3 / state.reach
        share = rest * rest * (1.0 + 2.0 * q)
        return cls(len(state), i, j, dx / apart, dz / apart, apart, width, slope, share, at_zero)

    def sums(self, to_first: np.ndarray, to_second: np.ndarray) -> np.ndarray:
        """Return the sums (n,) over the pairs of every disc of values (pairs,) that its disc i and its disc j get."""
        return np.bincount(self.i, to_first, self.discs) + np.bincount(self.j, to_second, self.discs)

    def density(self, area: np.ndarray) -> np.ndarray:
        """Return the density (n,) of the areas (n,) in m2 of all discs at every disc (-)."""
        return self.at_zero * area + self.sums(self.width * area[self.j], self.width * area[self.i])

    def mean(self, values: np.ndarray, area: np.ndarray) -> np.ndarray:
        """Return the mean (n,) of values (n,) over the disc and its neighbours, weighted by W and the areas (n,) in m2,
        which are 0 for discs that do not count."""
        i, j = self.i, self.j
        width = np.where((area[i] > 0.0) & (area[j] > 0.0), self.width, 0.0)
        weight = self.at_zero * area + self.sums(width * area[j], width * area[i])
        near = self.sums(width * area[j] * values[j], width * area[i] * values[i])
        return np.asarray((self.at_zero * area * values + near) / np.where(weight > 0.0, weight, 1.0))
