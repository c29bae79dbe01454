"""Defines the errors that end an analysis without an answer."""

from collections.abc import Callable
from typing import TypeVar

from meshes.errors import NoAnswerError

Answer = TypeVar("Answer")


class UnstableError(NoAnswerError):
    """The ground fails under its own weight.

    Attributes
    ----------
    reason : str
        Reason why the ground fails, such as the share of its weight that is in equilibrium.
    remedy : str
        Advice on what the user can change.
    """


class NoEquilibriumError(NoAnswerError):
    """No state was found in which stresses inside the yield surface balance the loads: whether the ground stands or
    fails is unknown.
    """


def answer_or_none(find: Callable[[], Answer]) -> Answer | None:
    """Return the answer of limit analysis; None if the solver has none, so that an equilibrium path has to do. An
    UnstableError is an answer, and is raised."""
    try:
        return find()
    except UnstableError:
        raise
    except NoAnswerError:
        return None
