"""A path of equilibria, step by step, with growth and cut-back of the step, and rests to let the overstress go."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fem.continuation import Constraint, Found, Loading, NewtonSettings, follow, residual_of
from fem.plane_strain import PlaneStrain


@dataclass(frozen=True)
class PathSettings:
    """How to walk. Lengths are in units of the path length; see ``Walk``.

    ``relaxation`` is the path length over which the overstress decays; 0 for none. A rest lasts ``rest`` times that
    and is repeated, ``most_rests`` times at most, until the forces balance without overstress to ``rest_tolerance`` of
    the weight; ``give_way`` are the shares by which the factor is lowered in a rest that sets it. Steps grow by
    ``growth`` while Newton needs no more than ``few`` iterations, and by ``shrink`` if it needs more than ``many``.
    """

    newton: NewtonSettings = field(default_factory=NewtonSettings)
    first: float = 0.08
    largest: float = 0.3
    smallest: float = 1e-5
    growth: float = 1.5
    shrink: float = 0.7
    few: int = 6
    many: int = 12
    relaxation: float = 0.0
    rest: float = 30.0
    most_rests: int = 6
    rest_tolerance: float = 2e-3
    give_way: tuple[float, ...] = (0.0, 0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04)
    longest: int = 400


@dataclass(frozen=True)
class Step:
    """A step of the path, for the record; ``displacement`` (m) is the control's, from the start of the path.

    ``at_rest`` steps let overstress go; ``balanced`` says that afterwards the forces balanced without any.
    """

    length: float
    displacement: float
    factor: float
    iterations: int
    residual: float
    plastic_share: float
    cutbacks: int
    at_rest: bool
    balanced: bool = False


@dataclass
class Walk:
    """A walk along a path of ``problem`` under ``loading``.

    ``control`` (a vector, a·u in m) and ``reference`` (m) measure the displacement, ``share`` is the β that the load
    factor has in the path length, ``scale`` (N/m) makes residuals dimensionless.
    """

    problem: PlaneStrain
    loading: Loading
    control: np.ndarray
    reference: float
    scale: float
    settings: PathSettings
    share: float = 0.0
    factor: float = 0.0
    length: float = 0.0
    displacement: float = 0.0
    steps: list[Step] = field(default_factory=list)
    solves: int = 0
    reason: str = ""
    _last: tuple[np.ndarray, float, float] | None = None

    def __post_init__(self) -> None:
        self.start = self.factor
        self._step = self.settings.first
        self._elastic: tuple[np.ndarray, float] | None = None

    def advance(self) -> bool:
        """One step along the path, cut back as often as it takes; False (with ``reason``) if there is none."""
        cutbacks = 0
        while True:
            if self._step < self.settings.smallest:
                self.reason = "no equilibrium was found even with the smallest step"
                return False
            found = self._try(self._step)
            if found.converged:
                break
            cutbacks += 1
            self._step *= 0.5
        taken = self._step
        self._accept(found, taken, cutbacks, at_rest=False)
        if found.iterations <= self.settings.few:
            self._step = min(self._step * self.settings.growth, self.settings.largest)
        elif found.iterations > self.settings.many:
            self._step *= self.settings.shrink
        return True

    def rest(self) -> bool:
        """Let the overstress go; True if what is left is an equilibrium without it.

        Where the load is a force the displacement stays and the load factor gives way. Ground that is weakened does not
        feel the factor where it is elastic, so there the factor is set, as high as the ground then stands.
        """
        if self.settings.relaxation <= 0.0:
            return True
        if self.share > 0.0:
            return any(self.reach(self.factor * (1.0 - less)) for less in self.settings.give_way)
        return self._let_go(Constraint(self.control / self.reference, 0.0, 0.0))

    def reach(self, factor: float) -> bool:
        """Go to a given load factor, at rest there; False, and nothing accepted, if no equilibrium is found."""
        increment = np.zeros_like(self.control)
        if self._last is not None and self._last[2] > 0.0:
            increment = self._last[0] * (factor - self.factor) / self._last[2]
        mark = self.mark()
        self.problem.overstress = self._overstress(self._step)
        found = self._newton(factor, increment, None)
        at_once = self.settings.relaxation <= 0.0
        if found.converged:
            self._accept(found, self._moved(found), 0, at_rest=at_once)
        if found.converged and (at_once or self._let_go(None)):
            self._last = None
            return True
        self.back(mark)
        return False

    def _let_go(self, constraint: Constraint | None) -> bool:
        """Rest until the forces balance without overstress; False if that does not come about.

        The load factor stays unless a ``constraint`` holds the displacement instead.
        """
        for _ in range(self.settings.most_rests):
            self.problem.overstress = 1.0 / (1.0 + self.settings.rest)
            found = self._newton(self.factor, np.zeros_like(self.control), constraint)
            if not found.converged:
                return False
            moved = 0.0 if constraint else self._moved(found)
            self._accept(found, moved, 0, at_rest=True)
            if self._unbalanced_without_overstress() <= self.settings.rest_tolerance:
                self.steps[-1] = replace(self.steps[-1], balanced=True)
                return True
        return False

    def _unbalanced_without_overstress(self) -> float:
        """The residual that the accepted state would have if its stress returned to the yield surface."""
        self.problem.overstress = 0.0
        return residual_of(self.problem, self.loading, np.zeros_like(self.control), self.factor, self.scale)[1]

    def _moved(self, found: Found) -> float:
        """How far a step has gone along the path."""
        moved = self.problem.exchange.dot(self.control, found.increment) / self.reference
        return moved + self.share * (found.factor - self.factor)

    def mark(self) -> tuple[Any, ...]:
        """The place on the path, for ``back``."""
        return (
            self.problem.state(), self.factor, self.length, self.displacement, len(self.steps), self._last, self._step,
        )  # fmt: skip

    def back(self, mark: tuple[Any, ...]) -> None:
        """Go back to a place on the path."""
        state, self.factor, self.length, self.displacement, steps, self._last, self._step = mark
        self.problem.restore(state)
        del self.steps[steps:]

    def _overstress(self, step: float) -> float:
        relaxation = self.settings.relaxation
        return relaxation / (relaxation + step) if relaxation > 0.0 else 0.0

    def _try(self, step: float) -> Found:
        self.problem.overstress = self._overstress(step)
        if self._last is None:
            first, change = self._elastic_guess(step)
        else:
            last, length, last_change = self._last
            first, change = last * (step / length), last_change * (step / length)
        return self._newton(self.factor + change, first, Constraint(self.control / self.reference, self.share, step))

    def _elastic_guess(self, step: float) -> tuple[np.ndarray, float]:
        """Increment and change of the load factor of an elastic step."""
        if self._elastic is None:
            zero = np.zeros_like(self.control)
            self.problem.use_elastic_tangent()
            self.problem.factorise()
            along = self.problem.solve(self.loading.derivative(self.problem, zero, self.factor))
            moved = self.problem.exchange.dot(self.control, along) / self.reference
            self._elastic = along, moved + self.share
        along, length = self._elastic
        return along * (step / length), step / length

    def _newton(self, factor: float, first: np.ndarray, constraint: Constraint | None) -> Found:
        found = follow(self.problem, self.loading, factor, first, constraint, self.scale, self.settings.newton)
        self.solves += found.iterations
        return found

    def _accept(self, found: Found, length: float, cutbacks: int, at_rest: bool) -> None:
        share = self.problem.plastic_share()
        self.problem.accept(found.increment)
        if length > 0.0:
            self._last = found.increment, length, found.factor - self.factor
        self.factor = found.factor
        self.length += length
        self.displacement += self.problem.exchange.dot(self.control, found.increment)
        self.steps.append(
            Step(
                self.length, self.displacement, self.factor, found.iterations, found.residual, share, cutbacks, at_rest
            )
        )
