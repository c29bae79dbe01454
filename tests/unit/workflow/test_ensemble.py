"""Tasks on workers: each is computed once, whoever dies meanwhile, and the answers are those of one worker."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from distributed import LocalCluster

from meshes.errors import InputError
from tests.support import TOP
from tests.support.tasks import Number, Numbers, breaks, dies_always, dies_once, slow_total, total
from workflow.study.ensemble import Ensemble, TaskOutcome
from workflow.study.result_cache import Outcome, ResultCache
from workflow.study.task import Task


def totals(count: int) -> list[Task[Numbers, Number]]:
    return [Task(total, Numbers(values=(0.1 * k, 0.2))) for k in range(count)]


def test_rows_come_in_the_order_of_the_tasks_and_are_kept(tmp_path: Path) -> None:
    first = Ensemble(tmp_path, 2).rows(totals(5))
    assert [row.answer for row in first] == [Number(value=0.1 * k + 0.2) for k in range(5)]
    messages: list[tuple[int, int, int]] = []
    longer = Ensemble(tmp_path, 2).rows(totals(7), lambda *counts: messages.append(counts))
    assert messages[0] == (5, 0, 7)
    assert [row.answer for row in longer[:5]] == [row.answer for row in first]


def test_equal_tasks_are_computed_once(tmp_path: Path) -> None:
    task = Task(slow_total, Numbers(values=(1.0, 2.0), folder=str(tmp_path)))
    assert [row.answer for row in Ensemble(tmp_path / "kept", 2).rows([task, task])] == [Number(value=3.0)] * 2
    assert (tmp_path / "(1.0, 2.0)").read_text() == "begun\n"


def test_a_failed_task_is_a_row_with_its_reason(tmp_path: Path) -> None:
    numbers = Numbers(values=(-1.0,), folder=str(tmp_path))
    messages: list[tuple[int, int, int]] = []
    tasks = [Task(total, numbers), Task(breaks, numbers), Task(total, Numbers(values=(1.0,)))]
    rows = Ensemble(tmp_path, 1).rows(tasks, lambda *counts: messages.append(counts))
    assert [row.reason for row in rows] == [
        "a number is negative; take its absolute value",
        "ZeroDivisionError: what no one expected",
        "",
    ]
    assert messages[0] == (0, 0, 3)
    assert messages[-1] == (3, 2, 3)
    # what may be mended is tried again, what has no answer is not
    messages.clear()
    Ensemble(tmp_path, 1).rows(tasks, lambda *counts: messages.append(counts))
    assert messages == [(2, 1, 3), (3, 2, 3)]


def test_a_worker_that_dies_costs_its_task_a_second_try_and_no_third(tmp_path: Path) -> None:
    once, always = tmp_path / "once", tmp_path / "always"
    for folder in (once, always):
        folder.mkdir()
    tasks = [
        Task(dies_once, Numbers(values=(1.0, 2.0), folder=str(once))),
        Task(dies_always, Numbers(values=(1.0, 2.0), folder=str(always))),
        *totals(4),
    ]
    rows = Ensemble(tmp_path, 2).rows(tasks)
    assert rows[0].answer == Number(value=3.0)
    assert rows[1].answer is None
    assert "worker process ended" in rows[1].reason
    assert len(list((always / "tries").iterdir())) == 2
    assert all(row.answer is not None for row in rows[2:])


def test_a_half_written_or_foreign_file_is_no_answer(tmp_path: Path) -> None:
    task = totals(1)[0]
    result_cache = ResultCache(tmp_path)
    result_cache.write(task.fingerprint, Outcome(task=task.name, argument={}, answer={"value": 7.0}))
    assert Ensemble(tmp_path, 1).rows([task]) == [TaskOutcome(Number(value=7.0))]
    result_cache.path(task.fingerprint).write_text('{"task": "tests.supp')
    assert Ensemble(tmp_path, 1).rows([task])[0].answer == Number(value=0.2)


STUDY = """
import sys
from pathlib import Path
from tests.support.tasks import Numbers, waiting_total
from workflow.study.ensemble import Ensemble
from workflow.study.task import Task
if __name__ == "__main__":
    folder = sys.argv[1]
    tasks = [Task(waiting_total, Numbers(values=(float(k),), folder=folder)) for k in range(40)]
    rows = Ensemble(Path(folder) / "kept", 2).rows(tasks)
    print([row.answer.value for row in rows])
"""


def started(tmp_path: Path) -> "subprocess.Popen[str]":
    script = tmp_path / "study.py"
    script.write_text(STUDY)
    return subprocess.Popen(
        [sys.executable, str(script), str(tmp_path)], cwd=TOP, env={**os.environ, "PYTHONPATH": str(TOP)},
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip


def start_event(tmp_path: Path) -> dict[str, int]:
    return {path.name: len(path.read_text().splitlines()) for path in tmp_path.glob("(*)")}


def test_two_studies_of_one_folder_compute_every_task_once(tmp_path: Path) -> None:
    (tmp_path / "go").touch()
    both = [started(tmp_path) for _ in range(2)]
    assert [item.communicate()[0].strip() for item in both] == [str([float(k) for k in range(40)])] * 2
    assert start_event(tmp_path) == {f"({float(k)},)": 1 for k in range(40)}


def test_a_killed_study_goes_on(tmp_path: Path) -> None:
    killed = started(tmp_path)
    answers = tmp_path / "kept/tasks"
    while len(list(answers.glob("*.json"))) < 20:  # the others wait for `go`
        time.sleep(0.01)
    killed.send_signal(signal.SIGKILL)
    killed.communicate()
    assert len(list(answers.glob("*.json"))) == 20
    (tmp_path / "go").touch()
    again = started(tmp_path)
    assert again.communicate()[0].strip() == str([float(k) for k in range(40)])
    assert start_event(tmp_path) == {f"({float(k)},)": 1 for k in range(40)}


def test_a_scheduler_that_exists_is_used_and_one_that_does_not_is_told(tmp_path: Path) -> None:
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as cluster:
        rows = Ensemble(tmp_path, scheduler=cluster.scheduler_address).rows(totals(3))
    assert [row.answer for row in rows] == [Number(value=0.1 * k + 0.2) for k in range(3)]
    with pytest.raises(InputError, match="expected an address such as tcp://"):
        Ensemble(tmp_path, scheduler="nowhere").rows(totals(4))
