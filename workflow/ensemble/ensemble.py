"""Tasks computed by workers, each once: what a folder keeps already is taken from there."""

import socket
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Generic

from meshes.errors import InputError, NoAnswerError
from workflow.ensemble.kept import Kept, Outcome
from workflow.ensemble.task import Found, Given, Task
from workflow.ensemble.workers import LostError, Workers, hired

LOOK_AGAIN = 1.0  # s between two looks for answers that another machine computes


@dataclass(frozen=True)
class Row(Generic[Found]):
    """What a task came to.

    Attributes
    ----------
    answer : pydantic model or None
        None where it failed.
    reason : str
        Why it failed.
    reused : bool
        Whether it was there already.
    """

    answer: Found | None
    reason: str = ""
    reused: bool = False


# Hears after every task how many are done, how many of these failed, and how many there are.
OnRow = Callable[[int, int, int], None]


class Ensemble:
    """A folder of answers, and who computes those that are missing.

    Parameters
    ----------
    folder
        Where they are kept.
    workers
        Processes of this machine.
    scheduler
        The address of a Dask scheduler whose workers are taken instead. They see the folder by the same name.
    """

    def __init__(self, folder: Path, workers: int = 1, scheduler: str | None = None) -> None:
        self.folder, self.workers, self.scheduler = folder.absolute(), workers, scheduler
        self.kept = Kept(self.folder)

    def rows(self, tasks: Sequence[Task[Given, Found]], on_row: OnRow | None = None) -> list[Row[Found]]:
        """What every task came to, in their order, whoever computed which when.

        Tasks that another machine is at are waited for, and taken over if that one dies.
        """
        found: dict[str, Row[Found]] = {}
        missing: dict[str, Task[Given, Found]] = {}
        for task in tasks:
            kept = self.kept.read(task.fingerprint)
            if kept is None:
                missing[task.fingerprint] = task
            else:
                found[task.fingerprint] = _row(task, kept, reused=True)
        total = len(found) + len(missing)

        def tell() -> None:
            if on_row is not None:
                on_row(len(found), sum(row.answer is None for row in found.values()), total)

        tell()
        team = hired(min(self.workers, len(missing)), self.scheduler) if missing else nullcontext()
        with team as workers:
            while missing and workers is not None:
                self._round(workers, missing, found, tell)
                if missing:
                    time.sleep(LOOK_AGAIN)
        return [found[task.fingerprint] for task in tasks]

    def _round(
        self,
        workers: Workers,
        missing: dict[str, Task[Given, Found]],
        found: dict[str, Row[Found]],
        tell: Callable[[], None],
    ) -> None:
        """Let every missing task be tried once; those that another machine is at stay missing."""
        tasks = list(missing.values())
        attempts = [Attempt(str(self.folder), task.fingerprint, partial(_outcome, task), task.name) for task in tasks]
        for place, outcome in workers.results(attempt, attempts):
            if outcome is None:
                continue
            if isinstance(outcome, InputError | KeyboardInterrupt):
                raise outcome
            task = tasks[place]
            if not isinstance(outcome, Outcome):
                told = str(outcome) if isinstance(outcome, LostError) else f"{type(outcome).__name__}: {outcome}"
                outcome = Outcome(task=task.name, given={}, reason=told, lasting=False)
            del missing[task.fingerprint]
            found[task.fingerprint] = _row(task, outcome)
            tell()


@dataclass(frozen=True)
class Attempt:
    """What a worker is sent: the folder of the answers, the task's fingerprint, and how to compute it."""

    folder: str
    fingerprint: str
    compute: Callable[[], Outcome]
    name: str


def attempt(wanted: Attempt) -> Outcome | None:
    """Compute a task unless it is there or someone else is at it (then None); called in a worker."""
    kept = Kept(Path(wanted.folder))
    with kept.claimed(wanted.fingerprint) as mine:
        there = kept.read(wanted.fingerprint)
        if there is not None or not mine:
            return there
        outcome = wanted.compute()
        if outcome.lasting:
            kept.write(wanted.fingerprint, outcome)
        return outcome


def _outcome(task: Task[Given, Found]) -> Outcome:
    """Call the function; what it raises becomes the reason.

    Input that cannot be used, and an analysis without an answer, are so again. All else may be of the machine, or of
    a program that is mended later, and is tried again when the study goes on.
    """
    start, answer, reason, lasting = time.perf_counter(), None, "", True
    try:
        answer = task.function(task.given).model_dump(mode="json")
    except (InputError, NoAnswerError) as error:
        reason = "; ".join(error.problems) if isinstance(error, InputError) else str(error)
    except Exception as error:
        reason, lasting = f"{type(error).__name__}: {error}", False
    return Outcome(
        task=task.name, given=task.given.model_dump(mode="json"), answer=answer, reason=reason,
        seconds=round(time.perf_counter() - start, 3), host=socket.gethostname(), lasting=lasting,
    )  # fmt: skip


def _row(task: Task[Any, Found], outcome: Outcome, reused: bool = False) -> Row[Found]:
    answer = None if outcome.answer is None else task.answer_type.model_validate(outcome.answer)
    return Row(answer, outcome.reason, reused)
