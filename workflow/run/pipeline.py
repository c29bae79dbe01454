"""Runs the stages of a run in their order: each reads its input and writes its files."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import partial
from pathlib import Path
from threading import RLock
from typing import Protocol

from meshes.errors import NoAnswerError
from meshes.executor import SERIAL, Tell, interruptible, then
from workflow.config import Config
from workflow.run.fingerprint import title
from workflow.run.lock import locked
from workflow.run.log import RunLog
from workflow.run.plan import Choice, Decision, is_of_this_input, made_from, plan
from workflow.run.progress import Progress, silent
from workflow.run.record import Entry, Record, keep_mesh_options, sizes
from workflow.run.stage import Job, Stage
from workflow.run.store import Store


class Listener(Protocol):
    """Follows the progress of a run; this is the interface of listeners."""

    def begin(self, decision: Decision) -> Progress:
        """Note that a stage begins; return the callback for its progress."""

    def end(self, decision: Decision, entry: Entry) -> None:
        """Note that a stage has ended, with or without an answer, or is reused."""

    def skip(self, decision: Decision, why: str) -> None:
        """Note that a stage does not run."""


def execute(job: Job, choice: Choice, listener: Listener, what: str) -> None:
    """Run the stages of a choice while the folder is locked. The executor is closed at the end.

    Parameters
    ----------
    job : stages, config and folder
    choice : stages that are to run
    listener : is notified of stages and progress
    what : the command, for the log

    Raises
    ------
    InputError : if something cannot be used or written
    NoAnswerError : if a chosen stage has no answer: the stages that need it do not run, all other stages run, and then
        the error is raised. Other stages without an answer in the folder are no error, unless a chosen stage reports
        the results of all stages.
    """
    with locked(job.store.folder):
        job.store.sweep()
        record, log = Record(job.store), RunLog(job.store)
        decisions = plan(job, record, choice)
        log.begin(what)
        failures: dict[str, NoAnswerError] = {}
        try:
            with job.executor:
                work = partial(Run(job, record, log, listener, failures).do_all, decisions)
                interruptible(work) if job.ranks is None or job.ranks.comm.size == 1 else work()
        except BaseException as error:
            log.stop(error)
            raise
        keep_mesh_options(job.store, job.mesh_options)
        log.done()
        of_all = any(decision.stage.of_all and decision.stage.name in choice.chosen for decision in decisions)
        for decision in decisions:
            if decision.stage.name in failures and (of_all or decision.stage.name in choice.chosen):
                raise failures[decision.stage.name]


@dataclass
class Run:
    """Holds a run in its folder.

    Attributes
    ----------
    job : stages, config and folder
    record : outcomes of the stages
    log : log.txt
    listener : notified of stages and progress
    failures : errors of stages without an answer, by name, and of the stages that need them
    pending : stages and pictures that run concurrently with this process
    """

    job: Job
    record: Record
    log: RunLog
    listener: Listener
    failures: dict[str, NoAnswerError] = field(default_factory=dict)
    pending: list[Future[None]] = field(default_factory=list)

    def __post_init__(self) -> None:
        single_process = self.job.ranks is None or self.job.ranks.comm.size == 1  # else MPI started several processes
        self.executor = self.job.executor if single_process and self.job.executor.count > 1 else SERIAL
        self.one_at_a_time = RLock()  # who writes the record, the log and the input: stages beside others do so, too

    def do_all(self, decisions: Sequence[Decision]) -> None:
        """Run the stages in order, and concurrently where they do not depend on each other."""
        waiting = list(decisions)
        while waiting:
            for decision in [candidate for candidate in waiting if self._can_run_concurrently(candidate, waiting)]:
                waiting.remove(decision)
                self.work_in_other_process(decision)
            decision = waiting.pop(0)
            if decision.stage.of_all:
                self._wait()
            for future in self.pending:
                if future.done():
                    future.result()
            if self.has_to_work(decision):
                with self._recorded(decision) as job:
                    decision.stage.work(job)
        self._wait()

    def _wait(self) -> None:
        """Wait for all concurrent tasks; raises the first error."""
        for future in as_completed(self.pending):
            future.result()

    def _can_run_concurrently(self, decision: Decision, waiting: Sequence[Decision]) -> bool:
        """Return whether a stage can run now in another process, while this process has other work."""
        stage = decision.stage
        if self.executor.count < 2 or stage.concurrent_after is None or decision.action != "run":
            return False
        needed = {*stage.concurrent_after, *stage.needs}
        if needed & {other.stage.name for other in waiting} or needed & self.failures.keys():
            return False
        return any(
            other.action == "run" and other.stage.concurrent_after is None and not other.stage.of_all
            for other in waiting
        )

    def has_to_work(self, decision: Decision) -> bool:
        """Return whether a stage has to work. If the stage does not have to work, this function skips the stage,
        because of its settings or because a stage that it needs has no answer, or reuses its results.
        """
        stage, left = decision.stage, self.record[decision.stage.name]
        if decision.action == "off":
            self.listener.skip(decision, decision.reason)
            return False
        without = [name for name in stage.needs if name in self.failures]
        if without and not stage.of_all:
            self.failures[stage.name] = self.failures[without[0]]
            self.listener.skip(decision, f"{without[0]} has no answer")
            return False
        if decision.action == "reuse" and left is not None:
            self.listener.end(decision, left)
            self.log.line(f"{stage.name}: result of {left.ended} reused (computed in {left.seconds:.1f} s)")
        elif decision.action == "redraw" and stage.draw is not None:
            self.redraw(decision, stage.draw)
            self.log.line(f"{stage.name}: pictures drawn again")
        else:
            return True
        entry = self.record.entries[stage.name]
        if entry.outcome == "no answer":
            self.failures[stage.name] = NoAnswerError(entry.reason, entry.remedy)
        return False

    @contextmanager
    def _recorded(self, decision: Decision) -> Iterator[Job]:
        """Give the job for the work of a stage. Afterwards record the outcome, and draw the pictures."""
        started, failure = self._begin(decision), None
        try:
            yield replace(self.job, progress=started.progress)
        except NoAnswerError as error:  # all else is a fault of the input, of the machine, or of the program
            failure = error
        self._end(decision, started, failure)
        stage = decision.stage
        if stage.draw is not None and stage.drawn_after and self.record.entries[stage.name].files:
            self._draw(stage, stage.draw, started)

    def _draw(self, stage: Stage, draw: Callable[[Job], None], started: "StartedStage") -> None:
        """Draw the pictures of a stage, in another process if there is one."""

        def keep(drawn: "Future[None]") -> None:
            drawn.result()
            self._keep_pictures(stage, started.files_before)

        self.pending.append(then(self.executor.submit(draw, self._for_others()), keep))

    def _for_others(self) -> Job:
        """Return the job in the form that other processes receive."""
        return replace(self.job, stages=(), progress=silent, executor=SERIAL, ranks=None)

    def _keep_pictures(self, stage: Stage, before: Mapping[str, tuple[int, int]]) -> None:
        """Record the pictures of a stage."""
        with self.one_at_a_time:
            entry = self.record.entries[stage.name]
            pictures = self._drawn(stage, before)
            self.record.put(stage.name, replace(entry, pictures=pictures, title=title(self.job.config)))

    def work_in_other_process(self, decision: Decision) -> None:
        """Run the work of a stage in another process. The outcome is recorded as soon as the work ends."""
        started = self._begin(decision)

        def end(worked: "Future[None]") -> None:
            failure = None
            try:
                worked.result()
            except NoAnswerError as error:
                failure = error
            self._end(decision, started, failure)

        work = partial(_do_work, decision.stage.work, self._for_others())
        self.pending.append(then(self.executor.begin(work, lambda progress: started.progress(*progress)), end))

    def _begin(self, decision: Decision) -> "StartedStage":
        """Remove intermediate files of other inputs, and record that a stage has begun."""
        stage, store, left = decision.stage, self.job.store, self.record[decision.stage.name]
        inputs = made_from(stage, self.job, self.record)  # those of a report depend on how the others have ended
        with self.one_at_a_time:
            progress = self._logged(stage, self.listener.begin(decision))
            goes_on = left is not None and left.inputs == inputs and decision.reason != "asked for"
            if not goes_on:
                store.remove(stage.leftovers)
            self.log.line(f"{stage.name}: begins ({decision.reason})")
            self.record.put(stage.name, Entry(inputs, "begun"))
        return StartedStage(inputs, progress, store.marks((*stage.results, *stage.pictures)), time.perf_counter())

    def _end(self, decision: Decision, started: "StartedStage", failure: NoAnswerError | None) -> None:
        """Record how a stage has ended, and its files."""
        stage, store = decision.stage, self.job.store
        seconds = time.perf_counter() - started.start
        # What it did not write may be of other inputs, but for a stage that continues and has cleaned up before.
        results = (
            store.matching(stage.results) if stage.leftovers else store.written(stage.results, started.files_before)
        )
        to_draw = stage.drawn_after and bool(results)
        entry = Entry(
            started.inputs,
            "no answer" if failure else "part" if stage.partial(self.job) else "done",
            failure.reason if failure else "",
            failure.remedy if failure else "",
            round(seconds, 2),
            datetime.now().isoformat(" ", "seconds"),
            sizes(store, results),
            [] if to_draw else self._drawn(stage, started.files_before),
            "" if to_draw else title(self.job.config),
        )
        with self.one_at_a_time:
            if failure is None:
                leave_input(self.job.config, store)
                keep_mesh_options(store, self.job.mesh_options)
            else:
                self.failures[stage.name] = failure
            self.record.put(stage.name, entry)
            self.log.line(
                f"{stage.name}: {entry.outcome} after {seconds:.1f} s" + (f": {failure}" if failure else "")
            )  # fmt: skip
            self.listener.end(decision, entry)

    def redraw(self, decision: Decision, draw: Callable[[Job], None]) -> None:
        """Draw the pictures of a stage again from stored results."""
        stage = decision.stage
        self.listener.begin(decision)("pictures", None)
        before = self.job.store.marks(stage.pictures)
        draw(self.job)
        self._keep_pictures(stage, before)
        self.listener.end(decision, self.record.entries[stage.name])

    def _drawn(self, stage: Stage, before: Mapping[str, object]) -> list[str]:
        """Return the pictures that a stage has drawn, and delete those that it drew from earlier inputs."""
        pictures = self.job.store.written(stage.pictures, before)
        self.job.store.remove(sorted(set(self.job.store.matching(stage.pictures)) - set(pictures)))
        return pictures

    def _logged(self, stage: Stage, progress: Progress) -> Progress:
        """Return a progress callback that also writes a line to the log every 30 s."""
        last = time.monotonic()

        def tell(line: str, share: float | None) -> None:
            nonlocal last
            progress(line, share)
            if time.monotonic() - last > 30.0:
                last = time.monotonic()
                with self.one_at_a_time:
                    self.log.line(f"{stage.name}: {line}")

        return tell


def _do_work(work: Callable[[Job], None], job: Job, tell: Tell) -> None:
    """Do the work of a stage in the process of the stage."""
    work(replace(job, progress=lambda line, share: tell((line, share))))


@dataclass(frozen=True)
class StartedStage:
    """Holds a stage that has begun: fingerprints of its inputs, progress callback, files before it, and start
    time (s)."""

    inputs: dict[str, str]
    progress: Progress
    files_before: Mapping[str, tuple[int, int]]
    start: float


def leave_input(config: Config, store: Store) -> None:
    """Write section.toml, the complete input, and copies of the files that the input names.

    Parameters
    ----------
    config : section and settings; all defaults are written, too
    store : folder of the run. Copies lie beside section.toml, which names them; a second file of the same name is
        renamed to "table_name".
    """
    left: dict[str, Path] = {}
    for (table, key), file in config.named_files().items():
        name = file.name if left.get(file.name, file) == file else f"{table}_{file.name}"  # another of the same name
        left[name] = file
        with store.writing(name) as path:
            path.write_bytes(file.read_bytes())
        config = config.model_copy(update={table: getattr(config, table).model_copy(update={key: name})})
    store.write_text("section.toml", config.to_toml())


def redraw_all(job: Job, listener: Listener) -> list[str]:
    """Draw all pictures again from stored results.

    Parameters
    ----------
    job : stages, config and folder
    listener : is notified of stages and progress

    Returns
    -------
    A sentence for each stage whose pictures could not be drawn, with the reason.
    """
    messages = []
    with locked(job.store.folder):
        job.store.sweep()
        run = Run(job, Record(job.store), RunLog(job.store), listener)
        for decision in plan(job, run.record, Choice(())):
            stage = decision.stage
            if decision.action == "off" and not is_of_this_input(stage, job, run.record):
                messages.append(f"{stage.name}: no pictures: {decision.reason}")
            elif stage.draw is not None:
                run.redraw(replace(decision, action="redraw", reason="drawn again"), stage.draw)
            elif stage.pictures:
                messages.append(f"{stage.name}: its pictures are drawn only when it runs")
    return messages
