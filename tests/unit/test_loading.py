"""A Ctrl-C that comes while libraries are loaded is kept, not lost."""

import os
import signal

import pytest

from workflow.loading import interrupts_later


def test_an_interrupt_comes_at_the_end() -> None:
    reached = False
    with pytest.raises(KeyboardInterrupt), interrupts_later():
        os.kill(os.getpid(), signal.SIGINT)
        reached = True
    assert reached
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_without_one_nothing_happens_and_faults_pass() -> None:
    with interrupts_later():
        pass
    with pytest.raises(ZeroDivisionError), interrupts_later():
        _ = 1 // 0
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
