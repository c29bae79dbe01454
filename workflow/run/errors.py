"""How a stage can end without an answer, and results that cannot be used."""

from meshes.errors import InputError, NoAnswerError

__all__ = ["NoAnswerError", "OtherVersionError"]


class OtherVersionError(InputError):
    """A file that this version of the program did not write: a key is missing, or unknown, or of another kind."""
