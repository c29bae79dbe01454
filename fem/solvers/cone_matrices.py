"""Holds the data of the second-order cone programs of ``cone_program.py``, and forms their matrices for the solvers."""

from dataclasses import dataclass
from functools import cached_property

import clarabel
import numpy as np
from scipy import sparse

from fem.solvers.interior_point import Corners, Standard

# Room below tension cut-offs, over the unit of stress; up to ten times as much counts as none (``bound_checks.py``).
TENSION_MARGIN = 1e-7


@dataclass(frozen=True, eq=False)
class ConeProgram:
    """Holds the data of both problems, for k corners and n velocities, dimensionless.

    Attributes
    ----------
    strain (3 k, n) : the matrix G from velocities to strain rates [xx, yy, engineering xy], corner by corner
    cohesion, friction (k,) : cohesion over the unit of stress, and friction angle in rad
    weight (k,) : weight w of each corner, by which its dissipation is multiplied: the root of its dimensionless area if
        its strain rates in G are multiplied by this root, 1 otherwise
    dead, live (n,) : vectors b0 and b1: work of the dead and the live load on a unit velocity
    stress_margin (k,) : smallest distance of the stress to the yield surface, so that rounding does not lead beyond it.
        No distance to the tension cut-off is required, since there may be no admissible stress below a reduced cut-off.
    strain_margin (k,) : volumetric strain rate that is required in addition to the flow rule where φ > 0, so that
        rounding does not violate the flow rule
    strain_share : additional volumetric strain rate where φ > 0, as a share of the shear rate
    tension (k,) : tension cut-off over the unit of stress, inf for none
    bare (k,) : corners on a bare surface, where equilibrium makes one principal stress zero, so that the cut-off limits
        the other principal stress, which is equal to the trace
    softening (k,) : vector s > 0 if λ reduces the strength and multiplies no load: the right-hand side of the yield
        condition is reduced by λ s. Then b1 is zero, and the dual has Σ w s |(εxx - εyy, εxy)| = 1 in place of b1·x =
        1.
    """

    strain: sparse.csr_matrix
    cohesion: np.ndarray
    friction: np.ndarray
    weight: np.ndarray
    dead: np.ndarray
    live: np.ndarray
    stress_margin: np.ndarray | float = 0.0
    strain_margin: np.ndarray | float = 0.0
    strain_share: float = 0.0
    tension: np.ndarray | float = np.inf
    bare: np.ndarray | bool = False
    softening: np.ndarray | None = None

    @cached_property
    def torn(self) -> np.ndarray:
        """Return the numbers of the corners whose tension cut-off lies below the apex of their cone, so that it
        acts."""
        tension = np.broadcast_to(self.tension, self.cohesion.shape)
        finite = np.where(np.isfinite(tension), tension, 0.0)
        return np.flatnonzero(np.isfinite(tension) & (finite * np.tan(self.friction) < self.cohesion))


@dataclass(frozen=True, eq=False)
class Assembled:
    """Holds the problem min cost·y subject to matrix y + s = offset, with s in the ``cones``. The unknowns y are the
    velocities, the dissipation over c at each corner of φ = 0, and the opening rates at torn corners. ``shear`` and
    ``torn`` compute the values of the ``Solution`` from y.
    """

    cost: np.ndarray
    matrix: sparse.csr_matrix
    offset: np.ndarray
    cones: list
    shear: sparse.csr_matrix
    torn: np.ndarray


def assembled(program: ConeProgram, clay: np.ndarray) -> Assembled:
    """Return the second (dual) problem in the form of the solver; ``clay`` are the numbers of the corners of φ = 0."""
    corners = len(program.cohesion)
    sin, cos = np.sin(program.friction), np.cos(program.friction)
    steeper = sin * (1.0 + program.strain_share)
    opening, tears, no_tears, torn_cones = _opening(program)
    volume = _volumetric(corners)
    across = sparse.hstack(
        [volume @ program.strain, sparse.csr_matrix((corners, len(clay))), -volume @ opening]
    ).tocsr()
    shear = _shear_of(program, across, clay)
    torn = np.pad(opening.T @ (volume.T @ _tension_of(program)), (len(program.live) + len(clay), 0))
    cost = shear.T @ (np.where(sin > 0.0, program.cohesion * cos, program.cohesion) - program.stress_margin) + torn
    cost[: len(program.live)] -= program.dead
    extra = sparse.csr_matrix((np.ones(len(clay)), (3 * clay, np.arange(len(clay)))), shape=(3 * corners, len(clay)))
    steeper_map = _cone_map(steeper)
    cone = sparse.hstack([steeper_map @ program.strain, extra, -steeper_map @ opening])
    load = np.pad(program.live, (0, cone.shape[1] - len(program.live)))
    if program.softening is not None:
        load = shear.T @ program.softening
    before = sparse.csr_matrix((tears.shape[0], cone.shape[1] - tears.shape[1]))
    margin = np.zeros((corners, 3))
    margin[:, 0] = np.where(sin > 0.0, program.strain_margin, 0.0)
    offset = np.concatenate([[1.0], np.zeros(len(clay)), -margin.ravel(), no_tears])
    cones = [clarabel.ZeroConeT(1 + len(clay)), *[clarabel.SecondOrderConeT(3)] * corners, *torn_cones]
    rows = [sparse.csr_matrix(load), across[clay], -cone, sparse.hstack([before, -tears])]
    return Assembled(cost, sparse.vstack(rows).tocsr(), offset, cones, shear, torn)


def _shear_of(program: ConeProgram, across: sparse.csr_matrix, clay: np.ndarray) -> sparse.csr_matrix:
    """Return the matrix from the unknowns to the weighted shear rates (k,). The shear rate is the volumetric rate over
    sin φ, or an unknown at corners of φ = 0.
    """
    corners, sin = len(program.cohesion), np.sin(program.friction)
    of_volume = sparse.diags(np.divide(program.weight, sin, out=np.zeros(corners), where=sin > 0.0)) @ across
    entries = (clay, len(program.live) + np.arange(len(clay)))
    return (of_volume + sparse.csr_matrix((program.weight[clay], entries), shape=across.shape)).tocsr()


def _tension_of(program: ConeProgram) -> np.ndarray:
    """Return the dissipation of a corner (k,) per volume of opening: weight times T, or 0 without a cut-off.

    On a bare surface the dissipation is half of this, since there T limits the whole trace, which is twice the mean
    stress.
    """
    torn = program.torn
    tension = np.zeros(len(program.cohesion))
    bare, cut_off = (np.broadcast_to(value, tension.shape)[torn] for value in (program.bare, program.tension))
    tension[torn] = program.weight[torn] * np.where(bare, 0.5 * cut_off, cut_off)
    return tension


def _opening(program: ConeProgram) -> tuple[sparse.csr_matrix, sparse.csr_matrix, np.ndarray, list]:
    """Return the opening of torn corners: strain rates (3 k, p) of p unknowns, and the matrix, offset and cones that
    constrain these unknowns.

    Each corner has three unknowns, a strain rate whose volumetric part is at least its shear part; on a bare surface it
    has one, half of the volumetric part.
    """
    torn, corners = program.torn, len(program.cohesion)
    bare = np.broadcast_to(program.bare, corners)[torn]
    singles, three = torn[bare], torn[~bare]
    single = np.arange(len(singles))
    rows = np.concatenate([3 * singles, 3 * singles + 1, (3 * three[:, None] + [0, 1, 2]).ravel()])
    columns = np.concatenate([single, single, len(singles) + np.arange(3 * len(three))])
    opening = sparse.csr_matrix(
        (np.ones(len(rows)), (rows, columns)), shape=(3 * corners, len(singles) + 3 * len(three))
    )
    margins = np.where(program.friction > 0.0, 0.0, program.strain_margin)
    least = np.zeros((len(three), 3))
    least[:, 0] = margins[three]
    tears = sparse.block_diag(
        [sparse.identity(len(singles)), _cone_map(np.full(len(three), 1.0 + program.strain_share))], format="csr"
    )
    offset = np.concatenate([-0.5 * margins[singles], -least.ravel()])
    cones = [clarabel.NonnegativeConeT(len(singles))] if len(singles) else []
    return opening, tears, offset, [*cones, *[clarabel.SecondOrderConeT(3)] * len(three)]


def _volumetric(corners: int) -> sparse.csr_matrix:
    """Return the matrix from strain rates (3 k,) to their volumetric part (k,)."""
    rows = np.repeat(np.arange(corners), 2)
    columns = (3 * np.arange(corners)[:, None] + [0, 1]).ravel()
    return sparse.csr_matrix((np.ones(2 * corners), (rows, columns)), shape=(corners, 3 * corners))


def _cone_map(sin: np.ndarray) -> sparse.csr_matrix:
    """Return the matrix from strain rates (3 k,) to vectors in cones: [volume, sin φ (xx - yy), sin φ xy], or [0, xx -
    yy, xy].
    """
    corners = len(sin)
    first = 3 * np.arange(corners)
    much = np.where(sin > 0.0, sin, 1.0)
    dilates = np.where(sin > 0.0, 1.0, 0.0)
    rows = np.concatenate([first, first, first + 1, first + 1, first + 2])
    columns = np.concatenate([first, first + 1, first, first + 1, first + 2])
    values = np.concatenate([dilates, dilates, much, -much, much])
    return sparse.csr_matrix((values, (rows, columns)), shape=(3 * corners, 3 * corners))


def stress_of(
    program: ConeProgram, multiplier: float, pressure: np.ndarray, z: np.ndarray, clay: np.ndarray
) -> np.ndarray:
    """Compute the stress (k, 3) from the multipliers of the cones and of the volume of clay.

    ``program``: the cone program; ``multiplier``: load multiplier; ``pressure``: multipliers of the volume of clay;
    ``z`` (k, 3): multipliers of the cones; ``clay``: mask or numbers of corners with φ = 0.
    """
    sin, cos = np.sin(program.friction), np.cos(program.friction)
    radius = np.where(sin > 0.0, program.cohesion * cos, program.cohesion) - program.stress_margin
    if program.softening is not None:
        radius = radius - multiplier * program.softening
    z = z / program.weight[:, None]
    mean = np.divide(radius, sin, out=np.zeros(len(sin)), where=sin > 0.0) - z[:, 0]
    mean[clay] = pressure / program.weight[clay]
    much = np.where(sin > 0.0, sin * (1.0 + program.strain_share), 1.0)
    half, shear = -much * z[:, 1], -much * z[:, 2]
    return np.stack([mean + half, mean - half, shear], axis=1)


def standard(program: ConeProgram, data: Assembled, magnified: float) -> tuple[Standard, np.ndarray]:
    """Return the program in the form of the interior-point method, and the order of its rows.

    ``magnified`` is a factor on its forces.
    Tension cut-offs are relaxed a little: where they meet bare edges they would force zero stress and leave no
    interior.
    """
    corners, sin = len(program.cohesion), np.sin(program.friction)
    clay = np.flatnonzero(sin == 0.0)
    bare = np.broadcast_to(program.bare, corners)[program.torn]
    single, three = program.torn[bare], program.torn[~bare]
    sine = np.where(sin > 0.0, sin * (1.0 + program.strain_share), 1.0)
    first = 1 + len(clay) + 3 * corners
    size = data.matrix.shape[0]
    order = np.concatenate([np.arange(first), np.arange(first + len(single), size), first + np.arange(len(single))])
    cost = data.cost.copy()
    openings = len(program.live) + len(clay) + len(single)
    cost[openings - len(single) : openings] += TENSION_MARGIN * program.weight[single]
    for component in (0, 1):
        cost[openings + component :: 3] += TENSION_MARGIN * program.weight[three]
    turn = sparse.kron(sparse.identity(corners), [[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 1.0]])
    clays, singles, triples = (_numbers(corners, those) for those in (clay, single, three))
    places = Corners(sine, clays, singles, triples, torn_sine=1.0 + program.strain_share)
    rates = (turn @ program.strain).tocsr()
    return Standard(magnified * cost, data.matrix[order], data.offset[order], places, rates), order


def _numbers(corners: int, selected: np.ndarray) -> np.ndarray:
    """Return the index of every corner (k,) within ``selected``, -1 for corners that are not among them."""
    numbers = np.full(corners, -1)
    numbers[selected] = np.arange(len(selected))
    return numbers
