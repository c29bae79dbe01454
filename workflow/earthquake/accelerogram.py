"""Reads records of ground acceleration from files of any format, and warns about them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meshes.borings.text_file import read_text
from meshes.errors import InputError
from meshes.section.motion_units import EXPECTED, MotionUnit, motion_unit
from meshes.section.quantity import GRAVITY
from workflow.earthquake.attenuation import GAL
from workflow.earthquake.network_formats import FORMATS
from workflow.earthquake.record_table import table
from workflow.earthquake.recorded_series import RecordedSeries

# The largest accelerations ever recorded are about 4 g; what is above ten is another quantity or unit.
STRONG_MOTION, LARGEST_ACCELERATION, FAINT_MOTION = 3.0 * GRAVITY, 10.0 * GRAVITY, 0.001 * GRAVITY
COARSE_STEP = 0.1  # s, a step that leaves out what lies above 5 Hz
LARGEST_OFFSET = 0.01  # of the peak
PEAK_TOLERANCE = 0.05  # relative difference of the peak of a record from a stated peak, above which it is reported


@dataclass(frozen=True)
class Accelerogram:
    """Holds a record of acceleration, linear between its times.

    Attributes
    ----------
    name, kind : name of the file, and name of its format
    time (n,) : times (s), rising or with steps
    acceleration (n,) : acceleration at these times (m/s²)
    remarks : corrections and warnings, one sentence without its full stop each
    """

    name: str
    kind: str
    time: np.ndarray
    acceleration: np.ndarray
    remarks: tuple[str, ...] = ()

    @property
    def peak(self) -> float:
        """Return the largest acceleration without regard to sign (m/s²)."""
        return float(np.abs(self.acceleration).max())

    def scaled(self, factor: float) -> "Accelerogram":
        """Return the record with every acceleration multiplied by a factor."""
        scaled = replace(self, acceleration=factor * self.acceleration)
        remarks = [text for text in (_size(scaled.peak),) if text and factor != 1.0]
        return replace(scaled, remarks=(*self.remarks, *(f"multiplied by {factor:g}, {text}" for text in remarks)))


def read(path: Path, unit: str = "", component: str = "") -> Accelerogram:
    """Read a record of acceleration. The format is recognised by the content of the file.

    Velocity and displacement are differentiated in time, and an offset is subtracted; the remarks state both.

    Parameters
    ----------
    path : Path
        A file of PEER (.AT2, .VT2, .DT2), K-NET or KiK-net, COSMOS or CSMIP (V1, V2), RENADIC, ESM, GeoNet, BHRC, or
        columns.
    unit : str
        Unit of the values if the heading of the file names none.
    component : str
        Component of a file that has several: its name in the heading, or its number from 1.

    Returns
    -------
    Accelerogram

    Raises
    ------
    InputError
        If there is no such file, or if its format, quantity, unit, component or times are not known.
    """
    lines = _lines(path)
    try:
        known = next((style for style in FORMATS if style.recognised(lines)), None)
        series = _chosen(table(lines) if known is None else known.read(lines), component)
        return _accelerogram(path.name, series, unit)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(str(path), [str(error)]) from None


def _lines(path: Path) -> list[str]:
    """Return the lines of a text file in any encoding."""
    if not path.exists():
        raise InputError(str(path), ["there is no such accelerogram"])
    text = read_text(path).text
    if "\0" in text:
        message = "is a binary file, such as miniSEED, SAC or a spreadsheet; expected columns of time and acceleration"
        raise InputError(str(path), [message])
    return text.splitlines()


def _chosen(components: list[RecordedSeries], wanted: str) -> RecordedSeries:
    """Return the component that is ``wanted``, or, if none is named, the only component of acceleration.

    Raises ValueError if the file has no such component, or several and none is named.
    """
    of_acceleration = [component for component in components if component.quantity.lower().startswith("accel")]
    components = of_acceleration or components
    if not components:
        raise ValueError("has the heading of a record, but no values")
    if not wanted:
        if len(components) > 1:
            raise ValueError(
                f"holds {len(components)} components, {_names(components)}: expected component = one of them"
            )
        return components[0]
    key = _plain(wanted)
    for number, component in enumerate(components, start=1):
        parts = {_plain(component.component), *map(_plain, component.component.split(":")), str(number)}
        if key in parts or (key.isalpha() and _plain(component.component).startswith(key)):
            return component
    raise ValueError(f'component = "{wanted}": the file holds the components {_names(components)}')


def _names(components: list[RecordedSeries]) -> str:
    return ", ".join(f'"{component.component or number}"' for number, component in enumerate(components, start=1))


def _plain(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())


def _accelerogram(name: str, series: RecordedSeries, unit: str) -> Accelerogram:
    measured = _unit(series, unit)
    values = measured.factor * series.values
    remarks: list[str] = []
    if not values.any():
        raise ValueError("holds only zeros; expected a record of ground motion")
    if abs(series.time[0]) > COARSE_STEP:
        remarks.append(f"the times of the record begin at {series.time[0]:.6g} s, and are counted from there")
        series = replace(series, time=series.time - series.time[0])
    if measured.motion != "acceleration":
        peak = f"{np.abs(series.values).max():.4g} {series.unit or unit}"
        remarks.append(f"the record holds {measured.motion}, up to {peak}, which is differentiated in time")
        values = _differentiated(series.time, values, 1 if measured.motion == "velocity" else 2)
    elif series.counts:
        values = values - values.mean()
    else:
        values, notes = _without_offset(series.time, values)
        remarks += notes
    record = Accelerogram(name, series.format, series.time, values)
    if record.peak >= LARGEST_ACCELERATION:
        raise ValueError(
            f'the peak of the record is {record.peak / GRAVITY:.3g} g with the unit "{series.unit or unit}"; no '
            "recorded ground motion is as large: check the unit, and that the values are accelerations"
        )
    stated = None if series.peak is None else measured.factor * series.peak
    return replace(
        record, remarks=(*remarks, *_warnings(record, stated if measured.motion == "acceleration" else None))
    )


def _unit(series: RecordedSeries, setting: str) -> MotionUnit:
    """Return the quantity and unit of the values. Raises ValueError if they are missing or contradictory."""
    named = motion_unit(series.unit) if series.unit else None
    if series.unit and named is None:
        raise ValueError(f'the heading of the file gives the unit "{series.unit}", which is not understood; {EXPECTED}')
    wanted = motion_unit(setting) if setting else None
    if named is None and wanted is None:
        raise ValueError(
            'the heading of the file names no unit; expected unit = "g", "m/s^2" or "gal" after the name of the '
            "file, or a heading such as time (s), acceleration (g)"
        )
    if named is not None and wanted is not None and named != wanted:
        raise ValueError(
            f'unit = "{setting}": the heading of the file says "{series.unit}"; expected the same, or no unit'
        )
    unit = named or wanted
    assert unit is not None
    if series.quantity and not unit.motion.startswith(series.quantity.lower()[:5]):
        raise ValueError(
            f"the heading of the file says that the values are {series.quantity.lower()}, but their unit, "
            f"{series.unit or setting}, is one of {unit.motion}: expected a unit of {series.quantity.lower()}"
        )
    return unit


def _differentiated(time: np.ndarray, values: np.ndarray, times: int) -> np.ndarray:
    """Return the acceleration by differentiating velocity once, or displacement twice, with a spline of the fifth
    degree through the values."""
    from scipy.interpolate import make_interp_spline

    if len(time) < 6 or np.any(np.diff(time) <= 0.0):
        raise ValueError(
            "holds velocity or displacement with fewer than six values, or with steps; expected a series that can be "
            "differentiated to acceleration"
        )
    return np.asarray(make_interp_spline(time, values, k=5).derivative(times)(time))


def _without_offset(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return accelerations without a constant offset, and a remark where one was removed.

    The mean acceleration of ground that ends at rest is 0. If the median agrees with the mean, the whole record has an
    offset. If median and mean differ, the record is a pulse, or was cut off, and is not changed.
    """
    mean = float(0.5 * (values[1:] + values[:-1]) @ np.diff(time)) / max(float(time[-1] - time[0]), 1e-9)
    middle, peak = float(np.median(values)), float(np.abs(values).max())
    if abs(mean) <= LARGEST_OFFSET * peak:
        return values, []
    size = f"{mean / GAL:.3g} gal, {100.0 * abs(mean) / peak:.2g} % of its peak"
    shifted = abs(middle - mean) <= 0.25 * abs(mean) and abs(mean) < 0.5 * peak
    if shifted:
        return values - mean, [f"the mean of the record, {size}, was subtracted as an offset"]
    return values, [
        f"the mean of the record is {size}, so that the ground is not at rest at the end; the record is not corrected"
    ]


def _warnings(record: Accelerogram, stated: float | None) -> Iterator[str]:
    """Yield warnings about the size and the steps of a record, and about a peak that differs from the peak in its
    heading (m/s²)."""
    if text := _size(record.peak):
        yield text
    longest = float(np.diff(record.time).max())
    if longest > (1.0 + 1e-9) * COARSE_STEP:
        steps = f"the time steps of the record are up to {longest:g} s long"
        yield f"{steps}; expected up to {COARSE_STEP:g} s; check their unit"
    if stated is not None and abs(record.peak - stated) > PEAK_TOLERANCE * stated:
        yield f"the peak of the record is {record.peak / GAL:.4g} gal, where its heading says {stated / GAL:.4g} gal"


def _size(peak: float) -> str:
    if peak > STRONG_MOTION:
        return f"the peak of the record is {peak / GRAVITY:.3g} g, above {STRONG_MOTION / GRAVITY:g} g; check its unit"
    if peak < FAINT_MOTION:
        return f"the peak of the record is {peak / GAL:.3g} gal, below {FAINT_MOTION / GAL:.2g} gal; check its unit"
    return ""
