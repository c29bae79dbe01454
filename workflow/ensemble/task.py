"""A task: one pure function of a typed input, whose answer is addressed by the fingerprint of both."""

import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Generic, TypeVar, get_type_hints

from pydantic import BaseModel

from workflow.run import source
from workflow.run.fingerprint import fingerprint_of

Given = TypeVar("Given", bound=BaseModel)
Found = TypeVar("Found", bound=BaseModel)


@dataclass(frozen=True)
class Task(Generic[Given, Found]):
    """One function to be called once.

    Attributes
    ----------
    function : callable
        At the top level of a module that the workers can import too. Its annotations say what it takes and returns,
        and its answer hangs on nothing but its input.
    given : pydantic model
        The input.
    """

    function: Callable[[Given], Found]
    given: Given

    @property
    def name(self) -> str:
        """Which function it is."""
        return f"{self.function.__module__}.{self.function.__qualname__}"

    @property
    def answer_type(self) -> type[Found]:
        """The model of its answer."""
        found: type[Found] = get_type_hints(self.function)["return"]
        return found

    @cached_property
    def fingerprint(self) -> str:
        """Of the function, of the text of all that it is made of, and of its input."""
        data = {"task": self.name, "program": _program(self.function.__module__), **_as_data(self.given)}
        return fingerprint_of(data)


def _as_data(given: BaseModel) -> dict[str, object]:
    return {"given": given.model_dump(mode="json")}


def _program(module: str) -> str:
    """A fingerprint of a module with all of noshiro that it imports; of one that is not noshiro's, its own text."""
    if module.split(".")[0] in source.PACKAGES:
        return source.fingerprint(source.closure(module, without=source.DRAWING))
    file = inspect.getsourcefile(sys.modules[module])
    return fingerprint_of(Path(file).read_text(encoding="utf-8") if file else module)
