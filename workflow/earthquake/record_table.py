"""Reads records in columns: time and components under a heading, separated by commas, semicolons, tabs or blanks.

A column of time may be missing if the heading has a time step or a sampling rate (as in the CSV files of the Japan
Meteorological Agency). Numbers may have decimal commas if semicolons or tabs separate the columns.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.motion_units import motion_unit, time_unit
from workflow.earthquake.network_formats import READ, unit_in, word_of
from workflow.earthquake.recorded_series import EXPONENT, LONGEST_STEP, RecordedSeries, finite, steps

BRACKETS = re.compile(r"\[([^\]]+)\]|\(((?:[^()]|\([^()]*\))+)\)|_(g|gal|m_s2|ms2|cm_s2|s|ms)\s*$", re.IGNORECASE)
SUFFIXES = {"m_s2": "m/s^2", "ms2": "m/s^2", "cm_s2": "cm/s^2"}
TIME = re.compile(r"^\W*(t|time|times|zeit|temps|tempo|tiempo|時間|時刻|経過時間)\b|^\W*(t|time)_", re.IGNORECASE)
STEP = re.compile(
    r"\b(?:dt|delta_?t|time[ _]?step|step|(?:sampling|sample)[ _](?:interval|period))\b[^\d\n-]*?"
    r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)\s*([a-zµ]*)",
    re.IGNORECASE,
)
RATE = re.compile(
    r"\b(?:(?:sampling|sample)[ _](?:rate|freq\w*)|frequency|fs)\b[^\d\n]*?(\d+\.?\d*)\s*(hz|sps|1/s)?", re.IGNORECASE
)
# A file with at least this number of lines of words among its first lines is one of a network, not a plain table.
NETWORKS_HEADING, FIRST_LINES = 8, 25
DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?|[-+]?\d+(?:[eE][-+]?\d+)?")
# Numbers with decimal commas that blanks part; and numbers in columns so narrow that nothing but signs part them.
APART_BY_BLANKS = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?(?:\s+[-+]?\d*,\d+(?:[eE][-+]?\d+)?)+")
APART_BY_SIGNS = re.compile(r"(?:\s*[-+]?\d*\.\d+)(?:\s+[-+]?\d*\.\d+|[-+]\d*\.\d+)+")
CLOCK = re.compile(r"(?:\d{4}[-/]\d\d[-/]\d\d[T ,;])?(?<!\d)(\d{1,2}):(\d\d):(\d\d(?:\.\d+)?)Z?")
BEHIND_THE_NAME = re.compile(r"(?:\bin|,)\s+(\S.*?)\s*$", re.IGNORECASE)  # "Acceleration in g", "Time, s"
COUNTER = re.compile(r"^\W*(no|nr|n|i|k|id|index|sample|samples|point|番号)\W*$", re.IGNORECASE)
# Smallest number of values in a row of one series, mostly eight; components are three.
VALUES_IN_A_ROW = 5
SAME_TIMES = 0.6  # share of the times that may be those before them: a record of steps has two at each


@dataclass(frozen=True)
class TableColumn:
    """Holds a column: its name, and the unit in the name, or an empty unit."""

    name: str
    unit: str


def table(lines: Sequence[str]) -> list[RecordedSeries]:
    """Read the components of a record in columns. Raises ValueError if the lines are no such table, or have no
    times."""
    try:
        return _components(lines)
    except ValueError as error:
        if READ in str(error) or sum(_row(line) is None for line in lines[:FIRST_LINES]) < NETWORKS_HEADING:
            raise
        raise ValueError(f"is of an unknown format ({error}); known formats: {READ}") from None


def _components(lines: Sequence[str]) -> list[RecordedSeries]:
    heading, rows = _split(lines)
    if len(rows) < 2:
        raise ValueError(f"is no accelerogram of a known format; known formats: {READ}")
    text = "\n".join(heading)
    step = _step(text)
    columns = _columns(heading, len(rows[0]))
    if step is not None and not columns and len(rows[0]) >= VALUES_IN_A_ROW:
        series = finite([value for row in rows for value in row])
        return [RecordedSeries("columns", "", steps(len(series), step, "the heading"), series, unit_in(text),
                               word_of(text))]  # fmt: skip
    if len(rows[-1]) != len(rows[0]):
        raise ValueError(f"the last row has {len(rows[-1])} numbers; expected {_numbers(len(rows[0]))}")
    values = np.array(_without_count(rows) if not heading else rows)
    columns = columns or [TableColumn("", "")] * values.shape[1]
    timed = [k for k, column in enumerate(columns) if TIME.search(column.name) or time_unit(column.unit)]
    counters = [k for k, column in enumerate(columns) if COUNTER.search(column.name) and not column.unit]
    if not timed and (values.shape[1] == 1 or step is not None or 0 in counters):
        if step is None:
            has = "holds one column" if values.shape[1] == 1 else f'the first column, "{columns[0].name}", is no time'
            raise ValueError(f'{has}: expected a column of time before it, or a heading such as "dt = 0.01 s"')
        time, no_component = steps(len(values), step, "the heading"), counters
    else:
        place = timed[0] if timed else 0
        if not timed and values.shape[1] >= VALUES_IN_A_ROW and np.any(np.diff(values[:, 0]) < 0.0):
            raise ValueError(
                f"holds rows of {values.shape[1]} numbers whose first column is no time; expected a time step in the "
                'heading of such a series, as in "dt = 0.01 s"'
            )
        time, no_component = _times(values[:, place], columns[place]), [place, *counters]
    places = [k for k in range(values.shape[1]) if k not in no_component]
    stated = unit_in(text) if not any(columns[k].unit for k in places) else ""
    components = [
        RecordedSeries("columns", columns[k].name, time, finite(values[:, k].tolist()), columns[k].unit or stated,
                       word_of(columns[k].name))
        for k in places
    ]  # fmt: skip
    return components if len(components) == 1 else _of_acceleration(components)


def _of_acceleration(components: list[RecordedSeries]) -> list[RecordedSeries]:
    """Return the components in units of acceleration if there are any, since other columns are integrals of these."""
    known = [(component, motion_unit(component.unit)) for component in components]
    return [component for component, unit in known if unit is not None and unit.motion == "acceleration"] or components


def _without_count(rows: list[list[float]]) -> list[list[float]]:
    """Return the rows without the first row of a DEEPSOIL file, which holds the number of samples and the time step."""
    if len(rows) < 3 or len(rows[0]) != 2 or rows[0][0] != len(rows) - 1 or rows[0][1] <= 0.0:
        return rows
    return rows[1:] if abs(rows[2][0] - rows[1][0] - rows[0][1]) <= 0.1 * rows[0][1] else rows


def _split(lines: Sequence[str]) -> tuple[list[str], list[list[float]]]:
    """Return the lines before the first row of numbers, and all rows. Each row has as many numbers as the first row.

    The last row of a series that is written in rows may have fewer.
    """
    heading: list[str] = []
    rows: list[list[float]] = []
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        row = None if text.startswith(("#", "%", "!")) else _row(text.partition("#")[0])
        if rows and row and not np.isfinite(row).all():
            raise ValueError(
                f"line {number}: {text!r}: a value is missing or not finite; expected a number in every column"
            )
        if row is None and rows and text and not text.startswith(("#", "%", "!")):
            raise ValueError(f"line {number}: {text!r}: expected {_numbers(len(rows[0]))}")
        if row is None:
            heading += [text.lstrip("#%! ")] if text and not rows else []
        elif (
            row
            and rows
            and (len(row) > len(rows[0]) or len(row) < len(rows[-1]) < VALUES_IN_A_ROW or len(rows[-1]) < len(rows[0]))
        ):
            raise ValueError(f"line {number}: {text!r}: expected {_numbers(len(rows[0]))}")
        elif row:
            rows.append(row)
    return heading, rows


def _numbers(count: int) -> str:
    return "two numbers, time and acceleration" if count == 2 else f"{count} numbers, as in the rows above"


def _row(text: str) -> list[float] | None:
    """Return the numbers of a line; an empty list for a blank line, None for a line with other text."""
    text = CLOCK.sub(_seconds, text.replace('"', "").strip())
    if APART_BY_BLANKS.fullmatch(text):
        text = text.replace(",", ".")
    if APART_BY_SIGNS.fullmatch(text):
        text = " ".join(re.findall(r"[-+]?\d*\.\d+", text))
    apart = ";" if ";" in text else "\t" if "\t" in text else ""
    cells = [cell.strip() for cell in text.split(apart)] if apart else re.split(r"[,\s]+", text)
    if apart and any("," in cell for cell in cells):
        if all(DECIMAL_COMMA.fullmatch(cell) for cell in cells if cell):
            cells = [cell.replace(",", ".") for cell in cells]
        else:
            cells = re.split(r"[,;\s]+", text)
    try:
        return [float(cell.translate(EXPONENT)) for cell in cells if cell]
    except ValueError:
        return None


def _seconds(clock: re.Match[str]) -> str:
    """Return the time of day in s, with the date before it left out."""
    return f"{3600 * int(clock[1]) + 60 * int(clock[2]) + float(clock[3]):.9g}"


def _columns(heading: list[str], count: int) -> list[TableColumn]:
    """Return the names and units of the columns; units may stand in the line below the names."""
    columns = _columns_in(heading, count)
    if not columns or not all(column.unit and column.name.strip("[]() ") == column.unit for column in columns):
        return columns
    names = _columns_in(heading[:-1], count)
    return (
        [TableColumn(above.name, below.unit) for above, below in zip(names, columns, strict=True)] if names else columns
    )


def _columns_in(heading: list[str], count: int) -> list[TableColumn]:
    """Return names and units from the last line of the heading that has an entry for every column; nothing without such
    a line.
    """
    for above, line in enumerate(reversed(heading)):
        for apart in (";", "\t", ","):
            cells = [cell.strip() for cell in line.rstrip(" ,;\t").split(apart)]
            if len(cells) == count and (count > 1 or BRACKETS.search(cells[0])):
                return [_column(cell) for cell in cells]
        cells = re.findall(r"[^\s(\[]+(?: ?[(\[][^)\]]*[)\]])?", line)
        if count > 1 and len(cells) == count and above < 2 and (TIME.search(cells[0]) or BRACKETS.search(line)):
            return [_column(cell) for cell in cells]
    return []


def _column(cell: str) -> TableColumn:
    cell = cell.strip("\"' ")
    brackets = BRACKETS.findall(cell)
    words = [next(filter(None, groups)).strip() for groups in brackets] or [cell, *BEHIND_THE_NAME.findall(cell)]
    unit = next((w for w in reversed(words) if motion_unit(SUFFIXES.get(w.lower(), w)) or time_unit(w)), "")
    return TableColumn(BRACKETS.sub("", cell).strip() or cell, SUFFIXES.get(unit.lower(), unit))


def _step(text: str) -> float | None:
    """Return the time step (s) that a heading states, or 1 over its sampling rate; None if the heading states
    neither."""
    if match := STEP.search(text):
        second = time_unit(match[2]) if match[2] else 1.0
        return float(match[1]) * (second if second is not None else 1.0)
    if match := RATE.search(text):
        return 1.0 / float(match[1]) if float(match[1]) > 0.0 else None
    return None


def _times(values: np.ndarray, column: TableColumn) -> np.ndarray:
    """Return times in s, converted from the unit of their heading. Raises ValueError if they fall, or cannot be
    seconds."""
    if not np.isfinite(values).all():
        raise ValueError("holds a time that is not finite")
    second = time_unit(column.unit) if column.unit else 1.0
    if second is None:
        raise ValueError(f'the heading gives the time in "{column.unit}"; expected s or ms')
    back = np.flatnonzero(np.diff(values) < 0.0)
    if len(back):
        shown = column.unit or "s"
        raise ValueError(
            f"the time falls from {values[back[0]]:g} {shown} to {values[back[0] + 1]:g} {shown}; expected it to rise"
        )
    repeated = np.flatnonzero(np.diff(values) == 0.0)
    if len(values) >= VALUES_IN_A_ROW and len(repeated) > SAME_TIMES * len(values):
        raise ValueError(
            f"{len(repeated)} of its {len(values)} times are equal to the time before, such as "
            f"{values[repeated[0]]:g}: they have too few digits; expected rising times"
        )
    typical = float(np.median(np.diff(values))) * second
    if len(values) >= 50 and typical > LONGEST_STEP:
        unit = f'in "{column.unit}"' if column.unit else "without a unit, which are taken as seconds"
        raise ValueError(
            f"the times, {unit}, are {typical:g} s apart; expected up to {LONGEST_STEP:g} s. If they are milliseconds, "
            'head their column "time (ms)"'
        )
    return values * second
