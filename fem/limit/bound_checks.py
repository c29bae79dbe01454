"""What makes a bound a bound, looked at again from the answer alone, with NumPy and none of the solver's matrices.

Dimensionless: residuals over the units of the problem.
"""

from dataclasses import dataclass

import numpy as np

from fem.limit.limit_problem import LimitProblem

# What rounding leaves of an equation that is met, over the largest stress or velocity.
ROUNDING = 1e-9


@dataclass(frozen=True)
class StressCheck:
    """``imbalance``: largest body force left over in a cell times its size; ``traction_jump``: largest across an edge,
    or from the given one on the outline; both over the largest stress. ``yield_slack``: smallest distance of a corner
    to the yield surface, negative past it, over the unit of stress.
    """

    imbalance: float
    traction_jump: float
    yield_slack: float

    @property
    def holds(self) -> bool:
        """Whether the stress proves its multiplier to be a lower bound."""
        return self.yield_slack >= 0.0 and max(self.imbalance, self.traction_jump) <= ROUNDING


@dataclass(frozen=True)
class VelocityCheck:
    """``multiplier``: the bound, computed from the velocities alone. ``flow_slack``: smallest volume rate beyond what
    the flow rule asks for where φ > 0; ``volume``: largest volume rate where φ = 0; ``boundary``: largest velocity of a
    held component; ``jump``: largest difference at a common node. The rates are over the largest strain rate, the
    velocities over the largest velocity.
    """

    multiplier: float
    flow_slack: float
    volume: float
    boundary: float
    jump: float

    @property
    def holds(self) -> bool:
        """Whether the velocities prove the multiplier to be an upper bound."""
        return self.flow_slack >= 0.0 and max(self.volume, self.boundary, self.jump) <= ROUNDING


def yield_slack(problem: LimitProblem, stress: np.ndarray) -> np.ndarray:
    """Distance of every corner's stress (m, 3, 3) to the yield surface, c cos φ - p sin φ less the radius, (m, 3)."""
    mean = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    cohesion, friction = problem.cohesion[:, None], problem.friction[:, None]
    return cohesion * np.cos(friction) - mean * np.sin(friction) - radius


def check_stress(problem: LimitProblem, stress: np.ndarray, multiplier: float) -> StressCheck:
    """Balance, tractions and yield of stresses (m, 3, 3) that are to carry a multiplier."""
    mesh, outline = problem.mesh, problem.outline
    scale = max(float(np.abs(stress).max()), 1.0)
    # The slopes of the stress from its differences along two sides.
    sides = mesh.points[mesh.cells[:, 1:]] - mesh.points[mesh.cells[:, :1]]
    slopes = np.linalg.solve(sides, stress[:, 1:] - stress[:, :1])
    force = problem.fixed_force + multiplier * problem.live_force
    left = np.column_stack([slopes[:, 0, 0] + slopes[:, 1, 2], slopes[:, 0, 2] + slopes[:, 1, 1]]) + force
    imbalance = np.hypot(*left.T) * np.sqrt(mesh.areas)

    inner = np.flatnonzero(mesh.edge_cells[:, 1] >= 0)
    one, other = mesh.edge_cells[inner].T
    ends = mesh.edges[inner]
    jumps = [0.0]
    normal = _unit_normals(problem, one, ends)
    for end in (0, 1):
        here, there = (_at_point(problem, stress, cells, ends[:, end]) for cells in (one, other))
        jumps.append(float(np.abs(_traction(here - there, normal)).max(initial=0.0)))
    normal = _unit_normals(problem, outline.cells, outline.ends)
    for end in (0, 1):
        here = _at_point(problem, stress, outline.cells, outline.ends[:, end])
        given = outline.fixed[:, end] + multiplier * outline.live[:, end]
        miss = np.where(outline.held, 0.0, _traction(here, normal) - given)
        jumps.append(float(np.abs(miss).max()))
    return StressCheck(
        imbalance=float(imbalance.max()) / scale,
        traction_jump=max(jumps) / scale,
        yield_slack=float(yield_slack(problem, stress).min()),
    )


def _at_point(problem: LimitProblem, stress: np.ndarray, cells: np.ndarray, points: np.ndarray) -> np.ndarray:
    return stress[cells, np.argmax(problem.mesh.cells[cells] == points[:, None], axis=1)]


def _traction(stress: np.ndarray, normal: np.ndarray) -> np.ndarray:
    xx, yy, xy = stress.T
    return np.column_stack([xx * normal[:, 0] + xy * normal[:, 1], xy * normal[:, 0] + yy * normal[:, 1]])


def _unit_normals(problem: LimitProblem, cells: np.ndarray, ends: np.ndarray) -> np.ndarray:
    points = problem.mesh.points
    along = points[ends[:, 1]] - points[ends[:, 0]]
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    outwards = points[ends[:, 0]] - points[problem.mesh.cells[cells]].mean(axis=1)
    return normal * np.sign(np.sum(normal * outwards, axis=1))[:, None]


def corner_rates(problem: LimitProblem, velocity: np.ndarray) -> np.ndarray:
    """Strain rates (m, 3 corners, [xx, yy, engineering xy]) of velocities (m, 6, 2), by differences along the sides.

    On a side from a corner, the velocity is quadratic: its slope there is -3 v + 4 v(middle) - v(end).
    """
    points = problem.mesh.points[problem.mesh.cells]
    rates = np.empty((len(points), 3, 3))
    for k in range(3):
        after, before = (k + 1) % 3, (k + 2) % 3
        sides = np.stack([points[:, after] - points[:, k], points[:, before] - points[:, k]], axis=1)
        here = -3.0 * velocity[:, k]
        slopes = np.stack(
            [
                here + 4.0 * velocity[:, 3 + k] - velocity[:, after],
                here + 4.0 * velocity[:, 3 + before] - velocity[:, before],
            ],
            axis=1,
        )
        gradient = np.linalg.solve(sides, slopes)  # [by x or y, of vx or vy]
        rates[:, k] = np.column_stack([gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]])
    return rates


def dissipation(problem: LimitProblem, rates: np.ndarray) -> np.ndarray:
    """An upper limit of the dissipation in every cell (m,), of strain rates (m, 3, 3) that obey the flow rule."""
    volume, shear = rates[..., 0] + rates[..., 1], np.hypot(rates[..., 0] - rates[..., 1], rates[..., 2])
    cohesion, friction = problem.cohesion[:, None], problem.friction[:, None]
    clay = friction == 0.0
    apex = np.where(clay, 0.0, cohesion / np.tan(np.where(clay, 1.0, friction)))
    return problem.mesh.areas / 3.0 * np.sum(np.where(clay, cohesion * shear, apex * volume), axis=1)


def work(problem: LimitProblem, velocity: np.ndarray) -> tuple[float, float]:
    """Work rates of the load that stays and of the live one on velocities (m, 6, 2)."""
    mesh, outline = problem.mesh, problem.outline
    mean = velocity[:, 3:].mean(axis=1)
    points = mesh.points
    length = np.hypot(*(points[outline.ends[:, 1]] - points[outline.ends[:, 0]]).T)
    first, last = (_node(problem, velocity, outline.ends[:, end]) for end in (0, 1))
    middle = velocity[outline.cells, 3 + np.argmax(mesh.cell_edges[outline.cells] == outline.edges[:, None], axis=1)]
    done = []
    for force, given in ((problem.fixed_force, outline.fixed), (problem.live_force, outline.live)):
        inside = float(np.sum(mesh.areas * np.sum(mean * force, axis=1)))
        pressed = np.sum(given[:, 0] * (first + 2.0 * middle) + given[:, 1] * (last + 2.0 * middle), axis=1)
        done.append(inside + float(np.sum(length * pressed)) / 6.0)
    return done[0], done[1]


def _node(problem: LimitProblem, velocity: np.ndarray, points: np.ndarray) -> np.ndarray:
    cells = problem.outline.cells
    return velocity[cells, np.argmax(problem.mesh.cells[cells] == points[:, None], axis=1)]


def check_velocity(problem: LimitProblem, velocity: np.ndarray) -> VelocityCheck:
    """Flow rule, boundary and work of velocities (m, 6, 2), and the multiplier that they bound."""
    mesh, outline = problem.mesh, problem.outline
    rates = corner_rates(problem, velocity)
    volume = rates[..., 0] + rates[..., 1]
    shear = np.hypot(rates[..., 0] - rates[..., 1], rates[..., 2])
    fastest, largest = float(np.abs(velocity).max()), float(np.abs(rates).max())
    clay = problem.friction == 0.0
    slack = volume - np.sin(problem.friction)[:, None] * shear
    stays, does = work(problem, velocity)
    along = [_node(problem, velocity, outline.ends[:, end]) for end in (0, 1)]
    along.append(
        velocity[outline.cells, 3 + np.argmax(mesh.cell_edges[outline.cells] == outline.edges[:, None], axis=1)]
    )
    held = max(float(np.abs(np.where(outline.held, v, 0.0)).max()) for v in along)
    return VelocityCheck(
        multiplier=(float(dissipation(problem, rates).sum()) - stays) / does,
        flow_slack=float(slack[~clay].min(initial=np.inf)) / largest if not clay.all() else 0.0,
        volume=float(np.abs(volume[clay]).max(initial=0.0)) / largest,
        boundary=held / fastest,
        jump=_largest_jump(problem, velocity) / fastest,
    )


def _largest_jump(problem: LimitProblem, velocity: np.ndarray) -> float:
    """Largest difference of the velocities that cells have at a common node."""
    node = problem.mesh.six_nodes.ravel()
    flat = velocity.reshape(-1, 2)
    one = np.zeros((int(node.max()) + 1, 2))
    one[node] = flat
    return float(np.abs(one[node] - flat).max())
