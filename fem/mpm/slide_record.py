"""A slide of material points as it went."""

from dataclasses import dataclass, field

import numpy as np

WINDOW, WINDOWS = 5.0, 3  # s, and number, of windows in which the surface must not move
STILL_SHARE = 2e-3  # of the slide: what it moves less by in a window is no movement, far below what the method knows


@dataclass
class PointSlide:
    """A slide as it went; lengths in m, downslope and down positive.

    Attributes
    ----------
    times : list of float
        Of the looks (s).
    slide, settlement : list of ndarray (k,)
        Movement of the surface at each look, from left to right, smoothed.
    settled : bool
        Whether the surface came to rest.
    reason : str
        Why the slide is over.
    before, after : ndarray (k, 2)
        The surface in coordinates of the section.
    transfer_loss_share : float
        Energy lost between points and grid over the energy turned over (-).
    energy_lost_share : float
        All energy that is neither dissipated by the ground nor in it, over the same (-).
    stopped_by : str or None
        "left" or "right", the side that the slide ran up against, or out of where it is free-field.
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

    def at_rest(self, still: float, calm: float) -> bool:
        """Whether the mean place of the surface in each of the last windows is that in the window before.

        Ground under Kh swings about where it has come to lie, and little damps that.

        Parameters
        ----------
        still : float
            What may lie between two means (m); or `STILL_SHARE` of the slide, if that is more.
        calm : float
            From when on the ground may come to rest (s).
        """
        times = np.array(self.times)
        if times[-1] - max(calm, times[0]) < WINDOWS * WINDOW - 1e-9:
            return False
        window = ((times[-1] - times) / WINDOW).astype(int)
        moved = np.hstack([np.array(self.slide), np.array(self.settlement)])
        means = np.array([moved[window == k].mean(axis=0) for k in range(WINDOWS)])
        return bool(np.abs(np.diff(means, axis=0)).max() < max(still, STILL_SHARE * self.slide_max))
