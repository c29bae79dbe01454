"""Finds the length of a Newton correction that reduces a convex potential (line search)."""

import numpy as np

# Largest slope at the end of a correction over the slope at its start; largest number of lengths tried; longest length;
# smallest distance of a trial from an end of the interval, as a share of the interval.
REMAINING_SLOPE, MOST_TRIALS, LONGEST_STEP, INTERVAL_MARGIN = 0.5, 9, 8.0, 0.1


class LineSearch:
    """Searches the length of a correction that nearly minimises a convex potential, from the slope of the potential
    alone.

    ``slope`` is the slope of the potential at the start, and ``step_length`` the next length of the correction that is
    tried. The search also ends if the potential does not decrease, which rounding of the stiffness may cause.
    """

    def __init__(self, slope: float) -> None:
        self.step_length, self._slope, self._tried = 1.0, slope, 0
        self._low, self._high = (0.0, slope), (np.inf, 0.0)

    def ends(self, slope: float) -> bool:
        """Return whether the last step length of the line search is good enough, given the ``slope`` of the potential
        at its end. If it is not, set ``step_length`` to the next step length to try.
        """
        self._tried += 1
        if (
            not abs(slope) > REMAINING_SLOPE * self._slope
            or self.step_length >= LONGEST_STEP
            or self._tried == MOST_TRIALS
        ):
            return True
        if slope > 0.0:
            self._low = self.step_length, slope
        else:
            self._high = self.step_length, slope
        (low, at_low), (high, at_high) = self._low, self._high
        between = (
            min(max(at_low / (at_low - at_high), INTERVAL_MARGIN), 1.0 - INTERVAL_MARGIN) if at_low > at_high else 0.5
        )
        self.step_length = 2.0 * self.step_length if high == np.inf else low + between * (high - low)
        return False
