"""Pictures that another process draws while the next stage works."""

import os
import signal
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from meshes.errors import InputError, NoAnswerError
from meshes.executor import LostError, Processes
from tests.support.toy_stages import Heard, Toys
from workflow.run import pipeline
from workflow.run.plan import plan
from workflow.run.record import Record
from workflow.run.stage import Job


def draws(job: Job) -> None:
    """Leaves a picture, and who drew it."""
    job.store.write_text("mesh_1.png", str(os.getpid()))


def fails(job: Job) -> None:
    raise InputError("mesh_1.png", ["cannot be written: no space"])


def dies(job: Job) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def run(toys: Toys, folder: Path, draw: Callable[[Job], None], several: bool = True) -> None:
    """The toy stages, of which the mesh is drawn after its work."""
    toys.change("mesh", draw=draw, drawn_after=True)
    job = toys.job(folder)
    pipeline.execute(replace(job, executor=Processes(2)) if several else job, toys.choose(), Heard(), "test")


@pytest.mark.parametrize("several", [True, False])
def test_it_draws_beside_what_comes_next_or_this_process_does(toys: Toys, tmp_path: Path, several: bool) -> None:
    of_process = str(os.getpid())
    run(toys, tmp_path, draws, several)
    assert ((tmp_path / "mesh_1.png").read_text() != of_process) == several
    assert Record(toys.job(tmp_path).store).entries["mesh"].pictures == ["mesh_1.png"]


def test_before_the_report_all_is_drawn(toys: Toys, tmp_path: Path) -> None:
    there: list[bool] = []
    toys.change("report", work=lambda job: there.append((tmp_path / "mesh_1.png").is_file()))
    run(toys, tmp_path, draws)
    assert there == [True]


def test_the_error_of_a_drawing_is_raised_and_the_results_are_kept(toys: Toys, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no space"):
        run(toys, tmp_path, fails)
    assert (tmp_path / "mesh.txt").is_file()
    assert Record(toys.job(tmp_path).store).entries["mesh"].outcome == "done"


def breaks(job: Job) -> None:
    raise KeyError("in the drawing")


def test_a_fault_of_a_drawing_is_told_with_where_it_was(toys: Toys, tmp_path: Path) -> None:
    with pytest.raises(KeyError, match="in the drawing") as caught:
        run(toys, tmp_path, breaks)
    assert "in breaks" in str(caught.value.__cause__)


def finds_nothing(job: Job) -> None:
    raise NoAnswerError("there is none", "")


def test_a_stage_without_an_answer_has_nothing_to_be_drawn(toys: Toys, tmp_path: Path) -> None:
    """Older pictures go, and the next run does not try to draw."""
    (tmp_path / "mesh_1.png").write_text("of another input")
    toys.change("mesh", work=finds_nothing)
    with pytest.raises(NoAnswerError):
        run(toys, tmp_path, draws)
    assert not (tmp_path / "mesh_1.png").exists()
    decisions = plan(toys.job(tmp_path), Record(toys.job(tmp_path).store), toys.choose())
    assert [each.action for each in decisions if each.stage.name == "mesh"] == ["reuse"]


def test_what_was_stopped_before_it_was_drawn_is_drawn_without_computing(toys: Toys, tmp_path: Path) -> None:
    with pytest.raises(LostError):
        run(toys, tmp_path, dies)
    toys.change("mesh", draw=draws)
    decisions = plan(toys.job(tmp_path), Record(toys.job(tmp_path).store), toys.choose())
    messages = {each.stage.name: (each.action, each.reason) for each in decisions}
    assert messages["mesh"] == ("redraw", "the stage was stopped before its pictures were drawn")
