"""Runs a collection of cases and stores the results after each case."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from docs.verify.record import FILE, Stored, read_answers, version_of, write_answers


class Case(Protocol):
    """Describes the common part of published slopes and known slides."""

    @property
    def name(self) -> str: ...


CaseOf = TypeVar("CaseOf", bound=Case)
Verdict = TypeVar("Verdict")


@dataclass(frozen=True)
class Row(Generic[CaseOf, Stored, Verdict]):
    """Holds a case, its answer, and the verdict."""

    case: CaseOf
    answer: Stored | None
    verdict: Verdict


def run(
    folder: Path,
    cases: Sequence[CaseOf],
    kind: type[Stored],
    judge: Callable[[CaseOf, Stored | None], Verdict],
    find: Callable[[CaseOf, Stored | None], Stored] | None,
    tell: Callable[[Row[CaseOf, Stored, Verdict]], None],
) -> list[Row[CaseOf, Stored, Verdict]]:
    """Compute the answers of cases, or take the stored ones, and compare them with the published values.

    Parameters
    ----------
    folder : folder of the cases; the answers are written into it after each case
    cases : the cases
    kind : type of their answers
    judge : returns the verdict on a case and its answer, which is None if the case was not run
    find : computes the answer of a case from the case and its stored answer; None to compute nothing
    tell : called with every row

    Returns
    -------
    One row per case.
    """
    record, version = folder / FILE, version_of(folder)
    rows = []
    for case in cases:
        if find is not None:
            answer = replace(find(case, read_answers(record, kind).get(case.name)), commit=version)
            # another process may have written answers since
            write_answers(record, read_answers(record, kind) | {case.name: answer})
        known = read_answers(record, kind).get(case.name)
        rows.append(Row(case, known, judge(case, known)))
        tell(rows[-1])
    return rows
