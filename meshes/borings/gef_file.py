"""Reads cone penetration tests in GEF, the Geotechnical Exchange Format of the Netherlands, a file for each sounding.

Quantities have the numbers of GEF-CPT-Report (CUR 2004): 1 length of penetration, 2 cone resistance, 3 sleeve friction,
4 friction ratio (%), 6 pore pressure u2, 11 depth corrected for inclination, 13 resistance corrected for pore pressure.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.boring import Cone
from meshes.borings.complaints import folded
from meshes.borings.log import BoringFile, Log
from meshes.borings.plausible import implausible_cones
from meshes.borings.text_file import read_text
from meshes.errors import InputError
from meshes.section.quantity import HEIGHT, STRENGTH
from meshes.section.sentences import sentences

LENGTH, RESISTANCE, FRICTION, RATIO, PORE_PRESSURE, DEPTH, CORRECTED = 1, 2, 3, 4, 6, 11, 13
STRESSES = (RESISTANCE, FRICTION, PORE_PRESSURE, CORRECTED)
AREA_RATIO = "3"  # the MEASUREMENTVAR of the net area ratio of the cone
HEADER = re.compile(r"#\s*(\w+)\s*=(.*)")

# The values of a header in its lines, by the key of the line.
Header = dict[str, list[list[str]]]


def read_gef(path: Path, columns: Mapping[str, str] | None = None) -> BoringFile:
    """Read the sounding of a file, without layers.

    The resistance is the corrected resistance. If the file has none, it is the measured resistance plus (1 - a) times
    the pore pressure u2, if the file gives the area ratio a. Readings without a resistance or a sleeve friction are
    left out.

    Parameters
    ----------
    path : path of the file
    columns : must be empty, since the columns of the file have numbers

    Returns
    -------
    The sounding, and notices.

    Raises
    ------
    InputError
        If the file cannot be read. The error contains all problems.
    """
    text = read_text(path)
    head, mark, data = text.text.partition("#EOH")
    header: Header = {}
    for key, values in HEADER.findall(head):
        header.setdefault(key.upper(), []).append([value.strip() for value in values.split(",")])
    kinds = [line[0] for key in ("REPORTCODE", "PROCEDURECODE") for line in header.get(key, [])]
    if not mark or "COLUMNINFO" not in header or any("CPT" not in kind.upper() for kind in kinds):
        kind_words = f", not {kinds[0]}" if kinds else ""
        raise InputError(str(path), [f"expected a cone penetration test in GEF, GEF-CPT-Report{kind_words}"])
    try:
        log = _log(path, header, data.partition("\n")[2])
    except InputError:
        raise
    except (IndexError, ValueError) as error:
        raise InputError(str(path), [f"the header of the file cannot be read: {error}"]) from None
    return sounding_file(path, log, [text.notice] if text.notice else [])


def _log(path: Path, header: Header, data: str) -> Log:
    """Return the sounding. Raises ValueError or IndexError for a header that cannot be read, InputError with
    problems."""
    columns = {int(line[3]): (int(line[0]) - 1, line[1]) for line in header["COLUMNINFO"]}
    if RESISTANCE not in columns or not {FRICTION, RATIO} & columns.keys() or not {LENGTH, DEPTH} & columns.keys():
        expected = "depth (quantity 1 or 11), cone resistance (2) and sleeve friction (3) or friction ratio (4)"
        raise InputError(str(path), [f"expected columns of {expected}"])
    factors = {number: _factor(number, *columns[number]) for number in (LENGTH, DEPTH, *STRESSES) if number in columns}
    factors[RATIO] = 0.01
    area = [float(line[1]) for line in header.get("MEASUREMENTVAR", []) if line[0] == AREA_RATIO]
    readings = (
        {
            number: factors[number] * cell
            for number, (column, _) in columns.items()
            if number in factors and (cell := numbers[column]) is not None
        }
        for numbers in _readings(path, header, data)
    )
    name = ",".join(header.get("TESTID", [[""]])[-1]) or path.stem
    place = header.get("XYID", [["", "nan", "nan"]])[0]
    level = float(header.get("ZID", [["", "nan"]])[0][1])
    return Log(
        name, (float(place[1]), float(place[2])), level, (), cones=cones_of(path, readings, area[0] if area else 1.0)
    )


def cones_of(path: Path, readings: Iterable[Mapping[int, float]], area: float) -> tuple[Cone, ...]:
    """Return cone resistances from the top down, without readings of zero.

    Parameters
    ----------
    path : path of the file, for messages
    readings : measured quantities (m, Pa) by their numbers in GEF-CPT-Report
    area : net area ratio of the cone

    Raises
    ------
    InputError : if a reading is impossible, or if none is left
    """
    cones: dict[float, Cone] = {}
    for count, values in enumerate(readings, start=1):
        reading = _reading(values, area)
        if reading is None:
            continue
        try:
            cones.setdefault(reading["depth"], Cone.model_validate(reading))
        except ValidationError as error:
            problems = [f"reading {count}: {text}" for text in sentences(error, reading, Cone)]
            raise InputError(str(path), problems) from None
    if not cones:
        raise InputError(str(path), ["the file has no reading with a depth, a resistance and a sleeve friction"])
    return tuple(cones[depth] for depth in sorted(cones))


def sounding_file(path: Path, log: Log, notices: Sequence[str]) -> BoringFile:
    """Return the file of one sounding. Raises InputError if the readings are impossible for soil."""
    if problems := list(implausible_cones(f"sounding {log.name}, ", log.cones, with_units=True)):
        raise InputError(str(path), folded(problems))
    return BoringFile([log], list(notices))


def _factor(number: int, column: int, unit: str) -> float:
    """Return the factor from the unit of a quantity to m or Pa; raise ValueError that names the column.

    The national registry writes the name of the unit after its symbol, as in "MPa (megaPascal)"; this name is ignored.
    """
    try:
        return float((STRENGTH if number in STRESSES else HEIGHT).read(f"1 {unit.partition('(')[0]}"))
    except ValueError as error:
        raise ValueError(f"column {column + 1} in {unit} {error}") from None


def _readings(path: Path, header: Header, data: str) -> Iterator[list[float | None]]:
    """Yield the numbers of every line, None if there is none."""
    void = {int(line[0]) - 1: float(line[1]) for line in header.get("COLUMNVOID", [])}
    separator, end = (header.get(key, [[""]])[0][0] for key in ("COLUMNSEPARATOR", "RECORDSEPARATOR"))
    last = max(int(line[0]) for line in header["COLUMNINFO"])
    for count, line in enumerate(filter(None, map(str.strip, data.splitlines())), start=1):
        cells = line.removesuffix(end).strip().split(separator or None)
        try:
            numbers = [float(cell) for cell in cells[:last]]
        except ValueError:
            raise InputError(str(path), [f"reading {count} is {line[:60]!r}: expected numbers"]) from None
        if len(numbers) < last:
            raise InputError(str(path), [f"reading {count} has {len(numbers)} numbers; expected {last}"])
        yield [None if number == void.get(k) else number for k, number in enumerate(numbers)]


def _reading(values: Mapping[int, float], area: float) -> dict[str, float] | None:
    """Return depth (m), resistance and friction (Pa) from quantities by their numbers; None if the cone met no
    resistance.

    ``area``: net area ratio of the cone.
    """
    if not {RESISTANCE, CORRECTED} & values.keys() or not {FRICTION, RATIO} & values.keys():
        return None
    depth, measured = abs(values.get(DEPTH, values.get(LENGTH, 0.0))), values.get(RESISTANCE, 0.0)
    resistance = values.get(CORRECTED, measured + (1.0 - area) * values.get(PORE_PRESSURE, 0.0))
    friction = values.get(FRICTION, values.get(RATIO, 0.0) * measured)
    if depth <= 0.0 or resistance <= 0.0:
        return None
    return {"depth": depth, "qc": resistance, "fs": max(0.0, friction)}
