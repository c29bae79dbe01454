"""What discs made of a known slide, and how it is kept from run to run: `answers.json` beside the cases."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from meshes.errors import InputError
from workflow.run.store import Store

FILE = "answers.json"

Line = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class SlideAnswer:
    """What was predicted, packing by packing.

    Attributes
    ----------
    name : str
        Of the case.
    values : tuple of float
        Of the quantity of the case, by seed.
    loose : tuple of float
        Shares of the mass that left the connected ground.
    rested : tuple of bool
        Whether the ground came to rest.
    before, after : tuple of (x, z)
        Surface of the first packing (m).
    seconds : float
        Of processor time.
    commit : str
        Version of the program.
    failure : str
        Why there is no prediction; empty where there is one.
    points : float or None
        What material points predict, where the case asks for that judge, too.
    """

    name: str
    values: tuple[float, ...] = ()
    loose: tuple[float, ...] = ()
    rested: tuple[bool, ...] = ()
    before: Line = ()
    after: Line = ()
    seconds: float = 0.0
    commit: str = ""
    failure: str = ""
    points: float | None = None


def read_answers(path: Path) -> dict[str, SlideAnswer]:
    """The answers in a file, none if there is no file; raises InputError if it is something else."""
    if not path.exists():
        return {}
    try:
        answers = TypeAdapter(list[SlideAnswer]).validate_json(path.read_bytes())
    except ValidationError as error:
        told = "these are not answers of `noshiro verify --slides`; delete the file"
        raise InputError(str(path), [told]) from error
    return {found.name: found for found in answers}


def write_answers(path: Path, answers: Mapping[str, SlideAnswer]) -> None:
    """Write answers in the order of their names, whole or not at all."""
    rows = [json.dumps(asdict(answers[name]), ensure_ascii=False) for name in sorted(answers)]
    Store(path.parent).write_text(path.name, "[\n" + ",\n".join(rows) + "\n]\n")
