"""Finds the place where the pore pressure in the ground exceeds the weight of everything above, so that the ground is
lifted.

The total vertical stress σv at a depth, of soil, water on the ground and loads, has to balance the pore pressure u. If
u > σv the effective stress would be tension, and the ground above is lifted (a blow-out, or hydraulic heave, of an
excavation above an aquifer), unless its strength holds it down. The factor against uplift is σv / u: EN 1997-1, 10.2,
compares the weight, and the resistance beside it, with the pressure below.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from meshes.section.layering import Layering
from meshes.section.sentences import coordinate
from meshes.section.stratum import Stratum
from meshes.section.surcharge import SurfaceLoads

# Excess of the pore pressure over the weight (Pa) up to which there is no uplift: 1 cm of water, the tolerance of
# points.
SMALLEST_UPLIFT = 100.0
# The same where water flows, as the head of this share of the step of its grid: where a shore lies between two of its
# points, the pressure at the ground beside it is off by so much.
LEAST_OF_STEP = 0.1
# Where water flows, also vertically through a stratum, the pore pressure bends within a stratum: depths in it, as
# shares of its thickness.
WITHIN_FLOW = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0)
UPWARDS = np.array([[0.0, 1.0]])


@dataclass(frozen=True)
class Uplift:
    """Describes the place where a pore pressure exceeds the total vertical stress by most.

    Attributes
    ----------
    stratum : name of the stratum whose pore pressure is too large
    x, elevation : position of the place (m)
    pressure, weight : pore pressure and total vertical stress there (Pa)
    start, end : range of x in which some pore pressure of the section exceeds the total vertical stress (m)
    bare : whether pore pressure at the surface of cohesionless ground exceeds the load on it; such ground cannot be in
        equilibrium
    """

    stratum: str
    x: float
    elevation: float
    pressure: float
    weight: float
    start: float
    end: float
    bare: bool

    @property
    def factor(self) -> float:
        """Return the total vertical stress over the pore pressure (-), below 1."""
        return self.weight / self.pressure

    @property
    def description(self) -> str:
        """Describe in words the place of uplift and the excess of pressure."""
        return (
            f'the pore pressure in "{self.stratum}" exceeds the weight above it, most at x = {coordinate(self.x)} m, '
            f"elevation {coordinate(self.elevation)} m, where it is {self.pressure / 1e3:.1f} kPa under a total "
            f"vertical stress of {self.weight / 1e3:.1f} kPa (factor against uplift {self.factor:.2f}); the ground "
            f"blows out between x = {coordinate(self.start)} and {coordinate(self.end)} m unless its strength holds it "
            "down"
        )


def uplift(layers: Layering, strata: tuple[Stratum, ...], loads: SurfaceLoads) -> Uplift | None:
    """Find the place where a static pore pressure exceeds the total vertical stress by most; return None if there is
    none.

    Both stresses are linear within a stratum between breakpoints and the kinks of the water, so that the ends of these
    stretches are checked; where water flows, or flows through a stratum, also depths within the stratum. A surcharge
    counts with its weight on the ground above.
    """
    water = loads.water
    if not water.still:
        return None
    x, least, shares = np.union1d(layers.x, water.kinks), SMALLEST_UPLIFT, WITHIN_FLOW[:: len(WITHIN_FLOW) - 1]
    if any(water.heads):
        shares = WITHIN_FLOW
    if water.flow is not None:
        grid = water.flow.grid.x
        x, shares = np.union1d(layers.x, grid), WITHIN_FLOW
        least = max(SMALLEST_UPLIFT, LEAST_OF_STEP * water.unit_weight * float(np.diff(grid).max()))
    worst: Uplift | None = None
    spans, bare = [], False
    for k, share in product(range(len(strata)), shares):
        points, pressure, weight = _along(layers, loads, x, k, share)
        excess = np.where(pressure - weight > least, pressure - weight, 0.0)
        spans += [_positive(x[i : i + 2], (pressure - weight)[i]) for i in np.flatnonzero(excess.any(axis=1))]
        i, end = np.unravel_index(int(np.argmax(excess)), excess.shape)
        if excess[i, end] > (0.0 if worst is None else worst.pressure - worst.weight):
            at, elevation = points[i, end].tolist()
            u, total = float(pressure[i, end]), float(weight[i, end])
            worst = Uplift(strata[k].name, at, elevation, u, total, at, at, bare=False)
        on_ground = points[..., 1] >= _along(layers, loads, x, 0, 0.0)[0][..., 1]
        bare = bare or bool(not strata[k].has_cohesion and (excess[on_ground] > 0.0).any())
    if worst is None:
        return None
    return replace(worst, start=min(start for start, _ in spans), end=max(end for _, end in spans), bare=bare)


def _along(
    layers: Layering, loads: SurfaceLoads, x: np.ndarray, k: int, share: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points (n, 2 ends, 2) at a share of the thickness of stratum k, at both ends of the stretches between x (n
    + 1,), and pore pressure and total vertical stress (n, 2) at these points; no points where the stratum has no
    thickness.
    """
    middle = np.repeat(0.5 * (x[1:] + x[:-1]), 2)
    ends = np.column_stack([x[:-1], x[1:]]).ravel()
    elevations = layers.interfaces(ends, near=middle)
    points = np.column_stack([ends, (1.0 - share) * elevations[:, k] + share * elevations[:, k + 1]])
    near = np.column_stack([middle, points[:, 1]])
    water = loads.water
    pressure = water.at_rest(points, near, np.full(len(ends), k))
    weight = water.overburden(points, near) + water.ponded(water.table_after, points, near)
    weight = weight - loads.dead(points, near, np.repeat(UPWARDS, len(points), axis=0))[:, 1]
    present = (elevations[:, k] > elevations[:, k + 1]).reshape(-1, 2).any(axis=1, keepdims=True)
    pressure, weight = (np.where(present, stress.reshape(-1, 2), 0.0) for stress in (pressure, weight))
    return points.reshape(-1, 2, 2), pressure, weight


def _positive(x: np.ndarray, excess: np.ndarray) -> tuple[float, float]:
    """Return the two x between which a function is positive that is linear between two given x, and positive at one of
    them."""
    zero = float(x[0] + (x[1] - x[0]) * excess[0] / (excess[0] - excess[1])) if excess.min() < 0.0 else 0.0
    return float(x[0]) if excess[0] >= 0.0 else zero, float(x[1]) if excess[1] >= 0.0 else zero
