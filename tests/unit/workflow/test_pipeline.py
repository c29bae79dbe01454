"""Which stages run, which are reused, and what becomes of those that fail: on stages that take no time."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from meshes.errors import InputError
from tests.support.command_line import TOP
from tests.support.sections import slope
from workflow.run import pipeline
from workflow.run.errors import NoAnswerError
from workflow.run.lock import locked
from workflow.run.plan import Choice, Step, plan
from workflow.run.progress import Progress, duration, silent, time_left
from workflow.run.record import Entry, Record
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages import Job, Stage

Work = Callable[[Job], None]


class Heard:
    """A listener that remembers."""

    def __init__(self) -> None:
        self.ran: list[str] = []
        self.ended: dict[str, str] = {}
        self.skipped: dict[str, str] = {}

    def begin(self, step: Step) -> Progress:
        self.ran.append(step.stage.name)
        return silent

    def end(self, step: Step, entry: Entry) -> None:
        self.ended[step.stage.name] = entry.outcome

    def skip(self, step: Step, why: str) -> None:
        self.skipped[step.stage.name] = why


def leaves(name: str, text: str = "result") -> Work:
    """Work that leaves one file of a text."""
    return lambda job: job.store.write_text(name, text) and None


def stage(name: str, work: Work, needs: tuple[str, ...] = (), tables: tuple[str, ...] = (), **more: object) -> Stage:
    code = ("workflow.store",)
    files, pictures = (f"{name}.txt",), (f"{name}.png",)
    return Stage(name, f"the {name}", code[0], needs, tables, code, files, pictures, work, **more)  # type: ignore


@pytest.fixture
def toys(monkeypatch: pytest.MonkeyPatch) -> dict[str, Stage]:
    """Three stages in a row, and a report."""
    made = (
        stage("mesh", leaves("mesh.txt"), tables=("mesh",)),
        stage("fem", leaves("fem.txt"), ("mesh",), ("fem",)),
        stage("slide", leaves("slide.txt"), ("fem",), leftovers=("dem/*",)),
        stage("report", leaves("report.txt"), ("mesh", "fem", "slide"), ("figures",)),
    )
    monkeypatch.setattr("workflow.stages.ALL", made)
    return {each.name: each for each in made}


def replaced(monkeypatch: pytest.MonkeyPatch, toys: dict[str, Stage], name: str, work: Work) -> None:
    from dataclasses import replace

    toys[name] = replace(toys[name], work=work)
    monkeypatch.setattr("workflow.stages.ALL", tuple(toys.values()))


def go(folder: Path, choice: Choice | None = None, **settings: dict[str, object]) -> Heard:
    """Run the pipeline on the small slope."""
    heard = Heard()
    job = Job(Input.parse({**slope(), **settings}), Store(folder))
    pipeline.execute(job, choice or Choice.of(), heard, "test")
    return heard


ALL_OF_THEM = ["mesh", "fem", "slide", "report"]


def test_what_has_not_changed_is_reused(toys: dict[str, Stage], tmp_path: Path) -> None:
    assert go(tmp_path).ran == ALL_OF_THEM
    again = go(tmp_path)
    assert again.ran == []
    assert again.ended == dict.fromkeys(ALL_OF_THEM, "done")


@pytest.mark.parametrize(
    ("settings", "ran"),
    [
        ({"mesh": {"refine": 2}}, ALL_OF_THEM),
        ({"fem": {"sides": "fixed"}}, ["fem", "slide", "report"]),
        ({"figures": {"report_width": 800}}, ["report"]),
        ({"name": "other"}, ALL_OF_THEM),
    ],
)
def test_what_has_changed_runs_with_all_that_hangs_on_it(
    settings: dict[str, dict[str, object]], ran: list[str], toys: dict[str, Stage], tmp_path: Path
) -> None:
    go(tmp_path)
    assert go(tmp_path, **settings).ran == ran
    assert go(tmp_path, **settings).ran == []


def test_another_version_of_the_code_runs_again(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    go(tmp_path)
    monkeypatch.setattr("workflow.run.fingerprint.code", lambda names: "another")
    assert go(tmp_path).ran == ALL_OF_THEM


@pytest.mark.parametrize("damage", ["removed", "shortened"])
def test_a_result_that_is_gone_is_made_again(damage: str, toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    (tmp_path / "fem.txt").unlink() if damage == "removed" else (tmp_path / "fem.txt").write_text("res")
    assert go(tmp_path).ran == ["fem", "report"]
    assert (tmp_path / "fem.txt").read_text() == "result"


def test_missing_pictures_are_drawn_without_computing(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace

    def work(job: Job) -> None:
        job.store.write_text("mesh.txt", "result")
        job.store.write_text("mesh.png", "picture")

    def redraw(job: Job) -> bool:
        job.store.write_text("mesh.png", "drawn again")
        return True

    toys["mesh"] = replace(toys["mesh"], work=work, redraw=redraw)
    monkeypatch.setattr("workflow.stages.ALL", tuple(toys.values()))
    go(tmp_path)
    (tmp_path / "mesh.png").unlink()
    (tmp_path / "mesh.txt").write_text("RESULT")  # as long as before: nobody computes it again
    go(tmp_path)
    assert (tmp_path / "mesh.png").read_text() == "drawn again"
    assert (tmp_path / "mesh.txt").read_text() == "RESULT"


def test_force_from_and_only(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    assert go(tmp_path, Choice.of(force=True)).ran == ALL_OF_THEM
    assert go(tmp_path, Choice.of(start="fem")).ran == ["fem", "slide", "report"]
    assert go(tmp_path, Choice.of(only=("fem",), force=True)).ran == ["fem"]
    assert go(tmp_path, Choice.of(only=("fem",))).ran == []
    assert go(tmp_path, Choice.up_to("fem", force=True)).ran == ["fem"]
    with pytest.raises(InputError, match="expected a stage, one of mesh, fem, slide, report"):
        Choice.of(only=("mehs",))


def test_only_does_not_work_on_what_others_made(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    with pytest.raises(InputError, match=r"needs the stage mesh: changed: \[mesh\]"):
        go(tmp_path, Choice.of(only=("fem",)), mesh={"refine": 2})
    with pytest.raises(InputError, match="needs the stage fem: it has not run yet"):
        go(tmp_path / "new", Choice.of(only=("mesh", "slide")))
    assert not (tmp_path / "new/mesh.txt").exists()


def test_a_dry_run_says_why(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    job = Job(Input.parse({**slope(), "fem": {"sides": "fixed"}}), Store(tmp_path))
    steps = {step.stage.name: (step.action, step.why) for step in plan(job, Record(job.store), Choice.of())}
    assert steps == {
        "mesh": ("reuse", ""),
        "fem": ("run", "changed: [fem]"),
        "slide": ("run", "changed: fem"),
        "report": ("run", "changed: fem, slide"),
    }


def test_no_answer_ends_what_hangs_on_it_but_not_the_report(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(job: Job) -> None:
        job.store.write_text("fem.txt", "undecided")
        raise NoAnswerError("the path ended undecided", "refine the mesh")

    replaced(monkeypatch, toys, "fem", work)
    for _ in range(2):  # the second time nothing runs, and the answer is still none
        heard = Heard()
        job = Job(Input.parse(slope()), Store(tmp_path))
        with pytest.raises(NoAnswerError, match="undecided; refine the mesh"):
            pipeline.execute(job, Choice.of(), heard, "test")
        assert heard.ended == {"mesh": "done", "fem": "no answer", "report": "done"}
        assert heard.skipped == {"slide": "fem has no answer"}
    entry = Record(job.store)["fem"]
    assert entry is not None
    assert (entry.reason, entry.remedy) == ("the path ended undecided", "refine the mesh")
    assert list(entry.files) == ["fem.txt"]


def test_without_an_answer_older_files_are_not_taken_for_it(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    go(tmp_path)
    os.utime(tmp_path / "fem.txt", (1e9, 1e9))

    def work(job: Job) -> None:
        raise NoAnswerError("it fails under its own weight")

    replaced(monkeypatch, toys, "fem", work)
    with pytest.raises(NoAnswerError):
        go(tmp_path, fem={"sides": "fixed"})
    entry = Record(Store(tmp_path))["fem"]
    assert entry is not None
    assert entry.files == {}


def test_a_stage_that_was_stopped_goes_on_from_what_it_left(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(job: Job) -> None:
        journal = job.store.folder / "dem/trials.jsonl"
        journal.parent.mkdir(exist_ok=True)
        before = journal.read_text() if journal.exists() else ""
        journal.write_text(before + "trial\n")
        if before.count("trial") < 2:
            raise KeyboardInterrupt
        job.store.write_text("slide.txt", "result")

    replaced(monkeypatch, toys, "slide", work)
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            go(tmp_path)
    assert go(tmp_path).ran == ["slide", "report"]
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 3
    # other inputs, or force: nothing of the old is used
    with pytest.raises(KeyboardInterrupt):
        go(tmp_path, fem={"sides": "fixed"})
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 1
    with pytest.raises(KeyboardInterrupt):
        go(tmp_path, Choice.of(start="slide"), fem={"sides": "fixed"})
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 1


def test_some_cases_only_are_a_part(toys: dict[str, Stage], tmp_path: Path) -> None:
    job = Job(Input.parse(slope()), Store(tmp_path), cases=(2,))
    pipeline.execute(job, Choice.up_to("slide"), Heard(), "test")
    assert Record(job.store)["slide"].outcome == "part"  # type: ignore[union-attr]
    assert go(tmp_path).ran == ["slide", "report"]


def test_a_fault_of_the_program_keeps_what_is_done(
    toys: dict[str, Stage], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(job: Job) -> None:
        raise ZeroDivisionError("somewhere")

    right = toys["fem"].work
    replaced(monkeypatch, toys, "fem", work)
    with pytest.raises(ZeroDivisionError):
        go(tmp_path)
    assert "ZeroDivisionError: somewhere" in (tmp_path / "log.txt").read_text()
    replaced(monkeypatch, toys, "fem", right)
    assert go(tmp_path).ran == ["fem", "slide", "report"]


@pytest.mark.parametrize(
    "text", ["", "{", '{"version": 99, "stages": {}}', '{"version": 1, "stages": {"fem": {}}}', "[]"]
)
def test_a_record_that_cannot_be_read_is_forgotten(text: str, toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    (tmp_path / ".noshiro/stages.json").write_text(text)
    assert go(tmp_path).ran == ALL_OF_THEM


def test_half_written_files_of_the_dead_are_swept(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    (tmp_path / ".123-fem.txt").write_text("hal")
    (tmp_path / ".hidden").write_text("mine")
    go(tmp_path)
    assert not (tmp_path / ".123-fem.txt").exists()
    assert (tmp_path / ".hidden").exists()


# --- The lock -----------------------------------------------------------------------------------------------------

HOLDER = """
import sys, time
from pathlib import Path
from workflow.run.lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_two_runs_do_not_share_a_folder_and_a_dead_one_holds_nothing(toys: dict[str, Stage], tmp_path: Path) -> None:
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=TOP)
    try:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(InputError, match=rf"is in use by another run \(process {holder.pid} on "):
            go(tmp_path)
        assert not (tmp_path / "mesh.txt").exists()
        holder.send_signal(signal.SIGKILL)
        holder.wait(timeout=10)
        assert go(tmp_path).ran == ALL_OF_THEM
    finally:
        holder.kill()
        holder.wait()


def test_children_do_not_keep_the_lock(tmp_path: Path) -> None:
    """The workers of a run that was killed live on for a while."""
    fork = HOLDER.replace('print("held"', 'import os\n    if os.fork() == 0: time.sleep(60)\n    print("held"')
    holder = subprocess.Popen([sys.executable, "-c", fork, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=TOP,
                              start_new_session=True)  # fmt: skip
    try:
        assert holder.stdout is not None
        holder.stdout.readline()
        os.kill(holder.pid, signal.SIGKILL)
        holder.wait(timeout=10)
        with locked(tmp_path):
            pass
    finally:
        os.killpg(holder.pid, signal.SIGKILL)


# --- The log and the clock ----------------------------------------------------------------------------------------


def test_the_log_says_what_ran_with_what_and_for_how_long(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    go(tmp_path)
    text = (tmp_path / "log.txt").read_text()
    for words in (
        "--- test",
        "host: ",
        "versions: python 3.",
        "noshiro 0.1.0",
        "numpy ",
        "mesh: begins (it has not run yet)",
    ):
        assert words in text
    assert text.count("fem: done after") == 1
    assert text.count("fem: reused, made in") == 1


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.44, "0.4 s"), (9.96, "10 s"), (59.4, "59 s"), (60, "1 min 0 s"), (7500, "2 h 5 min")]
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_time_left() -> None:
    assert time_left(30.0, 0.25) == pytest.approx(90.0)
    assert time_left(30.0, 1.0) == 0.0
    assert time_left(30.0, None) is None
    assert time_left(30.0, 0.0) is None


def test_the_record_is_small_and_whole(toys: dict[str, Stage], tmp_path: Path) -> None:
    go(tmp_path)
    data = json.loads((tmp_path / ".noshiro/stages.json").read_text())
    assert set(data["stages"]) == set(ALL_OF_THEM)
    assert data["stages"]["fem"]["files"] == {"fem.txt": 6}
    assert time.strptime(data["stages"]["fem"]["ended"], "%Y-%m-%d %H:%M:%S")
