"""An input of which several known slides ask."""

from dem.case import Case
from workflow.config import Config


class Sliding:
    """An input, compared by content and not by name: several cases may share one ground."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self.key = config.model_dump_json(exclude={"section": {"name", "title"}, "free_face": True})

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sliding) and self.key == other.key


def number_of(case: str, cases: tuple[Case, ...]) -> int:
    """The number of a case by its name or number. Raises ValueError where there is none."""
    for number, numbered in enumerate(cases, start=1):
        if case in (numbered.name, str(number)):
            return number
    raise ValueError(f'there is no case "{case}": there are {len(cases)}')
