"""Defines geometry, materials and boundary of an assembly of discs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dem.pair_table import LineStrengths, strength_of_each
from dem.springs import Law, LayerSprings, Mean, Strength

SHORTEST_PERIOD = 12.0  # largest radii: twice the length that the cells of the neighbour list require


class DiscGeometry:
    """Holds positions, radii and layers of discs.

    Attributes
    ----------
    x, z : (n,)
        Coordinates of the centres (m).
    radius : (n,)
        Radii (m).
    layer : (n,)
        Index of the layer of each disc, -1 for boundary discs.
    fixed : (n,)
        Mask of the discs that do not move: boundary discs, and other fixed discs.

    Raises
    ------
    ValueError
        If arrays have different lengths, or radii are not positive.
    """

    def __init__(
        self,
        x: np.ndarray | Sequence[float],
        z: np.ndarray | Sequence[float],
        radius: np.ndarray | float,
        layer: np.ndarray | Sequence[int] | int = 0,
        *,
        fixed: np.ndarray | Sequence[bool] | bool = False,
    ) -> None:
        self.x, self.z = np.array(x, float), np.array(z, float)
        n = len(self.x)
        if n == 0 or self.z.shape != (n,) or not (np.isfinite(self.x).all() and np.isfinite(self.z).all()):
            raise ValueError("discs: x and z must be finite, of equal length, and not empty")
        self.radius = np.array(np.broadcast_to(np.asarray(radius, float), n))
        if not (self.radius > 0.0).all():
            smallest = int(np.argmin(self.radius))
            raise ValueError(f"discs: radius of disc {smallest} is {self.radius[smallest]}; expected a positive radius")
        self.layer = np.array(np.broadcast_to(layer, n), np.int32)
        self.fixed = np.array(np.broadcast_to(fixed, n), bool) | (self.layer < 0)


@dataclass(frozen=True)
class DiscMaterials:
    """Holds the materials of the discs.

    Attributes
    ----------
    layers : sequence of LayerSprings
        Constants of the springs of each layer.
    law, mean : str
        Contact law, and kind of mean of the constants of two layers, see `pair_table.pair_table`.
    turns : bool
        Whether discs rotate; discs of a layer with infinite rolling friction do not rotate in any case.
    """

    layers: Sequence[LayerSprings]
    law: Law = "paper"
    mean: Mean = "arithmetic"
    turns: bool = True

    def check_numbers(self, layer: np.ndarray) -> None:
        """Raise ValueError unless there are constants for the layers (n,) of the discs. Layer number -1 marks the
        boundary discs."""
        if layer.max() >= len(self.layers) or layer.min() < -1:
            raise ValueError(
                f"discs: layers {layer.min()} to {layer.max()}; expected 0 to {len(self.layers) - 1}, or -1 for "
                "boundary discs"
            )

    def densities(self, layer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return density and buoyant density (kg/m3) of discs by their layers (n,)."""
        density = np.array([soil.density for soil in self.layers] + [self.layers[0].density])
        effective = np.array([soil.effective_density for soil in self.layers] + [0.0])
        return density[layer], effective[layer]

    def rotates(self, layer: np.ndarray) -> np.ndarray:
        """Return a mask of the discs that rotate, by their layers (n,)."""
        rolls = np.isfinite([soil.rolling_friction for soil in self.layers] + [0.0])
        return np.asarray(rolls[layer] & self.turns)


class DiscBoundary:
    """Holds rigid lines that discs cannot pass, and the period of periodic sides.

    Attributes
    ----------
    lines : (k, 6)
        Rigid lines, see `DiscState`.
    strengths : tuple of Strength or None
        Strength of the contacts with each line. An entry is None if the line has the strength of the disc's layer; the
        tuple is empty if this holds for all lines.
    period : (length, rise) or None
        Length (m) of the period, and height (m) by which the ground is higher one period to the right; for soil discs
        only.
    """

    def __init__(
        self,
        lines: np.ndarray | None = None,
        line_strength: LineStrengths = None,
        period: tuple[float, float] | None = None,
    ) -> None:
        """Make the boundary from rigid lines; line_strength: one strength for all lines, or one for each, such as
        `springs.SMOOTH`.

        Raises ValueError unless there are as many strengths as lines.
        """
        self.lines = np.array(lines if lines is not None else np.zeros((0, 6)), float).reshape(-1, 6)
        self.strengths: tuple[Strength | None, ...] = strength_of_each(line_strength, len(self.lines))
        self.period = None if period is None else (float(period[0]), float(period[1]))

    def check_period(self, law: Law, largest: float) -> None:
        """Raise ValueError unless the period fits the contact law and the largest radius (m)."""
        if self.period is not None and (law != "soil" or not self.period[0] >= SHORTEST_PERIOD * largest):
            raise ValueError(
                f"discs: periodic sides need law='soil' and a period of at least {SHORTEST_PERIOD:g} times the largest "
                f"radius of {largest:g} m; the law is {law!r} and the period {self.period[0]:g} m"
            )
