"""Runs the collection of known slides for `python -m docs.verify --slides`."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape

from docs.verify.collection import Row, run
from docs.verify.slides.case import FOLDER, SlideCase, read_cases
from docs.verify.slides.points import by_points
from docs.verify.slides.predict import predict
from docs.verify.slides.record import SlideAnswer
from docs.verify.slides.verdict import SlideVerdict, judge, judge_points

SlideRow = Row[SlideCase, SlideAnswer, SlideVerdict]


def verify_slides(
    out: Console, folder: Path | None, names: list[str], *, judge_only: bool, packings: int | None
) -> list[dict[str, Any]]:
    """Predict known slides, print a line on each, and return rows for JSON."""
    place = folder or FOLDER
    find = None if judge_only else lambda case, _: _by_both(case, packings)
    rows = run(place, read_cases(place, names), SlideAnswer, judge, find, lambda row: _print_row(out, row))
    return [_as_dict(row) for row in rows]


def _by_both(case: SlideCase, packings: int | None) -> SlideAnswer:
    """Return the predictions by discs in some packings and by material points; without points if the discs have no
    answer."""
    answer = predict(case, packings)
    return answer if answer.failure else replace(answer, points=by_points(case))


def sentence(verdict: SlideVerdict) -> str:
    """Return a ratio and its spread in words, with significant digits only."""
    if verdict.ratio is None or verdict.spread is None:
        return ""
    low, high = verdict.spread
    return f"{verdict.ratio:.2f}" if low == high else f"{verdict.ratio:.2f} ({low:.2f} to {high:.2f})"


def predicted(answer: SlideAnswer, verdict: SlideVerdict) -> str:
    """Return the predictions of all packings in words; "no end" for ground that flows."""
    return "no end" if verdict.word == "flows" else ", ".join(number(value) for value in answer.values)


def number(value: float) -> str:
    """Return a measured or predicted number as text."""
    return f"{value:.3g}"


def _as_dict(row: SlideRow) -> dict[str, object]:
    answer = {} if row.answer is None else asdict(row.answer)
    return answer | {
        "name": row.case.name,
        "group": row.case.known.group,
        "measured": row.case.measured,
        "verdict": row.verdict.word,
        "ratio": row.verdict.ratio,
        "spread": row.verdict.spread,
    }


def _print_row(out: Console, row: SlideRow) -> None:
    """Print one line on a case, and further lines on material points and failures."""
    answer = row.answer
    values = predicted(answer, row.verdict) if answer is not None else ""
    measured = " to ".join(dict.fromkeys(number(end) for end in row.case.measured))
    line = (
        f"{row.verdict.word:<15} {row.case.name:<30} measured {measured}, predicted {values}; {sentence(row.verdict)}"
    )
    out.print(escape(line.rstrip("; ")), soft_wrap=True)
    if answer is not None and (points := judge_points(row.case, answer)) is not None:
        tail = f"predicted {number(answer.points or 0.0)}; {sentence(points)}".rstrip("; ")
        out.print(escape(f"{points.word:<15} {'by material points':<30} {tail}"), soft_wrap=True)
    if answer is not None and answer.failure:
        out.print(escape(f"                {answer.failure}"), soft_wrap=True)
