"""Checks whether an answer is a strict bound. The conditions are computed from the answer alone, without the matrices
of the solver.

A stress field is statically admissible, and its multiplier a lower bound, if it is in equilibrium, its tractions are
continuous and equal to the prescribed ones, and no point is beyond the yield surface. Velocities are kinematically
admissible if they are continuous, zero where the boundary is fixed, and obey the associated flow rule. The upper bound
from kinematically admissible velocities is the dissipation less the work of the dead load, over the work of the live
load. All numbers are dimensionless: they are divided by the units of length and stress of the problem.
"""

from dataclasses import dataclass

import numpy as np

from fem.limit.limit_problem import LimitProblem
from meshes.pore_loads import outward_normals

# Residual of an equation, over the largest stress or velocity, that counts as rounding.
RESIDUAL_ROUNDING = 1e-9
# Tension above the cut-off, over the unit of stress, that counts as rounding: 0.2 Pa in a slope of 10 m. On the bare
# surface of ground without tensile strength, the stress cannot have a margin from the cut-off.
TENSION_ROUNDING = 1e-6
# Difference of velocities along a side, over the largest velocity of the cell, that counts as rounding.
VELOCITY_ROUNDING = 16.0 * np.finfo(float).eps


@dataclass(frozen=True)
class StressCheck:
    """Holds the errors with which a stress field violates the conditions of static admissibility.

    Attributes
    ----------
    imbalance : largest unbalanced body force of a cell, times the root of its area, over the largest stress
    traction_jump : largest jump of the traction across an edge, or difference from the prescribed traction on the
        outline, over the largest stress
    yield_slack : smallest distance of a corner's stress to the yield surface, negative beyond it, over the unit of
        stress
    tension_slack : smallest distance of a corner's stress to its tension cut-off, negative beyond it, over the unit of
        stress
    """

    imbalance: float
    traction_jump: float
    yield_slack: float
    tension_slack: float = np.inf

    @property
    def holds(self) -> bool:
        """Return whether the stress field proves that its multiplier is a lower bound."""
        return (
            self.yield_slack >= 0.0
            and self.tension_slack >= -TENSION_ROUNDING
            and max(self.imbalance, self.traction_jump) <= RESIDUAL_ROUNDING
        )

    @property
    def needs_margin(self) -> bool:
        """Return whether a larger distance to the yield surface at some corners may help. It does not help where a
        cut-off is exceeded, from which no margin can be kept."""
        return self.yield_slack < 0.0 and self.tension_slack >= -TENSION_ROUNDING

    def __str__(self) -> str:
        """Return the violated conditions of a statically admissible stress field as a text."""
        if self.yield_slack < 0.0:
            return f"the stress lies beyond the yield surface by {-self.yield_slack:.1e} of the unit of stress"
        if self.tension_slack < -TENSION_ROUNDING:
            return f"the tension exceeds the cut-off by {-self.tension_slack:.1e} of the unit of stress"
        return (
            f"the stress field is out of balance by {max(self.imbalance, self.traction_jump):.1e} of the largest stress"
        )


@dataclass(frozen=True)
class VelocityCheck:
    """Holds the upper bound from a velocity field, and the errors with which the field violates the conditions of
    kinematic admissibility.

    Attributes
    ----------
    multiplier : the upper bound of the load multiplier, computed from the velocities alone
    flow_slack : where φ > 0, or ground may open: smallest volumetric strain rate less sin φ times the shear rate, over
        the largest strain rate
    volume : where φ = 0 and ground may not open: largest volumetric strain rate, over the largest strain rate
    boundary : largest velocity of a fixed component, over the largest velocity
    jump : largest difference of the velocities that two cells have at a common node, over the largest velocity
    """

    multiplier: float
    flow_slack: float
    volume: float
    boundary: float
    jump: float

    @property
    def holds(self) -> bool:
        """Return whether the velocity field proves that the multiplier is an upper bound."""
        return self.flow_slack >= 0.0 and max(self.volume, self.boundary, self.jump) <= RESIDUAL_ROUNDING

    @property
    def needs_margin(self) -> bool:
        """Return whether a larger distance to the limit of the flow rule at some corners may help."""
        return not self.holds

    def __str__(self) -> str:
        """Return the violated conditions of kinematically admissible velocities as a text."""
        if self.flow_slack < 0.0:
            return f"the strain rates violate the flow rule by {-self.flow_slack:.1e} of the largest"
        missed = max(self.volume, self.boundary, self.jump)
        return f"the velocities violate constant volume, fixed sides or continuity by {missed:.1e} of the largest"


def yield_slack(problem: LimitProblem, stress: np.ndarray) -> np.ndarray:
    """Return the distance of the stress at every corner to the yield surface.

    The distance is c cos φ - σm sin φ less the radius of Mohr's circle, σm the mean stress in the plane, tension
    positive.

    Parameters
    ----------
    problem : the ground with its strength, over the unit of stress
    stress (m, 3 corners, 3) : stress [xx, yy, xy], tension positive, over the unit of stress

    Returns
    -------
    The distance (m, 3) over the unit of stress, negative beyond the yield surface.
    """
    mean = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    cohesion, friction = problem.cohesion, problem.friction[:, None]
    return cohesion * np.cos(friction) - mean * np.sin(friction) - radius


def tension_slack(problem: LimitProblem, stress: np.ndarray) -> np.ndarray:
    """Return the tension cut-off less the major principal stress (m, 3) of the stress (m, 3, 3) at every corner."""
    mean = 0.5 * (stress[..., 0] + stress[..., 1])
    return problem.tension[:, None] - mean - np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])


def check_stress(problem: LimitProblem, stress: np.ndarray, multiplier: float) -> StressCheck:
    """Check equilibrium, tractions and yield of a stress field (m, 3 corners, 3) under the loads at a load
    multiplier."""
    mesh, outline = problem.mesh, problem.outline
    scale = max(float(np.abs(stress).max()), 1.0)
    # The slopes of the stress from its differences along two sides.
    sides = mesh.points[mesh.cells[:, 1:]] - mesh.points[mesh.cells[:, :1]]
    slopes = np.linalg.solve(sides, stress[:, 1:] - stress[:, :1])
    force = problem.dead_force + multiplier * problem.live_force
    unbalanced = np.column_stack([slopes[:, 0, 0] + slopes[:, 1, 2], slopes[:, 0, 2] + slopes[:, 1, 1]]) + force
    imbalance = np.hypot(*unbalanced.T) * np.sqrt(mesh.areas)

    interior = np.flatnonzero(mesh.edge_cells[:, 1] >= 0)
    first, second = mesh.edge_cells[interior].T
    ends = mesh.edges[interior]
    jumps = [0.0]
    tractions = np.zeros((len(mesh.edges), 2, 2))
    tractions[problem.jumps.edges] = problem.jumps.traction + multiplier * problem.jumps.live
    normal = outward_normals(problem.mesh, first, ends)
    for end in (0, 1):
        inner_stress, outer_stress = (_at_point(problem, stress, cells, ends[:, end]) for cells in (first, second))
        jumps.append(
            float(np.abs(_traction(inner_stress - outer_stress, normal) - tractions[interior, end]).max(initial=0.0))
        )
    normal = outward_normals(problem.mesh, outline.cells, outline.ends)
    for end in (0, 1):
        inner_stress = _at_point(problem, stress, outline.cells, outline.ends[:, end])
        traction = outline.dead[:, end] + multiplier * outline.live[:, end]
        miss = np.where(outline.reacts, 0.0, _traction(inner_stress, normal) - traction)
        jumps.append(float(np.abs(miss).max()))
        sides = []
        for ends in mesh.matched:
            cells = mesh.edge_cells[mesh.edge_numbers(ends), 0]
            sides.append(
                _traction(_at_point(problem, stress, cells, ends[:, end]), outward_normals(problem.mesh, cells, ends))
            )
        jumps.append(float(np.abs(sides[0] + sides[1]).max(initial=0.0)))
    return StressCheck(
        imbalance=float(imbalance.max()) / scale,
        traction_jump=max(jumps) / scale,
        yield_slack=float(yield_slack(problem, stress).min()),
        tension_slack=float(tension_slack(problem, stress).min()),
    )


def _at_point(problem: LimitProblem, stress: np.ndarray, cells: np.ndarray, points: np.ndarray) -> np.ndarray:
    return stress[cells, np.argmax(problem.mesh.cells[cells] == points[:, None], axis=1)]


def _traction(stress: np.ndarray, normal: np.ndarray) -> np.ndarray:
    xx, yy, xy = stress.T
    return np.column_stack([xx * normal[:, 0] + xy * normal[:, 1], xy * normal[:, 0] + yy * normal[:, 1]])


def corner_rates(problem: LimitProblem, velocity: np.ndarray) -> np.ndarray:
    """Return the strain rates at the corners of cells, by differences of the velocities along the sides.

    On a side from a corner, the velocity is quadratic: its slope there is -3 v + 4 v(middle) - v(end). Where the slope
    of the velocity is as small as rounding errors, as at a corner between fixed sides, the strain rate is zero.

    Parameters
    ----------
    problem : the ground with its mesh, over the unit of length
    velocity (m, 6 nodes, 2) : velocities at corners and middles of the sides of every cell

    Returns
    -------
    Strain rates (m, 3 corners, [xx, yy, engineering xy]), extension positive.
    """
    points = problem.mesh.points[problem.mesh.cells]
    none = VELOCITY_ROUNDING * np.abs(velocity).max(axis=(1, 2))[:, None, None]
    rates = np.empty((len(points), 3, 3))
    for k in range(3):
        after, before = (k + 1) % 3, (k + 2) % 3
        sides = np.stack([points[:, after] - points[:, k], points[:, before] - points[:, k]], axis=1)
        opposite_velocity = -3.0 * velocity[:, k]
        slopes = np.stack(
            [
                opposite_velocity + 4.0 * velocity[:, 3 + k] - velocity[:, after],
                opposite_velocity + 4.0 * velocity[:, 3 + before] - velocity[:, before],
            ],
            axis=1,
        )
        slopes[np.abs(slopes) <= none] = 0.0
        gradient = np.linalg.solve(sides, slopes)  # [by x or y, of vx or vy]
        rates[:, k] = np.column_stack([gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]])
    return rates


def dissipation(problem: LimitProblem, rates: np.ndarray) -> np.ndarray:
    """Return an upper limit of the dissipation in every cell (m,), for strain rates (m, 3, 3) that obey the flow
    rule."""
    volume, shear = rates[..., 0] + rates[..., 1], np.hypot(rates[..., 0] - rates[..., 1], rates[..., 2])
    cohesion, friction = problem.spread_cohesion, problem.friction[:, None]
    clay = friction == 0.0
    apex = np.where(clay, 0.0, cohesion / np.tan(np.where(clay, 1.0, friction)))
    by_corner = np.where(clay, cohesion * shear, apex * volume)
    torn = np.isfinite(problem.tension)
    if torn.any():
        by_corner[torn] = _with_cut_off(
            volume[torn],
            shear[torn],
            cohesion[torn] * np.cos(friction[torn]),
            np.sin(friction[torn]),
            problem.tension[torn],
        )
    return problem.mesh.areas / 3.0 * np.sum(by_corner, axis=1)


def _with_cut_off(
    volume: np.ndarray, shear: np.ndarray, strength: np.ndarray, sin: np.ndarray, tension: np.ndarray
) -> np.ndarray:
    """Return the dissipation (n, 3) per area for strain rates with volume >= sin φ shear, ``strength`` = c cos φ, and a
    tension cut-off T (n,).

    The dissipation is the largest work of a stress with R <= c cos φ - σm sin φ and R <= T - σm, where R is the radius
    of Mohr's circle and σm its centre. The largest work is that at σm = T, or at σm = (T - c cos φ) / (1 - sin φ),
    where the two lines meet.
    """
    limit = tension[:, None]
    both = (limit * (volume - sin * shear) + strength * (shear - volume)) / (1.0 - sin)
    return np.maximum(limit * volume, both)


def work(problem: LimitProblem, velocity: np.ndarray) -> tuple[float, float]:
    """Return the power of the dead load and of the live load on velocities (m, 6 nodes, 2)."""
    mesh, outline = problem.mesh, problem.outline
    mean = velocity[:, 3:].mean(axis=1)
    points = mesh.points
    length = np.hypot(*(points[outline.ends[:, 1]] - points[outline.ends[:, 0]]).T)
    first, last = (_node(problem, velocity, outline.ends[:, end]) for end in (0, 1))
    middle = velocity[outline.cells, 3 + np.argmax(mesh.cell_edges[outline.cells] == outline.edges[:, None], axis=1)]
    done = []
    for force, traction in ((problem.dead_force, outline.dead), (problem.live_force, outline.live)):
        inside = float(np.sum(mesh.areas * np.sum(mean * force, axis=1)))
        pressed = np.sum(traction[:, 0] * (first + 2.0 * middle) + traction[:, 1] * (last + 2.0 * middle), axis=1)
        done.append(inside + float(np.sum(length * pressed)) / 6.0)
    jumps = problem.jumps
    return done[0] + _work_at_jumps(problem, velocity, jumps.traction), done[1] + _work_at_jumps(
        problem, velocity, jumps.live
    )


def _work_at_jumps(problem: LimitProblem, velocity: np.ndarray, traction: np.ndarray) -> float:
    """Return the power (work rate) of tractions by jumps of the pore pressure, (k, 2 ends, 2), on velocities (m, 6
    nodes, 2)."""
    mesh, jumps = problem.mesh, problem.jumps
    cells = mesh.edge_cells[jumps.edges, 0]
    first, last = (velocity[cells, np.argmax(mesh.cells[cells] == end[:, None], axis=1)] for end in jumps.ends.T)
    middle = velocity[cells, 3 + np.argmax(mesh.cell_edges[cells] == jumps.edges[:, None], axis=1)]
    length = np.hypot(*(mesh.points[jumps.ends[:, 1]] - mesh.points[jumps.ends[:, 0]]).T)
    pressed = np.sum(traction[:, 0] * (first + 2.0 * middle) + traction[:, 1] * (last + 2.0 * middle), axis=1)
    return float(np.sum(length * pressed)) / 6.0


def _node(problem: LimitProblem, velocity: np.ndarray, points: np.ndarray) -> np.ndarray:
    cells = problem.outline.cells
    return velocity[cells, np.argmax(problem.mesh.cells[cells] == points[:, None], axis=1)]


def check_velocity(problem: LimitProblem, velocity: np.ndarray) -> VelocityCheck:
    """Check flow rule, boundary conditions and work of velocities (m, 6 nodes, 2), and compute the upper bound from
    them."""
    mesh, outline = problem.mesh, problem.outline
    rates = corner_rates(problem, velocity)
    volume = rates[..., 0] + rates[..., 1]
    shear = np.hypot(rates[..., 0] - rates[..., 1], rates[..., 2])
    fastest, largest = float(np.abs(velocity).max()), float(np.abs(rates).max())
    clay = (problem.friction == 0.0) & ~np.isfinite(problem.tension)
    slack = volume - np.sin(problem.friction)[:, None] * shear
    dead, live = work(problem, velocity)
    along = [_node(problem, velocity, outline.ends[:, end]) for end in (0, 1)]
    along.append(
        velocity[outline.cells, 3 + np.argmax(mesh.cell_edges[outline.cells] == outline.edges[:, None], axis=1)]
    )
    largest_on_supports = max(float(np.abs(np.where(outline.fixed, v, 0.0)).max()) for v in along)
    return VelocityCheck(
        multiplier=(float(dissipation(problem, rates).sum()) - dead) / live,
        flow_slack=float(slack[~clay].min(initial=np.inf)) / largest if not clay.all() else 0.0,
        volume=float(np.abs(volume[clay]).max(initial=0.0)) / largest,
        boundary=largest_on_supports / fastest,
        jump=_largest_jump(problem, velocity) / fastest,
    )


def _largest_jump(problem: LimitProblem, velocity: np.ndarray) -> float:
    """Return the largest difference between the velocities of neighbouring cells at a common node."""
    node = problem.mesh.own_node[problem.mesh.six_nodes.ravel()]
    flat = velocity.reshape(-1, 2)
    of_node = np.zeros((int(node.max()) + 1, 2))
    of_node[node] = flat
    return float(np.abs(of_node[node] - flat).max())
