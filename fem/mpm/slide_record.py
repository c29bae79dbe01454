"""Records the slide of material points over time."""

from dataclasses import dataclass, field

import numpy as np

WINDOW_LENGTH, WINDOWS = 5.0, 3  # s, and number, of windows in which the surface must not move
# Of the largest slide: what it changes less by in a window is no movement, far below what the method knows. The rest of
# the surface may creep by more, since a few metres of it do so long after the slide.
STILL_SHARE, CREEP_SHARE = 2e-3, 1e-2
# Of the movement that counts as still: where the whole surface moves by less within one window, it is at rest without a
# second look. S-13 rests 7 s earlier, and its slide differs by 0.05 %.
STEADY_SHARE = 0.5


def earliest_rest(rest_from: float) -> float:
    """Return the earliest time at which a surface can be found at rest.

    Parameters
    ----------
    rest_from : time from which on the surface may come to rest (s)

    Returns
    -------
    The time (s) after one window in which the surface must not move.
    """
    return rest_from + WINDOW_LENGTH


@dataclass
class PointSlide:
    """Holds the record of a slide over time; lengths in m, positive downslope and downwards.

    Attributes
    ----------
    times : times of the record (s)
    slide, settlement (k,) : displacement of the surface at each time, from left to right, smoothed along the surface
    settled : whether the surface came to rest
    reason : reason why the computation of the slide ended
    surface_before, surface_after (k, 2) : surface before and after the slide, in the coordinates of the section
    transfer_loss_share : energy lost between points and grid over the total energy exchanged (-)
    energy_lost_share : energy that the ground neither dissipated nor stores, over the total energy exchanged (-)
    stopped_by : side ("left" or "right") at which the slide was stopped, or through which it left the section if the
        side is free-field
    cell : side of a cell of the grid (m)
    """

    times: list[float] = field(default_factory=list)
    slide: list[np.ndarray] = field(default_factory=list)
    settlement: list[np.ndarray] = field(default_factory=list)
    settled: bool = False
    reason: str = ""
    surface_before: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    surface_after: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    transfer_loss_share: float = 0.0
    energy_lost_share: float = 0.0
    stopped_by: str | None = None
    cell: float = 0.0

    @property
    def slide_max(self) -> float:
        """Return the largest displacement of the surface to either side at the end (m)."""
        return float(np.abs(self.slide[-1]).max()) if self.slide else 0.0

    def at_rest(self, still: float, rest_from: float) -> bool:
        """Return whether the surface is at rest: it hardly moves within a window of time, or its mean displacement is
        the same in each of the last windows as in the window before.

        Ground under a constant Kh oscillates about its final position with little damping.

        Parameters
        ----------
        still : largest difference of two means (m); or `STILL_SHARE` of the slide for the largest slide, and
            `CREEP_SHARE` of it for every part of the surface, if that is larger
        rest_from : time from which the ground may come to rest (s)
        """
        times, slide = np.array(self.times), np.array(self.slide)
        moved = np.hstack([slide, np.array(self.settlement)])
        since = max(rest_from, times[0])
        if times[-1] < earliest_rest(since) - 1e-9:
            return False
        if float(np.ptp(moved[times >= times[-1] - WINDOW_LENGTH - 1e-9], axis=0).max()) < STEADY_SHARE * still:
            return True
        if times[-1] < since + WINDOWS * WINDOW_LENGTH - 1e-9:
            return False
        window = ((times[-1] - times) / WINDOW_LENGTH).astype(int)

        def change(values: np.ndarray) -> float:
            means = np.array([values[window == k].mean(axis=0) for k in range(WINDOWS)])
            return float(np.abs(np.diff(means, axis=0)).max())

        creep = change(moved)
        largest = change(np.abs(slide).max(axis=1))
        return creep < max(still, CREEP_SHARE * self.slide_max) and largest < max(still, STILL_SHARE * self.slide_max)
