"""Stores the answers of the program for published cases in the file `answers.json` beside the cases."""

import json
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal, TypeVar

from pydantic import TypeAdapter, ValidationError

from meshes.errors import InputError
from workflow.run.store import Store

FILE = "answers.json"

Part = Literal["bounds", "associated", "davis"]
PARTS: tuple[Part, ...] = ("bounds", "associated", "davis")


@dataclass(frozen=True)
class Named:
    """Holds an answer for the case of this name; ``commit`` is the version of the program that computed it last."""

    name: str
    commit: str = field(default="", kw_only=True)


Stored = TypeVar("Stored", bound=Named)


@dataclass(frozen=True)
class Answer(Named):
    """Holds factors of safety or critical seismic coefficients of a slope, None where there is none, and processor
    times (s).

    ``associated`` and ``davis`` are answers of the finite elements with ψ = φ and with Davis's estimate for ψ < φ, each
    with its upper limit. ``lower`` and ``upper`` are strict bounds with ψ = φ. If a cohesionless face fails before the
    slope, at ``shallow_failure``, the other numbers are those of the slope as a whole.
    """

    lower: float | None = None
    upper: float | None = None
    associated: float | None = None
    associated_upper: float | None = None
    davis: float | None = None
    davis_upper: float | None = None
    shallow_failure: float | None = None
    bounds_seconds: float | None = None
    associated_seconds: float | None = None
    davis_seconds: float | None = None
    failures: tuple[str, ...] = ()


def version_of(folder: Path) -> str:
    """Return the commit of the checkout that contains ``folder``, with a + if Python files differ from it; empty
    outside a checkout."""
    lines = []
    for command in (["rev-parse", "--short=9", "HEAD"], ["diff", "--name-only", "HEAD", "--", ":/*.py"]):
        try:
            lines.append(
                subprocess.run(["git", *command], cwd=folder, capture_output=True, text=True, check=True).stdout
            )
        except (OSError, subprocess.CalledProcessError):
            return ""
    return lines[0].strip() + ("+" if lines[1] else "")


def read_answers(path: Path, kind: type[Stored]) -> dict[str, Stored]:
    """Read the answers of a kind from a file; none if there is no file. Raises InputError if the file has no such
    answers."""
    if not path.exists():
        return {}
    try:
        answers: list[Stored] = TypeAdapter(list[kind]).validate_json(path.read_bytes())  # type: ignore[valid-type]
    except ValidationError as error:
        raise InputError(str(path), ["these are not answers of `python -m docs.verify`; delete the file"]) from error
    return {answer.name: answer for answer in answers}


def write_answers(path: Path, answers: Mapping[str, Stored]) -> None:
    """Write answers in alphabetical order, one per line; the file is replaced as a whole."""
    rows = [json.dumps(asdict(answers[name]), ensure_ascii=False) for name in sorted(answers)]
    Store(path.parent).write_text(path.name, "[\n" + ",\n".join(rows) + "\n]\n")
