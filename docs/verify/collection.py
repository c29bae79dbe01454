"""A run over a collection of cases; results are stored after each case."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from docs.verify.record import FILE, Stored, read_answers, version_of, write_answers


class Case(Protocol):
    """What is common to published slopes and known slides."""

    @property
    def name(self) -> str: ...


CaseOf = TypeVar("CaseOf", bound=Case)
Verdict = TypeVar("Verdict")


@dataclass(frozen=True)
class Row(Generic[CaseOf, Stored, Verdict]):
    """A case, its results, and the verdict."""

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
    """Find the answers of some cases, or take those that were found before, and judge them.

    Parameters
    ----------
    folder
        Of the cases. Answers are written into it after each of them.
    cases
        The cases.
    kind
        Of their answers.
    judge
        The verdict on a case and its answer, None where it was not run.
    find
        The answer of a case, with what was found before; None to compute nothing.
    tell
        Called with every row.
    """
    record, version = folder / FILE, version_of(folder)
    rows = []
    for case in cases:
        if find is not None:
            answer = replace(find(case, read_answers(record, kind).get(case.name)), commit=version)
            # others may have been at it meanwhile
            write_answers(record, read_answers(record, kind) | {case.name: answer})
        known = read_answers(record, kind).get(case.name)
        rows.append(Row(case, known, judge(case, known)))
        tell(rows[-1])
    return rows
