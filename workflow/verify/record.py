"""Answers kept from run to run, so that one case can be run anew: `answers.json` beside the cases."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from meshes.errors import InputError
from workflow.run.store import Store
from workflow.verify.answer import Answer

FILE = "answers.json"


def read_answers(path: Path) -> dict[str, Answer]:
    """The answers in a file, none if there is no file; raises InputError if it is something else."""
    if not path.exists():
        return {}
    try:
        answers = TypeAdapter(list[Answer]).validate_json(path.read_bytes())
    except ValidationError as error:
        raise InputError(str(path), ["these are not answers of `noshiro verify`; delete the file"]) from error
    return {found.name: found for found in answers}


def write_answers(path: Path, answers: Mapping[str, Answer]) -> None:
    """Write answers in the order of their names, whole or not at all."""
    rows = [asdict(answers[name]) for name in sorted(answers)]
    Store(path.parent).write_text(path.name, json.dumps(rows, indent=1, ensure_ascii=False) + "\n")
