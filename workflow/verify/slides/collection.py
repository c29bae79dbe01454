"""The errors of the program on known slides, as a table of the package."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

from workflow.estimates.slide_error import TABLE
from workflow.run.store import Store
from workflow.verify.slides.case import Ground, SlideCase
from workflow.verify.slides.record import SlideAnswer
from workflow.verify.slides.verdict import judge, judge_points


def errors(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> str:
    """The table of errors on known slides for the report: every case that was run, as CSV."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["name", "group", "kind", "method", "ratio"])
    for case in cases:
        answer = answers.get(case.name)
        verdicts = {"discs": judge(case, answer), "mpm": judge_points(case, answer)}
        problem = case.known.problem
        kind: str = problem.kind
        if case.known.group == "field":
            kind = "flow" if isinstance(problem, Ground) and problem.flow else "spread"
        for who, verdict in verdicts.items():
            if verdict is not None and verdict.ratio is not None:
                table.writerow([case.name, case.known.group, kind, who, f"{verdict.ratio:.3g}"])
    return text.getvalue()


def write_errors(package: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> Path:
    """Write that table into the package, where reports find it."""
    return Store(package).write_text(TABLE, errors(cases, answers))
