"""Reads files of strong-motion networks: PEER, K-NET and KiK-net, COSMOS V1 and V2, CSMIP V1 and V2, RENADIC, ESM.

Sources: PEER NGA-West2, file formats; NIED, "About K-NET ASCII format"; COSMOS Strong Motion Data Format v1.20 (2001);
A. F. Shakal, M. J. Huang, Standard Tape Format for CSMIP Strong-Motion Data, OSMS 85-03 (1985); ESM, DYNA 1.2.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.motion_units import motion_unit, time_unit
from workflow.earthquake.national_formats import BHRC, GEONET, SMC, bhrc, geonet, smc
from workflow.earthquake.recorded_series import RecordedSeries, fixed_numbers, free_numbers, steps

Lines = Sequence[str]
HEADING = 100  # lines within which a file says what it is

# PEER's NGA files write "NPTS= 7807, DT= .0050 SEC", its older ones "4000 0.0100 NPTS, DT".
PEER_NEW = re.compile(r"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([\d.Ee+-]+)\s*([A-Za-z]*)", re.IGNORECASE)
PEER_OLD = re.compile(r"^\s*(\d+)\s+([\d.Ee+-]+)\s+NPTS\s*,\s*DT", re.IGNORECASE)
QUANTITY = re.compile(r"\b(ACCEL|VELOC|DISPL)[A-Z]*", re.IGNORECASE)
IN_UNITS = re.compile(r"UNITS?\s*(?:OF|IN|ARE|[:=])?\s+(\S+(?: ?/ ?\w+)*)|UNITS?\s*[:=]\s*(\S+)", re.IGNORECASE)
BEHIND_IN = re.compile(r"\b(?:ACC|VEL|DISP)[A-Z]*\.?\s+IN\s+([^\s,;:]+)", re.IGNORECASE)  # "acceleration in m/s2"

KNET_LINES = 17  # of heading, of which the last begins with Memo.
KNET = re.compile(r"^Station Code.*^Sampling Freq\(Hz\)", re.MULTILINE | re.DOTALL)
KNET_SCALE = re.compile(r"Scale Factor[\s,;]+([\d.]+)\(gal\)/(\d+)")
KNET_RATE = re.compile(r"Sampling Freq\(Hz\)[\s,;]+([\d.]+)")
KNET_DURATION = re.compile(r"Duration Time\(s\)[\s,;]+([\d.]+)")
KNET_PEAK = re.compile(r"Max\.? ?Acc\.? ?\(gal\)[\s,;]+([\d.]+)")
KNET_WAY = re.compile(r"Dir\.[\s,;]+(\S+)")

COSMOS = re.compile(
    r"^\s*(\d+)\s+(?:raw )?(accel|veloc|displ)\w*\.?\s+pts\s*,\s*approx\s+[\d.]+\s*secs?\s*,\s*units\s*=\s*([^(,]+?)\s*"
    r"(?:\(\s*\d+\s*\))?\s*,\s*Format\s*=\s*(.+?)\s*$",
    re.IGNORECASE,
)
COSMOS_REALS = re.compile(
    r"^\s*(\d+)\s+Real-header values follow on\s+\d+\s+lines?\s*,\s*Format\s*=?\s*(.+?)\s*$", re.I
)
COSMOS_CHANNEL = re.compile(r"^\s*Sta Cha\w*\s*:?\s*(\d+)\s*:?\s*(.*?)\s*(?:\(|$)", re.IGNORECASE)
COSMOS_STEP, COSMOS_PEAK = 34, 64  # which of the real values are the sampling interval (s) and the series' peak

CSMIP_V1 = re.compile(
    r"^\s*(\d+)\s+acc\w*\s+points at\s+([\d.]+)\s*pts/sec,? in units of\s+(\S+?)[\s.,]+.*?(\(\d*f\d+\.\d+\))?\s*$", re.I
)
CSMIP_V2 = re.compile(
    r"^\s*(\d+)\s+points of\s+(accel|veloc|displ)\w*\s+data\s+equally spaced at\s+([\d.]+)\s*sec\w*[.,]*\s*"
    r"\(?(?:in|units:)\s*([^\s()]+?)[.)]*\s*(\(?\d*f\d+\.\d+\)?)?\s*$",
    re.IGNORECASE,
)
CSMIP_CHANNEL = re.compile(r"\bChan\s+(\d+)\s*:\s*(.*?)\s*(?:Location|from|$)", re.IGNORECASE)

# Digitised film, with a time before each acceleration.
FILM = re.compile(
    r"^\s*UNITS OF UNCOR\w* ACCEL\w* ARE SEC AND ([A-Z]\S*?)\.?\s+(?:MAX\s*=\s*([-\d.]+)\s*G)?", re.IGNORECASE
)
FILM_CHANNEL = re.compile(r"^\s*CHAN\s+(\d+)\s*:\s*(.*?)\s*(?:\(|$)", re.IGNORECASE)
FILM_POINTS = re.compile(r"^\s*NO\. OF POINTS\s*=\s*(\d+)", re.IGNORECASE)
FILM_INTEGERS, FILM_REALS = (100, "16I5"), (50, "8F10.3")  # of the heading of each channel

# The first line of volume 3 of CSMIP and COSMOS: "Response and Fourier amplitude spectra (86 periods, ...".
SPECTRA = re.compile(r"^\s*(?:response|fourier)\b.*\bspectr(?:a|um)\b", re.IGNORECASE)

ESM_KEY = re.compile(r"^([A-Z][A-Z0-9_/^]*): ?(.*)$")


@dataclass(frozen=True)
class NetworkFormat:
    """Holds a file format of records: the function that recognises it, and its reader."""

    name: str
    recognised: Callable[[Lines], bool]
    read: Callable[[Lines], list[RecordedSeries]]


def peer(lines: Lines) -> list[RecordedSeries]:
    """Read PEER .AT2, .VT2, .DT2: values after a line with their number and the time step; the line above names the
    unit."""
    place = next(k for k, line in enumerate(lines) if PEER_NEW.search(line) or PEER_OLD.search(line))
    match = PEER_NEW.search(lines[place]) or PEER_OLD.search(lines[place])
    assert match is not None
    second = time_unit(match[3]) if match.re is PEER_NEW and match[3] else 1.0
    if second is None:
        raise ValueError(f'line {place + 1}: "{match[3]}" is no unit of time; expected SEC')
    heading = [line for line in lines[:place] if IN_UNITS.search(line)]
    line = heading[-1] if heading else next((line for line in lines[:place] if QUANTITY.search(line)), "")
    quantity, unit = word_of(line), unit_in(line)
    values = free_numbers(lines, place + 1)
    if len(values) != int(match[1]):
        series = " ".join(word for word in (quantity.lower(), unit and f"in {unit}") if word)
        raise ValueError(_wrong_number(len(values), int(match[1]), f"line {place + 1} (NPTS)", series))
    time = steps(len(values), float(match[2]) * second, f"line {place + 1}")
    return [RecordedSeries("PEER", "", time, values, unit, quantity)]


def knet(lines: Lines) -> list[RecordedSeries]:
    """Read K-NET and KiK-net: counts of one component after 17 lines of heading, separated by blanks or commas."""
    head = "\n".join(lines[:KNET_LINES])
    scale, rate = KNET_SCALE.search(head), KNET_RATE.search(head)
    if scale is None or rate is None:
        key = "Scale Factor" if scale is None else "Sampling Freq(Hz)"
        raise ValueError(f'is a K-NET file whose heading has no "{key}"')
    counts = free_numbers(lines, KNET_LINES)
    peak, direction = KNET_PEAK.search(head), KNET_WAY.search(head)
    length, stated = len(counts) / float(rate[1]), KNET_DURATION.search(head)
    if stated is not None and length < float(stated[1]) - 1.0:
        raise ValueError(f"is cut off: it holds {length:g} s; Duration Time(s) is {stated[1]}; expected the whole file")
    values = counts * float(scale[1]) / float(scale[2])
    time = steps(len(counts), 1.0 / float(rate[1]), "Sampling Freq(Hz)")
    return [RecordedSeries("K-NET", direction[1] if direction else "", time, values, "gal", "acceleration",
                           float(peak[1]) if peak else None, counts=True)]  # fmt: skip


def cosmos(lines: Lines) -> list[RecordedSeries]:
    """Read COSMOS V1 and V2: blocks of one series each, with the time step in the real values of their heading."""
    components: list[RecordedSeries] = []
    reals, channel = np.zeros(0), ""
    place = 0
    while place < len(lines):
        line = lines[place]
        place += 1
        if named := COSMOS_CHANNEL.match(line):
            channel = f"{named[1]}: {named[2]}".strip(" :")
        elif header := COSMOS_REALS.match(line):
            reals, place = fixed_numbers(lines, place, int(header[1]), header[2])
        elif block := COSMOS.match(line):
            values, after = fixed_numbers(lines, place, int(block[1]), block[4])
            step = float(reals[COSMOS_STEP - 1]) if len(reals) >= COSMOS_STEP else -999.0
            peak = float(abs(reals[COSMOS_PEAK - 1])) if len(reals) >= COSMOS_PEAK else 999.0
            time = steps(len(values), step, f"line {place}: real value {COSMOS_STEP} of its heading")
            components.append(
                RecordedSeries("COSMOS", channel, time, values, block[3], block[2], None if peak == 999.0 else peak)
            )
            place = after
    return components


def csmip(lines: Lines) -> list[RecordedSeries]:
    """Read CSMIP V1 and V2: blocks of one series each, whose first line has number, time step, unit and format."""
    components: list[RecordedSeries] = []
    channel = ""
    place = 0
    while place < len(lines):
        line = lines[place]
        place += 1
        if named := CSMIP_CHANNEL.search(line):
            channel = f"{named[1]}: {named[2]}".strip(" :")
        if raw := CSMIP_V1.match(line):
            count, step, quantity, unit, form = int(raw[1]), 1.0 / float(raw[2]), "acceleration", raw[3], raw[4]
        elif block := CSMIP_V2.match(line):
            count, step, quantity, unit, form = int(block[1]), float(block[3]), block[2], block[4], block[5]
        else:
            continue
        values, after = fixed_numbers(lines, place, count, form or "")
        components.append(RecordedSeries("CSMIP", channel, steps(count, step, f"line {place}"), values, unit, quantity))
        place = after
    return components


def film(lines: Lines) -> list[RecordedSeries]:
    """Read CSMIP V1 of digitised film, which RENADIC of Chile has: pairs of time (s) and acceleration in g or its
    tenths."""
    components: list[RecordedSeries] = []
    channel, count, place = "", 0, 0
    while place < len(lines):
        line = lines[place]
        place += 1
        if named := FILM_CHANNEL.match(line):
            channel = f"{named[1]}: {named[2]}".strip(" :")
        elif stated := FILM_POINTS.match(line):
            count = int(stated[1])
        elif unit := FILM.match(line):
            place += 1  # the root mean square
            for numbers, form in (FILM_INTEGERS, FILM_REALS):
                _, place = fixed_numbers(lines, place, numbers, form)
            values, place = fixed_numbers(lines, place, 2 * count, "10F7.3")
            tenths = 0.1 if unit[1].upper() == "G/10" else 1.0
            acceleration = tenths * values[1::2]
            name = "g" if unit[1].upper() in ("G", "G/10") else unit[1]
            components.append(RecordedSeries("CSMIP", channel, values[::2], acceleration, name, "acceleration"))
    return components


def esm(lines: Lines) -> list[RecordedSeries]:
    """Read ESM (DYNA): keys with values, one a line, then one value a line."""
    keys: dict[str, str] = {}
    first = 0
    for line in lines:
        if (match := ESM_KEY.match(line)) is None:
            break
        keys[match[1]] = match[2].strip()
        first += 1
    missing = [key for key in ("SAMPLING_INTERVAL_S", "NDATA", "UNITS") if not keys.get(key)]
    if missing:
        raise ValueError(f"is an ESM file whose heading has no {', '.join(missing)}")
    values = free_numbers(lines, first)
    if len(values) != int(keys["NDATA"]):
        raise ValueError(_wrong_number(len(values), int(keys["NDATA"]), "its NDATA", keys.get("DATA_TYPE", "").lower()))
    time = steps(len(values), float(keys["SAMPLING_INTERVAL_S"]), "SAMPLING_INTERVAL_S")
    stated = next((text for key, text in keys.items() if re.fullmatch(r"PG[AVD]_CM.*", key)), "")
    return [RecordedSeries("ESM", keys.get("STREAM", ""), time, values, keys["UNITS"], keys.get("DATA_TYPE", ""),
                           abs(float(stated)) if stated else None)]  # fmt: skip


def spectra(lines: Lines) -> list[RecordedSeries]:
    """Raise ValueError for a file of spectra, which are no record."""
    raise ValueError(
        "holds spectra (volume 3 of CSMIP or COSMOS), not a record; expected the acceleration in time of the same "
        "station, volume 1 or 2"
    )


def _wrong_number(count: int, stated: int, where: str, what: str) -> str:
    """Return the message that a file holds fewer or more values than its heading states."""
    of = f" ({what})" if what else ""
    if count < stated:
        return (
            f"is cut off: {where} announces {stated} values{of}, of which {stated - count} are missing at its end; "
            "expected the whole file"
        )
    return (
        f"holds {count} values{of}, where {where} announces {stated}; expected as many: something that is not part of "
        "the record may stand at its end"
    )


def unit_in(heading: str) -> str:
    """Return the unit in a heading after "units of", "units:", "units =", in brackets or after "acceleration in"; empty
    without a unit."""
    if match := IN_UNITS.search(heading):
        return (match[1] or match[2]).strip(" .,;:")
    words = [*BEHIND_IN.findall(heading), *re.findall(r"[(\[]\s*([^)\]]+?)\s*[)\]]", heading)]
    return next((word for word in reversed(words) if motion_unit(word)), "")


def word_of(heading: str) -> str:
    """Return the quantity that a heading names: acceleration, velocity or displacement; empty without a quantity."""
    match = QUANTITY.search(heading)
    return match[0] if match else ""


def _first(pattern: re.Pattern[str]) -> Callable[[Lines], bool]:
    return lambda lines: bool(lines) and bool(pattern.match(lines[0]))


def _any(*patterns: re.Pattern[str]) -> Callable[[Lines], bool]:
    return lambda lines: any(pattern.search(line) for line in lines[:HEADING] for pattern in patterns)


def _is_knet(lines: Lines) -> bool:
    head = "\n".join(lines[:KNET_LINES])
    return bool(KNET_SCALE.search(head) or KNET.search(head))


FORMATS = (
    NetworkFormat("", _first(SPECTRA), spectra),
    NetworkFormat("GeoNet V1 and V2", _first(GEONET), geonet),
    NetworkFormat("BHRC V1", _first(BHRC), bhrc),
    NetworkFormat("COSMOS V1 and V2", _any(COSMOS, COSMOS_REALS), cosmos),
    NetworkFormat("CSMIP V1 and V2", _any(CSMIP_V1, CSMIP_V2), csmip),
    NetworkFormat("RENADIC", _any(FILM), film),
    NetworkFormat("K-NET and KiK-net", _is_knet, knet),
    NetworkFormat("SMC", _first(SMC), smc),
    NetworkFormat("ESM", lambda lines: any(line.startswith("SAMPLING_INTERVAL_S:") for line in lines[:HEADING]), esm),
    NetworkFormat("PEER .AT2, .VT2, .DT2", _any(PEER_NEW, PEER_OLD), peer),
)
# Which files are read, in a sentence.
READ = f"{', '.join(known.name for known in FORMATS if known.name)}, and columns of numbers: time (s) and acceleration"
