"""Defines the stored record of every step of an equilibrium path."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PathStep:
    """Holds the record of one step of an equilibrium path.

    Attributes
    ----------
    length : arc length from the start of the path (-)
    displacement : control displacement from the start of the path (m)
    factor : load multiplier λ (-): Kh, or the factor of safety
    iterations : iterations of Newton's method
    residual : norm of the unbalanced force over that of the weight (-)
    plastic_share : share of the quadrature points at yield (-)
    cutbacks : number of halvings of the step before it converged
    at_rest : whether the overstress was relaxed in this step, while the load was not increased
    balanced : whether there was equilibrium without overstress after the relaxation
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
