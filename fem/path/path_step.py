"""Defines the stored record of every step of an equilibrium path."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PathStep:
    """Holds the record of one step of an equilibrium path.

    Attributes
    ----------
    length : float
        Arc length from the start of the path (-).
    displacement : float
        Control displacement from the start of the path (m).
    factor : float
        Load multiplier λ (-): Kh, or the factor of safety.
    iterations : int
        Iterations of Newton's method.
    residual : float
        Norm of the unbalanced force over that of the weight (-).
    plastic_share : float
        Share of the quadrature points at yield (-).
    cutbacks : int
        Number of halvings of the step before it converged.
    at_rest : bool
        Whether the overstress was relaxed in this step, while the load was not increased.
    balanced : bool
        Whether there was equilibrium without overstress after the relaxation.
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
