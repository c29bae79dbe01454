"""Defines the errors that end an analysis without an answer."""

from meshes.errors import NoAnswerError


class UnstableError(NoAnswerError):
    """The ground fails under its own weight.

    Attributes
    ----------
    reason : str
        Why the ground fails, such as the share of its weight that is in equilibrium.
    remedy : str
        Advice on what the user can change.
    """


class NoEquilibriumError(NoAnswerError):
    """Equilibrium with stresses inside the yield surface was not reached: whether the ground stands or fails is
    unknown.
    """
