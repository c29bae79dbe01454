"""Record of a slide of material points over time."""

from dataclasses import dataclass, field

import numpy as np

WINDOW, WINDOWS = 5.0, 3  # s, and number, of windows in which the surface must not move
STILL_SHARE = 2e-3  # of the slide: what it moves less by in a window is no movement, far below what the method knows


@dataclass
class PointSlide:
    """Record of a slide over time; lengths in m, positive downslope and down.

    Attributes
    ----------
    times : list of float
        Times of the record (s).
    slide, settlement : list of ndarray (k,)
        Smoothed displacement of the surface at each time, from left to right.
    settled : bool
        Whether the surface came to rest.
    reason : str
        Why the slide is over.
    before, after : ndarray (k, 2)
        The surface in coordinates of the section.
    transfer_loss_share : float
        Energy lost between points and grid over the total energy exchanged (-).
    energy_lost_share : float
        All energy that the ground neither dissipated nor stores, over the total energy exchanged (-).
    stopped_by : str or None
        "left" or "right": the side at which the slide was stopped, or at which it left the section if the side is
        free-field.
    cell : float
        Side of a cell of the grid (m).
    """

    times: list[float] = field(default_factory=list)
    slide: list[np.ndarray] = field(default_factory=list)
    settlement: list[np.ndarray] = field(default_factory=list)
    settled: bool = False
    reason: str = ""
    before: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    after: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    transfer_loss_share: float = 0.0
    energy_lost_share: float = 0.0
    stopped_by: str | None = None
    cell: float = 0.0

    @property
    def slide_max(self) -> float:
        """Largest slide of the surface at the end (m)."""
        return float(self.slide[-1].max()) if self.slide else 0.0

    def at_rest(self, still: float, rest_from: float) -> bool:
        """Whether the mean place of the surface is the same in each of the last windows of time as in the window
        before.

        Ground under a constant Kh oscillates about its final place with little damping.

        Parameters
        ----------
        still : float
            Largest difference of two means (m); or `STILL_SHARE` of the slide, if that is larger.
        rest_from : float
            Time from which the ground may come to rest (s).
        """
        times = np.array(self.times)
        if times[-1] - max(rest_from, times[0]) < WINDOWS * WINDOW - 1e-9:
            return False
        window = ((times[-1] - times) / WINDOW).astype(int)
        moved = np.hstack([np.array(self.slide), np.array(self.settlement)])
        means = np.array([moved[window == k].mean(axis=0) for k in range(WINDOWS)])
        return bool(np.abs(np.diff(means, axis=0)).max() < max(still, STILL_SHARE * self.slide_max))
