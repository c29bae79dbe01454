"""Computes the lateral spread of ground behind a bank, integrated over its depth, to compare discs and material points
with.

Columns of crust rest on columns of a liquefied layer on a level base. The shear strain of the layer is uniform over its
thickness h_l, by the law of its strain potential up to its residual strength (`meshes.section.strain_potential`). It
keeps its volume:

    h_l = H_l / (1 + u'/2),  h_c = H_c / (1 + u'),  u the displacement of the crust,
    (m_c + m_l/2) ü = -N' - τ(u / H_l) + (m_c + m_l) a,  N = w_c h_c h_l + w_l h_l²/2 + K(u') w_c h_c²/2.

This is a heavy liquid below a crust, whose earth pressure changes from K0 to the active one under an extension of 0.5
%, and to the passive one under a shortening of 4 % (Rankine, with its friction angle). Where it slips, the layer also
has a lateral stress of its own, π s/2 less than the overburden in extension and π s/2 more in shortening: the mean of 2
√(s² - τ²), with τ from 0 at its top to its strength s at its base (Nye 1951, Proc. R. Soc. A 207, 554). The ends are
fixed. Quays, and the ground within a thickness of the layer from the face, are not modelled.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from docs.verify.slides.case import Ground, SlideCase
from meshes.section.quantity import GRAVITY
from meshes.section.strain_potential import REGAINING_STRAIN, SoftRange, soft_range
from workflow.stages.shaking import shaking_of

ACTIVE_STRAIN, PASSIVE_STRAIN = 0.005, 0.04  # strains of the crust at its active and passive earth pressure
SLIP_STRAIN = 0.01  # strain of a layer that slips, at its least and its greatest lateral stress
THINNEST_COLUMN = 0.02  # m: of a column that takes part
CREEP_TIME = 5.0  # s: dashpot over stiffness of ground short of its potential, as in discs and points
LEAST_LENGTH_SHARE = 0.2  # of its length that a column keeps
TIME_BEFORE_SHAKING = 5.0  # s before the shaking of a case, in which its ground liquefies
FOLLOWED_TIME = 45.0  # s for which the spread is followed


@dataclass(frozen=True)
class ThinGround:
    """Holds columns from left to right, the face falling to the right; arrays (n,).

    Attributes
    ----------
    step : width of a column (m)
    crust, layer (n,) : thickness of the crust and of the layer that liquefies (m)
    crust_weight, layer_weight (n,) : unit weights (N/m³)
    effective (n,) : vertical effective stress in the middle of the layer (Pa)
    strength, potential : residual strength (Pa) and strain potential; 0 for a layer that has its strength from the
        start
    friction_angle : friction angle of the crust (rad)
    """

    step: float
    crust: np.ndarray
    layer: np.ndarray
    crust_weight: np.ndarray
    layer_weight: np.ndarray
    effective: np.ndarray
    strength: float
    potential: float
    friction_angle: float = field(default=np.radians(33.0))

    @cached_property
    def soft(self) -> SoftRange:
        """Return the strain and the stress (Pa) at which the ground of each column begins to regain its strength."""
        if not self.potential:
            return SoftRange(np.zeros(len(self.layer)), np.zeros(len(self.layer)))
        return soft_range(self.potential, self.effective, np.full(len(self.layer), self.strength))

    def stress_of(self, way: np.ndarray, plastic: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return shear stress (Pa), its initial stiffness (Pa) and plastic strain for displacements of the crust
        (m)."""
        if self.potential:
            first, knee = self.soft
            last = first + REGAINING_STRAIN
        else:
            first, last = (np.full(len(way), share * REGAINING_STRAIN) for share in (0.5, 1.0))
            knee = np.full(len(way), 0.5 * self.strength)
        strain = way / self.layer - plastic
        elastic = np.clip(strain, -last, last)
        size = np.abs(elastic)
        rise = (self.strength - knee) / (last - first)
        stress = np.where(size < first, knee / first * size, knee + rise * (size - first))
        return np.sign(elastic) * stress, knee / first, plastic + strain - elastic

    def pressure(self, stretch: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Return the horizontal force N (N/m) in columns with this extension (n,) and displacement (m) of the crust."""
        sine = np.sin(self.friction_angle)
        active, rest, passive = (1.0 - sine) / (1.0 + sine), 1.0 - sine, (1.0 + sine) / (1.0 - sine)
        rising = np.where(stretch > 0.0, (rest - active) / ACTIVE_STRAIN, (passive - rest) / PASSIVE_STRAIN)
        earth = np.clip(rest - rising * stretch, active, passive)
        layer = self.layer / np.maximum(1.0 + 0.5 * stretch, LEAST_LENGTH_SHARE)
        crust = self.crust / np.maximum(1.0 + stretch, LEAST_LENGTH_SHARE)
        liquid = self.crust_weight * crust * layer + 0.5 * self.layer_weight * layer**2
        slips = np.clip((np.hypot(way / self.layer, stretch) - self.soft.strain) / REGAINING_STRAIN, 0.0, 1.0)
        lateral = 0.5 * np.pi * self.strength * layer * slips * np.clip(stretch / SLIP_STRAIN, -1.0, 1.0)
        return np.asarray(liquid - lateral + 0.5 * earth * self.crust_weight * crust**2)

    def spread(self, time: np.ndarray, loading: np.ndarray, seconds: float, dt: float = 0.005) -> np.ndarray:
        """Return the displacement (m) of the crust (n,) some seconds after the layer has liquefied; time (s),
        acceleration (m/s²)."""
        way, speed, plastic = (np.zeros(len(self.layer)) for _ in range(3))
        crust, layer = self.crust_weight * self.crust / GRAVITY, self.layer_weight * self.layer / GRAVITY
        moving = self.crust + self.layer > 2.0 * THINNEST_COLUMN
        for a in np.interp(np.arange(0.0, seconds, dt), time, loading, right=0.0):
            ends = np.concatenate([[0.0], 0.5 * (way[1:] + way[:-1]), [0.0]])
            force = self.pressure(np.diff(ends) / self.step, way)
            between = np.concatenate([force[:1], 0.5 * (force[1:] + force[:-1]), force[-1:]])
            stress, stiffness, plastic = self.stress_of(way, plastic)
            stress = np.clip(stress + CREEP_TIME * stiffness * speed / self.layer, -self.strength, self.strength)
            net = -np.diff(between) / self.step - stress + (crust + layer) * a
            speed = np.where(moving, speed + dt * net / (crust + 0.5 * layer), 0.0)
            way = way + dt * speed
        return way


def spread_of(case: SlideCase, step: float = 1.0) -> float:
    """Return the displacement of the crust (m) at the place of a known slide behind a face, for columns of a width (m).
    Only one stratum may liquefy. The section ends at rigid sides, as for the discs."""
    config, problem = case.config, case.known.problem
    assert config is not None
    assert isinstance(problem, Ground)
    assert isinstance(problem.at, float)
    section = config.section
    [number] = [n for n, each in enumerate(config.cases, start=1) if each.name == problem.case]
    [k] = [k for k, stratum in enumerate(section.strata) if number in stratum.liquefies_in]
    left, right = section.extent
    x = np.arange(left + 0.5 * step, right, step)
    heights = section.layering.interfaces(x)
    top, bottom = heights[:, k], heights[:, k + 1]
    water, there = section.water_pressure, np.full(len(x), k)
    above, below, middle = (np.column_stack([x, z]) for z in (top, bottom, 0.5 * (top + bottom)))
    crust, layer = heights[:, 0] - top, np.maximum(top - bottom, 0.5 * THINNEST_COLUMN)
    weight, all_of_it = water.overburden(above, above), water.overburden(below, below)
    left_over = config.cases[number - 1].remains_of(section, k)
    ground = ThinGround(
        step=step, crust=crust, layer=layer,
        crust_weight=weight / np.maximum(crust, THINNEST_COLUMN), layer_weight=(all_of_it - weight) / layer,
        effective=water.vertical_effective(middle, middle, there),
        strength=left_over.strength, potential=left_over.strain_potential,
        friction_angle=section.strata[k - 1].friction_angle,
    )  # fmt: skip
    shaking = shaking_of(config, [k])
    assert shaking is not None
    return float(
        np.interp(problem.at, x, ground.spread(shaking.time - TIME_BEFORE_SHAKING, shaking.acceleration, FOLLOWED_TIME))
    )
