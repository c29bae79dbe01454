"""The command `noshiro verify --slides`."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape

from workflow.estimates import slide_error
from workflow.verify.collection import Row, run
from workflow.verify.numbers import keep_numbers
from workflow.verify.record import FILE, read_answers
from workflow.verify.slides.case import FOLDER, SlideCase, read_cases
from workflow.verify.slides.collection import write_errors
from workflow.verify.slides.page import counts, number, predicted, told, write_page
from workflow.verify.slides.predict import predict
from workflow.verify.slides.record import SlideAnswer
from workflow.verify.slides.verdict import SlideVerdict, judge

SlideRow = Row[SlideCase, SlideAnswer, SlideVerdict]


def verify_slides(
    out: Console, folder: Path | None, names: list[str], *, judge_only: bool, page: bool, packings: int | None
) -> list[dict[str, Any]]:
    """Predict known slides and judge them; tells each, and returns the rows as JSON can hold them."""
    place = folder or FOLDER
    find = None if judge_only else lambda case, _: predict(case, packings)
    rows = run(place, read_cases(place, names), SlideAnswer, judge, find, lambda row: _tell(out, row))
    if page:
        cases, answers = read_cases(place), read_answers(place / FILE, SlideAnswer)
        out.print(str(write_page(place, cases, answers)), soft_wrap=True)
        if folder is None:
            commits = [answer.commit for answer in answers.values()]
            command = "noshiro verify --slides --page"
            keep_numbers(Path("docs"), "slides", command, counts(cases, answers), commits)
            out.print(str(write_errors(Path(slide_error.__file__).parent, cases, answers)), soft_wrap=True)
    return [_as_dict(row) for row in rows]


def _as_dict(row: SlideRow) -> dict[str, object]:
    answer = {} if row.found is None else asdict(row.found)
    return answer | {
        "name": row.case.name,
        "group": row.case.known.group,
        "measured": row.case.measured,
        "verdict": row.verdict.word,
        "ratio": row.verdict.ratio,
        "spread": row.verdict.spread,
    }


def _tell(out: Console, row: SlideRow) -> None:
    """One line for a case."""
    answer = row.found
    values = predicted(answer, row.verdict) if answer is not None else ""
    measured = " to ".join(dict.fromkeys(number(end) for end in row.case.measured))
    line = f"{row.verdict.word:<15} {row.case.name:<30} measured {measured}, predicted {values}; {told(row.verdict)}"
    out.print(escape(line.rstrip("; ")), soft_wrap=True)
    if answer is not None and answer.failure:
        out.print(escape(f"                {answer.failure}"), soft_wrap=True)
