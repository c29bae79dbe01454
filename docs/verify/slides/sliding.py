"""Identifies configs that several known slides share."""

from dem.case import Case
from workflow.config import Config


class Sliding:
    """Holds a config that is compared by content and not by name, since several cases may share one ground."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self.key = config.model_dump_json(exclude={"section": {"name", "title"}, "free_face": True})

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sliding) and self.key == other.key


def number_of(case: str, cases: tuple[Case, ...]) -> int:
    """Return the number of a case of liquefaction from its name or number; raises ValueError if there is none."""
    for number, numbered in enumerate(cases, start=1):
        if case in (numbered.name, str(number)):
            return number
    raise ValueError(f'there is no case "{case}": there are {len(cases)}')
