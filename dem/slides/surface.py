"""Describes the ground surface of discs: the topmost discs, how far they settle and slide, and how wide cracks open."""

from dataclasses import dataclass

import numpy as np

from dem.ground import Ground
from dem.model import DiscModel
from meshes.slip_line import running_median

NEIGHBOURS = 5  # surface discs of a running median: one that rolls away alone is no slide
THIRDS = ("uphill", "middle", "downhill")


@dataclass(frozen=True)
class Surface:
    """Holds the topmost disc of every column of discs before a slide, from uphill to downhill.

    Attributes
    ----------
    discs (n,) : numbers of the discs
    x, z (n,) : positions before the slide, in the frame of the section (m)
    third (n,) : third of the surface: 0 uphill, 1 middle, 2 downhill
    """

    discs: np.ndarray
    x: np.ndarray
    z: np.ndarray
    third: np.ndarray

    @classmethod
    def of(cls, model: DiscModel, ground: Ground) -> "Surface":
        """Return the surface of discs in their present positions."""
        free = np.flatnonzero(~model.fixed)
        x, z = ground.to_section(model.x[free], model.z[free])
        top = topmost(x, z, 2.0 * ground.radius)[:: ground.downhill]
        third = np.minimum((np.arange(len(top)) * 3) // len(top), 2)
        return cls(free[top], x[top], z[top], third)

    def movement(self, model: DiscModel, ground: Ground) -> tuple[np.ndarray, np.ndarray]:
        """Return slide (m, horizontally towards the lower end of the surface) and settlement (m, downwards) of each
        disc of the surface."""
        x, z = ground.to_section(model.x[self.discs], model.z[self.discs])
        return ground.downhill * (x - self.x), self.z - z

    def by_thirds(self, values: np.ndarray) -> dict[str, float]:
        """Return the median of each third of the surface."""
        return {name: float(np.median(values[self.third == k])) for k, name in enumerate(THIRDS)}

    def smoothed(self, values: np.ndarray) -> np.ndarray:
        """Return the running median over `NEIGHBOURS` discs of the surface."""
        return running_median(values, NEIGHBOURS // 2)

    def points(self, model: DiscModel, ground: Ground) -> np.ndarray:
        """Return the tops of the discs of the surface (n, 2), from left to right (m)."""
        x, z = ground.to_section(model.x[self.discs], model.z[self.discs])
        order = np.argsort(x, kind="stable")
        return np.column_stack([x, z + model.radius[self.discs]])[order]


def topmost(x: np.ndarray, z: np.ndarray, width: float) -> np.ndarray:
    """Return the numbers of the highest discs of all columns, from left to right.

    The last column is up to twice as wide: a narrower one at the right side may contain only discs far below the
    surface.

    Parameters
    ----------
    x, z (n,) : positions of the discs (m)
    width : width of a column (m)

    Returns
    -------
    Numbers (columns with discs,).
    """
    last = max(int(np.ptp(x) / width) - 1, 0)
    column = np.minimum(((x - x.min()) / width).astype(int), last)
    order = np.lexsort((z, column))
    return order[np.flatnonzero(np.append(np.diff(column[order]) > 0, True))]


def crack_opening(model: DiscModel, ground: Ground, surface: Surface) -> float:
    """Return the widest gap between the discs at the surface, measured as the width of the opening (m)."""
    x, z = ground.to_section(model.x, model.z)
    depth = np.interp(x, *surface.points(model, ground).T) - z
    near = np.flatnonzero(~model.fixed & (depth < 1.6 * ground.radius))
    begin, end = x[near] - model.radius[near], x[near] + model.radius[near]
    order = np.argsort(begin, kind="stable")
    covered = np.maximum.accumulate(end[order])
    return float(max(0.0, np.max(begin[order][1:] - covered[:-1], initial=0.0)))


def escaped(model: DiscModel) -> int:
    """Return the number of discs whose centres are outside the rigid lines."""
    free = ~model.fixed
    gone = np.zeros(len(model), bool)
    for px, pz, nx, nz, begin, end in model.lines:
        along = (model.z - pz) * nx - (model.x - px) * nz
        gone |= ((model.x - px) * nx + (model.z - pz) * nz < 0.0) & (along > begin) & (along < end)
    return int((gone & free).sum())
