"""Provides stages that take no time."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.support.sections import analysed, slope
from workflow.run import pipeline
from workflow.run.plan import Choice, Decision
from workflow.run.progress import Progress, silent
from workflow.run.record import Entry
from workflow.run.stage import Job, Stage
from workflow.run.store import Store

ALL_OF_THEM = ["mesh", "fem", "slide", "report"]

Work = Callable[[Job], None]


class Heard:
    """Stores all messages that it receives."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.ended: dict[str, str] = {}
        self.skipped: dict[str, str] = {}

    def begin(self, decision: Decision) -> Progress:
        self.ran.append(decision.stage.name)
        return silent

    def end(self, decision: Decision, entry: Entry) -> None:
        self.ended[decision.stage.name] = entry.outcome

    def skip(self, decision: Decision, why: str) -> None:
        self.skipped[decision.stage.name] = why


def leaves(name: str, text: str = "result") -> Work:
    """Return the work of a stage that writes one file with a text."""
    return lambda job: job.store.write_text(name, text) and None


def stage(name: str, **more: Any) -> Stage:
    """Return a stage that writes one file."""
    return Stage(
        name=name, description=f"the {name}", work=leaves(f"{name}.txt"),
        results=(f"{name}.txt",), pictures=(f"{name}*.png",), **more,
    )  # fmt: skip


class Toys(dict[str, Stage]):
    """Holds stages by their names, in their order."""

    def change(self, name: str, **values: Any) -> None:
        """Replace one stage by another."""
        self[name] = replace(self[name], **values)

    def job(self, folder: Path, **settings: Any) -> Job:
        """Return the job of the small slope with some settings."""
        return Job(analysed({**slope(), **settings}), Store(folder), tuple(self.values()))

    def choose(self, **options: Any) -> Choice:
        """Return a choice of these stages."""
        return Choice.of(tuple(self.values()), **options)

    def go(self, folder: Path, choice: Choice | None = None, **settings: Any) -> Heard:
        """Run the pipeline on the small slope."""
        heard = Heard()
        pipeline.execute(self.job(folder, **settings), choice or self.choose(), heard, "test")
        return heard
