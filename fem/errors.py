"""How an analysis can end without an answer."""


class UnstableError(RuntimeError):
    """The ground does not stand under its own weight; says what share of it it carries."""
