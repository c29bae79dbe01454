"""Results for a case, and their file from run to run: `answers.json` beside the cases."""

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
    """Results for the case of this name; ``commit`` is the version of the program that found the last."""

    name: str
    commit: str = field(default="", kw_only=True)


Stored = TypeVar("Stored", bound=Named)


@dataclass(frozen=True)
class Answer(Named):
    """Factors of safety or critical coefficients, None where there is none; seconds of processor time.

    ``associated`` and ``davis`` are of the finite elements with ψ = φ and with Davis's estimate for ψ < φ; each with
    its upper limit. ``lower`` and ``upper`` are strict bounds with ψ = φ. Where a face fails before, at
    ``shallow_failure``, all of these are of the slope as a whole.
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
    """The commit that a checkout with ``folder`` in it is at, with a + if Python files differ; empty elsewhere."""
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
    """The answers of a kind in a file, none if there is no file; raises InputError if it is something else."""
    if not path.exists():
        return {}
    try:
        answers: list[Stored] = TypeAdapter(list[kind]).validate_json(path.read_bytes())  # type: ignore[valid-type]
    except ValidationError as error:
        raise InputError(str(path), ["these are not answers of `python -m docs.verify`; delete the file"]) from error
    return {answer.name: answer for answer in answers}


def write_answers(path: Path, answers: Mapping[str, Stored]) -> None:
    """Write answers in the order of their names, a line each, whole or not at all."""
    rows = [json.dumps(asdict(answers[name]), ensure_ascii=False) for name in sorted(answers)]
    Store(path.parent).write_text(path.name, "[\n" + ",\n".join(rows) + "\n]\n")
