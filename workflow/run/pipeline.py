"""A run: the stages one after the other, each from the input to the files it leaves behind."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Protocol

from dem.errors import DemError
from fem.errors import UnstableError
from meshes.quad_mesh import BadMeshError
from workflow.run.errors import NoAnswerError
from workflow.run.fingerprint import drawing
from workflow.run.interrupts import remembered
from workflow.run.lock import locked
from workflow.run.log import Log
from workflow.run.plan import Choice, Step, made_from, plan
from workflow.run.progress import Progress
from workflow.run.record import Entry, Record, sizes
from workflow.run.stage import Job, Stage
from workflow.run.store import Store
from workflow.settings import Input

# How far (s) the clock of a file system may be behind.
CLOCK = 0.1

# What ends a stage without an answer; all else is a fault of the input, of the machine, or of the program.
NO_ANSWER = (NoAnswerError, BadMeshError, UnstableError, DemError)


class Listener(Protocol):
    """Who is told how a run goes."""

    def begin(self, step: Step) -> Progress:
        """A stage begins; returns whom it tells how far it is."""

    def end(self, step: Step, entry: Entry) -> None:
        """A stage has ended, with or without an answer, or is reused."""

    def skip(self, step: Step, why: str) -> None:
        """A stage does not run."""


class Heeding:
    """A listener that raises KeyboardInterrupt at any sign of progress after a Ctrl-C that was swallowed."""

    def __init__(self, listener: Listener, check: Callable[[], None]) -> None:
        self.listener, self.check = listener, check
        self.skip = listener.skip

    def begin(self, step: Step) -> Progress:
        progress = self.listener.begin(step)

        def tell(line: str, share: float | None) -> None:
            self.check()
            progress(line, share)

        return tell

    def end(self, step: Step, entry: Entry) -> None:
        self.listener.end(step, entry)
        self.check()


def execute(job: Job, choice: Choice, listener: Listener, what: str) -> None:
    """Do what has to be done, with the folder locked; ``what`` is the command, for the log.

    Raises InputError if something cannot be used or written. A stage without an answer keeps those from running that
    need it; all others run, and then its error is raised.
    """
    with locked(job.store.folder):
        job.store.sweep()
        record, log = Record(job.store), Log(job.store)
        steps = plan(job, record, choice)
        log.begin(what)
        failures: dict[str, Exception] = {}
        try:
            with remembered() as check:
                for step in steps:
                    _take(step, job, record, Heeding(listener, check), log, failures)
        except BaseException as error:
            log.stop(error)
            raise
        log.done()
        if failures:
            raise next(iter(failures.values()))


def _take(step: Step, job: Job, record: Record, listener: Listener, log: Log, failures: dict[str, Exception]) -> None:
    """Do what a step says, unless a stage that it needs has no answer."""
    stage, before = step.stage, record[step.stage.name]
    if step.action == "off":
        return listener.skip(step, step.why)
    without = [name for name in stage.needs if name in failures]
    if without and not stage.of_all:
        failures[stage.name] = failures[without[0]]
        return listener.skip(step, f"{without[0]} has no answer")
    if step.action == "reuse" and before is not None:
        listener.end(step, before)
        log.line(f"{stage.name}: reused, made in {before.seconds:.1f} s until {before.ended}")
    elif step.action == "redraw" and stage.draw is not None:
        _redraw(stage, stage.draw, job, record, listener.begin(step))
        log.line(f"{stage.name}: pictures drawn again")
        listener.end(step, record.entries[stage.name])
    else:
        step = replace(step, inputs=made_from(stage, job, record))  # a report's depend on how the others have ended
        progress = _logged(listener.begin(step), stage, log)
        failure = _run(step, replace(job, progress=progress), record, log)
        listener.end(step, record.entries[stage.name])
        if failure is not None:
            failures[stage.name] = failure
        return None
    entry = record.entries[stage.name]
    if entry.outcome == "no answer":
        failures[stage.name] = NoAnswerError(entry.reason, entry.remedy)
    return None


def _run(step: Step, job: Job, record: Record, log: Log) -> Exception | None:
    """Run a stage and keep how it ended; returns what kept it from an answer."""
    stage, store, before = step.stage, job.store, record[step.stage.name]
    goes_on = before is not None and before.inputs == step.inputs and step.why != "asked for"
    if not goes_on:
        store.remove((*stage.leftovers, *stage.pictures))
    log.line(f"{stage.name}: begins ({step.why})")
    record.put(stage.name, Entry(step.inputs, "begun"))
    start, failure = time.perf_counter(), None
    # What lies there after a stage that failed may be of other inputs, but for a stage that goes on and has cleaned up.
    since = 0.0 if stage.leftovers else time.time() - CLOCK
    try:
        stage.work(job)
    except NO_ANSWER as error:
        failure = error
    seconds = time.perf_counter() - start
    entry = Entry(
        step.inputs,
        "no answer" if failure else "part" if stage.partial(job) else "done",
        failure.reason if isinstance(failure, NoAnswerError) else str(failure or ""),
        failure.remedy if isinstance(failure, NoAnswerError) else "",
        round(seconds, 2),
        datetime.now().isoformat(" ", "seconds"),
        sizes(store, store.matching(stage.results, since)),
        store.matching(stage.pictures),
        drawing(stage),
    )
    if failure is None:
        leave_input(job.given, store)
    record.put(stage.name, entry)
    log.line(f"{stage.name}: {entry.outcome} after {seconds:.1f} s" + (f": {failure}" if failure else ""))
    return failure


def _redraw(stage: Stage, draw: Callable[[Job], None], job: Job, record: Record, progress: Progress) -> None:
    """Draw a stage's pictures again from what is stored."""
    progress("pictures", None)
    job.store.remove(stage.pictures)
    draw(job)
    pictures = job.store.matching(stage.pictures)
    record.put(stage.name, replace(record.entries[stage.name], pictures=pictures, drawing=drawing(stage)))


def _logged(progress: Progress, stage: Stage, log: Log, every: float = 30.0) -> Progress:
    """The same, with a line in the log now and then."""
    last = time.monotonic()

    def tell(line: str, share: float | None) -> None:
        nonlocal last
        progress(line, share)
        if time.monotonic() - last > every:
            last = time.monotonic()
            log.line(f"{stage.name}: {line}")

    return tell


def leave_input(given: Input, store: Store) -> None:
    """Leave section.toml, the input as used, and beside it the accelerogram that it names."""
    record = Path(given.sliding_block.accelerogram) if given.sliding_block.accelerogram else None
    if record is not None:
        with store.writing(record.name) as path:
            path.write_bytes(record.read_bytes())
        block = given.sliding_block.model_copy(update={"accelerogram": record.name})
        given = given.model_copy(update={"sliding_block": block})
    store.write_text("section.toml", given.to_toml())


def redraw_all(job: Job, listener: Listener) -> list[str]:
    """Draw all pictures again from what is stored; returns the stages whose pictures could not be drawn, with why."""
    told = []
    with _folder(job) as (record, steps):
        for step in steps:
            if step.action == "off":
                told.append(f"{step.stage.name}: no pictures: {step.why}")
                continue
            stage, step = step.stage, replace(step, action="redraw", why="drawn again")
            if stage.draw is not None:
                _redraw(stage, stage.draw, job, record, listener.begin(step))
                listener.end(step, record.entries[stage.name])
            elif stage.pictures:
                told.append(f"{stage.name}: its pictures are drawn only when it runs")
    return told


@contextmanager
def _folder(job: Job) -> Iterator[tuple[Record, list[Step]]]:
    """A locked folder in which nothing is computed: what it holds for this input."""
    with locked(job.store.folder):
        job.store.sweep()
        record = Record(job.store)
        yield record, plan(job, record, Choice(()))
