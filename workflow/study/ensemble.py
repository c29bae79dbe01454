"""Computes tasks by workers, each once; stored answers are read from the folder."""

import socket
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic

from meshes.errors import InputError, NoAnswerError
from meshes.executor import LostError, Processes, is_interrupt
from workflow.study.result_cache import Outcome, ResultCache
from workflow.study.task import Input, Result, Task

POLL_INTERVAL = 1.0  # s between two looks for answers that another machine computes
SCHEDULER_TIMEOUT = 30  # s for a scheduler to answer


@dataclass(frozen=True)
class TaskOutcome(Generic[Result]):
    """Holds the outcome of a task.

    Attributes
    ----------
    answer : the answer; None if the task failed
    reason : reason why the task failed
    """

    answer: Result | None
    reason: str = ""


# Hears after every task how many are done, how many of these failed, and how many there are.
OnRow = Callable[[int, int, int], None]


class Ensemble:
    """Computes missing answers in a folder of answers by workers.

    Parameters
    ----------
    folder : folder of the answers
    workers : processes of this machine
    scheduler : address of a Dask scheduler, whose workers are used in place of processes of this machine. The workers
        must see the folder under the same path.
    """

    def __init__(self, folder: Path, workers: int = 1, scheduler: str | None = None) -> None:
        self.folder, self.workers, self.scheduler = folder.absolute(), workers, scheduler
        self.cache = ResultCache(self.folder)

    def rows(self, tasks: Sequence[Task[Input, Result]], on_row: OnRow | None = None) -> list[TaskOutcome[Result]]:
        """Return the outcomes of all tasks, in their order.

        Tasks that another machine computes are waited for, and taken over if that machine fails.
        """
        rows: dict[str, TaskOutcome[Result]] = {}
        missing: dict[str, Task[Input, Result]] = {}
        for task in tasks:
            stored = self.cache.read(task.fingerprint)
            if stored is None:
                missing[task.fingerprint] = task
            else:
                rows[task.fingerprint] = _row(task, stored)
        total = len(rows) + len(missing)

        def tell() -> None:
            if on_row is not None:
                on_row(len(rows), sum(row.answer is None for row in rows.values()), total)

        tell()
        if missing:
            with self._executor(min(self.workers, len(missing))) as executor:
                self._round(executor, missing, rows, tell)
                while missing:
                    time.sleep(POLL_INTERVAL)
                    self._round(executor, missing, rows, tell)
        return [rows[task.fingerprint] for task in tasks]

    @contextmanager
    def _executor(self, count: int) -> Iterator[futures.Executor]:
        """Yield an executor with processes of this machine, or with the workers of the scheduler; raise InputError
        without any.
        """
        if self.scheduler is None:
            with Processes(count) as executor:
                yield executor
            return
        from distributed import Client

        try:
            client = Client(self.scheduler, timeout=SCHEDULER_TIMEOUT, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            message = (
                f"no Dask scheduler answers ({error}); expected an address such as tcp://{socket.gethostname()}:8786"
            )
            raise InputError(f"--scheduler {self.scheduler}", [message]) from None
        with client:
            executor = client.get_executor(pure=False)
            try:
                yield executor
            finally:
                executor.shutdown(wait=False)  # cancels the remaining tasks

    def _round(
        self,
        executor: futures.Executor,
        missing: dict[str, Task[Input, Result]],
        rows: dict[str, TaskOutcome[Result]],
        tell: Callable[[], None],
    ) -> None:
        """Try every missing task once. Tasks that another machine computes remain missing."""
        tasks = list(missing.values())
        waiting = {executor.submit(attempt, self.folder, task): task for task in tasks}
        for future in futures.as_completed(waiting):
            task = waiting[future]
            try:
                outcome = future.result()
            except InputError:
                raise
            except Exception as error:
                reason = str(error) if isinstance(error, LostError) else f"{type(error).__name__}: {error}"
                outcome = Outcome(task=task.name, argument={}, reason=reason, lasting=False)
            if outcome is None:
                continue
            del missing[task.fingerprint]
            rows[task.fingerprint] = _row(task, outcome)
            tell()


def attempt(folder: Path, task: Task[Any, Any]) -> Outcome | None:
    """Compute a task unless its answer is stored in the folder, or another worker computes it (then return None).
    Workers call this function, with a task whose fingerprint is already computed."""
    cache = ResultCache(folder)
    with cache.claimed(task.fingerprint) as claimed:
        there = cache.read(task.fingerprint)
        if there is not None or not claimed:
            return there
        outcome = _outcome(task)
        if outcome.lasting:
            cache.write(task.fingerprint, outcome)
        return outcome


def _outcome(task: Task[Input, Result]) -> Outcome:
    """Call the function of a task; the message of an exception becomes the reason.

    Invalid input and missing answers are stored, since they would recur. Other errors may be due to the machine or to a
    fault of the program, and are tried again when the study continues.
    """
    start, answer, reason, lasting = time.perf_counter(), None, "", True
    try:
        answer = task.function(task.argument).model_dump(mode="json")
    except (InputError, NoAnswerError) as error:
        reason = "; ".join(error.problems) if isinstance(error, InputError) else str(error)
    except Exception as error:
        if is_interrupt(error):
            raise KeyboardInterrupt from error
        reason, lasting = f"{type(error).__name__}: {error}", False
    return Outcome(
        task=task.name, argument=task.argument.model_dump(mode="json"), answer=answer, reason=reason,
        seconds=round(time.perf_counter() - start, 3), host=socket.gethostname(), lasting=lasting,
    )  # fmt: skip


def _row(task: Task[Any, Result], outcome: Outcome) -> TaskOutcome[Result]:
    answer = None if outcome.answer is None else task.answer_type.model_validate(outcome.answer)
    return TaskOutcome(answer, outcome.reason)
