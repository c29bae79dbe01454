"""The stored record of every step of an equilibrium path."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PathStep:
    """A step of the path, for the record.

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
        How often the step was halved before it converged.
    at_rest : bool
        Whether the overstress was relaxed in this step instead of the load raised.
    balanced : bool
        Whether after that the forces balanced without overstress.
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
