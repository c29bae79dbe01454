"""Makes uniform ground of infinite length: random discs between two horizontal rows of fixed discs, with periodic
sides."""

from dataclasses import dataclass

import numpy as np

from dem.kernels.neighbours import pairs_within
from dem.kernels.period import Period

SWEEPS = 300  # in which discs grow to their size and are pushed apart
CORRECTIONS = 10  # in each sweep
CORRECTED_SHARE = 0.6  # of an overlap that a push takes away
PLATE_DISTANCE = 0.9  # radii between the rim of a plate's disc and the plane that the others keep to


@dataclass(frozen=True)
class TiedPacking:
    """Holds one period of uniform ground with periodic sides.

    Attributes
    ----------
    x, z, radius (n,) : centres and radii (m); the free discs lie between z = 0 and ``height``
    layer (n,) : 0 for free discs, -1 for the discs of the plates
    length, height : length of the period, and distance between the planes of the plates (m)
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    layer: np.ndarray
    length: float
    height: float

    @property
    def above(self) -> np.ndarray:
        """Return the mask of the discs of the upper plate."""
        return (self.layer < 0) & (self.z > 0.5 * self.height)

    def without_upper_plate(self) -> "TiedPacking":
        """Return the ground without the upper plate."""
        below = ~self.above
        return TiedPacking(
            self.x[below], self.z[below], self.radius[below], self.layer[below], self.length, self.height
        )


def tied_packing(
    columns: int, rows: int, radius: float, *, spread: float = 0.2, porosity: float = 0.22, seed: int = 0
) -> TiedPacking:
    """Make a random packing between two plates; some discs overlap by some per cent of a radius until they settle.

    Parameters
    ----------
    columns, rows : length and height in mean diameters
    radius : mean radius (m)
    spread : half the width of the range of radii, over their mean (-)
    porosity : area of the voids over the total area (-)
    seed : seed of the random numbers
    """
    rng = np.random.default_rng(seed)
    length, height = 2.0 * radius * columns, 2.0 * radius * rows
    solid = length * height * (1.0 - porosity)
    count = round(solid / (np.pi * radius**2 * (1.0 + spread**2 / 3.0)))
    sizes = radius * rng.uniform(1.0 - spread, 1.0 + spread, count)
    sizes *= np.sqrt(solid / np.sum(np.pi * sizes**2))
    x, z = rng.uniform(0.0, length, count), rng.uniform(0.0, height, count)
    still = np.zeros(count, bool)
    for sweep in range(SWEEPS):
        grown = sizes * min(1.0, 0.5 + sweep / SWEEPS)
        i, j = pairs_within(x, z, grown, still, 0.2 * radius, Period(length, 0.0))
        for _ in range(CORRECTIONS):
            dx, dz = x[j] - x[i], z[j] - z[i]
            dx -= np.floor(dx / length + 0.5) * length
            distance = np.hypot(dx, dz)
            shift = 0.5 * CORRECTED_SHARE * np.maximum(grown[i] + grown[j] - distance, 0.0) / distance
            x += np.bincount(j, shift * dx, count) - np.bincount(i, shift * dx, count)
            z += np.bincount(j, shift * dz, count) - np.bincount(i, shift * dz, count)
            z = np.clip(z, grown, height - grown)
    plate = 2.0 * radius * (np.arange(columns) + 0.5)
    return TiedPacking(
        np.concatenate([plate, x, plate]),
        np.concatenate(
            [np.full(columns, -PLATE_DISTANCE * radius), z, np.full(columns, height + PLATE_DISTANCE * radius)]
        ),
        np.concatenate([np.full(columns, radius), sizes, np.full(columns, radius)]),
        np.concatenate([np.full(columns, -1), np.zeros(count), np.full(columns, -1)]).astype(np.int32),
        length,
        height,
    )
