"""Defines the background grid of the material points: its cells, and its fixed nodes."""

from dataclasses import dataclass

import numpy as np

from fem.kernels import grid_motion


@dataclass(frozen=True, eq=False)
class BackgroundGrid:
    """Holds the background grid, which begins at x = 0, z = 0; its cells are squares unless rows of nodes are inclined.

    Attributes
    ----------
    cell : side of a cell (m)
    support (nx, nz) : boundary condition of each node: `FREE`, `FIXED` or `WALL` of `fem.kernels.grid_motion`
    uplift (nx, nz, 2) : minus the gradient of the pore pressure (N/m³)
    periodic : whether the right side continues at the left one
    slope : slope dz/dx of the rows of nodes, which are parallel to inclined layers
    """

    cell: float
    support: np.ndarray
    uplift: np.ndarray
    periodic: bool = False
    slope: float = 0.0

    @classmethod
    def empty(cls, cell: float, columns: int, rows: int, periodic: bool = False, floor: int = 3) -> "BackgroundGrid":
        """Make a grid without water whose lowest ``floor`` rows of nodes are fixed, and three columns at either side
        unless it is periodic. ``cell`` is the side of a cell (m); ``columns`` and ``rows`` are the numbers of nodes.
        """
        support = np.full((columns, rows), grid_motion.FREE, dtype=np.int8)
        support[:, :floor] = grid_motion.FIXED
        if not periodic:
            support[:3] = support[-3:] = grid_motion.FIXED
        return cls(cell, support, np.zeros((columns, rows, 2)), periodic)

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of columns and rows of nodes."""
        return int(self.support.shape[0]), int(self.support.shape[1])

    @property
    def stretch(self) -> float:
        """Return the side of a cell over its shortest extent: the norm of the matrix [[1, 0], [-slope, 1]] (-)."""
        half = 0.5 * abs(self.slope)
        return float(half + np.sqrt(1.0 + half**2))

    def level(self, x: np.ndarray) -> np.ndarray:
        """Return positions (n, 2) in m in coordinates in which cells are squares: x, and the height above the inclined
        row of nodes through the origin.
        """
        return np.column_stack([x[:, 0], x[:, 1] - self.slope * x[:, 0]])
