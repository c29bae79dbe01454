"""Computes the collapse of columns of material points: dry sand, clay whose support is removed suddenly or slowly, and
vertical cuts.

A column stands on rough, firm ground and spreads to both sides; each half moves as a column behind a gate. Lengths are
in m, x = 0 is the left end of the grid, and the column stands in the middle.
"""

from dataclasses import dataclass

import numpy as np

from docs.verify.slides.case import Column
from docs.verify.slides.predict import STABLE_WEIGHT_RATIO
from fem.mpm import BackgroundGrid, MaterialPointEngine, MaterialPoints, PointSoil
from fem.mpm.slide import DECAY_RATES
from meshes.section.quantity import GRAVITY

FLOOR_ROWS = 3  # rows of nodes at rest
CELLS_IN_HEIGHT = 20  # in the height of a column, or in its width if that is less
SAND_STIFFNESS, CLAY_STIFFNESS = 200.0, 300.0  # Young's modulus over the weight on the floor, and over s_u
POISSON_OF_SAND, POISSON_OF_CLAY = 0.3, 0.45  # Poisson's ratio
GRAVITY_STEPS = 96  # of gravity in a slow loss of strength; with 24 of them inertia carries clay a sixth further
SETTLING_UNITS = 8.0  # sqrt(H/g) after these steps
SPREADING_UNITS = 12.0  # sqrt(H/g) in which a suddenly released column comes to rest


@dataclass(frozen=True)
class PointColumn:
    """Describes half of a column of ground.

    Attributes
    ----------
    half_width, height : size (m)
    cohesion, friction : strength (Pa, rad)
    cell : size of the cells (m)
    reach : length of the floor on either side (m)
    unit_weight : unit weight (N/m³)
    young : Young's modulus (Pa); None for one in proportion to weight and strength
    """

    half_width: float
    height: float
    cohesion: float
    friction: float
    cell: float
    reach: float
    unit_weight: float = 18e3
    young: float | None = None

    @property
    def unit(self) -> float:
        """Return the unit of time sqrt(H/g) (s)."""
        return float(np.sqrt(self.height / GRAVITY))

    def engine(self, decay: float) -> MaterialPointEngine:
        """Return the column under its weight before its collapse; ``decay`` (1/s) is the damping rate of unresolved
        velocities."""
        cell, firm = self.cell, FLOOR_ROWS * self.cell
        soil_places = lattice(2.0 * self.half_width, self.height, 0.5 * cell) - np.array([self.half_width, 0.0])
        below = lattice(2.0 * self.reach, firm, 0.5 * cell) - np.array([self.reach, firm])
        places = np.vstack([soil_places, below])
        stratum = np.where(np.arange(len(places)) < len(soil_places), 0, -1)
        stiffness = max(SAND_STIFFNESS * self.unit_weight * self.height, CLAY_STIFFNESS * self.cohesion)
        poisson = POISSON_OF_SAND if self.friction > 0.0 else POISSON_OF_CLAY
        strength = np.where(stratum == 0, self.cohesion, 1e15)
        angle = np.where(stratum == 0, self.friction, 0.0)
        soil = PointSoil(self.unit_weight / GRAVITY, self.young or stiffness, poisson, strength, angle)
        half = int(self.reach / cell) + 4
        bottom = (FLOOR_ROWS - 1) * cell + firm
        places = places + np.array([half * cell, bottom])
        points = MaterialPoints.of(places, np.full(len(places), 0.25 * cell**2), soil, stratum)
        points.stress[:, 1] = -self.unit_weight * np.where(stratum == 0, self.height + bottom - places[:, 1], 0.0)
        points.stress[:, 0] = points.stress[:, 1] * poisson / (1.0 - poisson)
        if self.friction == 0.0:  # the floor over which it will run, too: knot spans halfway in it
            points.set_strength(self.cohesion, 0.0, where=(stratum < 0) & (places[:, 1] > bottom - 0.5 * cell))
        grid = BackgroundGrid.empty(cell, 2 * half + 1, int(self.height / cell) + 2 * FLOOR_ROWS + 8, floor=FLOOR_ROWS)
        return MaterialPointEngine(points, grid, decay=decay)

    def let_go_slowly(self, weight_over_strength: float, steps: int = GRAVITY_STEPS) -> MaterialPointEngine:
        """Return the deposit of a column whose gravity grows in ``steps`` from γH/s_u = 3, at which it stands."""
        engine = self.engine(DECAY_RATES[0])
        shares = np.geomspace(min(1.0, STABLE_WEIGHT_RATIO / weight_over_strength), 1.0, steps)
        engine.points.stress[:] *= shares[0]
        for share in shares:
            engine.gravity = (0.0, -GRAVITY * share)
            engine.run(self.unit / np.sqrt(share))
        engine.run(SETTLING_UNITS * self.unit)
        return engine


def lattice(width: float, height: float, spacing: float) -> np.ndarray:
    """Return the positions (n, 2) of points in rows that begin at (0, 0)."""
    x, z = (np.arange(round(size / spacing)) * spacing + 0.5 * spacing for size in (width, height))
    return np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)


def front(engine: MaterialPointEngine, thickness: float | None = None) -> float:
    """Return the distance (m) from the middle to the end of the connected deposit. The deposit ends at the first column
    of cells that is thinner than ``thickness`` (m), by default a quarter of a point."""
    cell, heights = engine.grid.cell, _thickness(engine)
    empty = np.flatnonzero(heights < (0.125 * cell if thickness is None else thickness))
    return float(cell * (empty[0] if len(empty) else len(heights)))


def toe(engine: MaterialPointEngine, thickness: float) -> float:
    """Return the distance (m) from the middle to the last column of cells in which the deposit is at least as thick as
    ``thickness`` (m), with or without gaps before it."""
    return float(engine.grid.cell * (np.flatnonzero(_thickness(engine) >= thickness)[-1] + 1))


def _thickness(engine: MaterialPointEngine) -> np.ndarray:
    """Return the thickness (k,) of the deposit (m) in the columns of cells from the middle outwards, as the mean of
    both sides."""
    points, cell = engine.points, engine.grid.cell
    middle = (engine.grid.shape[0] // 2) * cell
    own_part = points.stratum == 0
    cells = (np.abs(points.x[own_part, 0] - middle) / cell).astype(int)
    return np.bincount(cells, weights=points.state[own_part, 0]) / (2.0 * cell)


def run_out_of_column(wanted: Column) -> float:
    """Return the run-out of a column over the width of sand or the height of clay.

    The connected deposit ends where it is thinner than half a row of discs, as that of discs does. ``wanted`` is the
    problem of the discs.
    """
    weight = wanted.density * GRAVITY
    clay = wanted.weight_over_strength > 0.0
    su = weight * wanted.height / wanted.weight_over_strength if clay else 0.0
    column = PointColumn(
        wanted.width, wanted.height, su, wanted.friction_angle, min(wanted.width, wanted.height) / CELLS_IN_HEIGHT,
        wanted.reach * wanted.width, weight, wanted.rigidity * su if clay else None,
    )  # fmt: skip
    if wanted.slowly:
        engine = column.let_go_slowly(wanted.weight_over_strength)
    else:
        engine = column.engine(DECAY_RATES[0])
        engine.run(SPREADING_UNITS * column.unit)
    return (front(engine, wanted.radius) - wanted.width) / (wanted.height if clay else wanted.width)
