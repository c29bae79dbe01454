"""Tests that interrupt: a shell that runs `make test` in the background has told it to ignore Ctrl-C."""

import signal


def pytest_configure() -> None:
    """Hears Ctrl-C again, here and in every program that a test starts."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
