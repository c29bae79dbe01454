"""What a command shows on the terminal: the section, the plan, how the stages go, and what they found."""

import shlex
import sys

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from meshes.errors import NoAnswerError
from meshes.section.section import Section
from workflow.report import tables
from workflow.report.console import sentences
from workflow.results.results import Results
from workflow.run import pipeline
from workflow.run.display import NORMAL, QUIET, VERBOSE, Display
from workflow.run.plan import Choice, plan
from workflow.run.record import Record
from workflow.run.stage import Job

out = Console(highlight=False)
err = Console(stderr=True, highlight=False)


def show_strata(section: Section) -> None:
    """The strata in a table, and that they are a reconstruction if they are one."""
    if section.reconstruction:
        out.print(f"[bold]Reconstruction.[/] {escape(section.reconstruction_note)}")
    title = escape(section.title or section.name)
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for head in tables.STRATA_HEADS:
        table.add_column(head, justify="left" if head == "stratum" else "right")
    for row in tables.strata_rows(section):
        table.add_row(*(escape(cell) for cell in row))
    out.print(table)


def show_plan(job: Job, choice: Choice) -> None:
    """What would be done about every stage, and why."""
    table = Table(box=SIMPLE_HEAD, padding=(0, 2, 0, 0))
    for head in ("stage", "would", "because"):
        table.add_column(head)
    verbs = {"run": "run", "redraw": "draw again", "reuse": "be reused", "off": "not run"}
    for decision in plan(job, Record(job.store), choice):
        table.add_row(decision.stage.name, verbs[decision.action], escape(decision.why or "nothing has changed"))
    out.print(table)


def execute(job: Job, choice: Choice, quiet: bool, verbose: bool) -> None:
    """Run the stages that have to, and tell what they found. Raises what `pipeline.execute` does."""
    verbosity = QUIET if quiet else VERBOSE if verbose else NORMAL
    shown = [stage for stage in job.stages if stage.name in choice.chosen]
    what = "noshiro " + shlex.join(sys.argv[1:])
    try:
        with Display(out, err, shown, verbosity) as display:
            pipeline.execute(job, choice, display, what)
    except NoAnswerError:
        if verbosity > QUIET:
            _tell(job, choice)
        raise
    if verbosity > QUIET:
        _tell(job, choice)


def _tell(job: Job, choice: Choice) -> None:
    """What the stages found that have an answer, and where it all is."""
    ends = Results.of(job).ends
    for stage in job.stages:
        if stage.name in choice.chosen and stage.name in ends and ends[stage.name].outcome in ("done", "part"):
            for line in sentences(stage.name, job.given, job.store):
                out.print(escape(line))
    if "report" in choice.chosen and job.store.has("report.html"):
        for line in sentences("report", job.given, job.store):
            out.print(escape(line))
        out.print(f"Report: {job.store.folder / 'report.html'}", soft_wrap=True)
    out.print(f"Results and pictures are in {job.store.folder}/", soft_wrap=True)
