"""Runs the collection of published slopes for `python -m docs.verify`."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from docs.verify.answer import answer
from docs.verify.case import FOLDER, Case, read_cases
from docs.verify.collection import Row, run
from docs.verify.record import Answer, Part
from docs.verify.verdict import CaseVerdict, judge

SlopeRow = Row[Case, Answer, CaseVerdict]


def verify_slopes(
    out: Console, folder: Path | None, names: list[str], *, parts: Collection[Part]
) -> list[dict[str, Any]]:
    """Compute ``parts`` of the answers of published slopes, print a line on each, and return rows for JSON."""
    place = folder or FOLDER
    find = (lambda case, known: answer(case, parts, known)) if parts else None
    rows = run(place, read_cases(place, names), Answer, judge, find, lambda row: _print_row(out, row))
    words = list(dict.fromkeys(row.verdict.word for row in rows))
    table = Table(box=SIMPLE_HEAD, padding=(0, 2, 0, 0))
    for word in words:
        table.add_column(word, justify="right")
    table.add_row(*(str(sum(row.verdict.word == word for row in rows)) for word in words))
    out.print(table)
    return [_as_dict(row) for row in rows]


def numbers(answer: Answer) -> str:
    """Return the strict bounds as a range in words."""
    if answer.lower is None and answer.upper is None:
        return "-"
    low = "?" if answer.lower is None else f"{answer.lower:.3f}"
    high = "?" if answer.upper is None else f"{answer.upper:.3f}"
    return f"{low} to {high}"


def elements(answer: Answer) -> str:
    """Return the answers of the finite elements with ψ = φ and with Davis's estimate in words."""
    return " and ".join(f"{value:.3f}" if value is not None else "-" for value in (answer.associated, answer.davis))


def published(case: Case) -> str:
    """Return the smallest and the largest published number in words."""
    ends = [end for value in case.published.values for end in value.ends]
    low, high = min(ends), max(ends)
    return f"published {low:g}" if low == high else f"published {low:g} to {high:g}"


def _print_row(out: Console, row: SlopeRow) -> None:
    """Print one line on a case, and one for each remark if its answer is wrong."""
    answer = f"bounds {numbers(row.answer)}, elements {elements(row.answer)}" if row.answer else ""
    line = f"{row.verdict.word:<9} {row.case.name:<26} {published(row.case)}; {answer}"
    out.print(escape(line), soft_wrap=True)
    if row.verdict.word == "wrong":
        for remark in row.verdict.remarks:
            out.print(escape(f"          {remark}"), soft_wrap=True)


def _as_dict(row: SlopeRow) -> dict[str, Any]:
    """Return name, verdict, numbers and computing times of a case."""
    known = row.answer or Answer(row.case.name)
    return {
        "name": row.case.name,
        "verdict": row.verdict.word,
        "expected": row.case.published.expected,
        "kh": row.case.published.kh,
        "lower": known.lower,
        "upper": known.upper,
        "shallow_failure": known.shallow_failure,
        "elements_associated": known.associated,
        "elements_davis": known.davis,
        "commit": known.commit,
        "seconds": {"bounds": known.bounds_seconds, "elements_associated": known.associated_seconds}
        | {"elements_davis": known.davis_seconds},
        "published": [value.model_dump() for value in row.case.published.values],
        "remarks": list(row.verdict.remarks),
    }
