"""A slide of material points as it went."""

from dataclasses import dataclass, field

import numpy as np


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
