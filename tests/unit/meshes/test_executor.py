"""Tasks in order, in a thread and in processes: results, errors, and what becomes of those that are left."""

import operator
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from meshes.executor import (
    SERIAL,
    Executor,
    LostError,
    OneThread,
    Processes,
    check_cancelled,
    deferred_interruption,
    interruptible,
    is_left_working,
    then,
)
from tests.support import TOP
from tests.support.executor_tasks import OddError, dies_first, own_number, raises_odd_error, sleeps, squared

ALL = pytest.mark.parametrize("made", [lambda: SERIAL, OneThread, lambda: Processes(2)])


@pytest.fixture(scope="module")
def two() -> Processes:
    with Processes(2) as executor:
        yield executor  # type: ignore[misc]


@ALL
def test_results_are_in_order_and_what_tasks_tell_is_heard_here(made: Callable[[], Executor]) -> None:
    messages, done, here = [], [], threading.get_ident()

    def heard(*what: object) -> None:
        assert threading.get_ident() == here
        messages.append(what)

    with made() as executor:
        results = executor.compute(squared, [1, 2, 3], heard, lambda *each: done.append(each))
        assert executor.submit(divmod, 7, 2).result() == (3, 1)
    assert results == [1, 4, 9]
    assert sorted(messages) == [(0, 1), (1, 2), (2, 3)]
    assert sorted(done) == [(0, 1), (1, 4), (2, 9)]


@ALL
def test_an_error_is_raised_where_the_result_is_asked_for(made: Callable[[], Executor]) -> None:
    with made() as executor:
        failed, after = executor.submit(operator.truediv, 1, 0), executor.submit(divmod, 7, 2)
        assert after.result() == (3, 1)
        with pytest.raises(ZeroDivisionError):
            failed.result()
        with pytest.raises(TypeError):
            executor.compute(squared, [1, "two", 3])  # type: ignore[list-item]


def test_in_order_ctrl_c_is_heard_at_once() -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        SERIAL.submit(interrupted)


def test_a_thread_goes_on_beside_this_one_and_leaves_it_what_it_has_not_begun() -> None:
    met, of_thread = threading.Barrier(2), threading.get_ident()
    with OneThread() as executor:
        future, waits = executor.submit(met.wait), executor.submit(threading.get_ident)
        assert waits.result() == of_thread
        met.wait()
        future.result()


def test_a_task_that_several_threads_ask_for_is_done_once_and_what_follows_it_is_told() -> None:
    may_end, done, result = threading.Event(), list[int](), list[int]()

    def counted() -> int:
        done.append(threading.get_ident())
        time.sleep(0.05)
        return len(done)

    with OneThread() as executor:
        executor.submit(may_end.wait)
        waits = executor.submit(counted)
        follows = then(waits, lambda known: 10 * known.result())
        asking = [threading.Thread(target=lambda: result.append(waits.result())) for _ in range(4)]
        for thread in asking:
            thread.start()
        for thread in asking:
            thread.join()
        assert result == [1, 1, 1, 1]
        assert follows.result() == 10
        may_end.set()


def test_nobody_waits_for_a_thread_that_is_left_and_it_ends_at_its_next_look() -> None:
    event, may_end = threading.Event(), threading.Event()
    ended: list[str] = []

    def long() -> None:
        event.set()
        may_end.wait()
        try:
            check_cancelled()
        except KeyboardInterrupt:
            ended.append("left")
            raise

    with OneThread() as executor:
        executor.submit(long)
        executor.submit(ended.append, "never")
        event.wait()
    assert is_left_working()  # and nobody has waited for it
    may_end.set()
    while is_left_working():
        time.sleep(0.01)
    assert ended == ["left"]


def test_what_is_interruptible_has_the_result_and_the_error_of_its_work_from_another_thread() -> None:
    assert interruptible(threading.get_ident) != threading.get_ident()
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)


def test_ctrl_c_is_heard_while_a_library_computes_that_would_not_hear_it() -> None:
    def deaf() -> None:
        """As a compiled solver does, which calls back into Python and forgets its errors."""
        is_started.set()
        while not may_end.wait(0.1):
            pass

    def press() -> None:
        is_started.wait()
        os.kill(os.getpid(), signal.SIGINT)

    is_started, may_end = threading.Event(), threading.Event()
    threading.Thread(target=press, daemon=True).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            interruptible(deaf)
    finally:
        may_end.set()


@pytest.mark.parametrize("let", [True, False])
def test_ctrl_c_is_held_back_until_it_is_let_through_or_the_block_ends(let: bool) -> None:
    before, steps = signal.getsignal(signal.SIGINT), []

    def work() -> None:
        with deferred_interruption() as let_through:
            let_through()
            os.kill(os.getpid(), signal.SIGINT)
            steps.append("held")
            if let:
                let_through()
            steps.append("end of the block")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert steps == (["held"] if let else ["held", "end of the block"])
    assert signal.getsignal(signal.SIGINT) is before


def test_other_threads_hold_nothing_back() -> None:
    def deferred() -> object:
        with deferred_interruption() as let_through:
            let_through()
            return signal.getsignal(signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    assert interruptible(deferred) is before


def test_processes_do_their_tasks_side_by_side_and_a_single_one_is_done_here(two: Processes) -> None:
    assert os.getpid() not in two.compute(own_number, [1, 2])
    assert two.compute(own_number, [1]) == [os.getpid()]


def test_a_fault_comes_back_with_its_traceback(two: Processes) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        two.submit(open, "no such folder/mesh.msh").result()
    assert "in another process:\nTraceback" in str(caught.value.__cause__)
    with pytest.raises(RuntimeError, match="in raises_odd_error"):
        two.submit(raises_odd_error).result()
    assert OddError.__name__


def test_a_process_that_dies_costs_its_task_a_second_try_and_no_third(two: Processes, tmp_path: Path) -> None:
    assert two.submit(dies_first, str(tmp_path)).result() > 0
    with pytest.raises(LostError, match="2 tries"):
        two.submit(os._exit, 3).result()
    assert two.submit(divmod, 7, 2).result() == (3, 1)


def is_there(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().split(")")[1].split()[0] != "Z"
    except OSError:
        return False


def slept(folder: Path) -> int:
    """The number of the process that sleeps, once it does."""
    while not ((folder / "pid").exists() and (text := (folder / "pid").read_text())):
        time.sleep(0.02)
    return int(text)


def ends(process: int) -> None:
    """Wait until a process has ended, which would sleep for an hour."""
    while is_there(process):
        time.sleep(0.02)


@pytest.mark.parametrize("forks", [False, True])
def test_processes_are_killed_at_the_end_whatever_they_are_at(forks: bool, tmp_path: Path) -> None:
    with Processes(1, forks=forks) as executor:
        left, never = executor.submit(sleeps, str(tmp_path)), executor.submit(divmod, 7, 2)
        process = slept(tmp_path)
    ends(process)  # a child of the killed one dies a moment later
    assert never.cancelled()
    assert left.exception() is not None


PROGRAM = """
import sys
from meshes.executor import Processes
from tests.support.executor_tasks import sleeps
with Processes(1, forks=sys.argv[2] == "True") as executor:
    executor.submit(sleeps, sys.argv[1]).result()
"""


@pytest.mark.parametrize("forks", [False, True])
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_processes_end_with_the_program_that_started_them(how: signal.Signals, forks: bool, tmp_path: Path) -> None:
    line = [sys.executable, "-c", PROGRAM, str(tmp_path), str(forks)]
    program = subprocess.Popen(line, cwd=TOP, env={**os.environ, "PYTHONPATH": str(TOP)}, stderr=subprocess.DEVNULL)
    process = slept(tmp_path)
    program.send_signal(how)
    program.wait()
    ends(process)
