"""Displays the progress of a study: number of finished samples, number of failed ones, and remaining time."""

import time

from workflow.cli.terminal import err
from workflow.run.progress import TimeLeft

EVERY = 10.0  # s between two lines where there is no terminal
AT_ONCE = 0.2  # s on a terminal, where the line changes in place


class Counted:
    """Shows the number of finished tasks; used as a context manager."""

    def __init__(self, silent: bool = False) -> None:
        self.silent, self.console = silent, err
        self.start = self.last = time.monotonic()
        self.left = TimeLeft(self.start)
        self.before: int | None = None

    def __enter__(self) -> "Counted":
        return self

    def __exit__(self, *what: object) -> None:
        if self.console.is_terminal and not self.silent:
            self.console.print()

    def __call__(self, done: int, failed: int, total: int) -> None:
        """Count one more finished computation."""
        if self.before is None:
            self.before = done  # there already when it began: they say nothing of the time left
        now = time.monotonic()
        every = AT_ONCE if self.console.is_terminal else EVERY
        if self.silent or (done < total and now - self.last < every):
            return
        self.last = now
        missing = total - self.before
        left = self.left.words(now, (done - self.before) / missing if missing else None)
        message = f"{done} of {total} done" + (f", {failed} failed" if failed else "") + (f", {left}" if left else "")
        end = "\r" if self.console.is_terminal else "\n"
        self.console.print(f"{message:<70}" if end == "\r" else message, end=end, markup=False, soft_wrap=True)
