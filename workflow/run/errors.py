"""How a stage can end without an answer."""


class NoAnswerError(RuntimeError):
    """A stage that ended without an answer, after it wrote what it found: the reason, and what to try."""

    def __init__(self, reason: str, remedy: str = "") -> None:
        self.reason = reason
        self.remedy = remedy
        super().__init__(f"{reason}; {remedy}" if remedy else reason)
