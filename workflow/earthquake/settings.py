"""Defines the earthquake of a section (the table [earthquake] of the input file), and computes the peak acceleration
expected from it."""

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PlainSerializer, PlainValidator

from dem.settings import SlideSettings
from meshes.errors import InputError
from meshes.section.motion_units import RecordComponent, RecordScale, RecordUnit, motion_unit
from meshes.section.quantity import GRAVITY, NUMBER_AND_UNIT, Coordinate, Density, Kind, Length, with_a_point
from meshes.section.section import Model
from workflow.earthquake.accelerogram import PEAK_TOLERANCE, STRONG_MOTION, Accelerogram
from workflow.earthquake.accelerogram import read as read_record
from workflow.earthquake.attenuation import GAL, Mechanism, PeakMotion, Site, fukushima_tanaka, si_midorikawa
from workflow.earthquake.boore import Slip, boore
from workflow.earthquake.equivalent_kh import (
    REFERENCE_MAGNITUDE,
    EquivalentKh,
    cycles_of_magnitude,
    equivalent_kh,
    mean_period,
)

EARTHQUAKE = "earthquake"  # setting of Kh, cycles and period of the slides: those equivalent to [earthquake]
CYCLES = ("kh_cycles", "kh_period")
SHAKES = ("kh", "kh_seconds", "accelerogram", *CYCLES)  # keys of [slide], each of which says how the ground shakes
LARGEST_PLAIN_IN_G = 1.5  # below it a plain number of m/s² may be one of g
FIRM_VS30 = 760.0  # m/s: replaces a missing vs30 while other problems are searched for

Relation = Literal["si_midorikawa", "fukushima_tanaka", "boore"]


class AccelerationKind(Kind):
    """Describes an acceleration in the units of ground motion, such as g and gal, which the library pint would read as
    grams and gallons."""

    def _convert(self, text: str) -> float:
        if comma := with_a_point(text):
            raise ValueError(f'has a decimal comma; write "{comma}"; {self.expected}')
        parts = NUMBER_AND_UNIT.fullmatch(text)
        if parts is None:
            raise ValueError(f"not understood as a number with a unit; {self.expected}")
        if not parts[2]:
            raise ValueError(f"has no unit; {self.expected}, or a plain number in {self.unit}")
        unit = motion_unit(parts[2])
        if unit is None:
            raise ValueError(f'"{parts[2]}" is not understood as a unit of acceleration; {self.expected}')
        if unit.motion != "acceleration":
            raise ValueError(f'"{parts[2]}" is a unit of {unit.motion}; {self.expected}')
        return float(parts[1]) * unit.factor


ACCELERATION = AccelerationKind(
    "an acceleration", "m/s^2", '"250 gal", "0.25 g", "2.5 m/s^2" or "25 %g"', minimum=0.0, maximum=50.0,
    minimum_allowed=False, limits=" above 0 and below 50 m/s^2",
)  # fmt: skip

Acceleration = Annotated[
    float, PlainValidator(ACCELERATION.read), PlainSerializer(lambda number: getattr(number, "written", number))
]


class EarthquakeSettings(Model):
    """Holds the settings of an earthquake, the table [earthquake] of the input file.

    The earthquake is given by magnitude and distance, or by the peak or a record of the acceleration at the ground
    surface.
    """

    magnitude: float | None = Field(
        default=None, ge=4.0, le=9.5, description="moment magnitude, from 4 to 9.5, such as 7.7"
    )
    distance: Length | None = Field(
        default=None, description='the shortest distance to the fault, a length such as "27 km"'
    )
    depth: Length = Field(default=10_000.0, description='the depth of the middle of the fault, such as "14 km"')
    mechanism: Mechanism = Field(
        default="crustal", description='type of the earthquake: "crustal", "interplate" or "intraplate"'
    )
    site: Site = Field(default="average", description='kind of ground: "rock", "average" or "soft"')
    relation: Relation = Field(
        default="fukushima_tanaka",
        description=(
            'attenuation relation of the peak acceleration: "fukushima_tanaka" (1990) or "si_midorikawa" '
            '(1999), of Japan, or "boore" (Boore et al. 2014), of shallow crustal earthquakes anywhere'
        ),
    )
    vs30: float | None = Field(
        default=None, gt=0.0, description='mean V_s of the uppermost 30 m (m/s), such as 270, for relation = "boore"'
    )
    slip: Slip = Field(
        default="unknown",
        description='slip of the fault: "strike-slip", "normal", "reverse" or "unknown", for relation = "boore"',
    )
    peak_acceleration: Acceleration | None = Field(
        default=None,
        description=(
            'peak acceleration at the ground surface, such as "250 gal"; it takes precedence over the '
            "record, and over magnitude and distance"
        ),
    )
    record: str = Field(
        default="",
        description=(
            "file with a record of the ground surface (PEER, K-NET, COSMOS, ESM, .csv), whose peak is "
            "used; it takes precedence over magnitude and distance"
        ),
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: RecordScale = 1.0

    @property
    def gives_peak(self) -> bool:
        """Return whether the input determines a peak acceleration: directly, by a record, or by magnitude and
        distance."""
        expected = self.magnitude is not None and self.distance is not None
        return self.peak_acceleration is not None or bool(self.record) or expected

    def motion(self) -> PeakMotion | None:
        """Return the peak acceleration with its standard deviation; None if the input does not determine it.

        Raises InputError outside the range of the relation, or where the record cannot be read.
        """
        if self.peak_acceleration is not None:
            return PeakMotion(float(self.peak_acceleration), 0.0, "as given", "the input", "as given")
        if self.record:
            motion = self._recorded
            return PeakMotion(motion.peak, 0.0, f"the peak of {motion.name}", "the record", "as recorded")
        if self.magnitude is None or self.distance is None:
            return None
        return expected_motion(self, self.magnitude, self.distance)

    @cached_property
    def _recorded(self) -> Accelerogram:
        """Return the record, which is read only once."""
        try:
            return read_record(Path(self.record), self.unit, self.component).scaled(self.scale)
        except InputError as error:
            raise InputError("earthquake", [f"record = {self.record}: {text}" for text in error.problems]) from None

    def contradiction(self) -> str:
        """Return a sentence if the given peak differs by more than one standard deviation from the peak by magnitude
        and distance, else empty. In case of a contradiction the given peak is used; relations of magnitude and distance
        alone use both as given.
        """
        has_peak = self.peak_acceleration is not None or bool(self.record)
        if not has_peak or self.magnitude is None or self.distance is None:
            return ""
        try:
            motion, let_expect = self.motion(), expected_motion(self, self.magnitude, self.distance)
        except InputError:  # reported by problems, or nothing is expected there
            return ""
        if motion is None or let_expect.low <= motion.median <= let_expect.high:
            return ""
        low, median, high = (value / GAL for value in (let_expect.low, let_expect.median, let_expect.high))
        expectation = f"{median:.0f} gal are expected of M {self.magnitude:g} at {self.distance / 1000.0:g} km"
        return (
            f"the peak acceleration of [earthquake] is {motion.median / GAL:.0f} gal, {motion.relation}, where "
            f"{expectation} ({low:.0f} to {high:.0f} gal; {let_expect.relation}): the peak is used; relations that "
            "need the distance use the given distance"
        )

    def notices(self, slide: SlideSettings | None) -> list[str]:
        """Return warnings, contradictions, and the source of the Kh of the slides, if it follows from the table
        [earthquake]."""
        notices = [self._unlikely_peak(), self._unlike_record(), self.contradiction()]
        if slide is not None and (cycles := self.driving(slide)) is not None:
            notices.append(f"the Kh of the slides, {cycles.kh:g}, follows from [earthquake]: {cycles.description}")
        elif slide is not None and self.is_assumed(slide):
            magnitude = REFERENCE_MAGNITUDE if self.magnitude is None else self.magnitude
            reason, remedy = "no shaking of the slides is given", "give [earthquake], a record"
            if self != EarthquakeSettings():
                reason = "[earthquake] has no peak acceleration"
                remedy = "give the peak, or magnitude and distance, or a record"
            notices.append(
                f"{reason}; {slide.shaking} is assumed, with the cycles of magnitude {magnitude:g}: {remedy}, or kh "
                "(0 for a slide by its weight alone)"
            )
        elif slide is not None:
            notices.append(self._overruled(slide))
        return [text for text in notices if text]

    def _overruled(self, slide: SlideSettings) -> str:
        """Return a notice if slides have another Kh or duration than the Kh and duration that follow from the
        earthquake; else empty."""
        cycles = None if slide.accelerogram or slide.kh == 0.0 else self.equivalent()
        if cycles is None:
            return ""
        one_way = "" if slide.kh_cycles is not None or slide.kh_seconds is not None else " in one direction without end"
        return (
            f"the slides use the given {slide.shaking}{one_way}; the equivalent of [earthquake] is Kh = "
            f"{cycles.kh:g} in both directions ({cycles.cycles:g} cycles, period {cycles.period:g} s), as with "
            f'slide.kh = "{EARTHQUAKE}"'
        )

    def _unlike_record(self) -> str:
        """Return a notice if a record is not used because its peak differs from the given peak; else empty."""
        if self.peak_acceleration is None or not self.record:
            return ""
        try:
            record = self._recorded
        except InputError as error:
            used = "earthquake, record is not used, since peak_acceleration is given"
            return f"{used}, and cannot be read: {error.problems[0]}"
        peak = float(self.peak_acceleration)
        if abs(record.peak / peak - 1.0) <= PEAK_TOLERANCE:
            return ""
        return (
            f"earthquake, peak_acceleration of {peak / GRAVITY:.3g} g is used, and {record.name}, whose peak is "
            f"{record.peak / GRAVITY:.3g} g, is not: give one of them, or scale = {peak / record.peak:.3g}"
        )

    def _unlikely_peak(self) -> str:
        """Return a notice if a peak is above all recorded peaks, or is a plain number that may be meant in g; else
        empty."""
        if self.peak_acceleration is None:
            return ""
        peak = float(self.peak_acceleration)
        plain = not isinstance(getattr(self.peak_acceleration, "written", peak), str)
        if peak > STRONG_MOTION or (plain and peak < LARGEST_PLAIN_IN_G):
            unit = "a plain number, in m/s^2" if plain else "as written"
            return f"earthquake, peak_acceleration is {peak / GRAVITY:.3g} g, {unit}; check its unit"
        return ""

    def driving(self, slide: SlideSettings) -> EquivalentKh | None:
        """Return the equivalent cycles of Kh if they load the slides; else None."""
        cycles = None if slide.accelerogram else self.equivalent()
        return cycles if cycles is not None and (slide.kh, slide.kh_cycles) == (cycles.kh, cycles.cycles) else None

    def is_assumed(self, slide: SlideSettings) -> bool:
        """Return whether the input does not determine the shaking, so that ``slide`` has assumed values."""
        loading = {key: getattr(slide, key) for key in ("kh", *CYCLES)}
        return self.equivalent() is None and not slide.accelerogram and loading == assumed_loading(self.magnitude)

    def equivalent(self) -> EquivalentKh | None:
        """Return the equivalent cycles of Kh. If there is a record, number and period of the cycles follow from the
        record, also if the peak is given. The result is None if there is no peak acceleration.
        """
        try:
            motion = self.motion()
            record = self._recorded if self.record and not self._unlike_record() else None
        except InputError:
            return None
        if motion is None:
            return None
        return equivalent_kh(motion, self.magnitude, self.distance, self.site, record)

    def problems(self) -> list[str]:
        """Return missing input of the attenuation relation, and values outside its range. Records are checked when they
        are read."""
        if self.record and self.peak_acceleration is None:
            return []
        try:
            self.motion()
        except InputError as error:
            return [f"earthquake, {text}" for text in error.problems]
        return []


class SiteResponseSettings(Model):
    """Holds the settings of the site response, the table [site_response] of the input file.

    The settings are a point of the section and a record at the base of the layers under it.
    """

    record: str = Field(
        default="",
        description=(
            "file with a record of the rock below (PEER, K-NET, COSMOS, ESM, .csv), as it would be where "
            "the rock crops out"
        ),
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: RecordScale = 1.0
    x: Coordinate | None = Field(
        default=None,
        description="position of the computed column of layers along the section; by default the middle of the section",
    )
    velocities: dict[str, Annotated[float, Field(gt=10.0, le=3000.0)]] = Field(
        default={}, description="measured V_s (m/s) by the name of the stratum; by default V_s follows from E and ν"
    )
    plasticity: dict[str, Annotated[float, Field(ge=0.0, le=200.0)]] = Field(
        default={}, description="plasticity index (%) by the name of the stratum; by default 0"
    )
    base_velocity: float = Field(default=400.0, gt=50.0, le=5000.0, description="V_s (m/s) of the rock below")
    base_density: Density = Field(default=2000.0, description='the density of the rock below, such as "2.0 t/m^3"')
    slip_depth: Length | None = Field(
        default=None,
        description=(
            "depth of the slip surface at this position. The acceleration is averaged above it, for a "
            'rigid block (by default above the slip surface of the finite elements) and for kh = "k_max" '
            "in [slide]"
        ),
    )


def loading_of_slides(earthquake: EarthquakeSettings, slide: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return Kh of the slides, its cycles and their period, if the earthquake of the input determines them.

    If the input gives Kh or its duration, Kh has no cycles unless the settings request cycles.

    Parameters
    ----------
    earthquake : the table [earthquake]
    slide : the table [slide] as read
    source : name of the input, for errors

    Returns
    -------
    ``kh`` (-), ``kh_cycles`` (-) and ``kh_period`` (s), as far as [slide] leaves them to the earthquake. Empty if a
    record shakes the slides, without a peak acceleration, or if [earthquake] has errors, which are reported elsewhere.

    Raises
    ------
    InputError : A setting is "earthquake" although there is no peak acceleration, or although a record shakes the
        slides.
    """
    requested = [key for key in ("kh", *CYCLES) if slide.get(key) == EARTHQUAKE]
    kh_left = slide.get("kh", EARTHQUAKE) == EARTHQUAKE
    is_constant = "kh_seconds" in slide or not kh_left
    left = [key for key in CYCLES if slide.get(key, None if is_constant else EARTHQUAKE) == EARTHQUAKE]
    if requested and slide.get("accelerogram"):
        expected = "expected no accelerogram, which shakes the slides itself"
        message = f'slide, {requested[0]} = "{EARTHQUAKE}": {expected}'
        raise InputError(source, [message])
    if slide.get("accelerogram") or not (kh_left or left):
        return {}
    cycles = earthquake.equivalent()
    if cycles is None and requested:
        message = (
            f'slide, {requested[0]} = "{EARTHQUAKE}": expected [earthquake] with a peak, a record, or magnitude and '
        )
        raise InputError(source, [message + "distance"])
    if cycles is None:
        return {}
    values = {"kh": cycles.kh, "kh_cycles": cycles.cycles, "kh_period": cycles.period}
    return {key: values[key] for key in [*(["kh"] if kh_left else []), *left]}


def assumed_loading(magnitude: float | None) -> dict[str, float]:
    """Return assumed Kh of the slides, its cycles and their period, for an input that does not determine the shaking.

    A constant Kh without end would move even level ground without limit once its residual strength is exceeded.

    Parameters
    ----------
    magnitude : moment magnitude, to which cycles and period belong at a distance of 20 km; None for 7.5

    Returns
    -------
    The default ``kh`` (-) of [slide], ``kh_cycles`` (-) by Idriss & Boulanger (2008), ``kh_period`` (s) by Rathje et
    al. (2004).
    """
    kh = float(SlideSettings.model_fields["kh"].default)
    magnitude = REFERENCE_MAGNITUDE if magnitude is None else magnitude
    return {
        "kh": kh,
        "kh_cycles": round(cycles_of_magnitude(magnitude), 1),
        "kh_period": round(mean_period(magnitude), 2),
    }


def expected_motion(settings: EarthquakeSettings, magnitude: float, distance: float) -> PeakMotion:
    """Return the peak acceleration by the chosen attenuation relation, of a magnitude at a distance (m)."""
    if settings.relation == "boore":
        problems = []
        if settings.vs30 is None:
            problems.append('relation = "boore": expected vs30, the mean V_s of the uppermost 30 m (m/s)')
        try:
            motion = boore(magnitude, distance, settings.vs30 or FIRM_VS30, settings.slip)
        except InputError as error:
            problems += error.problems
        if problems:
            raise InputError("earthquake", problems)
        return motion
    if settings.relation == "si_midorikawa":
        return si_midorikawa(magnitude, distance, settings.depth, settings.mechanism)
    return fukushima_tanaka(magnitude, distance, settings.site)
