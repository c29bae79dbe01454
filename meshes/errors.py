"""Defines errors for the user whose input cannot be used, or has no answer."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar


class InputError(ValueError):
    """The input cannot be used.

    Attributes
    ----------
    source : str
        The file or setting.
    problems : tuple of str
        One sentence for each problem, naming the key, the value and what was expected.
    """

    def __init__(self, source: str, problems: Sequence[str]) -> None:
        self.source = source
        self.problems = tuple(problems)
        count = "1 problem" if len(self.problems) == 1 else f"{len(self.problems)} problems"
        super().__init__("\n".join([f"{source}: {count}", *(f"  - {text}" for text in self.problems)]))

    def of_file(self, name: str, file: Path | None) -> "InputError":
        """Return the error of a ``file``, if there is one, in which the file replaces the ``name`` of the section."""
        return self if file is None or self.source != name else InputError(str(file), self.problems)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the error in the form in which it is sent to another process."""
        return type(self), (self.source, self.problems)


class NoAnswerError(RuntimeError):
    """An analysis ended without an answer, though its input can be used.

    Attributes
    ----------
    reason : str
        Reason why there is no answer.
    remedy : str
        What the user can try; empty if nothing is known.
    MISSING : str
        Name of the missing answer, in words.
    """

    MISSING: ClassVar[str] = "No answer"

    def __init__(self, reason: str, remedy: str = "") -> None:
        self.reason = reason
        self.remedy = remedy
        super().__init__(f"{reason}; {remedy}" if remedy else reason)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return the error in the form in which it is sent to another process."""
        return type(self), (self.reason, self.remedy)
