"""A sample as a task takes it, and the numbers that a task leaves."""

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Sample(BaseModel):
    """The input of a task: the section, and those of its settings that matter to the task.

    ``files`` are fingerprints of the files that these settings name. ``folder`` keeps what a long task continues from
    after a stop; it is no part of the input.
    """

    model_config = ConfigDict(frozen=True)

    data: dict[str, Any]
    files: dict[str, str] = {}
    folder: str = Field(default="", exclude=True)


class Numbers(BaseModel):
    """What a task found, by the names of columns; words say how it ended.

    ``errors`` are half the 95 % intervals of numbers that are means over several packings.
    """

    numbers: dict[str, float | None]
    words: dict[str, str] = {}
    errors: dict[str, float] = {}
