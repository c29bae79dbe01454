"""Finds the length of a Newton correction that reduces a convex potential (line search)."""

import numpy as np

# The share of the slope at the start of a correction that may be left at its end, the most lengths that are tried, the
# longest, and how near to an end of the interval one may lie.
SLOPE_LEFT, MOST_LENGTHS, LONGEST, INSIDE = 0.5, 9, 8.0, 0.1


class LineSearch:
    """Searches the length of a correction that nearly minimises a convex potential, from the slope of the potential
    alone.

    ``slope`` is the slope of the potential at the start, and ``part`` the next length of the correction that is tried.
    The search also ends if the potential does not decrease, which rounding of the stiffness may cause.
    """

    def __init__(self, slope: float) -> None:
        self.part, self._slope, self._tried = 1.0, slope, 0
        self._low, self._high = (0.0, slope), (np.inf, 0.0)

    def ends(self, slope: float) -> bool:
        """Return whether the last step length of the line search is good enough, given the ``slope`` of the potential
        at its end. If it is not, set ``part`` to the next step length to try.
        """
        self._tried += 1
        if not abs(slope) > SLOPE_LEFT * self._slope or self.part >= LONGEST or self._tried == MOST_LENGTHS:
            return True
        if slope > 0.0:
            self._low = self.part, slope
        else:
            self._high = self.part, slope
        (low, at_low), (high, at_high) = self._low, self._high
        between = min(max(at_low / (at_low - at_high), INSIDE), 1.0 - INSIDE) if at_low > at_high else 0.5
        self.part = 2.0 * self.part if high == np.inf else low + between * (high - low)
        return False
