"""Defines the errors that end an analysis without an answer."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshes.errors import NoAnswerError


@dataclass(frozen=True, eq=False)
class FailureAtRest:
    """Holds the factor of safety of ground that fails without a seismic force, and where it slips.

    Attributes
    ----------
    factor : float
        Factor of safety at Kh = 0 (-), below 1.
    flow : str
        Its flow rule, "associated", "davis" or "non-associated".
    davis, associated : float or None
        Davis's estimate where ``factor`` is with ψ = φ, and the factor with ψ = φ where it is not (-).
    slip_surface : ndarray, shape (k, 2)
        The slip surface (m); empty if it is not known.
    """

    factor: float
    flow: str
    davis: float | None
    associated: float | None
    slip_surface: np.ndarray


class UnstableError(NoAnswerError):
    """The ground fails under its own weight.

    Attributes
    ----------
    reason : str
        Reason why the ground fails, such as the share of its weight that is in equilibrium.
    remedy : str
        Advice on what the user can change.
    at_rest : FailureAtRest or None
        Factor of safety of the ground; None if it was not computed.
    """

    def __init__(self, reason: str, remedy: str = "", at_rest: FailureAtRest | None = None) -> None:
        super().__init__(reason, remedy)
        self.at_rest = at_rest

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the error in the form in which it is sent to another process."""
        return UnstableError, (self.reason, self.remedy, self.at_rest)


class NoEquilibriumError(NoAnswerError):
    """No state was found in which stresses inside the yield surface balance the loads.

    Whether the ground stands or fails is unknown.
    """


@contextmanager
def accepting_no_answer() -> Iterator[None]:
    """Leave the block of a limit analysis whose solver has no answer, so that an equilibrium path has to do.

    Yields
    ------
    None. A NoAnswerError raised in the block ends the block, and the program continues behind it.

    Raises
    ------
    UnstableError
        If the block raises it: that the ground fails under its weight is an answer.
    """
    try:
        yield
    except UnstableError:
        raise
    except NoAnswerError:
        pass
