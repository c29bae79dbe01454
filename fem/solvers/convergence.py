"""Defines the criteria at which an interior-point method ends, and its iterates."""

from dataclasses import dataclass

import numpy as np

# Residual that is accepted if iterations no longer reduce it (-).
STALLED_RESIDUAL = 1e-8


@dataclass(frozen=True)
class Tolerance:
    """Holds the criteria of convergence.

    Attributes
    ----------
    gap : difference of both objectives as a share of the multiplier (-)
    smallest_multiplier : multiplier (-) below which ``gap`` is a share of this constant instead of the multiplier
    residual : relative residual of both equations (-)
    stalled_residual : residual that is accepted if iterations no longer reduce it (-). If edges pass almost straight
        through a point, the volume conditions of clay around the point are nearly dependent, and a residual of 5e-9
        remains.
    floor : multiplier (-) below which the method ends with the velocities that prove the multiplier to be smaller: if
        no stress balances the dead load, velocities prove ever smaller multipliers
    """

    gap: float
    smallest_multiplier: float = 0.05
    residual: float = 1e-9
    stalled_residual: float = STALLED_RESIDUAL
    floor: float = -np.inf


# Unknowns y, multipliers z and slacks s.
Place = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Iterate:
    """Holds an iterate of a cone program.

    Attributes
    ----------
    y, z, s : unknowns, multipliers and slacks
    primal, dual : both objectives
    gap : gap between both objectives, as a share of the load multiplier
    residual : relative residual of the equations
    iterations : number of iterations until this one
    warm : starting point for the next program on the same mesh; known at the end
    below_floor : whether the load multiplier fell below `Tolerance.floor`; known at the end
    """

    y: np.ndarray
    z: np.ndarray
    s: np.ndarray
    primal: float
    dual: float
    gap: float
    residual: float
    iterations: int
    warm: "Place | None" = None
    below_floor: bool = False

    def rank(self, nearly: float) -> tuple[bool, float]:
        """Return the rank of an iterate: its gap if the equations are met to ``nearly``."""
        met = self.residual <= nearly
        return (not met, self.gap if met else self.residual)
