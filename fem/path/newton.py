"""Finds equilibrium by Newton's method under a load whose multiplier may itself be an unknown (arc-length
continuation).

The path of equilibria is parametrised by its arc length l, which grows whatever the load multiplier λ does:

    a·u / reference + β λ = l,

with the control displacement a·u (m), which is work-conjugate to the load, and a reference displacement (m).
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem.continuum.linear_solver import SingularMatrixError
from fem.continuum.plane_strain import PlaneStrain
from fem.path.line_search import LineSearch
from fem.path.nonlinear_elimination import LocalSubproblem

# Newton's method ends after this number of iterations without progress. Progress is a residual below this ratio of the
# best residual.
MOST_STALLED, PROGRESS_RATIO = 8, 0.9
# Where there is a potential: if the line search takes less than this share of a correction, nonlinear elimination
# solves the equations of a few cells separately.
ELIMINATION_STEP = 0.5
DIVISOR_DIFFERENCE = 1e-4  # of the divisor of the strength, for the difference quotient


@dataclass(frozen=True)
class NewtonSettings:
    """Holds criteria of convergence of Newton's method, and limits of its iterations.

    Attributes
    ----------
    tolerance : norm of the unbalanced force over that of the weight (-) at which a state is in equilibrium
    iterations : largest number of iterations of a step
    line_search : largest number of halvings of a correction that does not reduce the unbalanced force
    descents : largest number of iterations of a step where the potential of associated flow is minimised
    """

    tolerance: float = 1e-6
    iterations: int = 20
    line_search: int = 2
    descents: int = 120


class Loading(Protocol):
    """Defines what the load multiplier λ scales: a load, or the strength of the ground."""

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        """Return external minus internal nodal forces (N/m)."""
        ...

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        """Return the derivative of the unbalanced force with respect to the multiplier (N/m)."""
        ...


@dataclass(frozen=True)
class ProportionalLoad:
    """Scales a proportional load: nodal forces ``constant`` + λ ``variable``.

    Attributes
    ----------
    constant, variable (dofs,) : nodal forces (N/m)
    """

    constant: np.ndarray
    variable: np.ndarray

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        return self.constant + multiplier * self.variable - problem.internal_force(increment)

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        return self.variable


@dataclass(frozen=True)
class StrengthReduction:
    """Reduces the strength: cohesion and tan φ of ground under constant nodal forces are divided by λ.

    Attributes
    ----------
    constant (dofs,) : nodal forces (N/m)
    """

    constant: np.ndarray

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        if multiplier <= 0.0:  # a correction of Newton's method that is too long: the line search shortens it
            return np.full_like(self.constant, np.inf)
        problem.use_strength(multiplier)
        return self.constant - problem.internal_force(increment)

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, multiplier: float) -> np.ndarray:
        """Return the derivative by a finite difference; the tangent of the problem is unchanged."""
        problem.use_strength(multiplier + DIVISOR_DIFFERENCE)
        weaker = problem.internal_force(increment, tangent=False)
        problem.use_strength(multiplier)
        return (problem.internal_force(increment, tangent=False) - weaker) / DIVISOR_DIFFERENCE


@dataclass(frozen=True)
class Constraint:
    """Holds the condition under which the load multiplier is an unknown: control·Δu + beta Δλ = target.

    Attributes
    ----------
    control (dofs,) : vector of the control displacement over the reference displacement (1/m)
    beta : weight of the load multiplier in the arc length (-)
    target : arc length of the step (-)
    """

    control: np.ndarray
    beta: float
    target: float


@dataclass(frozen=True)
class NewtonResult:
    """Holds the result of Newton's method.

    Attributes
    ----------
    converged : whether the residual is below the tolerance
    iterations : number of linear systems factorised
    residual : norm of the unbalanced force over the scale (-)
    multiplier : the load multiplier λ (-)
    increment (dofs,) : displacement since the last accepted state (m)
    """

    converged: bool
    iterations: int
    residual: float
    multiplier: float
    increment: np.ndarray


def residual_of(
    problem: PlaneStrain, loading: Loading, increment: np.ndarray, multiplier: float, scale: float
) -> tuple[np.ndarray, float]:
    """Return the unbalanced force (N/m) of the free components, and the norm of this force over ``scale`` (N/m).

    ``problem`` are the elements; ``loading`` gives the forces at a load multiplier; ``increment`` is the displacement
    increment (m); ``multiplier`` is the load multiplier (-).
    """
    unbalanced = loading.unbalanced(problem, increment, multiplier)
    unbalanced[~problem.free] = 0.0
    return unbalanced, problem.exchange.norm(unbalanced) / scale


def find_equilibrium(
    problem: PlaneStrain,
    loading: Loading,
    multiplier: float,
    first: np.ndarray,
    constraint: Constraint | None,
    scale: float,
    settings: NewtonSettings,
) -> NewtonResult:
    """Find the displacement increment of equilibrium and, under a ``constraint``, the load multiplier.

    Starts from the increment ``first`` (m) and ``multiplier``, which fulfil the constraint; without a constraint the
    multiplier is constant. ``scale`` (N/m) makes the residual dimensionless. With the tangent stiffness K, K a = r and
    K b = dr/dλ, the correction is a + dλ b (block elimination, Batoz & Dhatt 1979, eq. 12). Associated flow under a
    given multiplier has a convex potential, and Newton's method with a line search converges from any start.
    ``problem``: the elements; ``loading``: forces at a load multiplier; ``settings``: tolerance and iterations.
    """
    if constraint is None and problem.associated:
        return _lowest(problem, loading, multiplier, first, scale, settings)
    dot = problem.exchange.dot
    increment = first
    residual, norm = residual_of(problem, loading, increment, multiplier, scale)
    best, stalled, iteration = norm, 0, 0
    while norm > settings.tolerance and iteration < settings.iterations and stalled < MOST_STALLED:
        iteration += 1
        change = 0.0
        try:
            problem.factorise()
            step = problem.solve(residual)
            if constraint is not None:
                load_displacement = problem.solve(loading.derivative(problem, increment, multiplier))
                response = dot(constraint.control, load_displacement) + constraint.beta
                # Strength reduction does not change ground that is elastic everywhere: then λ stays as it is.
                change = -dot(constraint.control, step) / response if response != 0.0 else 0.0
                step = step + change * load_displacement
        except SingularMatrixError:
            break
        part = 1.0
        for _ in range(settings.line_search + 1):
            residual, new_residual = residual_of(
                problem, loading, increment + part * step, multiplier + part * change, scale
            )
            if new_residual < norm:
                break
            part *= 0.5
        else:
            part *= 2.0
        increment, multiplier, norm = increment + part * step, multiplier + part * change, new_residual
        if not np.isfinite(norm):
            break
        stalled = 0 if norm < PROGRESS_RATIO * best else stalled + 1
        best = min(best, norm)
    return NewtonResult(bool(norm <= settings.tolerance), iteration, norm, multiplier, increment)


def _lowest(
    problem: PlaneStrain, loading: Loading, multiplier: float, first: np.ndarray, scale: float, settings: NewtonSettings
) -> NewtonResult:
    """Find equilibrium under a given ``multiplier`` as the minimum of the potential of associated flow.

    The unbalanced force is the negative gradient of this potential (Ortiz & Stainier 1999): every correction reduces
    the potential, though the unbalanced force may grow on the way. Where the line search shortens a correction, the
    cells that cause this are solved separately (on one rank).
    """
    increment, iteration = first, 0
    residual, norm = residual_of(problem, loading, increment, multiplier, scale)
    while norm > settings.tolerance and iteration < settings.descents:
        iteration += 1
        try:
            problem.factorise()
            step = problem.solve(residual)
        except SingularMatrixError:
            break
        search = LineSearch(problem.exchange.dot(residual, step))
        while True:
            residual, norm = residual_of(problem, loading, increment + search.step_length * step, multiplier, scale)
            if search.ends(problem.exchange.dot(residual, step)):
                break
        increment = increment + search.step_length * step
        if not np.isfinite(norm):
            break
        if norm > settings.tolerance and search.step_length < ELIMINATION_STEP and problem.grid.comm.size == 1:
            increment = LocalSubproblem(problem, residual).at_rest(increment, residual)
            residual, norm = residual_of(problem, loading, increment, multiplier, scale)
    return NewtonResult(bool(norm <= settings.tolerance), iteration, norm, multiplier, increment)
