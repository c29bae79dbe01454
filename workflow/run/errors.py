"""How a stage can end without an answer, and results that cannot be used."""

from meshes.errors import InputError


class NoAnswerError(RuntimeError):
    """A stage that ended without an answer, after it wrote what it found: the reason, and what to try."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        self.reason = reason
        self.remedy = remedy
        super().__init__(f"{reason}; {remedy}" if remedy else reason)


class OtherVersionError(InputError):
    """A file that this version of the program did not write: a key is missing, or unknown, or of another kind."""
