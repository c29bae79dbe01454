"""Provides liquefied ground whose strength can be measured: a sheared box, an infinite slope, a slump; in SI units."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.kernels.liquefied_pairs import DENSITY as RHO0
from dem.kernels.liquefied_pairs import STIFFNESS, STRAIN, STRENGTH
from dem.liquefied_ground import SMALLEST_STRAIN, Onset, liquefy, set_share
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.springs import LayerSprings, Strength, soil_discs
from docs.verify.slides.tied_packing import TiedPacking, tied_packing

GRAVITY, DENSITY = 9.81, 1800.0
POROSITY = 0.28
BASE_ROWS = 3  # rows of fixed discs of a base, so that all the reach of pore water is filled
STEP = 0.6


def sand(stiffness: float, radius: float, name: str = "sand") -> LayerSprings:
    """Return springs of sand with phi of about 35 degrees."""
    return soil_discs(name, stiffness, Strength(0.36), DENSITY, DENSITY, radius, POROSITY)


def on_a_deep_base(packing: TiedPacking) -> tuple[np.ndarray, ...]:
    """Return x, z, radius and layer of a packing whose plates continue away from the free discs, each row shifted by a
    radius."""
    columns = [np.column_stack([packing.x, packing.z, packing.radius, packing.layer])]
    for row in range(1, BASE_ROWS):
        for plate, side in ((packing.above, 1.0), ((packing.layer < 0) & ~packing.above, -1.0)):
            x, z, radius = packing.x[plate], packing.z[plate], packing.radius[plate]
            away = side * row * 2.0 * radius * np.sqrt(0.75)
            columns.append(np.column_stack([x + radius * (row % 2), z + away, radius, np.full(len(x), -1.0)]))
    x, z, radius, layer = np.concatenate(columns).T
    return x, z, radius, layer.astype(np.int32)


def with_voids(model: DiscModel) -> np.ndarray:
    """Return the area of every disc with its voids (m2)."""
    return (1.0 + POROSITY) * np.pi * model.radius**2


@dataclass
class ShearedBox:
    """Holds a box of liquefied discs under 300 kPa between two rough plates, sheared at constant height."""

    model: DiscModel
    length: float
    height: float
    strength: float

    @classmethod
    def of(
        cls, seed: int, strength: float, *, columns: int = 24, rows: int = 10, radius: float = 0.5,
        pressure: float = 3.0e5, strain: float = SMALLEST_STRAIN,
    ) -> "ShearedBox":  # fmt: skip
        """Return the box at rest; strength in Pa."""
        packing = tied_packing(columns, rows, radius, porosity=POROSITY / (1.0 + POROSITY), seed=seed)
        layer = replace(sand(1.0e8, radius), faded=1.0)
        model = DiscModel.create(
            DiscGeometry(*on_a_deep_base(packing)),
            DiscMaterials([layer], law="soil", turns=False),
            DiscBoundary(period=(packing.length, 0.0)),
        )
        n = len(model)
        onset = Onset(~model.fixed, with_voids(model), np.full(n, pressure), np.full(n, strength), np.full(n, strain))
        liquefy(model, onset)
        set_share(model, np.ones(n))
        box = cls(model, packing.length, packing.height, strength)
        box.run(1.0, balance=5e-3)  # packed, and not yet at rest
        model.energy_sums[:] = 0.0
        model.energy_known, model.turnover = np.nan, 0.0
        return box

    def run(self, seconds: float, *, share: float = STEP, **settings: object) -> object:
        dt = share * largest_step(self.model).seconds
        return Engine(dt=dt, **{"balance": 1e-3} | settings).run(self.model, seconds)  # type: ignore[arg-type]

    def stress(self) -> tuple[float, float]:
        """Return shear stress and pressure on the two plates, mean of both (Pa)."""
        model = self.model
        fx, fz = model.liquefied_forces
        side = np.where(model.fixed, np.where(model.z > 0.5 * self.height, 1.0, -1.0), 0.0)
        return float(-np.sum(side * fx)) / (2.0 * self.length), float(np.sum(side * fz)) / (2.0 * self.length)

    def shear(
        self, strain: float, rate: float, window: float = 0.01, looks: int = 10, **settings: object
    ) -> np.ndarray:
        """Return the mean shear stress over the required strength, and the pressure (Pa), in windows of strain (n,
        2)."""
        model = self.model
        across = np.clip(model.z / self.height, 0.0, 1.0)
        model.set_velocity(model.vx + rate * self.height * across, model.vz)
        results = []
        for _ in range(round(strain / window)):
            seen = []
            for _ in range(looks):
                self.run(window / rate / looks, **settings)
                seen.append(self.stress())
            results.append(np.mean(seen, axis=0))
        return np.array(results) / [self.strength, 1.0]


class LayeredSlope:
    """Holds an infinite slope of 4 degrees with periodic sides: 14 m of sand on 6 m of liquefied sand."""

    ANGLE, LENGTH, LOW, HIGH = np.radians(4.0), 40, 6, 20

    def __init__(self, seed: int, ratio: float, radius: float = 0.5) -> None:
        """Bring the slope to rest; ratio: residual strength over the normal stress on the slope at the onset."""
        packing = tied_packing(self.LENGTH, self.HIGH, radius, porosity=0.23, seed=seed).without_upper_plate()
        x, z, r, layer = on_a_deep_base(packing)
        layer = np.where((layer >= 0) & (z > self.LOW), 1, layer)
        layers = [sand(1.41e8, radius, "loose"), sand(1.41e8, radius)]
        self.model = model = DiscModel.create(
            DiscGeometry(x, z, r, layer),
            DiscMaterials(layers, law="soil", turns=False),
            DiscBoundary(period=(packing.length, 0.0)),
            gravity=(0.0, -GRAVITY),
        )
        self.on(6.0, energies=False)
        for tilt in np.linspace(0.0, self.ANGLE, 6)[1:]:
            model.gravity = tilted_gravity(tilt, GRAVITY)
            self.on(1.0, energies=False)
        self.on(2.0, energies=False)
        n, overburden, wet = len(model), effective_overburden(model), model.layer == 0
        liquefy(model, Onset(wet, with_voids(model), overburden, ratio * overburden, np.full(n, SMALLEST_STRAIN)))
        for share in np.arange(1, 21) / 20:
            model.set_springs([replace(layers[0], faded=float(share)), layers[1]])
            set_share(model, np.where(wet, share, 0.0))
            self.on(0.25)
        self.on(5.0)

    def on(self, seconds: float, **settings: object) -> None:
        Engine(dt=STEP * largest_step(self.model).seconds, **settings).run(self.model, seconds)  # type: ignore[arg-type]

    def speed(self) -> float:
        """Return the speed of the upper sand along the slope (m/s)."""
        return float(self.model.vx[self.model.layer == 1].mean())

    def apply_kh(self, kh: float, seconds: float) -> tuple[float, np.ndarray]:
        """Return the slide of the sand under a Kh that is applied and removed within a millisecond (m), and the speeds
        every half second."""
        model, sand_on_top = self.model, self.model.layer == 1
        before, begin = model.x.copy(), model.time
        full = Acceleration.seismic(kh, tilt=self.ANGLE, g=GRAVITY)
        times = begin + np.array([0.0, 1e-3, seconds, seconds + 1e-3])
        on = np.array([0.0, 1.0, 1.0, 0.0])
        model.acceleration = Acceleration(times, full.x[0] * on, full.z[0] * on)
        speeds = []
        while model.time < begin + seconds + 1.0 or abs(self.speed()) > 2e-3:
            self.on(0.5)
            speeds.append(self.speed())
        return float((model.x - before)[sand_on_top].mean()), np.array(speeds)


class Slump:
    """Holds a column of soil of one shear strength, 30 m high and 120 m wide, on a rough base that extends to both
    sides.

    The column rests at eight times its strength, which is then reduced suddenly. Pore water a hundred times as stiff as
    the stress at half height keeps its volume, with one density for the whole column.
    """

    HEIGHT, HALF, REACH, FIRM, STIFF = 30.0, 60.0, 3.0, 8.0, 100.0

    def __init__(self, seed: int, weight_over_strength: float, radius: float = 0.75) -> None:
        columns, rows = round(self.HALF / radius), round(self.HEIGHT / (2.0 * radius))
        packing = tied_packing(columns, rows, radius, porosity=0.21, seed=seed)
        inside = packing.layer >= 0
        along = np.arange(-self.HALF - self.REACH * self.HEIGHT, self.HALF + self.REACH * self.HEIGHT, 2.0 * radius)
        deep = [
            (along + radius * (row % 2), np.full(len(along), -radius * (0.9 + 1.74 * row))) for row in range(BASE_ROWS)
        ]
        x = np.concatenate([packing.x[inside] - self.HALF, *(row[0] for row in deep)])
        z = np.concatenate([packing.z[inside], *(row[1] for row in deep)])
        r = np.concatenate([packing.radius[inside], np.full(BASE_ROWS * len(along), radius)])
        self.free = np.arange(len(x)) < inside.sum()
        self.model = model = DiscModel.create(
            DiscGeometry(x, z, r, np.where(self.free, 0, -1)),
            DiscMaterials([replace(sand(1e8, radius), faded=1.0)], law="soil", turns=False),
            gravity=(0.0, -GRAVITY),
        )
        self.area = np.pi * r**2 * 2.0 * self.HALF * self.HEIGHT / np.sum(np.pi * r[self.free] ** 2)
        model.mass[:] = DENSITY * self.area
        self.strength = DENSITY * GRAVITY * self.HEIGHT / weight_over_strength
        half_way = np.full(len(x), 0.5 * DENSITY * GRAVITY * self.HEIGHT)
        firm = np.full(len(x), self.FIRM * self.strength)
        liquefy(model, Onset(self.free, self.area, half_way, firm, np.full(len(x), 0.02)))
        set_share(model, np.ones(len(x)))
        middle = self.free & (np.abs(x) < self.HALF - 5.0) & (z > 5.0) & (z < self.HEIGHT - 5.0)
        model.liquefied[self.free, RHO0] = np.median(model.liquefied[middle, RHO0])
        model.liquefied[self.free, STIFFNESS] = self.STIFF * half_way[self.free]
        for _ in range(10):
            self.on(0.3, balance=1e-2)  # packed, and not yet at rest
            model.set_velocity(0.5 * model.vx, 0.5 * model.vz)
        model.energy_sums[:] = 0.0
        model.energy_known, model.turnover = np.nan, 0.0

    def on(self, seconds: float, balance: float = 1e-3) -> None:
        Engine(dt=0.8 * largest_step(self.model).seconds, balance=balance).run(self.model, seconds)

    def let_go(self) -> tuple[float, float]:
        """Return the run-out of 98 % of the mass over the height after the slump has come to rest, and the share of
        loose mass."""
        model, free = self.model, self.free
        model.liquefied[free, STRENGTH], model.liquefied[free, STRAIN] = self.strength, SMALLEST_STRAIN
        model.strength_factor[free] = 1.0
        for _ in range(10):
            self.on(np.sqrt(self.HEIGHT / GRAVITY))
        away = np.abs(model.x[free])
        order = np.argsort(away)
        share = np.cumsum(self.area[free][order]) / self.area[free].sum()
        places = cKDTree(np.column_stack([model.x[free], model.z[free]]))
        near = places.sparse_distance_matrix(places, 2.4 * float(model.radius.mean()))
        joined = np.bincount(connected_components(near, directed=False)[1]).max()
        out = (away[order][np.searchsorted(share, 0.98)] - self.HALF) / self.HEIGHT
        return float(out), float(1.0 - joined / free.sum())
