"""Columns of material points that are let go: dry sand, clay at once or slowly, vertical cuts.

A column stands on rough firm ground and is free at both sides, of which each runs as a column behind a gate does.
Lengths are in m, x is 0 at the left end of the grid, the column is in the middle.
"""

from dataclasses import dataclass

import numpy as np

from docs.verify.slides.case import Column
from docs.verify.slides.predict import STANDS
from fem.mpm import BackgroundGrid, MaterialPointEngine, MaterialPoints, PointSoil
from fem.mpm.slide import DECAY_RATES
from meshes.section.quantity import GRAVITY

FLOOR = 3  # rows of nodes at rest
CELLS = 20  # in the height of a column, or in its width if that is less
STIFF_SAND, STIFF_CLAY = 200.0, 300.0  # Young's modulus over the weight on the floor, and over s_u
SAND, CLAY = 0.3, 0.45  # Poisson's ratio
STEPS = 96  # of gravity in a slow loss of strength; with 24 of them inertia carries clay a sixth further
SETTLES = 8.0  # sqrt(H/g) after these steps
RUNS = 12.0  # sqrt(H/g) in which a column that is let go at once comes to rest


@dataclass(frozen=True)
class PointColumn:
    """Half of a column of ground: its size (m), strength (Pa, rad) and unit weight (N/m³).

    ``cell`` is the size of cells and ``reach`` the length of the floor on either side, both in m; ``young`` is Young's
    modulus (Pa), in proportion to weight and strength if None.
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
        """sqrt(H/g) (s)."""
        return float(np.sqrt(self.height / GRAVITY))

    def engine(self, decay: float) -> MaterialPointEngine:
        """The column under its weight, about to be let go; ``decay`` (1/s) is that of the transfer."""
        cell, firm = self.cell, FLOOR * self.cell
        soil_places = lattice(2.0 * self.half_width, self.height, 0.5 * cell) - np.array([self.half_width, 0.0])
        below = lattice(2.0 * self.reach, firm, 0.5 * cell) - np.array([self.reach, firm])
        places = np.vstack([soil_places, below])
        stratum = np.where(np.arange(len(places)) < len(soil_places), 0, -1)
        stiffness = max(STIFF_SAND * self.unit_weight * self.height, STIFF_CLAY * self.cohesion)
        poisson = SAND if self.friction > 0.0 else CLAY
        strength = np.where(stratum == 0, self.cohesion, 1e15)
        angle = np.where(stratum == 0, self.friction, 0.0)
        soil = PointSoil(self.unit_weight / GRAVITY, self.young or stiffness, poisson, strength, angle)
        half = int(self.reach / cell) + 4
        bottom = (FLOOR - 1) * cell + firm
        places = places + np.array([half * cell, bottom])
        points = MaterialPoints.of(places, np.full(len(places), 0.25 * cell**2), soil, stratum)
        points.stress[:, 1] = -self.unit_weight * np.where(stratum == 0, self.height + bottom - places[:, 1], 0.0)
        points.stress[:, 0] = points.stress[:, 1] * poisson / (1.0 - poisson)
        if self.friction == 0.0:  # the floor over which it will run, too: knot spans halfway in it
            points.set_strength(self.cohesion, 0.0, where=(stratum < 0) & (places[:, 1] > bottom - 0.5 * cell))
        grid = BackgroundGrid.empty(cell, 2 * half + 1, int(self.height / cell) + 2 * FLOOR + 8, floor=FLOOR)
        return MaterialPointEngine(points, grid, decay=decay)

    def let_go_slowly(self, weight_over_strength: float, steps: int = STEPS) -> MaterialPointEngine:
        """The deposit of a column whose gravity grows in ``steps`` from where it stands (γH/s_u of 3)."""
        engine = self.engine(DECAY_RATES[0])
        shares = np.geomspace(min(1.0, STANDS / weight_over_strength), 1.0, steps)
        engine.points.stress[:] *= shares[0]
        for share in shares:
            engine.gravity = (0.0, -GRAVITY * share)
            engine.run(self.unit / np.sqrt(share))
        engine.run(SETTLES * self.unit)
        return engine


def lattice(width: float, height: float, spacing: float) -> np.ndarray:
    """Places (n, 2) of points in rows, from (0, 0) on."""
    x, z = (np.arange(round(size / spacing)) * spacing + 0.5 * spacing for size in (width, height))
    return np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)


def front(engine: MaterialPointEngine, thickness: float | None = None) -> float:
    """How far from the middle (m) the deposit reaches without a gap: columns of cells that are as thick (m) as this, or
    a quarter of a point."""
    cell, heights = engine.grid.cell, _thickness(engine)
    empty = np.flatnonzero(heights < (0.125 * cell if thickness is None else thickness))
    return float(cell * (empty[0] if len(empty) else len(heights)))


def toe(engine: MaterialPointEngine, thickness: float) -> float:
    """How far from the middle (m) the deposit is as thick (m) as this in some column of cells, gaps or not."""
    return float(engine.grid.cell * (np.flatnonzero(_thickness(engine) >= thickness)[-1] + 1))


def _thickness(engine: MaterialPointEngine) -> np.ndarray:
    """Thickness (k,) of the deposit (m) in the columns of cells from the middle on, the mean of both sides."""
    points, cell = engine.points, engine.grid.cell
    middle = (engine.grid.shape[0] // 2) * cell
    own_part = points.stratum == 0
    cells = (np.abs(points.x[own_part, 0] - middle) / cell).astype(int)
    return np.bincount(cells, weights=points.state[own_part, 0]) / (2.0 * cell)


def run_out_of_column(wanted: Column) -> float:
    """Run-out over the width of sand, over the height of clay.

    The connected deposit ends where it is thinner than half a row of discs, as that of discs does.

    Parameters
    ----------
    wanted : Column
        The problem, as it is given to discs.
    """
    weight = wanted.density * GRAVITY
    clay = wanted.weight_over_strength > 0.0
    su = weight * wanted.height / wanted.weight_over_strength if clay else 0.0
    column = PointColumn(
        wanted.width, wanted.height, su, wanted.friction_angle, min(wanted.width, wanted.height) / CELLS,
        wanted.reach * wanted.width, weight, wanted.rigidity * su if clay else None,
    )  # fmt: skip
    if wanted.slowly:
        engine = column.let_go_slowly(wanted.weight_over_strength)
    else:
        engine = column.engine(DECAY_RATES[0])
        engine.run(RUNS * column.unit)
    return (front(engine, wanted.radius) - wanted.width) / (wanted.height if clay else wanted.width)
