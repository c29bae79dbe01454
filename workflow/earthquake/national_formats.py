"""Reads files of national networks: GeoNet of New Zealand (.V1A, .V2A), BHRC of Iran (.V1), USGS (.smc).

Sources: GNS Science, "Accelerogram data file format" (2012), and files that GeoNet and BHRC have published;
USGS, National Strong-Motion Program, SMC-format data files, 3.1 to 4.0.
"""

import re
from collections.abc import Sequence

import numpy as np

from workflow.earthquake.recorded_series import RecordedSeries, fixed_numbers, steps

Lines = Sequence[str]

GEONET = re.compile(r"^\s*(un)?corrected accelerogram\b.*\bGNS Science", re.IGNORECASE)
GEONET_COMPONENT = re.compile(r"^\s*Component\s+(\S+)", re.IGNORECASE)
# Of a component's heading: lines of text, and ten lines of ten numbers, which begin on these lines (from 0).
GEONET_HEADING = 26
COUNTS, INSTRUMENT, TIMES, PEAKS = 19, 20, 22, 23
IN_THE_TEXT = 12  # where the component stands
# Stands for a sample that was not recorded, where the ends of several instruments differ.
NOT_RECORDED = (999999.9, 9999.999, 99.99999)

BHRC = re.compile(r"^\*\s*(VOL\w*)\s+FILE", re.IGNORECASE)
BHRC_COMPONENT = re.compile(r"^\s*COMP\s+(\w)", re.IGNORECASE)
BHRC_AZIMUTHS = re.compile(r"Azimuth\s+L\s+(\d+)\s+T\s+(\d+)", re.IGNORECASE)
BHRC_POINTS = re.compile(r"NO\. OF POINTS\s*=\s*(\d+)\s+DURATION\s*=\s*([\d.]+)", re.IGNORECASE)
BHRC_UNITS = re.compile(r"UNITS ARE SECONDS AND\s+(\S+)", re.IGNORECASE)
BHRC_HEADING = 15  # lines between that of the units and the first values: a blank one, 7 of integers and 7 of reals
BHRC_VOLUME = "VOL1DS"

SMC = re.compile(r"^\s*[1-4]\s+(?:UN)?(?:CORRECTED\s+)?(ACCELEROGRAM|VELOCITY|DISPLACEMENT)\b", re.IGNORECASE)
SMC_TEXT_LINES, SMC_INTEGERS, SMC_REALS = 11, 48, 50
SMC_COUNT, SMC_RATE = 17, 2  # which of the integers and reals are the number of values, and those in a second
SMC_NO_VALUE = 1e30  # a real that is not known is 1.7E+38
SMC_QUANTITIES: dict[str, tuple[str, str]] = {
    "ACCELEROGRAM": ("acceleration", "cm/s/s"),
    "VELOCITY": ("velocity", "cm/s"),
    "DISPLACEMENT": ("displacement", "cm"),
}


def geonet(lines: Lines) -> list[RecordedSeries]:
    """Read GeoNet V1 and V2: for each component a heading of 26 lines, acceleration (mm/s²), velocity and
    displacement."""
    components: list[RecordedSeries] = []
    place = 0
    while place < len(lines) and lines[place].strip():
        heading = GEONET.match(lines[place])
        if heading is None or len(lines) < place + GEONET_HEADING:
            raise ValueError(f"line {place + 1}: expected the heading of a component, {GEONET_HEADING} lines")
        raw = heading[1] is not None
        named = GEONET_COMPONENT.match(lines[place + IN_THE_TEXT])
        counts, instrument, times, peaks = (_row(lines, place + k) for k in (COUNTS, INSTRUMENT, TIMES, PEAKS))
        first = place + GEONET_HEADING
        values, place = fixed_numbers(lines, first, int(counts[3]), "10F8.1")
        values = _recorded(values) * (instrument[7] if raw and instrument[7] > 0.0 else 1.0)
        time = steps(len(values), float(times[5]), f"line {first - GEONET_HEADING + TIMES + 1}")
        peak = abs(float(peaks[0] if raw else peaks[5]))
        name = named[1] if named else ""
        components.append(RecordedSeries("GeoNet", name, time, values, "mm/s/s", "acceleration", peak or None, raw))
        place += sum(-(-int(count) // 10) for count in counts[4:6])  # velocity and displacement, ten a line
    return components


def _row(lines: Lines, place: int) -> np.ndarray:
    """Return the ten numbers of a heading, in columns of eight."""
    return fixed_numbers(lines[: place + 1], place, 10, "10F8.1")[0]


def _recorded(values: np.ndarray) -> np.ndarray:
    """Return the values without missing samples at either end. Raises ValueError for missing samples in between."""
    recorded = ~np.isin(values, NOT_RECORDED)
    known = np.flatnonzero(recorded)
    if not len(known) or not recorded[known[0] : known[-1] + 1].all():
        raise ValueError("samples are missing within the record")
    return values[known[0] : known[-1] + 1]


def bhrc(lines: Lines) -> list[RecordedSeries]:
    """Read BHRC, volume 1: for each component a heading of 27 lines and acceleration, as a rule in tenths of g."""
    components: list[RecordedSeries] = []
    name, azimuths, count, duration, place = "", {}, 0, 0.0, 0  # type: tuple[str, dict[str, str], int, float, int]
    while place < len(lines):
        line = lines[place]
        place += 1
        if (volume := BHRC.match(line)) and volume[1].upper() != BHRC_VOLUME:
            raise ValueError(f"is a file of BHRC with {volume[1]}; expected {BHRC_VOLUME}, uncorrected acceleration")
        if component := BHRC_COMPONENT.match(line):
            name = component[1].upper()
        elif known := BHRC_AZIMUTHS.search(line):
            azimuths = {"L": known[1], "T": known[2]}
        elif points := BHRC_POINTS.search(line):
            count, duration = int(points[1]), float(points[2])
        elif unit := BHRC_UNITS.search(line):
            first = place + BHRC_HEADING
            values, place = fixed_numbers(lines, first, count, "10E13.6")
            share = re.fullmatch(r"g\s*/\s*(\d+)", unit[1], re.IGNORECASE)
            scale, measured = (1.0 / float(share[1]), "g") if share else (1.0, unit[1])
            time = steps(count, duration / max(count, 1), "DURATION over NO. OF POINTS")
            called = f"{name}: {azimuths[name]}" if name in azimuths else name
            components.append(RecordedSeries("BHRC", called, time, scale * values, measured, "acceleration"))
    return components


def smc(lines: Lines) -> list[RecordedSeries]:
    """Read SMC: 11 lines of text, 48 integers, 50 reals, comments, and one series in cm and s, eight values a line."""
    known = SMC.match(lines[0])
    assert known is not None
    integers, place = fixed_numbers(lines, SMC_TEXT_LINES, SMC_INTEGERS, "8I10")
    reals, place = fixed_numbers(lines, place, SMC_REALS, "5E15.7")
    rate = float(reals[SMC_RATE - 1])
    if not 0.0 < rate < SMC_NO_VALUE:
        raise ValueError(f"real value {SMC_RATE} of its heading, the samples per second, is {rate:g}; expected above 0")
    while place < len(lines) and lines[place].startswith("|"):
        place += 1
    values, _ = fixed_numbers(lines, place, int(integers[SMC_COUNT - 1]), "8E10.4")
    quantity, unit = SMC_QUANTITIES[known[1].upper()]
    time = steps(len(values), 1.0 / rate, f"real value {SMC_RATE} of its heading")
    is_raw = lines[0].lstrip().startswith("1")
    return [RecordedSeries("SMC", "", time, values, unit, quantity, counts=is_raw)]
