"""Convergence of slides: numbers over ever smaller discs, or time steps, extrapolated to size zero."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RATIO = math.sqrt(2.0)  # of one radius to the next
RADII = (1.0, 1.0 / RATIO, 0.5)  # of the one asked for
STEPS = (1.0, 1.0 / RATIO, 0.5)  # of the time step asked for
ORDERS = (0.5, 3.0)  # that a fit is believed to have


@dataclass(frozen=True)
class Fit:
    """Extrapolation of a number to size zero.

    Attributes
    ----------
    limit : float
        What it tends to.
    order : float or None
        Power of the size with which it does so; None where three values show none, and a straight line has to do.
    left : float
        How far the value of the smallest size is from the limit, with the half width of its 95 % interval where it is
        a mean over packings; a share of the limit.
    scatter : float
        That half width alone, as the same share.
    """

    limit: float
    order: float | None
    left: float
    scatter: float

    def converged(self, within: float) -> bool:
        """Whether no more than that share is left."""
        return self.left <= within

    def verdict(self, within: float) -> str:
        """In words."""
        if self.converged(within):
            return f"converged within {100.0 * self.left:.2g} %"
        message = f"not converged: {100.0 * self.left:.2g} % may be left"
        return f"{message}, {100.0 * self.scatter:.2g} % by the scatter of packings" if self.scatter > 0.0 else message


def fit(sizes: Sequence[float], values: Sequence[float], error: float = 0.0, least: float = 0.0) -> Fit:
    """Extrapolate values over three sizes, largest first, each by the same ratio smaller.

    Richardson's extrapolation with the order that the three values show (P. J. Roache, J. Fluids Eng. 116 (1994)
    405-413); where they scatter, or the order is not plausible, a straight line through all of them by least squares;
    the error is then at least the largest distance of a value from the line. ``error``: half width of the 95 % interval
    of the last value. ``least``: the number that shares refer to where the limit is smaller.
    """

    def share(value: float, whole: float) -> float:
        most = max(abs(whole), least)
        return value / most if most > 0.0 else math.inf if value > 0.0 else 0.0

    first, second, last = values
    ratio, early, late = sizes[0] / sizes[1], values[0] - values[1], values[1] - values[2]
    if first == second == last:
        return Fit(last, None, share(error, last), share(error, last))
    order = math.log(early / late) / math.log(ratio) if early * late > 0.0 else None
    if order is not None and ORDERS[0] <= order <= ORDERS[1]:
        limit = last - late / (ratio**order - 1.0)
        return Fit(limit, order, share(abs(last - limit) + error, limit), share(error, limit))
    slope, limit = np.polyfit(sizes, values, 1)
    off = float(np.abs(np.polyval((slope, limit), sizes) - values).max())
    away = max(abs(last - float(limit)), off)
    return Fit(float(limit), None, share(away + error, float(limit)), share(error, float(limit)))
