"""Stages that run beside others: when they begin, what becomes of their results, and of those that fail or are left."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from dem.team import Tell, alone
from meshes.errors import InputError
from tests.support.toy_stages import Heard, Toys, stage
from workflow.run import pipeline
from workflow.run.errors import NoAnswerError
from workflow.run.plan import Choice
from workflow.run.record import Record
from workflow.run.stage import Job
from workflow.run.store import Store


class Threads:
    """A team that does a job beside others in the thread that asks for it."""

    several = True

    def __init__(self) -> None:
        self.hired = 0

    def __call__(self, *given: Any, **more: Any) -> Any:
        return alone(*given, **more)

    def hire(self) -> None:
        self.hired += 1

    def beside(
        self, work: Callable[[Any, Tell], Any], given: Any, heard: Callable[[int, Any], None], stop: Event
    ) -> Any:
        return work(given, lambda told: heard(0, told))


@pytest.fixture
def more(toys: Toys) -> Toys:
    """The toys, with one that may run beside others once there is a mesh."""
    bounds = stage("bounds", reads=("bounds",), beside=("mesh",))
    report = replace(toys["report"], needs=("mesh", "fem", "slide", "bounds"))
    return Toys({**{name: toys[name] for name in ("mesh", "fem", "slide")}, "bounds": bounds, "report": report})


def go(toys: Toys, folder: Path, choice: Choice | None = None) -> Heard:
    heard = Heard()
    job = replace(toys.job(folder), team=Threads())
    pipeline.execute(job, choice or toys.choose(), heard, "test")
    return heard


def test_it_begins_once_what_it_waits_for_has_ended_and_is_kept_while_others_run(more: Toys, tmp_path: Path) -> None:
    def slide(job: Job) -> None:
        assert kept.wait(10.0)
        entry = Record(Store(tmp_path))["bounds"]  # on disk, though this stage goes on
        assert entry is not None
        assert entry.outcome == "done"
        assert entry.files == {"bounds.txt": 6}
        job.store.write_text("slide.txt", "result")

    kept = Event()
    more.change("slide", work=slide)

    class Listening(Heard):
        def end(self, decision: Any, entry: Any) -> None:
            super().end(decision, entry)
            if decision.stage.name == "bounds":
                kept.set()

    heard = Listening()
    pipeline.execute(replace(more.job(tmp_path), team=Threads()), more.choose(), heard, "test")
    assert heard.ran == ["mesh", "bounds", "fem", "slide", "report"]
    assert set(heard.ended.values()) == {"done"}
    assert go(more, tmp_path).ran == []
    assert more.go(tmp_path).ran == []  # a run without a team takes its results as they are


def test_nothing_runs_beside_where_nothing_else_runs(more: Toys, tmp_path: Path) -> None:
    go(more, tmp_path)
    job = replace(more.job(tmp_path), team=Threads())
    pipeline.execute(job, more.choose(only=("bounds", "report"), force=True), Heard(), "test")
    assert job.team.hired == 0  # type: ignore[attr-defined]


def test_the_report_tells_of_one_without_an_answer(more: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        raise NoAnswerError("no bracket", "more triangles")

    more.change("bounds", work=work)
    heard = Heard()
    with pytest.raises(NoAnswerError, match="no bracket; more triangles"):
        pipeline.execute(replace(more.job(tmp_path), team=Threads()), more.choose(), heard, "test")
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
    begun, left = Event(), Event()

    class Slow(Threads):
        def beside(self, work: Any, given: Any, heard: Any, stop: Event) -> Any:
            begun.set()
            assert stop.wait(10.0)
            left.set()
            return super().beside(work, given, heard, stop)

    def fem(job: Job) -> None:
        assert begun.wait(10.0)
        raise KeyboardInterrupt

    more.change("fem", work=fem)
    with pytest.raises(KeyboardInterrupt):
        pipeline.execute(replace(more.job(tmp_path), team=Slow()), more.choose(), Heard(), "test")
    assert left.is_set()
    entry = Record(Store(tmp_path))["bounds"]
    assert entry is not None
    assert entry.outcome == "begun"  # what came after nobody heard of
