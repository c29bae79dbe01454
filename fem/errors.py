"""How an analysis can end without an answer."""

from meshes.errors import NoAnswerError


class UnstableError(NoAnswerError):
    """The ground does not stand under its own weight; says what share of it it carries."""


class NoEquilibriumError(NoAnswerError):
    """No state on a path of equilibria balances on the yield surface, so that the path has no answer to give: neither
    that the ground stands, nor that it fails under its own weight."""
