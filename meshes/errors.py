"""What is told to a person whose input cannot be used."""

from collections.abc import Sequence


class InputError(ValueError):
    """Input that cannot be used: where it stands, and every problem found in it.

    ``problems`` holds one sentence each, naming the key, the value and what was expected.
    """

    def __init__(self, source: str, problems: Sequence[str]) -> None:
        self.source = source
        self.problems = tuple(problems)
        count = "1 problem" if len(self.problems) == 1 else f"{len(self.problems)} problems"
        super().__init__("\n".join([f"{source}: {count}", *(f"  - {text}" for text in self.problems)]))
