"""A Ctrl-C that somebody swallowed is raised again at the next sign of progress."""

import os
import signal

import pytest

from workflow.run.interrupts import postponed, remembered


def swallow() -> None:
    """What a library does that is interrupted while it is loaded."""
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        return
    raise AssertionError("Ctrl-C did nothing")


def test_a_swallowed_interrupt_comes_again() -> None:
    with remembered() as check:
        check()
        swallow()
        with pytest.raises(KeyboardInterrupt):
            check()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_in_a_callback_of_the_compiler_it_waits() -> None:
    """What is raised there Python prints and forgets."""
    code = compile(
        "def notify():\n    kill()\n    return 'went on'", "/lib/llvmlite/binding/executionengine.py", "exec"
    )
    space = {"kill": lambda: os.kill(os.getpid(), signal.SIGINT)}
    exec(code, space)
    with remembered() as check:
        assert space["notify"]() == "went on"  # type: ignore[operator]
        with pytest.raises(KeyboardInterrupt):
            check()


def test_a_block_within_a_block_shares_its_memory() -> None:
    with remembered() as outer:
        swallow()
        with remembered() as inner, pytest.raises(KeyboardInterrupt):
            inner()
        with pytest.raises(KeyboardInterrupt):
            outer()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_where_it_is_ignored_it_stays_ignored() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with remembered() as check:
            os.kill(os.getpid(), signal.SIGINT)
            check()
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def test_one_that_is_postponed_comes_at_the_end_of_the_block() -> None:
    reached = []

    def interrupted() -> None:
        with postponed():
            os.kill(os.getpid(), signal.SIGINT)
            reached.append("the end")

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert reached == ["the end"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
