"""Stages that run beside others: when they begin, what becomes of their results, and of those that fail or are left."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import Any, TypeVar

import pytest

from meshes.errors import InputError, NoAnswerError
from meshes.executor import Executor, Tell
from tests.support.toy_stages import Heard, Toys, stage
from workflow.run import pipeline
from workflow.run.plan import Choice
from workflow.run.record import Record
from workflow.run.stage import Job
from workflow.run.store import Store

A = TypeVar("A")


class Threads(Executor):
    """Does tasks beside others in threads of this process."""

    count = 2

    def __init__(self) -> None:
        self.started, self.pool = 0, ThreadPoolExecutor(2)

    def begin(self, work: Callable[[Tell], A], heard: Tell | None = None) -> "Future[A]":
        self.started += 1
        return self.pool.submit(work, heard or (lambda _: None))


@pytest.fixture
def more(toys: Toys) -> Toys:
    """The toys, with one that may run beside others once there is a mesh."""
    bounds = stage("bounds", reads=("bounds",), concurrent_after=("mesh",))
    report = replace(toys["report"], needs=("mesh", "fem", "slide", "bounds"))
    return Toys({**{name: toys[name] for name in ("mesh", "fem", "slide")}, "bounds": bounds, "report": report})


def go(toys: Toys, folder: Path, choice: Choice | None = None) -> Heard:
    heard = Heard()
    job = replace(toys.job(folder), executor=Threads())
    pipeline.execute(job, choice or toys.choose(), heard, "test")
    return heard


def test_it_begins_once_what_it_waits_for_has_ended_and_is_kept_while_others_run(more: Toys, tmp_path: Path) -> None:
    def slide(job: Job) -> None:
        assert event.wait(10.0)
        entry = Record(Store(tmp_path))["bounds"]  # on disk, though this stage goes on
        assert entry is not None
        assert entry.outcome == "done"
        assert entry.files == {"bounds.txt": 6}
        job.store.write_text("slide.txt", "result")

    event = Event()
    more.change("slide", work=slide)

    class Listening(Heard):
        def end(self, decision: Any, entry: Any) -> None:
            super().end(decision, entry)
            if decision.stage.name == "bounds":
                event.set()

    heard = Listening()
    pipeline.execute(replace(more.job(tmp_path), executor=Threads()), more.choose(), heard, "test")
    assert heard.ran == ["mesh", "bounds", "fem", "slide", "report"]
    assert set(heard.ended.values()) == {"done"}
    assert go(more, tmp_path).ran == []
    assert more.go(tmp_path).ran == []  # a run without a team takes its results as they are


def test_nothing_runs_beside_where_nothing_else_runs(more: Toys, tmp_path: Path) -> None:
    go(more, tmp_path)
    job = replace(more.job(tmp_path), executor=Threads())
    pipeline.execute(job, more.choose(only=("bounds", "report"), force=True), Heard(), "test")
    assert job.executor.started == 0  # type: ignore[attr-defined]


def test_the_report_tells_of_one_without_an_answer(more: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        raise NoAnswerError("no bracket", "more triangles")

    more.change("bounds", work=work)
    heard = Heard()
    with pytest.raises(NoAnswerError, match="no bracket; more triangles"):
        pipeline.execute(replace(more.job(tmp_path), executor=Threads()), more.choose(), heard, "test")
    assert heard.ended == {"mesh": "done", "bounds": "no answer", "fem": "done", "slide": "done", "report": "done"}


@pytest.mark.parametrize("error", [InputError("bounds", ["no"]), RuntimeError("a fault")])
def test_an_error_beside_ends_the_run(error: Exception, more: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        raise error

    more.change("bounds", work=work)
    with pytest.raises(type(error)):
        go(more, tmp_path)
    entry = Record(Store(tmp_path))["bounds"]
    assert entry is not None
    assert entry.outcome == "begun"  # and so it runs again


def test_ctrl_c_in_one_stage_leaves_what_runs_beside(more: Toys, tmp_path: Path) -> None:
    event, may_end = Event(), Event()

    def bounds(job: Job) -> None:
        event.set()
        assert may_end.wait(10.0)

    class Left(Threads):
        def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
            shut.set()

    def fem(job: Job) -> None:
        assert event.wait(10.0)
        raise KeyboardInterrupt

    shut = Event()
    more.change("fem", work=fem)
    more.change("bounds", work=bounds)
    with pytest.raises(KeyboardInterrupt):
        pipeline.execute(replace(more.job(tmp_path), executor=Left()), more.choose(), Heard(), "test")
    assert shut.is_set()  # before the folder is let go
    entry = Record(Store(tmp_path))["bounds"]
    may_end.set()
    assert entry is not None
    assert entry.outcome == "begun"
