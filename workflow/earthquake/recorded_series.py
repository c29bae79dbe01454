"""Holds one component of a record file in its original unit, and reads numbers in fixed or free columns."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# Numbers that run into each other, such as -0.00003-0.00004 in columns of 8.
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?")
EXPONENT = str.maketrans("Dd", "Ee")  # Fortran's of double precision, 1.0D-03
LONGEST_STEP = 1.0  # s
FORTRAN = re.compile(r"\(?\s*(\d+)?\s*[FEGIfegi]\s*(\d+)(?:\.\d+)?\s*\)?")


@dataclass(frozen=True, eq=False)
class RecordedSeries:
    """Holds one component of a record, in the units of its file.

    Attributes
    ----------
    format : format of the file, such as "K-NET"
    component : name of the component in the file; empty without a name
    time (n,) : times (s)
    values (n,) : recorded values at these times, in ``unit``
    unit : unit in the heading; empty without one
    quantity : quantity in the heading, such as "VELOCITY"; empty if the heading names none
    peak : largest value without regard to sign that the heading states; None if it states none
    counts : whether the values are counts of a recorder, whose zero is their mean
    """

    format: str
    component: str
    time: np.ndarray
    values: np.ndarray
    unit: str
    quantity: str = ""
    peak: float | None = None
    counts: bool = False


def free_numbers(lines: Sequence[str], first: int) -> np.ndarray:
    """Return all numbers from a line on, separated by blanks or commas. Raises ValueError, which names the line, for a
    line without numbers.
    """
    values: list[float] = []
    for number, line in enumerate(lines[first:], start=first + 1):
        if (numbers := _free(line)) is None:
            raise ValueError(f"line {number}: {line.strip()!r}: expected numbers")
        values += numbers
    return finite(values)


def fixed_numbers(lines: Sequence[str], first: int, count: int, form: str) -> tuple[np.ndarray, int]:
    """Return ``count`` numbers from a line on by a Fortran format such as (8F10.5), and the number of the line after
    them.

    ``lines``: lines of the file; ``first``: number of the line to begin with; ``form``: the Fortran format. Raises
    ValueError if the numbers end before.
    """
    width = int(known[2]) if (known := FORTRAN.fullmatch(form.strip())) else 0
    values: list[float] = []
    place = first
    while len(values) < count and place < len(lines):
        line = lines[place].rstrip()
        try:
            cells = [line[k : k + width].strip() for k in range(0, len(line), width)] if width else NUMBER.findall(line)
            values += [float(cell) for cell in cells if cell]
        except ValueError:  # not in these columns after all, or the end
            if not (numbers := _free(line)):
                break
            values += numbers
        place += 1
    if len(values) != count:
        raise ValueError(f"line {first + 1}: {len(values)} numbers follow; the heading says {count}")
    return finite(values), place


def _free(line: str) -> list[float] | None:
    """Return the numbers of a line, separated by blanks or commas; None for a line with other text."""
    try:
        return [float(cell.translate(EXPONENT)) for cell in re.split(r"[,;\s]+", line.strip(" \t\r\n,;")) if cell]
    except ValueError:
        return None


def finite(values: Sequence[float]) -> np.ndarray:
    """Return the values (n,) of a series. Raises ValueError with fewer than two values, or if a value is not finite."""
    if len(values) < 2 or not np.isfinite(values).all():
        raise ValueError("expected at least two values, all of them finite")
    return np.array(values)


def steps(count: int, step: float, where: str) -> np.ndarray:
    """Return times (n,) from 0 in equal steps. Raises ValueError for a step that is not positive, or is too large or
    small for a record.
    """
    if not (np.isfinite(step) and 0.0 < step <= LONGEST_STEP):
        unit = "; is it in milliseconds?" if step > LONGEST_STEP else ""
        raise ValueError(
            f"{where}: the time step is {step:g} s; expected a step above 0, and up to {LONGEST_STEP:g} s{unit}"
        )
    return step * np.arange(count)
