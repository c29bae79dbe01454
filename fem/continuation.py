"""Newton's method along a path of equilibria, on which the load factor is an unknown.

A path is followed by its length l, which grows whatever the load factor λ does:

    a·u / reference + β λ = l,

with the control a·u, the displacement that is work-conjugate to the load, and a reference displacement (m).
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem.linear_solver import SingularMatrixError
from fem.plane_strain import PlaneStrain


@dataclass(frozen=True)
class NewtonSettings:
    """``tolerance`` is the norm of the unbalanced force over that of the weight."""

    tolerance: float = 1e-6
    iterations: int = 20
    line_search: int = 2


class Loading(Protocol):
    """What the load factor scales."""

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        """External minus internal nodal forces (N/m)."""
        ...

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        """Change of the unbalanced force with the load factor."""
        ...


@dataclass(frozen=True)
class Forces:
    """Nodal forces ``fixed`` + λ ``load``."""

    fixed: np.ndarray
    load: np.ndarray

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        return self.fixed + factor * self.load - problem.internal_force(increment)

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        return self.load


@dataclass(frozen=True)
class WeakerGround:
    """Nodal forces that stay, on ground whose cohesion and tan φ are divided by λ."""

    fixed: np.ndarray
    difference: float = 1e-4

    def unbalanced(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        problem.use_strength(factor)
        return self.fixed - problem.internal_force(increment)

    def derivative(self, problem: PlaneStrain, increment: np.ndarray, factor: float) -> np.ndarray:
        """By a difference in λ; leaves the tangent of the problem as it was."""
        problem.use_strength(factor + self.difference)
        weaker = problem.internal_force(increment, tangent=False)
        problem.use_strength(factor)
        return (problem.internal_force(increment, tangent=False) - weaker) / self.difference


@dataclass(frozen=True)
class Constraint:
    """``control``·u + ``share`` λ changes by ``target`` over the step; None for the whole: λ is given."""

    control: np.ndarray
    share: float
    target: float


@dataclass(frozen=True)
class Found:
    """What Newton's method ended with."""

    converged: bool
    iterations: int
    residual: float
    factor: float
    increment: np.ndarray


def residual_of(
    problem: PlaneStrain, loading: Loading, increment: np.ndarray, factor: float, scale: float
) -> tuple[np.ndarray, float]:
    """The unbalanced force (N/m) where nothing is held, and its norm over ``scale`` (N/m)."""
    unbalanced = loading.unbalanced(problem, increment, factor)
    unbalanced[~problem.free] = 0.0
    return unbalanced, problem.exchange.norm(unbalanced) / scale


def follow(
    problem: PlaneStrain,
    loading: Loading,
    factor: float,
    first: np.ndarray,
    constraint: Constraint | None,
    scale: float,
    settings: NewtonSettings,
) -> Found:
    """Find the displacement increment and, under a ``constraint``, the load factor of equilibrium.

    Starts from the increment ``first`` and from ``factor``, which fulfil the constraint. ``scale`` (N/m) makes the
    residual dimensionless. With K the tangent, K a = r and K b = dr/dλ, the correction is a + dλ b (block
    elimination, Batoz & Dhatt 1979, eq. 12).
    """
    dot = problem.exchange.dot
    increment = first
    residual, norm = residual_of(problem, loading, increment, factor, scale)
    best, stalled, iteration = norm, 0, 0
    while norm > settings.tolerance and iteration < settings.iterations and stalled < 8:
        iteration += 1
        change = 0.0
        try:
            problem.factorise()
            step = problem.solve(residual)
            if constraint is not None:
                along = problem.solve(loading.derivative(problem, increment, factor))
                response = dot(constraint.control, along) + constraint.share
                # Ground that does not feel the load factor at all (elastic, and only weakened) leaves it as it is.
                change = -dot(constraint.control, step) / response if response != 0.0 else 0.0
                step = step + change * along
        except SingularMatrixError:
            break
        part = 1.0
        for _ in range(settings.line_search + 1):
            residual, new = residual_of(problem, loading, increment + part * step, factor + part * change, scale)
            if new < norm:
                break
            part *= 0.5
        else:
            part *= 2.0
        increment, factor, norm = increment + part * step, factor + part * change, new
        if not np.isfinite(norm):
            break
        stalled = 0 if norm < 0.9 * best else stalled + 1
        best = min(best, norm)
    return Found(bool(norm <= settings.tolerance), iteration, norm, factor, increment)
