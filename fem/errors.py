"""Defines the errors that end an analysis without an answer."""

from collections.abc import Iterator
from contextlib import contextmanager

from meshes.errors import NoAnswerError


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


@contextmanager
def accepting_no_answer() -> Iterator[None]:
    """Leave the block of a limit analysis whose solver has no answer, so that an equilibrium path has to do. An
    UnstableError is an answer, and is raised."""
    try:
        yield
    except UnstableError:
        raise
    except NoAnswerError:
        pass
