"""Errors with which an analysis ends without an answer."""

from meshes.errors import NoAnswerError


class UnstableError(NoAnswerError):
    """Ground that fails under its own weight.

    Attributes
    ----------
    reason : str
        Why it fails, such as the share of its weight that it carries.
    remedy : str
        What to try.
    """


class NoEquilibriumError(NoAnswerError):
    """No state on the path is in equilibrium on the yield surface: whether the ground stands or fails is unknown."""
