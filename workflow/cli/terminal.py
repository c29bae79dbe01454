"""Prints on the terminal: the section, the plan, the progress of stages, and their results."""

import re
import shlex
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table

from meshes.errors import InputError, NoAnswerError
from meshes.executor import Processes
from meshes.section.section import Section
from workflow.config import Config, notice_lines
from workflow.report import data, tables
from workflow.run.plan import Action, Choice, Decision, plan
from workflow.run.progress import TimeLeft, Verbosity
from workflow.run.record import Record
from workflow.run.spelling import is_legible, legible
from workflow.run.stage import Job
from workflow.stages.expected_time import announcement

if TYPE_CHECKING:
    from workflow.report.side_by_side import ComparedRun
    from workflow.results.results import Results

VERBS: Mapping[Action, str] = {"run": "run", "redraw": "draw again", "reuse": "be reused", "off": "not run"}
SEISMIC_STAGES = frozenset(
    {"triggering", "liquefied", "calibrate", "slide", "mpm"}
)  # stages that an earthquake matters to
STABILITY_STAGES = frozenset({"bounds", "slices"})  # stages that need no mesh, whose notices on the ground they lack
WARNINGS = ("Warning", "Contradiction")  # with which a line begins that requires an action of the user
NAME_WIDTH = 10  # characters of the column of strata: names in a narrower one cannot be read
# The densities, of which a stratum may have two, and cohesions, which may have a minimum, a tension cut-off and a
# factor of overconsolidation: wrapped after a comma or before the factor where the screen is narrow.
SEVERAL = (tables.STRATA_HEADS[6], tables.STRATA_HEADS[7])
AFTER_COMMAS = r"(?<=,) | (?=\()"
BEFORE_POWERS = AFTER_COMMAS + r"| (?=[\d.]+\^)"  # on a screen that is narrower still
out = Console(highlight=False)
err = Console(stderr=True, highlight=False)
LINE_INTERVAL = 10.0  # s between two lines where there is no terminal
TERMINAL_INTERVAL = 0.2  # s on a terminal, where the line changes in place


def say(line: str) -> None:
    """Print a line unchanged, without wrapping."""
    out.print(line, soft_wrap=True, markup=False)


def warn(lines: Iterable[str], verbosity: Verbosity) -> list[str]:
    """Print warnings and return them. Warnings are printed on standard error if the command prints data instead of
    sentences."""
    messages = list(lines)
    for line in messages:
        (out if verbosity.in_sentences else err).print(line, soft_wrap=True, markup=False)
    return messages


def say_data(what: Any) -> None:
    """Print data as JSON, and nothing else."""
    text = data.as_json(what)
    out.print(text if is_legible(text) else data.as_json(what, only_ascii=True), soft_wrap=True, markup=False)


def show_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table of texts."""
    table = Table(box=SIMPLE_HEAD, padding=(0, 2, 0, 0))
    for head in heads:
        table.add_column(escape(legible(head)))
    for row in rows:
        table.add_row(*(escape(legible(cell)) for cell in row))
    out.print(table)


def _strata_table(section: Section, breaks: str = "") -> Table:
    """Return the table of the strata. ``breaks``: where cells of several numbers are wrapped, as an expression; empty
    to wrap none."""
    title = escape(legible(section.heading))
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    rows = [[legible(cell) for cell in row] for row in tables.strata_rows(section)]
    for head, cells in zip(tables.STRATA_HEADS, zip(*rows, strict=True), strict=True):
        name, wraps = head == "stratum", bool(breaks) and head in SEVERAL
        parts = [part for cell in (*cells, *head.split("\n")) for part in (re.split(breaks, cell) if wraps else [cell])]
        table.add_column(
            legible(head), justify="left" if name else "right", no_wrap=not (name or wraps), overflow="fold",
            min_width=NAME_WIDTH if name else None, width=max(map(len, parts)) if wraps else None,
        )  # fmt: skip
    for row in rows:
        table.add_row(*map(escape, row))
    return table


def _widths(table: Table) -> Measurement:
    """Return the least and the largest width (characters) of a table that shows all of its cells."""
    return table.__rich_measure__(out, out.options.update_width(1000))


def show_strata(section: Section) -> None:
    """Print the strata in a table, and a note if the ground is a reconstruction."""
    if section.reconstruction:
        out.print(f"[bold]Reconstruction.[/] {escape(section.reconstruction_note)}")
    table = _strata_table(section)
    for breaks, padding in ((AFTER_COMMAS, (0, 1, 0, 0)), (AFTER_COMMAS, 0), (BEFORE_POWERS, 0)):
        if _widths(table).maximum > out.width:  # too narrow a screen for whole cells
            table = _strata_table(section, breaks)
            table.padding = padding
            if _widths(table).minimum <= out.width:
                break
    table.width = max(out.width, _widths(table).minimum) if _widths(table).maximum > out.width else None
    out.print(table, crop=False)
    if any(not text.isascii() for text in tables.texts(section)):
        from workflow.figures import fonts

        if notice := fonts.notice(tables.texts(section)):
            say(f"Warning: {notice}.")


def show_soundness(config: Config, notices: Sequence[str], picture: Path) -> None:
    """Print the notices on a section that was checked, whether it is sound, and where its picture is."""
    section = config.section
    flow = [] if (seepage := section.water_pressure.flow) is None else [seepage.description]
    for line in (*flow, *notices, *config.notice_lines):
        say(line)
    lifts = "can be computed, but its pore pressure lifts the ground"
    say(f"The section {lifts if section.uplift else 'is sound'}. Picture: {picture}")


def show_plan(job: Job, choice: Choice, verbosity: Verbosity) -> None:
    """Print which stages would run, and why."""
    decisions = plan(job, Record(job.store), choice)
    if verbosity == Verbosity.JSON:
        return say_data(data.of_plan(decisions))
    rows = [
        (decision.stage.name, VERBS[decision.action], decision.reason or "nothing has changed")
        for decision in decisions
    ]
    show_table(("stage", "would", "because"), rows)
    _announce(decisions, job)
    return _show_shaking(job)


def _show_shaking(job: Job) -> None:
    """Print the corrections of records, the warnings about records and earthquake, and the resulting Kh."""
    for line in notice_lines(job.config.notices_of_slides):
        say(line)


def _announce(decisions: Sequence[Decision], job: Job) -> None:
    """Print how long a run takes, in words; nothing for a short run."""
    if words := announcement(decisions, job.config):
        say(words)


def announce(job: Job, choice: Choice, verbosity: Verbosity) -> None:
    """Print before a run how long it takes, in words, and in verbose mode the strata."""
    if verbosity == Verbosity.VERBOSE:
        show_strata(job.config.section)
    if verbosity.in_sentences:
        _announce(plan(job, Record(job.store), choice), job)


def execute(job: Job, choice: Choice, verbosity: Verbosity, warnings: Sequence[str] = (), pdf: bool = False) -> None:
    """Run the stages of a ``job`` by ``choice``, print their results, and write the report as PDF if ``pdf``. JSON
    output contains the ``warnings``. ``verbosity``: how much is printed.

    Raises the errors of `pipeline.execute` and `write_pdf`.
    """
    from workflow.results.results import Results
    from workflow.run import pipeline
    from workflow.run.display import Display

    shown = [stage for stage in job.stages if stage.name in choice.chosen]
    command_line = "noshiro " + shlex.join(sys.argv[1:])
    try:
        with Display(err, shown, verbosity) as display:
            pipeline.execute(replace(job, executor=Processes(job.config.dem.workers)), choice, display, command_line)
    except InputError as error:
        raise error.of_file(job.config.section.name, job.section_file) from None
    except NoAnswerError:
        _show_results(job, choice, verbosity, warnings, pdf)
        raise
    _show_results(job, choice, verbosity, warnings, pdf)
    if "fem" in choice.chosen:
        refuse_disproved(Results.of(job))


def refuse_disproved(results: "Results") -> None:
    """Raise UnstableError, as finite elements do, if only strict bounds, perhaps of an earlier command, prove that the
    section fails without a seismic force."""
    from fem.errors import UnstableError
    from workflow.report.at_rest import failure_at_rest

    if results.fem is not None and results.fails_at_rest:
        raise UnstableError(failure_at_rest(results).rstrip("."), "check strengths, densities and water")


def _show_results(job: Job, choice: Choice, verbosity: Verbosity, warnings: Sequence[str], pdf: bool) -> None:
    """Print the results of the stages, in sentences or as JSON, and the folder of the files; write the PDF if it is
    requested."""
    if pdf:
        from workflow.report.pdf import write_pdf

        write_pdf(job.store)
    if verbosity == Verbosity.JSON:
        say_data(data.of_stages(job, choice.chosen, warnings))
    elif verbosity.in_sentences:
        _tell_in_sentences(job, choice, verbosity == Verbosity.VERBOSE)


def _tell_in_sentences(job: Job, choice: Choice, every: bool) -> None:
    """Print the results of a whole run in at most twelve lines, or those of the requested stages, then warnings of the
    stages that they need. With ``every``, print the results of all stages with details.
    """
    from workflow.report.console import sentences
    from workflow.report.run_lines import run_lines
    from workflow.results.results import Results
    from workflow.results.summary import Summary
    from workflow.texts.report_texts import Texts

    reported = "report" in choice.chosen and job.store.has("report.html")
    shown = choice.requested or choice.chosen
    if every or not reported:
        results, warnings, printed_stages = Results.of(job), list[str](), list[str]()
        ends = results.ends
        for stage in job.stages:
            if stage.name in choice.chosen and stage.name in ends and ends[stage.name].outcome in ("done", "part"):
                for line in sentences(stage.name, job.config, job.store, every, results, printed_stages):
                    if line.startswith(WARNINGS):
                        warnings.append(line)
                    elif every or stage.name in shown:
                        say(line)
                if every or stage.name in shown:
                    printed_stages.append(stage.name)
        for line in distinct_warnings([*_on_the_ground(job, choice), *warnings]):
            say(line)
        if every or SEISMIC_STAGES & set(choice.chosen):
            _show_shaking(job)
    if reported:
        for line in [
            *(sentences("report", job.config, job.store) if every else ()),
            *run_lines(Summary.read(job.store), Texts(job.config.report.language)),
        ]:
            say(legible(line))
        printed = f", printed as {job.store.folder / 'report.pdf'}" if job.store.has("report.pdf") else ""
        say(f"Report: {job.store.folder / 'report.html'}{printed}")
    say(f"Results and pictures are in {job.store.folder}/")


def _on_the_ground(job: Job, choice: Choice) -> list[str]:
    """Return warnings on the ground if no mesh is made, whose sentences have them; none for other commands."""
    if "mesh" in choice.chosen or not STABILITY_STAGES & set(choice.chosen):
        return []
    return [line for line in notice_lines(job.config.section.notices) if line.startswith(WARNINGS)]


def distinct_warnings(lines: Iterable[str]) -> list[str]:
    """Return warnings each once; a warning that another line repeats with a remedy is left out.

    Parameters
    ----------
    lines : warnings, each beginning with its kind and a colon
    """
    lines = list(dict.fromkeys(lines))
    facts = [line.partition(": ")[2].casefold() for line in lines]
    return [
        line
        for line, fact in zip(lines, facts, strict=True)
        if not any(other.startswith(fact) and other != fact for other in facts)
    ]


def redraw(job: Job, json: bool) -> None:
    """Draw all pictures of a folder again, and name those that could not be drawn."""
    from workflow.run import pipeline
    from workflow.run.display import Display

    with Display(err, job.stages, Verbosity.QUIET if json else Verbosity.NORMAL) as display:
        messages = pipeline.redraw_all(job, display)
    if json:
        pictures = [str(job.store.folder / name) for name in job.store.matching(["figures/*"])]
        return say_data({"pictures": pictures, "not_drawn": messages})
    return say("\n".join([*messages, f"Pictures are in {job.store.folder / 'figures'}/"]))


def show_runs(runs: "Sequence[ComparedRun]") -> None:
    """Print several runs in adjacent columns: their results, and the settings in which they differ."""
    from workflow.report import side_by_side

    folders = side_by_side.run_names(runs)
    show_table(("", *folders), [(name, *values) for name, values in side_by_side.rows(runs)])
    differences = [(key, *values) for key, values in side_by_side.differences(runs)]
    if differences:
        show_table(("input", *folders), differences)
    elif len(folders) > 1:
        say("The inputs of these runs are the same.")


class TaskCounter:
    """Shows the number of finished tasks; used as a context manager."""

    def __init__(self, silent: bool = False) -> None:
        self.silent, self.console = silent, err
        self.start = self.last_report = time.monotonic()
        self.time_left = TimeLeft(self.start)
        self.done_before: int | None = None

    def __enter__(self) -> "TaskCounter":
        return self

    def __exit__(self, *what: object) -> None:
        if self.console.is_terminal and not self.silent:
            self.console.print()

    def __call__(self, done: int, failed: int, total: int) -> None:
        """Count one more finished computation."""
        if self.done_before is None:
            self.done_before = done  # there already when it began: they say nothing of the time left
        now = time.monotonic()
        every = TERMINAL_INTERVAL if self.console.is_terminal else LINE_INTERVAL
        if self.silent or (done < total and now - self.last_report < every):
            return
        self.last_report = now
        missing = total - self.done_before
        left = self.time_left.description(now, (done - self.done_before) / missing if missing else None)
        message = f"{done} of {total} done" + (f", {failed} failed" if failed else "") + (f", {left}" if left else "")
        end = "\r" if self.console.is_terminal else "\n"
        self.console.print(f"{message:<70}" if end == "\r" else message, end=end, markup=False, soft_wrap=True)
