"""Records of the ground's acceleration: PEER .AT2, K-NET, and files of two columns."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meshes.errors import InputError
from meshes.section.quantity import GRAVITY

GAL = 0.01  # m/s²
UNITS = {"g": GRAVITY, "m/s^2": 1.0, "gal": GAL}
# How headings of columns name the units.
UNIT_WORDS = {
    "g": "g",
    "m/s^2": "m/s^2",
    "m/s2": "m/s^2",
    "m/s²": "m/s^2",
    "gal": "gal",
    "cm/s^2": "gal",
    "cm/s2": "gal",
}
UNIT_IN_HEADING = re.compile(r"[(\[]\s*([^)\]]+?)\s*[)\]]|_(g|gal|m_s2)\s*$", re.IGNORECASE)

# PEER's NGA files write "NPTS= 7807, DT= .0050 SEC", its older ones "4000 0.0100 NPTS, DT".
AT2_NEW = re.compile(r"NPTS\s*=\s*(\d+)\s*,\s*DT\s*=\s*([\d.Ee+-]+)", re.IGNORECASE)
AT2_OLD = re.compile(r"^\s*(\d+)\s+([\d.Ee+-]+)\s+NPTS\s*,\s*DT", re.IGNORECASE)
KNET_SCALE = re.compile(r"Scale Factor\s+([\d.]+)\(gal\)/(\d+)")
KNET_RATE = re.compile(r"Sampling Freq\(Hz\)\s+([\d.]+)")
KNET_HEADER = 17  # lines, of which the last begins with Memo.


@dataclass(frozen=True)
class Accelerogram:
    """``time`` (n,) in s, rising or with steps, and ``acceleration`` (n,) in m/s²; linear in between."""

    name: str
    kind: str
    time: np.ndarray
    acceleration: np.ndarray

    @property
    def peak(self) -> float:
        """The largest acceleration without regard to sign (m/s²)."""
        return float(np.abs(self.acceleration).max())

    def scaled(self, factor: float) -> "Accelerogram":
        """The same with every acceleration multiplied."""
        return Accelerogram(self.name, self.kind, self.time, factor * self.acceleration)


def read(path: Path, unit: str = "") -> Accelerogram:
    """A record, its kind known by what stands in it.

    ``unit`` is that of a two-column file whose heading names none. Raises InputError if there is no such file or it is
    none of the three kinds.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except FileNotFoundError:
        raise InputError(str(path), ["there is no such accelerogram"]) from None
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror}"]) from None
    head = "\n".join(lines[:KNET_HEADER])
    try:
        if KNET_SCALE.search(head):
            return _knet(path, lines, head)
        if AT2_NEW.search(head) or any(AT2_OLD.search(line) for line in lines[:6]):
            return _at2(path, lines)
        return _columns(path, lines, unit)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(str(path), [str(error)]) from None


def _at2(path: Path, lines: Sequence[str]) -> Accelerogram:
    """PEER: acceleration in g after a line with the number of points and the time step."""
    place = next(i for i, line in enumerate(lines) if AT2_NEW.search(line) or AT2_OLD.search(line))
    found = AT2_NEW.search(lines[place]) or AT2_OLD.search(lines[place])
    assert found is not None
    count, step = int(found[1]), float(found[2])
    values = _numbers(lines, place + 1)
    if len(values) != count:
        raise ValueError(f"holds {len(values)} accelerations; its line {place + 1} says {count}")
    if not step > 0.0:
        raise ValueError(f"line {place + 1}: the time step is {step:g} s; expected one above 0")
    return Accelerogram(path.name, "PEER .AT2", step * np.arange(count), GRAVITY * values)


def _knet(path: Path, lines: Sequence[str], head: str) -> Accelerogram:
    """K-NET and KiK-net: counts after 17 lines of heading, with an offset that their mean is."""
    scale, rate = KNET_SCALE.search(head), KNET_RATE.search(head)
    if scale is None or rate is None:
        raise ValueError('is a K-NET file without "Sampling Freq(Hz)"')
    counts = _numbers(lines, KNET_HEADER)
    values = (counts - counts.mean()) * float(scale[1]) / float(scale[2]) * GAL
    return Accelerogram(path.name, "K-NET", np.arange(len(values)) / float(rate[1]), values)


def _columns(path: Path, lines: Sequence[str], unit: str) -> Accelerogram:
    """Two columns, time (s) and acceleration, under a heading that names the unit of the latter, if there is one."""
    rows: list[tuple[float, float]] = []
    for number, line in enumerate(lines, start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        cells = [cell for cell in re.split(r"[,;\s]+", text) if cell]
        try:
            time, acceleration = (float(cell) for cell in cells)
        except ValueError:
            if rows:
                raise ValueError(f"line {number}: {text!r}: expected two numbers, time and acceleration") from None
            unit = _unit_of(text) or unit
            continue
        rows.append((time, acceleration))
    if len(rows) < 2:
        raise ValueError(
            "is no accelerogram: expected PEER .AT2, K-NET, or lines of two numbers, time (s) and acceleration"
        )
    if not unit:
        raise ValueError('sliding_block, unit: expected "g", "m/s^2" or "gal", or a heading such as time (s), a (g)')
    time, acceleration = np.array(rows).T
    if not np.isfinite(time).all() or not np.isfinite(acceleration).all():
        raise ValueError("holds a number that is not finite")
    back = np.flatnonzero(np.diff(time) < 0.0)
    if len(back):
        raise ValueError(f"the time falls from {time[back[0]]:g} s to {time[back[0] + 1]:g} s; expected it to rise")
    return Accelerogram(path.name, "two columns", time, UNITS[unit] * acceleration)


def _unit_of(heading: str) -> str:
    """The unit that the last column of a heading names; empty if none does."""
    found = UNIT_IN_HEADING.findall(heading.split(",")[-1])
    if not found:
        return ""
    word = (found[-1][0] or found[-1][1]).lower().replace("m_s2", "m/s^2")
    return UNIT_WORDS.get(word, "")


def _numbers(lines: Sequence[str], first: int) -> np.ndarray:
    """All numbers from a line on."""
    values = []
    for number, line in enumerate(lines[first:], start=first + 1):
        try:
            values += [float(cell) for cell in line.split()]
        except ValueError:
            raise ValueError(f"line {number}: {line.strip()!r}: expected numbers") from None
    if len(values) < 2 or not np.isfinite(values).all():
        raise ValueError("holds no two finite accelerations")
    return np.array(values)
