"""How an analysis can end without an answer."""

from meshes.errors import NoAnswerError


class UnstableError(NoAnswerError):
    """Ground that fails under its own weight.

    Attributes
    ----------
    reason : str
        Up to which share of its weight it is in equilibrium.
    remedy : str
        What to try.
    """


class NoEquilibriumError(NoAnswerError):
    """No state on a path of equilibria balances on the yield surface, so that the path has no answer to give: neither
    that the ground stands, nor that it fails under its own weight."""
