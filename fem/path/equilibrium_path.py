"""Follows a path of equilibria with adaptive steps and relaxation of the overstress.

Where the flow is not associated, every step has a small overstress (``fem/kernels/viscoplastic.py``), which makes its
solution unique. Relaxation then lets the overstress decay, after which stresses on the yield surface have to be in
equilibrium.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fem.continuum.plane_strain import PlaneStrain
from fem.path.newton import Constraint, Loading, NewtonResult, NewtonSettings, find_equilibrium, residual_of
from fem.path.path_step import PathStep

# The smallest step, and the factors of the step size after a step with few or with many iterations.
SMALLEST_STEP, STEP_GROWTH, FEW_ITERATIONS, STEP_REDUCTION, MANY_ITERATIONS = 1e-5, 1.5, 6, 0.7, 12
# The length of a relaxation over that in which the overstress decays, the largest number of relaxations until there is
# equilibrium without overstress, and the norm of the force that is then unbalanced, over that of the weight.
RELAXATION_SPAN, MOST_RELAXATIONS, RELAXED_TOLERANCE = 30.0, 6, 2e-3
# Reductions of the multiplier, as shares, that are tried in this order until there is equilibrium without overstress.
MULTIPLIER_REDUCTIONS = (0.0, 0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04)


@dataclass(frozen=True)
class PathSettings:
    """Holds the step sizes and the relaxation of a path. Lengths are arc lengths, see ``EquilibriumPath``.

    Attributes
    ----------
    newton : settings of Newton's method within a step
    first_step, largest_step : first and largest step (-)
    relaxation : arc length over which the overstress decays (-); 0 for no overstress
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    first_step: float = 0.08
    largest_step: float = 0.3
    relaxation: float = 0.0


@dataclass
class EquilibriumPath:
    """Follows the equilibrium path of ``problem`` under ``loading``, and holds the last equilibrium found on it.

    Attributes
    ----------
    problem : the ground, with the state of equilibrium last accepted
    loading : the load, or strength, that the multiplier scales
    control (dofs,) : vector a whose product with the displacement, a·u, is the control displacement (m)
    reference : displacement (m) that is one unit of arc length
    scale : force (N/m) by which residuals are divided
    settings : settings that determine how the path is followed
    beta : weight of the load multiplier in the arc length (-)
    factor : load multiplier λ reached (-)
    length : arc length so far (-)
    displacement : control displacement reached (m)
    steps : the record of every step
    solves : linear systems factorised so far
    reason : reason why the path could not be followed further
    """

    problem: PlaneStrain
    loading: Loading
    control: np.ndarray
    reference: float
    scale: float
    settings: PathSettings
    beta: float = 0.0
    factor: float = 0.0
    length: float = 0.0
    displacement: float = 0.0
    steps: list[PathStep] = field(default_factory=list)
    solves: int = 0
    reason: str = ""
    _last: tuple[np.ndarray, float, float] | None = None

    def __post_init__(self) -> None:
        self.start = self.factor
        self._step = self.settings.first_step
        self._elastic: tuple[np.ndarray, float] | None = None

    def advance(self) -> bool:
        """Take one step along the path, halved until it converges; return False (with ``reason``) if no step
        converges."""
        cutbacks = 0
        while True:
            if self._step < SMALLEST_STEP:
                self.reason = "no equilibrium was found even with the smallest step"
                return False
            result = self._try(self._step)
            if result.converged:
                break
            cutbacks += 1
            self._step *= 0.5
        step_taken = self._step
        self._accept(result, step_taken, cutbacks, at_rest=False)
        if result.iterations <= FEW_ITERATIONS:
            self._step = min(self._step * STEP_GROWTH, self.settings.largest_step)
        elif result.iterations > MANY_ITERATIONS:
            self._step *= STEP_REDUCTION
        return True

    def relax(self) -> bool:
        """Relax the overstress; return True if the state without overstress is in equilibrium.

        If the multiplier scales a load, the control displacement is constant and the multiplier falls. If the
        multiplier scales the strength, elastic ground does not respond to the multiplier, which is then prescribed and
        reduced until the ground is in equilibrium.
        """
        if self.settings.relaxation <= 0.0:
            return True
        if self.beta > 0.0:
            return any(self.reach(self.factor * (1.0 - reduction)) for reduction in MULTIPLIER_REDUCTIONS)
        return self._relax(Constraint(self.control / self.reference, 0.0, 0.0))

    def reach(self, factor: float) -> bool:
        """Find equilibrium at a given multiplier, without overstress. Return False, with the state unchanged, if there
        is no equilibrium. The first guess is the last increment scaled with the multiplier, which saves a quarter of
        the iterations. After a relaxation the first guess is zero.
        """
        increment = np.zeros_like(self.control)
        if self._last is not None and self._last[2] > 0.0:
            increment = self._last[0] * (factor - self.factor) / self._last[2]
        mark = self.mark()
        self.problem.overstress = self._overstress(self._step)
        result = self._newton(factor, increment, None)
        rate_independent = self.settings.relaxation <= 0.0
        if result.converged:
            self._accept(result, self._length_of(result), 0, at_rest=False)
        if result.converged and (rate_independent or self._relax(None)):
            if not rate_independent:
                self._last = None
            return True
        self.back(mark)
        return False

    def _relax(self, constraint: Constraint | None) -> bool:
        """Relax the overstress until the forces balance without it; return False if they do not.

        The load multiplier is constant, unless a ``constraint`` prescribes the control displacement.
        """
        for _ in range(MOST_RELAXATIONS):
            self.problem.overstress = 1.0 / (1.0 + RELAXATION_SPAN)
            result = self._newton(self.factor, np.zeros_like(self.control), constraint)
            if not result.converged:
                return False
            length = 0.0 if constraint else self._length_of(result)
            self._accept(result, length, 0, at_rest=True)
            if self._unbalanced_without_overstress() <= RELAXED_TOLERANCE:
                self.steps[-1] = replace(self.steps[-1], balanced=True)
                return True
        return False

    def _unbalanced_without_overstress(self) -> float:
        """Return the residual that the accepted state would have if its stress returned to the yield surface."""
        self.problem.overstress = 0.0
        return residual_of(self.problem, self.loading, np.zeros_like(self.control), self.factor, self.scale)[1]

    def _length_of(self, result: NewtonResult) -> float:
        """Return the arc length of a step."""
        moved = self.problem.exchange.dot(self.control, result.increment) / self.reference
        return moved + self.beta * (result.multiplier - self.factor)

    def mark(self) -> tuple[Any, ...]:
        """Return the present place on the path, for ``back``."""
        return (
            self.problem.state(), self.factor, self.length, self.displacement, len(self.steps), self._last, self._step,
        )  # fmt: skip

    def back(self, mark: tuple[Any, ...]) -> None:
        """Go back to a place on the path that ``mark`` returned."""
        state, self.factor, self.length, self.displacement, steps, self._last, self._step = mark
        self.problem.restore(state)
        del self.steps[steps:]

    def _overstress(self, step: float) -> float:
        """Return the weight b of the elastic stress in a step, Simo & Hughes 1998, eq. 2.7.16."""
        relaxation = self.settings.relaxation
        return relaxation / (relaxation + step) if relaxation > 0.0 else 0.0

    def _try(self, step: float) -> NewtonResult:
        self.problem.overstress = self._overstress(step)
        if self._last is None:
            first, change = self._elastic_guess(step)
        else:
            last, length, last_change = self._last
            first, change = last * (step / length), last_change * (step / length)
        return self._newton(self.factor + change, first, Constraint(self.control / self.reference, self.beta, step))

    def _elastic_guess(self, step: float) -> tuple[np.ndarray, float]:
        """Return the increment and the change of the multiplier of an elastic step."""
        if self._elastic is None:
            zero = np.zeros_like(self.control)
            self.problem.use_elastic_tangent()
            self.problem.factorise()
            load_displacement = self.problem.solve(self.loading.derivative(self.problem, zero, self.factor))
            moved = self.problem.exchange.dot(self.control, load_displacement) / self.reference
            self._elastic = load_displacement, moved + self.beta
        load_displacement, length = self._elastic
        return load_displacement * (step / length), step / length

    def _newton(self, factor: float, first: np.ndarray, constraint: Constraint | None) -> NewtonResult:
        newton = self.settings.newton
        result = find_equilibrium(self.problem, self.loading, factor, first, constraint, self.scale, newton)
        self.solves += result.iterations
        return result

    def _accept(self, end: NewtonResult, length: float, cutbacks: int, at_rest: bool) -> None:
        share = self.problem.plastic_share()
        self.problem.accept(end.increment)
        if length > 0.0:
            self._last = end.increment, length, end.multiplier - self.factor
        self.factor = end.multiplier
        self.length += length
        self.displacement += self.problem.exchange.dot(self.control, end.increment)
        self.steps.append(
            PathStep(
                self.length, self.displacement, self.factor, end.iterations, end.residual, share, cutbacks, at_rest
            )
        )
