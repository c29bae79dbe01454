"""A run over the known slides; results are stored after each case."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from workflow.estimates.slide_error import TABLE
from workflow.run.store import Store
from workflow.verify.record import FILE, read_answers, version_of, write_answers
from workflow.verify.slides.case import Ground, SlideCase, read_cases
from workflow.verify.slides.predict import predict
from workflow.verify.slides.record import SlideAnswer
from workflow.verify.slides.verdict import SlideVerdict, judge, judge_points


@dataclass(frozen=True)
class SlideRow:
    """A case, its prediction, and the verdict."""

    case: SlideCase
    found: SlideAnswer | None
    verdict: SlideVerdict


def run(
    folder: Path,
    names: Sequence[str] = (),
    *,
    compute: bool = True,
    seeds: int | None = None,
    tell: Callable[[SlideRow], None] | None = None,
) -> list[SlideRow]:
    """Predict the cases whose names begin with one of ``names``, all without any, and judge them.

    What was found is written beside the cases after each of them.
    """
    record, version = folder / FILE, version_of(folder)
    rows = []
    for case in read_cases(folder, names):
        if compute:
            prediction = replace(predict(case, seeds), commit=version)
            write_answers(
                record, read_answers(record, SlideAnswer) | {case.name: prediction}
            )  # others may have been at it meanwhile
        answer = read_answers(record, SlideAnswer).get(case.name)
        rows.append(SlideRow(case, answer, judge(case, answer)))
        if tell:
            tell(rows[-1])
    return rows


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
