"""Defines a task: one pure function of a typed input, whose answer is found by the fingerprint of function and
input."""

import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, TypeVar, get_type_hints

from pydantic import BaseModel, ConfigDict, Field

from workflow.run.fingerprint import fingerprint_of, program

Input = TypeVar("Input", bound=BaseModel)
Result = TypeVar("Result", bound=BaseModel)


@dataclass(frozen=True)
class Task(Generic[Input, Result]):
    """Holds one function that is to be called once, and its input.

    Attributes
    ----------
    function : function at the top level of a module that the workers can import. The annotations of the function name
        its input and answer, and the answer depends only on the input.
    argument : the input
    """

    function: Callable[[Input], Result]
    argument: Input

    @property
    def name(self) -> str:
        """Return the name of the function that the task calls."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    @property
    def answer_type(self) -> type[Result]:
        """Return the model of the answer of the task."""
        answer_type: type[Result] = get_type_hints(self.function)["return"]
        return answer_type

    @cached_property
    def fingerprint(self) -> str:
        """Return the fingerprint of the function, its module, the program and its input."""
        made_by = {"task": self.name, "program": program(), "module": _text(self.function.__module__)}
        return fingerprint_of({**made_by, "given": self.argument.model_dump(mode="json")})


def _text(module: str) -> str:
    """Return the source of a module, which need not belong to the program."""
    file = inspect.getsourcefile(sys.modules[module])
    return fingerprint_of(Path(file).read_text(encoding="utf-8") if file else module)


class StudySample(BaseModel):
    """Holds the input of a task: the section, and the settings that matter to the task.

    ``files`` are fingerprints of the files that these settings name. ``folder`` contains the files from which a long
    task continues after a stop; it is no part of the input.
    """

    model_config = ConfigDict(frozen=True)

    data: dict[str, Any]
    files: dict[str, str] = {}
    folder: str = Field(default="", exclude=True)


class Numbers(BaseModel):
    """Holds the results of a task by the names of columns, and its outcome in words.

    ``errors`` are half the 95 % intervals of numbers that are means over several packings.
    """

    numbers: dict[str, float | None]
    texts: dict[str, str] = {}
    errors: dict[str, float] = {}
