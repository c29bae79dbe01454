"""Solves the programs of ``cone_program.py`` by an interior-point method that eliminates the unknowns of every corner
in closed form.

Once primal and dual equations are fulfilled, the two objectives are a bracket of the multiplier. Bounds need a gap of
3e-4, finite elements a gap of 1e-3. Newton's directions have the scaling of Nesterov & Todd (1997), the corrector of
Mehrotra (1992) and up to two correctors of Gondzio (1996). CHOLMOD factorises the positive definite stiffness matrix of
a body whose corners have the compliances of ``corner_stiffness.py``; the load is one more right-hand side. If a program
has no solution, the method can prove this in one case only: no stress balances the dead load, which velocities prove
whose multiplier is below a ``floor``. Below gaps of 1e-4 the method may break down.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from fem.kernels.corner_cones import add_products, centrality, corrections, longest_step, scalings
from fem.kernels.corner_stiffness import condense, expand, stiffnesses
from fem.solvers.convergence import STALLED_RESIDUAL, Iterate, Place, Tolerance
from fem.solvers.corner_matrix import CornerMatrix
from fem.solvers.program_matrix import ProgramMatrix
from meshes.executor import check_cancelled

MOST_ITERATIONS = 60
# If there is a solution, the residual is below FEASIBLE_RESIDUAL after this many iterations; 5 to 12 are usual.
ITERATIONS_TO_FEASIBILITY, FEASIBLE_RESIDUAL = 20, 1e-4
# The first iterate whose gap is below this share of the multiplier is the starting point for another strength.
WARM_START_GAP = 1.0
MOST_WARM_ITERATIONS = 15  # from such a starting point
# Largest number of iterations with a sufficient gap but an insufficient residual; and number of iterations without a
# halving of an insufficient residual, after which it is considered constant.
MOST_ITERATIONS_BELOW_GAP, STALLED_ITERATIONS = 4, 8
# Largest number of iterative refinements of a direction; the residual of a refined direction over the gap, and its
# smallest and largest value; the residual of directions that only predict.
MOST_REFINEMENTS, RESIDUAL_OVER_GAP, PREDICTOR_RESIDUAL = 10, 1e-5, 1e-3
SMALLEST_RESIDUAL, LARGEST_RESIDUAL = 1e-10, 1e-5
# The refinement ends if a step leaves a larger share of the residual.
LARGEST_REDUCTION = 0.8
# Initial, largest and smallest δ of clay (``corner_stiffness.py``), and the ratio of its changes. If δ is too small,
# rounding spoils equilibrium; if δ is too large, the refinement of the volume of clay converges slowly.
CLAY_COMPLIANCE, LARGEST_COMPLIANCE, SMALLEST_COMPLIANCE, COMPLIANCE_RATIO = 1e-4, 1.0, 1e-7, 10.0
# Error of the equilibrium of a direction above which δ rises if the error is larger than the residual that the
# direction should remove, however small it is beside the velocities.
EQUILIBRIUM_RESIDUAL = 1e-9
# A direction whose residual exceeds the requested one by more than this ratio is computed again; number of attempts.
POOR_RESIDUAL_RATIO, DIRECTION_ATTEMPTS = 100.0, 3
# Number of Gondzio's correctors; the increase of the step length that they aim at; smallest and largest product of a
# cone over the mean.
CORRECTORS, LENGTH_GAIN, SMALLEST_PRODUCT, LARGEST_PRODUCT = 2, 0.3, 0.1, 10.0
# The starting point is shifted into the cones by its distance outside the cones, or by the size of its vectors if that
# is larger, within these limits. With a shift of 1 the first gap was 10,000 times the multiplier, and two to four of
# fifteen iterations were added. A point counts as inside if its distance inside is this share of the shift.
SMALLEST_SHIFT, LARGEST_SHIFT, INTERIOR_SHARE = 1e-4, 1.0, 1e-3
# Share of the longest step that is taken, and the smallest centring parameter.
STEP_SHARE, SMALLEST_CENTRING = 0.99, 1e-6
# A direction with a shorter step removes only the share of the residuals by which it reduces the mean product. A
# direction that removes all of the residuals leaves the cones at once where residuals are large beside the products:
# an upper bound of a levee (8,330 triangles) stopped there with steps below 0.01, and took 65 iterations instead of 22.
SHORT_STEP = 0.1
# Surplus of the work of the loads over the dissipation, as a share of all work, above which velocities prove that no
# stress balances the dead load (0.43 for mud). Where velocities of single corners grow without end, rounded forces do
# work: 0.003 in a slope that stands up to Kh = 0.16.
PROOF_SHARE = 0.01


@dataclass(frozen=True, eq=False)
class Corners:
    """Holds the k corners of the cells of a program.

    Attributes
    ----------
    sine (k,) : slope of the cone of strain rates at each corner: sin φ, plus a margin; 1 for clay (φ = 0), whose
        volume is constant by an equation of its own
    clay (k,) : running number of each corner of clay; -1 for other corners
    single (k,) : running number of each corner with a tension cut-off whose plastic opening has one unknown, -1 for
        other corners
    triple (k,) : the same for openings with three unknowns
    torn_sine : sine of the cone of an opening: 1, plus a margin
    """

    sine: np.ndarray
    clay: np.ndarray
    single: np.ndarray
    triple: np.ndarray
    torn_sine: float


@dataclass(frozen=True, eq=False)
class Standard:
    """Holds the problem min cost·y subject to matrix y + s = offset. The slack s is zero in the first rows, which are
    equations, and lies in the cones in the other rows.

    Rows are [load, volume of clay, cones of corners, cones of openings with three unknowns, openings with one], columns
    [velocities, dissipation of clay, openings with one unknown, openings with three].
    """

    cost: np.ndarray
    matrix: sparse.csr_matrix
    offset: np.ndarray
    corners: Corners
    rates: sparse.csr_matrix  # [volume, difference, shear] (3 k, velocities)


class _BreakdownError(ArithmeticError):
    """An iteration made no progress."""


class InteriorPointMethod:
    """Runs the interior-point method on one program, and holds its iterate and the factors of its stiffness matrix."""

    def __init__(self, standard: Standard, unit: float, tolerance: Tolerance, matrix: CornerMatrix) -> None:
        """Begin with the program in standard form, whose costs are ``unit`` times the multiplier of the loads, and the
        ``matrix`` of its normal equations; the program is solved to a ``tolerance``."""
        self.program, self.tolerance, self.stiffness_matrix = standard, tolerance, matrix
        self.smallest_multiplier, self.floor = tolerance.smallest_multiplier * unit, tolerance.floor * unit
        corners = standard.corners
        self.matrix = ProgramMatrix(standard.matrix, corners.sine, corners.clay, matrix)
        self.b, self.c = standard.offset, standard.cost
        self.load = np.asarray(standard.matrix[0].todense()).ravel()
        clays, singles, triples = (
            int(part.max(initial=-1)) + 1 for part in (corners.clay, corners.single, corners.triple)
        )
        count = len(corners.sine)
        self.first_cone_row, self.cones = 1 + clays, count + triples
        self.first_single_row = self.first_cone_row + 3 * self.cones  # first row of single openings
        self.velocities = standard.rates.shape[1]
        at_corners = corners.sine, corners.clay, corners.single, corners.triple, corners.torn_sine
        self.eliminated = *at_corners, self.velocities, clays, self.velocities + clays + singles
        self.corners = at_corners
        self.axis, self.size = np.zeros((self.cones, 3)), np.zeros(self.cones)
        self.square, self.single_scaling = np.zeros((self.cones, 3, 3)), np.zeros(singles)
        self.c_inverse = np.zeros((count, 3, 3))
        self.degree = self.cones + singles
        self.compliance = CLAY_COMPLIANCE

    def cone(self, v: np.ndarray) -> np.ndarray:
        """Return the cones of a vector of rows, as a view (cones, 3)."""
        return v[self.first_cone_row : self.first_single_row].reshape(-1, 3)

    def run(self, start: Place | None, most_iterations: int) -> Iterate:
        """Iterate until the tolerances are met or no more progress is possible, at most ``most_iterations`` times.

        If the factorisation breaks down, the best iterate that satisfies the equations is returned, if there is one.
        ``start`` is an iterate of the same mesh with another strength: an iterate well inside the cones saves half of
        the iterations; with an iterate near the solution the method often breaks down.
        """
        y, z, s = start or self.start()
        warm, criteria = start, self.tolerance
        best: Iterate | None = None
        iterations_below_gap, smallest_residual, last_halving = 0, np.inf, 0
        for iteration in range(1 + (most_iterations if start is None else min(most_iterations, MOST_WARM_ITERATIONS))):
            check_cancelled()
            ry, rz = self.matrix.transposed_times(z) + self.c, self.b - self.matrix.times(y) - s
            primal, dual = float(self.c @ y), -float(self.b @ z)
            product = float(s[self.first_cone_row :] @ z[self.first_cone_row :])
            of_velocities = np.abs(rz).max() / max(1.0, np.abs(self.b).max() + np.abs(y).max() + np.abs(s).max())
            residual = max(
                of_velocities,
                np.abs(ry).max() / max(1.0, np.abs(self.c).max() + np.abs(z).max()),
            )
            gap = max(abs(primal - dual), product) / max(abs(dual), self.smallest_multiplier)
            iterate = Iterate(y, z, s, primal, dual, gap, float(residual), iteration)
            proves = primal < self.floor and -primal > PROOF_SHARE * float(np.abs(self.c) @ np.abs(y))
            if proves and of_velocities <= min(criteria.stalled_residual, STALLED_RESIDUAL):
                best = replace(iterate, below_floor=True)
                break
            if best is None or iterate.rank(criteria.stalled_residual) < best.rank(criteria.stalled_residual):
                best = iterate
            if warm is None and product <= WARM_START_GAP * max(abs(dual), self.smallest_multiplier):
                warm = y, z, s
            if (iterate is best and residual <= criteria.residual and gap <= criteria.gap) or not np.isfinite(gap):
                break
            iterations_below_gap += gap < criteria.gap and residual > criteria.residual
            if iterations_below_gap > MOST_ITERATIONS_BELOW_GAP:
                break
            if residual < 0.5 * smallest_residual:
                smallest_residual, last_halving = float(residual), iteration
            elif smallest_residual > criteria.stalled_residual and iteration - last_halving >= STALLED_ITERATIONS:
                break
            if iteration > ITERATIONS_TO_FEASIBILITY and best.residual > FEASIBLE_RESIDUAL:  # as without a solution
                break
            tolerance = RESIDUAL_OVER_GAP * product / max(abs(dual), 1e-3)
            try:
                dy, dz, ds, steps = self.direction(ry, rz, s, z, product / self.degree, tolerance)
            except ArithmeticError:
                break
            y, s, z = y + steps[0] * dy, s + steps[0] * ds, z + steps[1] * dz
        assert best is not None
        return replace(best, iterations=iteration, warm=warm)

    def direction(
        self, ry: np.ndarray, rz: np.ndarray, s: np.ndarray, z: np.ndarray, mean: float, tolerance: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[float, float]]:
        """Return the changes of y, z and s, and the step lengths of (y, s) and z, from the residuals ``ry``, ``rz`` of
        the two equations and the ``mean`` of the products of ``s`` and ``z``; ``tolerance``: relative residual that the
        direction may have. Raises ArithmeticError without a solution."""
        if not scalings(self.cone(s), self.cone(z), self.axis, self.size, self.square):
            raise _BreakdownError
        single_s, single_z = s[self.first_single_row :], z[self.first_single_row :]
        self.single_scaling[:] = single_s / single_z
        self.factorise()

        def solved(
            d: np.ndarray, start: tuple[np.ndarray, np.ndarray] | None, allowed_residual: float, most: int
        ) -> _Trial:
            right = rz + d
            dy, dz = self.refined(-ry, right, start or self.once(-ry, right), allowed_residual, most)
            ds = -d - self.squared(dz)
            ds[: self.first_cone_row] = 0.0
            return _Trial(d, dy, dz, ds, min(1.0, self.longest(s, ds)), min(1.0, self.longest(z, dz)))

        affine = solved(
            np.concatenate([np.zeros(self.first_cone_row), s[self.first_cone_row :]]), None, PREDICTOR_RESIDUAL, 1
        )
        predicted_product = (s + affine.primal * affine.ds)[self.first_cone_row :] @ (z + affine.dual * affine.dz)[
            self.first_cone_row :
        ]
        aim = max(min(1.0, max(predicted_product / self.degree / mean, 0.0) ** 3), SMALLEST_CENTRING) * mean
        d = np.zeros(len(s))
        corrections(self.axis, self.size, self.cone(z), self.cone(affine.ds), self.cone(affine.dz), aim, self.cone(d))
        d[self.first_single_row :] = (
            single_s * single_z + affine.ds[self.first_single_row :] * affine.dz[self.first_single_row :] - aim
        ) / single_z
        best = solved(d, None, PREDICTOR_RESIDUAL, 1)
        if min(best.primal, best.dual) < SHORT_STEP:
            ry, rz = (1.0 - aim / mean) * ry, (1.0 - aim / mean) * rz
            best = solved(d, None, PREDICTOR_RESIDUAL, 1)
        for _ in range(CORRECTORS):
            if min(best.primal, best.dual) > 0.95:
                break
            corrected = solved(best.d - self.centring(s, z, best, aim), None, PREDICTOR_RESIDUAL, 1)
            if corrected.primal + corrected.dual < best.primal + best.dual + 0.1 * LENGTH_GAIN:
                break
            best = corrected
        allowed_residual = min(LARGEST_RESIDUAL, max(SMALLEST_RESIDUAL, tolerance))
        start: tuple[np.ndarray, np.ndarray] | None = (best.dy, best.dz)
        for _ in range(DIRECTION_ATTEMPTS):
            best = solved(best.d, start, allowed_residual, MOST_REFINEMENTS)
            if self.is_exact(-ry, rz + best.d, best, allowed_residual):
                break
            self.factorise()
            start = None
        steps = tuple(min(1.0, STEP_SHARE * self.longest(v, dv)) for v, dv in ((s, best.ds), (z, best.dz)))
        if not np.isfinite(sum(steps)) or max(steps) < 1e-6:
            raise _BreakdownError
        return best.dy, best.dz, best.ds, (steps[0], steps[1])

    def is_exact(self, ry: np.ndarray, rz: np.ndarray, trial: "_Trial", within: float) -> bool:
        """Return whether the direction ``trial`` solves its equations with the right-hand sides ``ry``, ``rz`` well
        enough; if the relative residual is above ``within``, change the compliance δ."""
        ey, ez = (float(np.abs(error).max()) for error in self.errors(ry, rz, trial.dy, trial.dz))
        beyond = max(ey, ez) / (1e-12 + within * max(np.abs(ry).max(), np.abs(rz).max()))
        grows = ey > max(np.abs(ry).max(), EQUILIBRIUM_RESIDUAL)
        if beyond > 1.0 or grows:
            ratio = COMPLIANCE_RATIO if ey > ez or grows else 1.0 / COMPLIANCE_RATIO
            self.compliance = min(max(self.compliance * ratio, SMALLEST_COMPLIANCE), LARGEST_COMPLIANCE)
        return bool(beyond <= POOR_RESIDUAL_RATIO)

    def errors(self, ry: np.ndarray, rz: np.ndarray, dy: np.ndarray, dz: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return ry - Aᵀ dz and rz - A dy + W² dz."""
        return ry - self.matrix.transposed_times(dz), rz - self.matrix.times(dy) + self.squared(dz)

    def centring(self, s: np.ndarray, z: np.ndarray, trial: "_Trial", aim: float) -> np.ndarray:
        """Return Gondzio's corrector, which centres the products of ``s`` and ``z`` that a longer step along ``trial``
        would move far from their target mean ``aim``."""
        s_next = s + min(1.0, trial.primal + LENGTH_GAIN) * trial.ds
        z_next = z + min(1.0, trial.dual + LENGTH_GAIN) * trial.dz
        residual = np.zeros(len(s))
        cones = (self.cone(v) for v in (z, s_next, z_next))
        centrality(self.axis, self.size, *cones, aim, SMALLEST_PRODUCT, LARGEST_PRODUCT, self.cone(residual))
        product = s_next[self.first_single_row :] * z_next[self.first_single_row :]
        correction = np.clip(product, SMALLEST_PRODUCT * aim, LARGEST_PRODUCT * aim) - product
        residual[self.first_single_row :] = np.maximum(correction, -LARGEST_PRODUCT * aim) / z[self.first_single_row :]
        return residual

    def longest(self, v: np.ndarray, dv: np.ndarray) -> float:
        """Return the largest step after which all of v is still in its cones."""
        lone, change = v[self.first_single_row :], dv[self.first_single_row :]
        shrink = change < 0.0
        alone = (-lone[shrink] / change[shrink]).min(initial=1e30)
        return float(min(longest_step(self.cone(v), self.cone(dv)), alone))

    def squared(self, v: np.ndarray) -> np.ndarray:
        """Return W² v, with W the scaling matrix of the cones; the result is zero in the rows of equations, which come
        first."""
        squares = np.zeros(len(v))
        add_products(self.square, self.cone(v), self.cone(squares))
        squares[self.first_single_row :] = self.single_scaling * v[self.first_single_row :]
        return squares

    def factorise(self) -> None:
        """Factorise the stiffness matrix, and solve for the load."""
        stiffnesses(self.axis, self.size, self.single_scaling, *self.corners, self.compliance, self.c_inverse)
        self.stiffness_matrix.factorise(self.c_inverse)
        self.to_load = self.without_load(self.load, np.zeros(len(self.b)))
        self.load_work = float(self.load @ self.to_load[0])
        if not self.load_work > 0.0:
            raise _BreakdownError

    def without_load(self, ry: np.ndarray, rz: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solve Aᵀ dz = ry, A dy - W² dz = rz, where A lacks its first row, which holds the load."""
        g, force = np.empty((2, len(self.corners[0]), 3))
        dy, dz = np.zeros(len(ry)), np.zeros(len(rz))
        at = self.c_inverse, self.square, self.single_scaling, *self.eliminated
        condense(ry, rz, *at, g, force)
        n = self.velocities
        right = ry[:n].copy()
        self.stiffness_matrix.add_forces(force, right)
        dy[:n] = self.stiffness_matrix.solve(right)
        expand(self.stiffness_matrix.rates(dy[:n]), g, ry, rz, *at, dy, dz)
        return dy, dz

    def once(self, ry: np.ndarray, rz: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the solution dy, dz of Aᵀ dz = ry, A dy - W² dz = rz, where the first row of A holds the load."""
        dy, dz = self.without_load(ry, rz)
        multiplier = (float(self.load @ dy) - rz[0]) / self.load_work
        dy -= multiplier * self.to_load[0]
        dz -= multiplier * self.to_load[1]
        dz[0] = multiplier
        return dy, dz

    def refined(
        self, ry: np.ndarray, rz: np.ndarray, start: tuple[np.ndarray, np.ndarray], within: float, most: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Refine the solution ``start`` until its residual is ``within`` of the right-hand sides ``ry``, ``rz``, or no
        longer falls, in ``most`` corrections at most.

        Each correction minimises the residual over all corrections so far (Eisenstat, Elman & Schultz 1983). Simple
        iterative refinement would converge slowly, because the factors contain a compliance δ of clay and rounding.
        """
        (dy, dz), size = start, max(np.abs(ry).max(), np.abs(rz).max())
        ey, ez = self.errors(ry, rz, dy, dz)
        before: list[tuple[np.ndarray, ...]] = []
        for _ in range(most):
            error = max(np.abs(ey).max(), np.abs(ez).max())
            if error <= 1e-12 + within * size or not np.isfinite(error):
                break
            y, z = self.once(ey, ez)
            image_y, image_z = self.matrix.transposed_times(z), self.matrix.times(y) - self.squared(z)
            for old_y, old_z, old_image_y, old_image_z in before:
                share = image_y @ old_image_y + image_z @ old_image_z
                y, z = y - share * old_y, z - share * old_z
                image_y, image_z = image_y - share * old_image_y, image_z - share * old_image_z
            length = np.sqrt(image_y @ image_y + image_z @ image_z)
            if not length > 0.0:
                break
            y, z, image_y, image_z = y / length, z / length, image_y / length, image_z / length
            before.append((y, z, image_y, image_z))
            share = ey @ image_y + ez @ image_z
            dy, dz = dy + share * y, dz + share * z
            ey, ez = ey - share * image_y, ez - share * image_z
            if not max(np.abs(ey).max(), np.abs(ez).max()) < LARGEST_REDUCTION * error:
                break
        return dy, dz

    def start(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the y, z and s of least norm that fulfil the equations, moved into the cones (Mehrotra 1992)."""
        squares = self.program.matrix.multiply(self.program.matrix).sum(axis=1)
        rows = np.sqrt(np.asarray(squares).ravel())
        weight = np.maximum(self.cone(rows).max(axis=1), 1e-12)
        lone = np.maximum(rows[self.first_single_row :], 1e-12)
        self.axis[:], self.size[:] = [1.0, 0.0, 0.0], weight
        self.square[:] = np.eye(3) * (weight**2)[:, None, None]
        self.single_scaling[:] = lone**2
        self.factorise()
        nothing = np.zeros(len(self.c)), np.zeros(len(self.b))
        y, z_of_y = self.refined(nothing[0], self.b, self.once(nothing[0], self.b), 1e-8, MOST_REFINEMENTS)
        _, z = self.refined(-self.c, nothing[1], self.once(-self.c, nothing[1]), 1e-8, MOST_REFINEMENTS)
        s = -self.squared(z_of_y)
        return y, self.led_inside(z, weight, lone), self.led_inside(s, 1.0 / weight, 1.0 / lone)

    def led_inside(self, v: np.ndarray, weight: np.ndarray, lone: np.ndarray) -> np.ndarray:
        """Return a vector of rows over the weights, moved along the axes of all cones until it is inside them."""
        v = v.copy()
        cone, rest = self.cone(v), v[self.first_single_row :]
        cone *= weight[:, None]
        rest *= lone
        least = float(min((cone[:, 0] - np.hypot(cone[:, 1], cone[:, 2])).min(), rest.min(initial=np.inf)))
        usual = float(np.sqrt((cone * cone).sum() / len(cone)))
        inside = float(np.clip(max(usual, -least), SMALLEST_SHIFT, LARGEST_SHIFT))
        if least < INTERIOR_SHARE * inside:
            cone[:, 0] += inside - least
            rest += inside - least
        cone /= weight[:, None]
        rest /= lone
        return v


@dataclass(frozen=True, eq=False)
class _Trial:
    """Holds a search direction of the interior-point method: the residuals that the direction corrects, the changes of
    the variables, and the longest primal and dual steps along it (at most 1)."""

    d: np.ndarray
    dy: np.ndarray
    dz: np.ndarray
    ds: np.ndarray
    primal: float
    dual: float
