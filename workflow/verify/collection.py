"""A run over a collection of cases; results are stored after each case."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from workflow.verify.answer import answer
from workflow.verify.case import Case, read_cases
from workflow.verify.record import FILE, PARTS, Answer, Part, read_answers, version_of, write_answers
from workflow.verify.verdict import CaseVerdict, judge


@dataclass(frozen=True)
class Row:
    """A case, its results, and the verdict."""

    case: Case
    found: Answer | None
    verdict: CaseVerdict

    def as_dict(self) -> dict[str, Any]:
        """Name, verdict, numbers and seconds, for a file."""
        known = self.found or Answer(self.case.name)
        return {
            "name": self.case.name,
            "verdict": self.verdict.word,
            "expected": self.case.published.expected,
            "kh": self.case.published.kh,
            "lower": known.lower,
            "upper": known.upper,
            "shallow_failure": known.shallow_failure,
            "elements_associated": known.associated,
            "elements_davis": known.davis,
            "commit": known.commit,
            "seconds": {"bounds": known.bounds_seconds, "elements_associated": known.associated_seconds}
            | {"elements_davis": known.davis_seconds},
            "published": [value.model_dump() for value in self.case.published.values],
            "remarks": list(self.verdict.remarks),
        }


def run(
    folder: Path, names: Sequence[str] = (), parts: Collection[Part] = PARTS, tell: Callable[[Row], None] | None = None
) -> list[Row]:
    """Find the answers of the cases whose names begin with one of ``names``, all without any, and judge them.

    What was found is written beside the cases after each of them; parts that are not run keep what was found before.
    """
    record, version = folder / FILE, version_of(folder)
    rows = []
    for case in read_cases(folder, names):
        answers = read_answers(record, Answer)
        if parts:
            answers[case.name] = replace(answer(case, parts, answers.get(case.name)), commit=version)
            write_answers(record, answers)
        known = answers.get(case.name)
        rows.append(Row(case, known, judge(case, known)))
        if tell:
            tell(rows[-1])
    return rows
