"""Work in a second thread: its results and errors, and that nobody waits for what is left."""

import threading
import time

import pytest

from fem.solvers.blas_threads import bears_threads
from fem.solvers.meanwhile import IN_TURN, Meanwhile, interruptible, is_working

pytestmark = pytest.mark.skipif(not bears_threads(), reason="this BLAS is not to be called by two threads")


@pytest.mark.parametrize("alone", [False, True])
def test_work_is_done_in_the_order_in_which_it_was_begun(alone):
    done = []
    with IN_TURN if alone else Meanwhile() as meanwhile:
        futures = [meanwhile.begin(lambda k=k: done.append(k) or k * k) for k in range(5)]
        assert [each.result() for each in futures] == [0, 1, 4, 9, 16]
    assert done == list(range(5))


@pytest.mark.parametrize("alone", [False, True])
def test_an_error_is_raised_where_the_result_is_asked_for(alone):
    def fails():
        raise ValueError("no")

    with IN_TURN if alone else Meanwhile() as meanwhile:
        begun, after = meanwhile.begin(fails), meanwhile.begin(lambda: 1)
        assert after.result() == 1
        with pytest.raises(ValueError, match="no"):
            begun.result()


def test_it_goes_on_beside_this_thread():
    met = threading.Barrier(2, timeout=10.0)
    with Meanwhile() as meanwhile:
        begun = meanwhile.begin(met.wait)
        met.wait()
        begun.result()


def test_nobody_waits_for_work_that_is_left_and_what_is_interruptible_ends_then():
    begun, may_end = threading.Event(), threading.Event()

    def long():
        begun.set()
        may_end.wait(10.0)
        interruptible(lambda: None)

    start = time.monotonic()
    with Meanwhile() as meanwhile:
        left, never = meanwhile.begin(long), meanwhile.begin(lambda: None)
        begun.wait(10.0)
    assert time.monotonic() - start < 5.0
    may_end.set()
    assert isinstance(left.exception(10.0), KeyboardInterrupt)
    time.sleep(0.05)
    assert not never.done()


def test_what_is_interruptible_has_the_result_and_the_error_of_its_work():
    assert interruptible(lambda: 7) == 7
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 // 0)


def test_threads_that_still_work_are_known():
    may_end = threading.Event()
    with Meanwhile() as meanwhile:
        left = meanwhile.begin(may_end.wait)
        assert is_working()
    may_end.set()
    left.result(10.0)
    deadline = time.monotonic() + 10.0
    while is_working() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not is_working()


def test_in_turn_ctrl_c_is_heard_at_once():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        IN_TURN.begin(interrupted)
