"""Which stages run, which are reused, and what becomes of those that fail: on stages that take no time."""

import os
from dataclasses import replace
from pathlib import Path

import pytest

from meshes.errors import InputError, NoAnswerError
from tests.support.toy_stages import ALL_OF_THEM, Heard, Toys, leaves
from workflow.run import pipeline
from workflow.run.plan import Choice, plan
from workflow.run.record import Record
from workflow.run.stage import Job
from workflow.run.store import Store


def test_what_has_not_changed_is_reused(toys: Toys, tmp_path: Path) -> None:
    assert toys.go(tmp_path).ran == ALL_OF_THEM
    again = toys.go(tmp_path)
    assert again.ran == []
    assert again.ended == dict.fromkeys(ALL_OF_THEM, "done")


@pytest.mark.parametrize(
    ("settings", "ran"),
    [
        ({"mesh": {"refine": 2}}, ALL_OF_THEM),
        ({"fem": {"sides": "fixed"}}, ["fem", "slide", "report"]),
        ({"figures": {"report_width": 800}}, ["report"]),
        ({"beyond": "10 m"}, ALL_OF_THEM),
        ({"name": "other", "title": "Another"}, ["report"]),
    ],
)
def test_what_has_changed_runs_with_all_that_hangs_on_it(
    settings: dict[str, dict[str, object]], ran: list[str], toys: Toys, tmp_path: Path
) -> None:
    toys.go(tmp_path)
    assert toys.go(tmp_path, **settings).ran == ran
    assert toys.go(tmp_path, **settings).ran == []


def test_another_version_of_the_code_runs_again(toys: Toys, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    toys.go(tmp_path)
    monkeypatch.setattr("workflow.run.fingerprint.program", lambda: "another")
    assert toys.go(tmp_path).ran == ALL_OF_THEM


@pytest.mark.parametrize("damage", ["removed", "shortened"])
def test_a_result_that_is_gone_is_made_again(damage: str, toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    (tmp_path / "fem.txt").unlink() if damage == "removed" else (tmp_path / "fem.txt").write_text("res")
    assert toys.go(tmp_path).ran == ["fem", "report"]
    assert (tmp_path / "fem.txt").read_text() == "result"


def test_missing_pictures_are_drawn_without_computing(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        job.store.write_text("mesh.txt", "result")
        job.store.write_text("mesh.png", "picture")

    def draw(job: Job) -> None:
        job.store.write_text("mesh.png", "drawn again")

    toys.change("mesh", work=work, draw=draw)
    toys.go(tmp_path)
    (tmp_path / "mesh.png").unlink()
    (tmp_path / "mesh.txt").write_text("RESULT")  # as long as before: nobody computes it again
    toys.go(tmp_path)
    assert (tmp_path / "mesh.png").read_text() == "drawn again"
    assert (tmp_path / "mesh.txt").read_text() == "RESULT"


def test_pictures_have_the_new_title_without_computing(toys: Toys, tmp_path: Path) -> None:
    def draw(job: Job) -> None:
        job.store.write_text("mesh.png", job.config.section.title)

    toys.change("mesh", work=leaves("mesh.txt"), draw=draw, drawn_after=True)
    toys.go(tmp_path, title="Before")
    (tmp_path / "mesh.txt").write_text("RESULT")  # as long as before: nobody computes it again
    toys.go(tmp_path, title="After")
    assert (tmp_path / "mesh.png").read_text() == "After"
    assert (tmp_path / "mesh.txt").read_text() == "RESULT"


def test_pictures_of_other_inputs_go(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        for kh in job.config.fem.kh:
            job.store.write_text(f"fem_kh_{kh}.png", "picture")

    toys.change("fem", work=work, draw=work, leftovers=("dem/*",))  # goes on where it was stopped
    toys.go(tmp_path, fem={"kh": [0.2, 0.3]})
    toys.go(tmp_path, fem={"kh": [0.25]})
    entry = Record(Store(tmp_path))["fem"]
    assert entry is not None
    assert entry.pictures == ["fem_kh_0.25.png"]
    assert [path.name for path in tmp_path.glob("*.png")] == ["fem_kh_0.25.png"]


def test_only_a_stage_with_checkpoints_is_said_to_continue(toys: Toys, tmp_path: Path) -> None:
    """The log said that the finite elements continue, which began again."""

    def stops(_: Job) -> None:
        raise KeyboardInterrupt

    for leftovers, words in (((), "begins again"), (("dem/*",), "continues")):
        folder = tmp_path / words
        toys.change("fem", work=stops, leftovers=leftovers)
        with pytest.raises(KeyboardInterrupt):
            toys.go(folder)
        toys.change("fem", work=leaves("fem.txt"), leftovers=leftovers)
        toys.go(folder)
        assert f"fem: begins (the stage was stopped, and {words})" in (folder / "log.txt").read_text(encoding="utf-8")


def test_force_from_and_only(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    assert toys.go(tmp_path, toys.choose(force=True)).ran == ALL_OF_THEM
    assert toys.go(tmp_path, toys.choose(start="fem")).ran == ["fem", "slide", "report"]
    assert toys.go(tmp_path, toys.choose(only=("fem",), force=True)).ran == ["fem"]
    assert toys.go(tmp_path, toys.choose(only=("fem",))).ran == []
    assert toys.go(tmp_path, Choice.up_to(tuple(toys.values()), "fem", force=True)).ran == ["fem"]
    with pytest.raises(InputError, match="expected a stage, one of mesh, fem, slide, report"):
        toys.choose(only=("mehs",))


def test_what_is_asked_for_by_name_runs_in_whatever_order_it_is_named(toys: Toys, tmp_path: Path) -> None:
    toys.change("slide", unwanted=lambda config: "not asked for")
    for number, options in enumerate(
        ({"only": ("slide", "report")}, {"only": ("report", "slide")}, {"start": "slide"})
    ):
        folder = tmp_path / str(number)
        toys.go(folder, toys.choose(start="fem"))
        assert not (folder / "slide.txt").exists()
        assert toys.go(folder, toys.choose(**options)).ran == ["slide", "report"]


def test_only_does_not_work_on_what_others_made(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    with pytest.raises(InputError, match=r"needs the stage mesh: inputs changed: \[mesh\]"):
        toys.go(tmp_path, toys.choose(only=("fem",)), mesh={"refine": 2})
    with pytest.raises(InputError, match="needs the stage fem: not run"):
        toys.go(tmp_path / "new", toys.choose(only=("mesh", "slide")))
    assert not (tmp_path / "new/mesh.txt").exists()


def test_a_dry_run_says_why(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    job = toys.job(tmp_path, fem={"sides": "fixed"})
    decisions = {
        decision.stage.name: (decision.action, decision.reason)
        for decision in plan(job, Record(job.store), toys.choose())
    }
    assert decisions == {
        "mesh": ("reuse", ""),
        "fem": ("run", "inputs changed: [fem]"),
        "slide": ("run", "inputs changed: fem"),
        "report": ("run", "inputs changed: fem, slide"),
    }


def test_no_answer_ends_what_hangs_on_it_but_not_the_report(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        job.store.write_text("fem.txt", "undecided")
        raise NoAnswerError("the finite elements found no limit load", "refine the mesh")

    toys.change("fem", work=work)
    for _ in range(2):  # the second time nothing runs, and the answer is still none
        heard = Heard()
        job = toys.job(tmp_path)
        with pytest.raises(NoAnswerError, match="no limit load; refine the mesh"):
            pipeline.execute(job, toys.choose(), heard, "test")
        assert heard.ended == {"mesh": "done", "fem": "no answer", "report": "done"}
        assert heard.skipped == {"slide": "fem has no answer"}
    entry = Record(job.store)["fem"]
    assert entry is not None
    assert (entry.reason, entry.remedy) == ("the finite elements found no limit load", "refine the mesh")
    assert list(entry.files) == ["fem.txt"]


def test_a_stage_with_an_answer_does_not_fail_for_another_that_had_none(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        raise NoAnswerError("it fails under its own weight")

    toys.change("fem", work=work)
    with pytest.raises(NoAnswerError):
        toys.go(tmp_path, toys.choose(only=("mesh", "fem")))
    assert toys.go(tmp_path, Choice.up_to(tuple(toys.values()), "mesh", force=True)).ran == ["mesh"]
    with pytest.raises(NoAnswerError):
        toys.go(tmp_path, Choice.up_to(tuple(toys.values()), "slide"))


def test_without_an_answer_older_files_are_not_taken_for_it(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    os.utime(tmp_path / "fem.txt", (1e9, 1e9))

    def work(job: Job) -> None:
        raise NoAnswerError("it fails under its own weight")

    toys.change("fem", work=work)
    with pytest.raises(NoAnswerError):
        toys.go(tmp_path, fem={"sides": "fixed"})
    entry = Record(Store(tmp_path))["fem"]
    assert entry is not None
    assert entry.files == {}


def test_a_stage_that_was_stopped_goes_on_from_what_it_left(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        journal = job.store.folder / "dem/trials.jsonl"
        journal.parent.mkdir(exist_ok=True)
        before = journal.read_text() if journal.exists() else ""
        journal.write_text(before + "trial\n")
        if before.count("trial") < 2:
            raise KeyboardInterrupt
        job.store.write_text("slide.txt", "result")

    toys.change("slide", work=work)
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            toys.go(tmp_path)
    assert toys.go(tmp_path).ran == ["slide", "report"]
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 3
    # other inputs, or force: nothing of the old is used
    with pytest.raises(KeyboardInterrupt):
        toys.go(tmp_path, fem={"sides": "fixed"})
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 1
    with pytest.raises(KeyboardInterrupt):
        toys.go(tmp_path, toys.choose(start="slide"), fem={"sides": "fixed"})
    assert (tmp_path / "dem/trials.jsonl").read_text().count("trial") == 1


def test_some_cases_only_are_a_part(toys: Toys, tmp_path: Path) -> None:
    job = replace(toys.job(tmp_path), cases=(2,))
    pipeline.execute(job, Choice.up_to(tuple(toys.values()), "slide"), Heard(), "test")
    assert Record(job.store)["slide"].outcome == "part"  # type: ignore[union-attr]
    assert toys.go(tmp_path).ran == ["slide", "report"]


def test_a_fault_of_the_program_keeps_what_is_done(toys: Toys, tmp_path: Path) -> None:
    def work(job: Job) -> None:
        raise ZeroDivisionError("somewhere")

    right = toys["fem"].work
    toys.change("fem", work=work)
    with pytest.raises(ZeroDivisionError):
        toys.go(tmp_path)
    assert "ZeroDivisionError: somewhere" in (tmp_path / "log.txt").read_text()
    toys.change("fem", work=right)
    assert toys.go(tmp_path).ran == ["fem", "slide", "report"]


@pytest.mark.parametrize(
    "text", ["", "{", '{"version": 99, "stages": {}}', '{"version": 3, "stages": {"fem": {}}}', "[]"]
)
def test_a_record_that_cannot_be_read_is_forgotten(text: str, toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    (tmp_path / ".noshiro/stages.json").write_text(text)
    assert toys.go(tmp_path).ran == ALL_OF_THEM


def test_results_of_an_older_version_are_computed_anew_and_told_so(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    record = tmp_path / ".noshiro/stages.json"
    record.write_text(record.read_text().replace('"version": 3', '"version": 2').replace('"title"', '"drawing"'))
    job = toys.job(tmp_path)
    whys = {decision.reason for decision in plan(job, Record(job.store), toys.choose())}
    assert whys == {"computed by another version of noshiro"}
    assert toys.go(tmp_path).ran == ALL_OF_THEM


def test_half_written_files_of_the_dead_are_swept(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    (tmp_path / ".123-fem.txt").write_text("hal")
    (tmp_path / ".hidden").write_text("mine")
    toys.go(tmp_path)
    assert not (tmp_path / ".123-fem.txt").exists()
    assert (tmp_path / ".hidden").exists()
