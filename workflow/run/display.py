"""Displays a run: stages, progress, main quantity and remaining time; plain lines without a terminal."""

import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Literal

from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from workflow.run.plan import Decision
from workflow.run.progress import Progress, TimeLeft, Verbosity, duration
from workflow.run.record import Entry, Outcome
from workflow.run.spelling import legible
from workflow.run.stage import Stage

BAR_WIDTH = 14
LINE_INTERVAL = 30.0  # s between two lines of progress without a terminal
State = Outcome | Literal["wait", "run", "off"]  # of a stage on the screen
MARKS: Mapping[State, str] = {
    "wait": " ", "begun": "▸", "run": "▸", "done": "✓", "part": "✓", "no answer": "✗", "off": "-",
}  # fmt: skip
STYLES: Mapping[State, str] = {
    "begun": "bold", "run": "bold", "done": "green", "part": "green", "no answer": "red", "off": "dim", "wait": "dim",
}  # fmt: skip


class StageLine:
    """Shows one stage on the screen: mark of its state, name, activity or result, progress, and time."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        self.state, self.text, self.share = "wait", stage.description, None  # type: tuple[State, str, float | None]
        self.start, self.seconds = 0.0, 0.0
        self.time_left = TimeLeft(0.0)

    def cells(self) -> list[Text]:
        """Return mark, name, text, and times or a bar."""
        style = STYLES[self.state]
        clock = ""
        if self.state == "run":
            now = time.monotonic()
            left = self.time_left.description(now, self.share)
            clock = duration(now - self.start) + (f", {left}" if left else "")
        elif self.seconds:
            clock = duration(self.seconds)
        bar = ""
        if self.state == "run" and self.share is not None:
            full = round(BAR_WIDTH * min(max(self.share, 0.0), 1.0))
            bar = "█" * full + "░" * (BAR_WIDTH - full)
        line = Text(
            legible(self.text, sys.stderr),
            style="dim" if self.state in ("wait", "off") else "",
            overflow="ellipsis",
            no_wrap=True,
        )
        return [Text(MARKS[self.state], style), Text(self.stage.name, style), line, Text(bar, "cyan"), Text(clock)]


class Display:
    """Displays a run to which it listens; used as a context manager.

    On a terminal, ``err`` shows a list of all stages that is updated in place. If ``err`` is no terminal, one line is
    written to it every `LINE_INTERVAL` seconds while a stage runs, and one line when the stage ends. In verbose mode
    there is also one line when a stage begins, and one for every step.

    Parameters
    ----------
    err : console of standard error
    stages : stages that are displayed, in their order
    verbosity : amount of text; nothing is displayed for `QUIET` and `JSON`
    """

    def __init__(self, err: Console, stages: Sequence[Stage], verbosity: Verbosity) -> None:
        self.err, self.verbosity = err, verbosity
        self.lines = {stage.name: StageLine(stage) for stage in stages}
        self.live: Live | None = None
        if err.is_terminal and verbosity == Verbosity.NORMAL:
            self.live = Live(console=err, get_renderable=self._table, refresh_per_second=4)

    def __enter__(self) -> "Display":
        self.context: AbstractContextManager[object] = self.live or nullcontext()
        self.context.__enter__()
        return self

    def __exit__(self, *what: object) -> None:
        self.context.__exit__(None, None, None)

    def begin(self, decision: Decision) -> Progress:
        """Show that a stage begins; return the callback for its progress."""
        shown = self.lines[decision.stage.name]
        shown.state, shown.start = "run", time.monotonic()
        shown.time_left = TimeLeft(shown.start)
        if self.verbosity == Verbosity.VERBOSE:
            self._say(f"{decision.stage.name}: {decision.stage.description} ({decision.reason})")
        last = shown.start

        def progress(line: str, share: float | None) -> None:
            nonlocal last
            shown.text, shown.share = line, share
            now = time.monotonic()
            if self.verbosity == Verbosity.VERBOSE or now - last > LINE_INTERVAL:
                last = now
                left = shown.time_left.description(now, share)
                self._say(f"{decision.stage.name}: {line}" + (f", {left}" if left else ""))

        return progress

    def end(self, decision: Decision, entry: Entry) -> None:
        """Show that a stage has ended, or that its result is reused."""
        shown = self.lines.get(decision.stage.name)
        if shown is None:
            return
        shown.state, shown.share = entry.outcome, None
        shown.seconds = entry.seconds
        if decision.action == "reuse":
            shown.text = f"no input has changed: the result of {entry.ended} is reused"
            self._say(f"{decision.stage.name}: {shown.text}")
        elif entry.outcome == "no answer":
            shown.text = f"no answer: {entry.reason}"
            self._say(f"{decision.stage.name}: {shown.text}")
        elif decision.action == "redraw":
            shown.text = "pictures drawn again"
            self._say(f"{decision.stage.name}: {shown.text}")
        else:
            shown.text = decision.stage.description
            self._say(f"{decision.stage.name}: done in {duration(entry.seconds)}")

    def skip(self, decision: Decision, why: str) -> None:
        """Show that a stage does not run."""
        shown = self.lines.get(decision.stage.name)
        if shown is None:
            return
        shown.state, shown.text = "off", f"not run: {why}"
        if self.verbosity == Verbosity.VERBOSE or "no answer" in why:
            self._say(f"{decision.stage.name}: {shown.text}")

    def _say(self, text: str) -> None:
        if self.live is None and self.verbosity.in_sentences:
            self.err.print(escape(text), soft_wrap=True)

    def _table(self) -> Table:
        table = Table.grid(padding=(0, 1))
        for column in range(5):
            table.add_column(no_wrap=True, ratio=1 if column == 2 else None)
        table.expand = True
        for shown in self.lines.values():
            table.add_row(*shown.cells())
        return table
