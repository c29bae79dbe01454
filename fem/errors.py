"""Defines the errors that end an analysis without an answer."""

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
