"""Provides problems of the material point method with known answers: an infinite slope, and a collapsing column."""

from dataclasses import dataclass

import numpy as np

from docs.verify.slides.point_columns import FLOOR_ROWS, PointColumn, front, lattice
from fem.mpm import (
    BackgroundGrid,
    MaterialPointEngine,
    MaterialPoints,
    PointSlide,
    PointSlider,
    PointSoil,
    SlideProgramme,
    ground_of,
)
from fem.mpm.slide import DECAY_RATES
from fem.mpm.weak_edges import edge_strength
from fem.settings import Sides
from meshes.section.liquefies import RemainingStrength
from meshes.section.polyline import downhill
from meshes.section.quantity import GRAVITY
from tests.support import SECTIONS
from tests.support.sections import layer
from workflow.config import Config

UNIT_WEIGHT = 18e3  # N/m³


@dataclass(frozen=True)
class EndlessSlope:
    """Describes 14 m of crust on a liquefied layer of 6 m on firm ground, in axes along a slope of 4° with periodic
    sides."""

    strength: float  # of the layer: over the vertical stress, or in Pa
    as_ratio: bool = True
    angle: float = np.radians(4.0)
    crust: float = 14.0
    layer: float = 6.0
    rise: float = 1.0
    hold: float = 10.0

    @property
    def yield_coefficient(self) -> float:
        """Return k_y of the rigid block on the bottom of the layer, where demand over strength is largest."""
        depth = self.crust + self.layer
        share = self.strength if self.as_ratio else self.strength / (UNIT_WEIGHT * depth)
        return float((share - np.sin(self.angle)) / np.cos(self.angle))

    def newmark(self, kh: float, end: float, step: float = 2e-4) -> float:
        """Return the displacement (m) of this block under a Kh that increases, is constant and decreases (Newmark
        1965)."""
        speed = moved = 0.0
        share = self.strength if self.as_ratio else self.strength / (UNIT_WEIGHT * (self.crust + self.layer))
        for time in np.arange(0.5 * step, end, step):
            now = kh * min(1.0, time / self.rise) * (time < self.hold)
            pull = GRAVITY * (np.sin(self.angle) + now * np.cos(self.angle) - share)
            speed = max(0.0, speed + pull * step)
            moved += speed * step
        return float(moved)

    def engine(
        self, cell: float, columns: int = 6, threads: int = 1, decay: float = 1.0, above_node: float = 0.0
    ) -> MaterialPointEngine:
        """Return the slope in equilibrium; the layer begins at this share of a cell above a node."""
        deeper = int(above_node > 0.0)  # or the firm ground hardly reaches the nodes at rest
        firm, deep = (3.0 + deeper) * cell, self.crust + self.layer
        places = lattice(columns * cell, deep + firm, 0.5 * cell)
        height = places[:, 1] - firm
        depth = deep - height
        stratum = np.where(height < 0.0, -1, np.where(height < self.layer, 0, 1))
        density = UNIT_WEIGHT / GRAVITY
        shear = density * np.where(stratum == 0, 100.0, 200.0) ** 2
        poisson = np.where(stratum == 0, 0.45, 0.3)
        at_rest_strength = self.strength * UNIT_WEIGHT * depth if self.as_ratio else np.full(len(depth), self.strength)
        cohesion = np.where(stratum == 0, at_rest_strength, np.where(stratum < 0, 1e15, 5e3))
        friction = np.where(stratum == 1, np.radians(33.0), 0.0)
        places = places + np.array([0.0, (FLOOR_ROWS - 1 - deeper + above_node) * cell])
        if not self.as_ratio:  # whose shear band is at the edge
            mass = np.full(len(places), density * 0.25 * cell**2)
            weak = np.where(stratum == 0, 0, -1)
            edge = edge_strength(places, np.full(len(places), 0.5 * cell), mass, weak, at_rest_strength, cell)
            cohesion[edge.points], friction[edge.points] = edge.strength, 0.0
        soil = PointSoil(density, 2.0 * shear * (1.0 + poisson), poisson, cohesion, friction)
        points = MaterialPoints.of(places, np.full(len(places), 0.25 * cell**2), soil, stratum)
        points.stress[:, 1] = -UNIT_WEIGHT * np.cos(self.angle) * depth
        points.stress[:, 0] = np.where(stratum == 0, 1.0, 0.6) * points.stress[:, 1]
        points.stress[:, 2] = UNIT_WEIGHT * np.sin(self.angle) * depth
        grid = BackgroundGrid.empty(
            cell, columns, int((deep + firm) / cell) + FLOOR_ROWS + 6, periodic=True, floor=FLOOR_ROWS
        )
        gravity = GRAVITY * np.sin(self.angle), -GRAVITY * np.cos(self.angle)
        return MaterialPointEngine(points, grid, gravity, threads, decay)

    def moved(self, engine: MaterialPointEngine, kh: float, end: float) -> float:
        """Return the displacement (m) of the crust under Kh as in `newmark`."""

        def acceleration(time: np.ndarray) -> np.ndarray:
            return kh * GRAVITY * np.cos(self.angle) * np.minimum(1.0, time / self.rise) * (time < self.hold)

        engine.run(end, acceleration)
        points = engine.points
        return float(points.displacement[points.stratum == 1, 0].mean())

    def slid(self, kh: float, end: float, cells: int = 16) -> float:
        """Return the displacement (m) along the same slope as a dipping section.

        A row of such sections is the slope. Kh, weak layer and duration are those of `moved`; there are ``cells`` cells
        of 1 m along the section.
        """
        upright, firm = 1.0 / np.cos(self.angle), 3.0
        deep = (self.crust + self.layer) * upright
        density = UNIT_WEIGHT / GRAVITY
        soil = {
            "density_ordinary": density,
            "density_seismic": density,
            "friction_angle": "0 deg",
            "poissons_ratio": 0.3,
        }
        stiff = 2.6 * density * 200.0**2
        crust = layer("crust", **soil | {"cohesion": 5e3, "friction_angle": "33 deg", "youngs_modulus": stiff})
        weak = {"cohesion": 2e5, "poissons_ratio": 0.45, "youngs_modulus": 2.9 * density * 100.0**2}
        top = firm + deep
        data = {
            "name": "endless",
            "surface": [[0.0, top], [float(cells), top - cells * float(np.tan(self.angle))]],
            "base": {"depth": deep + firm},
            "strata": [
                crust | {"bottom": {"depth": self.crust * upright}},
                layer("weak", **soil | weak, bottom={"depth": deep}, liquefies_in=[1]),
                layer("firm", **soil | {"cohesion": 2e6, "youngs_modulus": stiff}),
            ],
        }
        slider = PointSlider(ground_of(Config.parse(data).section, round(cells * (deep + firm)), "periodic"), 1)
        slider.settle()

        def acceleration(time: np.ndarray) -> np.ndarray:
            return kh * GRAVITY * np.minimum(1.0, time / self.rise) * (time < self.hold)

        remains = RemainingStrength(0.0, 0.0, *((self.strength, 0.0) if self.as_ratio else (0.0, self.strength)))
        slide = slider.run(
            SlideProgramme(acceleration, {1: 0.0}, {1: remains}, 0.05, end, end, rest_displacement=1e-9),
            decay=DECAY_RATES[1],
        )
        return float(np.mean(slide.slide[-1])) * upright


@dataclass(frozen=True)
class RunOut:
    """Holds the run-out of clay over its height: its front, and the distance that contains 99 % of it."""

    front: float
    within: float


def slump(weight_over_strength: float, cells: int, steps: int) -> RunOut:
    """Return the run-out of a block of clay 30 m high and twice as wide to either side, ``cells`` cells high, whose
    weight grows in ``steps``."""
    height = 30.0
    strength = UNIT_WEIGHT * height / weight_over_strength
    column = PointColumn(
        2.0 * height, height, strength, 0.0, height / cells, 5.0 * height, UNIT_WEIGHT, 300.0 * strength
    )
    if steps > 1:
        engine = column.let_go_slowly(weight_over_strength, steps)
    else:
        engine = column.engine(DECAY_RATES[1])
        engine.run(25.0 * column.unit)
    away = np.abs(engine.points.x[engine.points.stratum == 0, 0] - (engine.grid.shape[0] // 2) * engine.grid.cell)
    return RunOut(front(engine) / height - 2.0, float(np.quantile(away, 0.99)) / height - 2.0)


def displaced(name: str, cells: int, sides: Sides, kh: float, rise: float, end: float) -> PointSlide:
    """Return the slide of a shipped section without liquefaction under a Kh that increases within ``rise`` (s) and is
    then constant."""
    section = Config.load(SECTIONS / f"{name}.toml").section
    slider = PointSlider(ground_of(section, cells, sides), downhill(section.ground))
    slider.settle()

    def acceleration(time: np.ndarray) -> np.ndarray:
        return kh * GRAVITY * (0.5 - 0.5 * np.cos(np.pi * np.clip(time / rise, 0.0, 1.0)))

    return slider.run(SlideProgramme(acceleration, {}, {}, 1.0, rise, end))
