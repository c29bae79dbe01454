"""Holds the samples of a study as one table, samples.csv, in the order of their numbers."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workflow.study.task import Numbers

FILE = "samples.csv"


@dataclass(frozen=True)
class SampleRow:
    """Holds one sample: drawn values by path, results by name, reasons of missing results, and parts of the study with
    an answer.
    """

    drawn: dict[str, Any]
    results: Numbers
    reason: str = ""
    answered: tuple[str, ...] = ()


@dataclass(frozen=True)
class SampleTable:
    """Holds all samples; ``units`` are the units of the drawn numbers."""

    units: dict[str, str]
    rows: Sequence[SampleRow]

    @property
    def names(self) -> list[str]:
        """Return the results, in the order in which they first appear."""
        return list(dict.fromkeys(name for row in self.rows for name in row.results.numbers))

    @property
    def failed(self) -> int:
        """Return samples in which at least one part of the study has no answer."""
        return sum(bool(row.reason) for row in self.rows)

    def column(self, name: str) -> np.ndarray:
        """Return a result over all samples (n,), NaN if it is missing."""
        values = [row.results.numbers.get(name) for row in self.rows]
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def drawn(self, path: str) -> list[Any]:
        """Return the drawn values of one uncertain number, by its path, in all samples."""
        return [row.drawn[path] for row in self.rows]

    def heading(self, path: str) -> str:
        """Return the path of an uncertain number with its unit, as it heads columns and labels axes."""
        unit = self.units.get(path, "")
        return f"{path} ({unit})" if unit else path

    def text(self) -> str:
        """Return the table as CSV; numbers with all their digits."""
        texts = list(dict.fromkeys(name for row in self.rows for name in row.results.texts))
        heads = list(map(self.heading, self.units))
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["sample", *heads, *self.names, *texts, "failed"])
        for number, row in enumerate(self.rows, start=1):
            numbers = _written_values(row.results.numbers.get(name) for name in self.names)
            said = [row.results.texts.get(name, "") for name in texts]
            drawn = _written_values(row.drawn[path] for path in self.units)
            writer.writerow([number, *drawn, *numbers, *said, row.reason])
        return out.getvalue()


def _written_values(values: Iterable[Any]) -> list[Any]:
    return ["" if value is None else repr(value) if isinstance(value, float) else value for value in values]
