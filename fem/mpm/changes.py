"""Finds the properties of material points before and after liquefaction, and in between."""

from collections.abc import Mapping

import numpy as np

from fem.continuum.liquefied_ground import LEAST_STRENGTH_RATIO, UNDRAINED_POISSON
from fem.kernels import point_stress as law
from fem.mpm.engine import MaterialPointEngine
from fem.mpm.ground import PointGround
from fem.mpm.points import UNLIMITED_TENSION
from fem.mpm.weak_edges import STEEPEST_EDGE, EdgeStrength, edge_strength, thickness_over_width
from meshes.section.liquefies import RemainingStrength
from meshes.section.strain_potential import LARGEST_SHARE, REGAINING_STRAIN, soft_range

# s: viscosity over stiffness of liquefied ground below its strain potential. With this viscosity ground comes to rest
# where it would if its stiffness were lost slowly, and does not oscillate for minutes; in sand hysteresis dissipates
# this energy.
CREEP_TIME = 5.0
# Properties that change as ground liquefies, and their columns, and that of the force at free-field sides, in what is
# remembered of them.
CHANGED_COLUMNS = (
    law.STRENGTH, law.SIN_PHI, law.TENSION_LIMIT, law.SHEAR, law.BULK, law.SOFT_SHEAR, law.SOFT_RADIUS, law.VISCOSITY,
    law.PLANE_SHEAR, law.PLANE_STRENGTH, law.PLANE_SINE, law.PLANE_SLOPE,
)  # fmt: skip
STRENGTH, SINE, LIMIT, SHEAR, BULK, SOFT, KNEE, VISCOUS, ON_PLANE, PLANE_STRENGTH, PLANE_SINE, SLOPE, SIDE = range(13)


def changes_of(
    ground: PointGround, engine: MaterialPointEngine, remains: Mapping[int, RemainingStrength]
) -> dict[str, np.ndarray]:
    """Return properties of the points before and after liquefaction, each (n, columns), and the number of the stratum
    with which each point liquefies, -1 for none (n,), in the original order of the points.

    Parameters
    ----------
    ground : ground of material points at rest
    engine : engine that moves the points
    remains : share of strength and stiffness that each liquefied stratum retains
    """
    changes = _Changes(ground, engine, remains)
    return {"before": changes.before, "after": changes.after, "liquefies": changes.liquefies}


def properties_at(before: np.ndarray, after: np.ndarray, share: float) -> np.ndarray:
    """Return the properties (n, columns) of points at a degree of liquefaction (0 to 1)."""
    values = before + share * (after - before)
    apex = np.divide(
        values[:, STRENGTH], values[:, SINE], out=np.full(len(values), UNLIMITED_TENSION), where=values[:, SINE] > 0.0
    )
    values[:, LIMIT] = np.minimum(np.maximum(before[:, LIMIT], after[:, LIMIT]), apex)
    strains = after[:, KNEE] > 0.0
    for column in (SHEAR, BULK, SOFT, ON_PLANE):
        chosen = strains & (before[:, column] > 0.0)
        start, end = before[chosen, column], after[chosen, column]
        values[chosen, column] = start * (end / start) ** share
    values[strains, KNEE] = after[strains, KNEE]
    return values


class _Changes:
    """Holds what `changes_of` returns, while it is found."""

    def __init__(
        self, ground: PointGround, engine: MaterialPointEngine, remains: Mapping[int, RemainingStrength]
    ) -> None:
        self.ground, self.engine = ground, engine
        points, original = ground.points, engine.original
        before = original(np.column_stack([points.properties[:, CHANGED_COLUMNS], points.side]))
        height = original(points.state[:, law.VOLUME]) / (0.5 * self.ground.grid.cell)
        after, stratum = before.copy(), original(points.stratum)
        potential, knee = np.zeros(len(stratum)), np.zeros(len(stratum))
        for k, left in remains.items():
            in_stratum, soil = stratum == k, self.ground.section.strata[k]
            stress, consolidated = self.ground.effective[in_stratum], self.ground.consolidated[in_stratum]
            friction = np.arctan(left.friction * np.tan(soil.friction_angle))
            intact = before[in_stratum, STRENGTH] / np.cos(soil.friction_angle)
            cohesion = left.cohesion * intact + left.residual * consolidated + left.strength
            if friction == 0.0:
                cohesion = np.maximum(cohesion, LEAST_STRENGTH_RATIO * stress)
            after[in_stratum, STRENGTH], after[in_stratum, SINE] = cohesion * np.cos(friction), np.sin(friction)
            after[in_stratum, LIMIT] = UNLIMITED_TENSION if friction == 0.0 else cohesion / np.tan(friction)
            if friction == 0.0 and left.strain_potential > 0.0:
                potential[in_stratum], knee[in_stratum] = soft_range(left.strain_potential, stress, cohesion)
        liquefies = np.where(np.isin(stratum, list(remains)), stratum, -1)
        self._weaken_edges(before, after, liquefies, potential, knee)
        self._soften(before, after, liquefies, potential, knee)
        liquefied = np.isin(stratum, list(remains))  # without firm ground at the edges, which keeps its pressure
        pressure = UNDRAINED_POISSON / (1.0 - UNDRAINED_POISSON) * self.ground.effective * height * liquefied
        after[:, SIDE] = np.sign(before[:, SIDE]) * np.maximum(pressure, np.abs(before[:, SIDE]))
        self.before, self.after, self.liquefies = before, after, liquefies

    def _weaken_edges(
        self, before: np.ndarray, after: np.ndarray, liquefies: np.ndarray, potential: np.ndarray, knee: np.ndarray
    ) -> None:
        """Give the points in knot spans at the edges of liquefying layers a plane of weakness along the edge, with the
        strength for slip at the edge, and with the stress-strain law of a layer with a strain potential: ``potential``
        (n,) and ``knee`` (n,), the stress (Pa) at this strain. Across the plane the ground keeps its strength.
        """
        x, height, mass = self._columns()
        stress = self.ground.effective
        whole, strength = (values[:, STRENGTH] + stress * values[:, SINE] for values in (before, after))
        edge, early = (
            edge_strength(x, height, mass, liquefies, of_layer, self.ground.grid.cell) for of_layer in (strength, whole)
        )
        sound = whole[edge.points]
        weakened, strains = edge.strength < sound, potential[edge.donors] > 0.0
        chosen = weakened | strains
        points, donors = edge.points[chosen], edge.donors[chosen]
        plane = np.ix_(points, [ON_PLANE, PLANE_STRENGTH, PLANE_SINE, SLOPE])
        before[plane] = np.column_stack([
            before[points, SHEAR], before[points, STRENGTH], before[points, SINE], self._edge_slopes(edge, chosen)
        ])  # fmt: skip
        after[plane] = before[plane]
        slips, sine = (early.strength < sound)[chosen], before[donors, SINE]  # before the layer has lost strength
        before[points[slips], PLANE_SINE] = sine[slips]
        at_edge = early.strength[chosen] - stress[points] * sine
        before[points[slips], PLANE_STRENGTH] = np.maximum(at_edge[slips], 0.0)
        slips, sine = weakened[chosen], after[donors, SINE]
        after[points[slips], PLANE_SINE] = sine[slips]
        at_edge = edge.strength[chosen] - stress[points] * sine
        after[points[slips], PLANE_STRENGTH] = np.maximum(at_edge[slips], 0.0)
        liquefies[points] = liquefies[donors]
        points, donors = edge.points[strains], edge.donors[strains]
        potential[points] = potential[donors]
        largest_strength = LARGEST_SHARE * np.minimum(edge.strength, sound)[strains]
        knee[points] = np.minimum(edge.demand[strains] * knee[donors], largest_strength)

    def _edge_slopes(self, edge: EdgeStrength, chosen: np.ndarray) -> np.ndarray:
        """Return the slope dz/dx of the edge at some points of an edge; at a step in the edge, of its flatter side."""
        layering, cell = self.ground.section.layering, self.ground.grid.cell
        stratum = self.engine.original(self.ground.points.stratum)[edge.donors[chosen]]
        line = stratum + edge.below[chosen]
        x = self.engine.original(self.ground.points.x)[edge.donors[chosen], 0] + self.ground.offset[0]
        at = np.clip([x - cell, x, x + cell], *self.ground.section.extent)
        z = np.array([layering.interfaces(each)[np.arange(len(x)), line] for each in at])
        width = np.diff(at, axis=0)
        sides = np.divide(np.diff(z, axis=0), width, out=np.full(width.shape, np.inf), where=width > 0.5 * cell)
        flatter = sides[np.abs(sides).argmin(axis=0), np.arange(len(x))]
        even = np.abs(sides).max(axis=0) < STEEPEST_EDGE
        return np.clip(np.where(even, sides.mean(axis=0), flatter), -STEEPEST_EDGE, STEEPEST_EDGE)

    def _soften(
        self, before: np.ndarray, after: np.ndarray, liquefies: np.ndarray, potential: np.ndarray, knee: np.ndarray
    ) -> None:
        """Give points with a strain potential the bilinear stress-strain law of their layer, scaled to the width that
        shears.
        """
        strains = np.flatnonzero(potential > 0.0)
        if not len(strains):
            return
        x, height, mass = self._columns()
        layer = np.where(potential > 0.0, liquefies, -1)
        in_layer = self.engine.original(self.ground.points.stratum) == layer
        share = thickness_over_width(x, height, mass, layer, in_layer, self.ground.grid.cell)[strains]
        on_plane = after[strains, ON_PLANE] > 0.0
        c, sine = (
            np.where(on_plane, after[strains, plane], after[strains, all_round])
            for plane, all_round in ((PLANE_STRENGTH, STRENGTH), (PLANE_SINE, SINE))
        )
        strength = c + self.ground.effective[strains] * sine
        full_stiffness = before[strains, SHEAR]
        stiff = np.minimum((strength - knee[strains]) / (REGAINING_STRAIN * share), full_stiffness)
        soft = np.minimum(knee[strains] / (potential[strains] * share), stiff)
        after[strains[on_plane], ON_PLANE] = stiff[on_plane]
        after[strains[~on_plane], SHEAR] = stiff[~on_plane]
        # λ + G at the same bulk modulus λ + 2 G / 3
        after[strains[~on_plane], BULK] += (stiff - full_stiffness)[~on_plane] / 3.0
        after[strains, SOFT], after[strains, KNEE], after[strains, VISCOUS] = soft, knee[strains], CREEP_TIME * soft
        before[strains, SOFT] = full_stiffness

    def _columns(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return for all points, in their original order: positions on the grid (n, 2) in m, heights (n,) in m of the
        rectangles, half a cell wide, that the points stand for, and masses (n,) in kg/m."""
        original, points, grid = self.engine.original, self.ground.points, self.ground.grid
        height = original(points.state[:, law.VOLUME]) / (0.5 * grid.cell)
        return grid.level(original(points.x)), height, original(points.mass)
