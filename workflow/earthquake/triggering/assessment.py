"""Computes F_L at every blow count of a section, decides which strata liquefy, and computes P_L of every boring."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshes.borings.boring import Boring, Cone, Sample
from meshes.errors import InputError
from meshes.section.cutting import BELOW_WATER, soil_of
from meshes.section.overburden import Overburden, outside, overburden, reaches_water, water_level
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from workflow.earthquake.attenuation import PeakMotion, ValidRange
from workflow.earthquake.settings import EarthquakeSettings
from workflow.earthquake.triggering import boulanger_idriss, idriss_boulanger
from workflow.earthquake.triggering.blow_count import KPA, BlowCount, Resistance, SurfaceMotion
from workflow.earthquake.triggering.boulanger_idriss import ConeTest
from workflow.earthquake.triggering.methods import RELATIONS, Relation, reasons_in_one
from workflow.earthquake.triggering.potential import potential
from workflow.earthquake.triggering.settings import TriggeringSettings

ABOVE_WATER = "above the water table"  # why a soil is not judged
REPORTED_LOAD_SHARE = 0.01  # of the total stress: what surcharges add to it is reported
CLAY = 'clay by its strength, φ = 0, and its plasticity index is not known; liquefies_in = "triggered" assesses it'


@dataclass(frozen=True)
class TestResult:
    """Holds one test and its factor F_L.

    Attributes
    ----------
    boring, x, sample : place and result of the test
    top, bottom : range of depth (m) that the test represents, half-way to its neighbours in the same stratum
    length : length of the stretch of the section for which this boring is the nearest one (m)
    overburden : stresses and stratum at the test
    outcome : demand, resistance and F_L by the method; None if the method does not apply
    reason : why the method does not apply
    """

    boring: str
    x: float
    sample: Sample | Cone
    top: float
    bottom: float
    length: float
    overburden: Overburden
    outcome: Resistance | None
    reason: str

    @property
    def area(self) -> float:
        """Return the area of ground (m²) that the test represents."""
        return (self.bottom - self.top) * self.length

    @property
    def factor(self) -> float | None:
        """Return F_L; None if the soil is not assessed."""
        return None if self.outcome is None else self.outcome.factor

    @property
    def liquefies(self) -> bool:
        """Return whether F_L is below 1."""
        return self.factor is not None and self.factor < 1.0


@dataclass(frozen=True)
class StratumResult:
    """Holds the share of a stratum that liquefies.

    Attributes
    ----------
    name : name of the stratum
    tests : number of tests in the stratum
    assessed : number of tests with an F_L
    share : share of the area of the tests in which F_L is below 1; None without tests
    lowest : smallest F_L; None if no test was assessed
    reason : why the stratum, or some of its tests, were not assessed
    liquefies : whether the share reaches the required share
    """

    name: str
    tests: int
    assessed: int
    share: float | None
    lowest: float | None
    liquefies: bool
    reason: str


@dataclass(frozen=True)
class TriggeringAssessment:
    """Holds the result of a triggering analysis.

    Attributes
    ----------
    motion : peak acceleration at the ground surface
    magnitude : moment magnitude; None if the input has none
    relation : method of the analysis
    tests : all tests, boring by boring, with F_L
    strata : share of each stratum that liquefies, in the order of the section
    potentials : liquefaction potential P_L (0 to 100) by the name of the boring
    """

    motion: PeakMotion
    magnitude: float | None
    relation: Relation
    tests: tuple[TestResult, ...]
    strata: tuple[StratumResult, ...]
    potentials: dict[str, float]


def assess(section: Section, earthquake: EarthquakeSettings, settings: TriggeringSettings) -> TriggeringAssessment:
    """Compute F_L of every test of every boring, the strata that liquefy, and P_L of every boring.

    Parameters
    ----------
    section : the ground, with the water table
    earthquake : peak acceleration at the ground surface, and magnitude
    settings : method, borings, and the share of a stratum with F_L below 1 from which the stratum liquefies

    Returns
    -------
    The assessment. Soil above the water table, and soil to which the method does not apply, has no F_L.

    Raises
    ------
    InputError : Input is missing or outside the range of the method, a boring lies outside the section, or the vertical
        effective stress at a test is not positive. The error has one sentence for every problem.
    """
    relation = RELATIONS[settings.method]
    problems = _missing(section, earthquake, settings)
    problems += off_the_section(section, settings)
    motion = None if problems else earthquake.motion()
    if motion is None:
        raise InputError(section.name, problems)
    shaking = SurfaceMotion(motion.median / GRAVITY, earthquake.magnitude or math.nan)
    tests: list[TestResult] = []
    borings = [boring for boring in settings.borings if getattr(boring, relation.kind)]
    lengths = _stretches(section, sorted({float(boring.x) for boring in borings}))
    for boring in borings:
        samples: tuple[Sample | Cone, ...] = getattr(boring, relation.kind)
        pieces = _ranges_of_tests(section, boring, [float(sample.depth) for sample in samples])
        for sample, (top, bottom, place_in_ground) in zip(samples, pieces, strict=True):
            point = point_of(sample, place_in_ground)
            reason = _why_not(section, sample, place_in_ground) or relation.why_not(point)
            try:
                resistance = None if reason else _resistance_of(relation, point, shaking, settings)
            except ValueError as error:
                problems.append(f"triggering, boring {boring.name}, test at {sample.depth:g} m: {error}")
                continue
            x = float(boring.x)
            tests.append(
                TestResult(boring.name, x, sample, top, bottom, lengths[x], place_in_ground, resistance, reason)
            )
    if problems:
        raise InputError(section.name, problems)
    strata = tuple(_of_stratum(section, k, tests, settings.share) for k in range(len(section.strata)))
    layers = {boring.name: [t for t in tests if t.boring == boring.name] for boring in borings}
    potentials = {
        name: potential([(t.top, t.bottom, t.factor) for t in tests_of_layer])
        for name, tests_of_layer in layers.items()
    }
    return TriggeringAssessment(motion, earthquake.magnitude, relation, tuple(tests), strata, potentials)


def _why_not(section: Section, sample: Sample | Cone, where: Overburden) -> str:
    """Return the reason why no method assesses a test: the ground is above the water table, or clay; empty if a method
    applies.
    """
    if not where.below_water:
        return ABOVE_WATER
    stratum = section.strata[where.stratum]
    may_liquefy = stratum.liquefiable or stratum.liquefies_in.triggered
    known = not isinstance(sample, Sample) or sample.plasticity is not None  # a cone has its soil behaviour index
    return "" if stratum.friction_angle > 0.0 or may_liquefy or known else CLAY


def _resistance_of(
    relation: Relation, point: BlowCount | ConeTest, shaking: SurfaceMotion, settings: TriggeringSettings
) -> Resistance:
    """Return the resistance of a test by a relation. Raises ValueError for missing input, or if the vertical
    effective stress is not positive."""
    if point.effective <= 0.0:
        raise ValueError(
            f"the vertical effective stress is {point.effective:.1f} kPa; the relations of triggering need a stress "
            "above 0 (the pore pressure lifts the ground: see the water of the section)"
        )
    return relation.find(point, shaking, settings)


def _missing(section: Section, earthquake: EarthquakeSettings, settings: TriggeringSettings) -> list[str]:
    """Return the missing input of triggering."""
    problems = []
    if not settings.borings:
        problems.append("triggering, borings: missing; expected one table [[triggering.borings]] for each boring")
    names = [boring.name for boring in settings.borings]
    problems += [f'triggering, borings: {names.count(n)} are called "{n}"' for n in dict.fromkeys(names)
                 if names.count(n) > 1]  # fmt: skip
    if section.water_points() is None and not any(stratum.confined for stratum in section.strata):
        problems.append("water, table: missing; soil liquefies only below the water table")
    try:
        if earthquake.motion() is None:
            problems.append("earthquake: expected peak_acceleration, or magnitude and distance")
    except InputError as error:
        problems += [f"earthquake, {text}" for text in error.problems]
    relation = RELATIONS[settings.method]
    if settings.borings and not any(getattr(boring, relation.kind) for boring in settings.borings):
        methods = [
            f'"{name}"' for name, other in RELATIONS.items()
            if any(getattr(boring, other.kind) for boring in settings.borings)
        ]  # fmt: skip
        remedy = f"; for what they have, set triggering.method to {' or '.join(methods)}" if methods else ""
        problems.append(f"triggering, borings: none has {relation.kind}, which {relation.title} requires{remedy}")
    if relation.magnitudes is not None and earthquake.magnitude is None:
        problems.append(f"earthquake, magnitude: missing; {relation.title} requires it")
    elif relation.magnitudes is not None and earthquake.magnitude is not None:
        problem = ValidRange("earthquake, magnitude", *relation.magnitudes).problem(
            earthquake.magnitude, relation.title
        )
        problems += [problem] if problem else []
    return problems


def off_the_section(section: Section, settings: TriggeringSettings) -> list[str]:
    """Return a sentence on every boring, or test of a boring, that lies outside the section.

    Parameters
    ----------
    section : the ground
    settings : the borings

    Returns
    -------
    The sentences; none if all tests lie in the section.
    """
    return [text for boring in settings.borings for text in _outside(section, boring)]


def below_loads(section: Section, settings: TriggeringSettings) -> list[str]:
    """Return a warning on borings whose stresses depend on surcharges, with the settings to check.

    Parameters
    ----------
    section : the ground with its surcharges
    settings : the borings

    Returns
    -------
    At most one sentence; none if surcharges are at most 1 % of the total vertical stress at all tests.
    """
    loaded = [boring.name for boring in settings.borings if section.surcharges and _feels_loads(section, boring)]
    if not loaded:
        return []
    return [
        f"F_L of {'boring' if len(loaded) == 1 else 'borings'} {', '.join(loaded)} includes surcharges, which spread "
        "with depth as on an elastic half-plane: check seismic_share (the share of a surcharge in σv) and consolidated "
        "(its share in σ'v and the normalised resistance, 1 if sand has drained under the load)"
    ]


def _feels_loads(section: Section, boring: Boring) -> bool:
    stresses = [overburden(section, boring.x, z) for z in boring.depths if not outside(section, boring.x, z)]
    return any(max(stress.loads) > REPORTED_LOAD_SHARE * stress.total for stress in stresses)


def _outside(section: Section, boring: Boring) -> list[str]:
    messages = {outside(section, boring.x, depth): None for depth in boring.depths}
    return [f"triggering, boring {boring.name}: {text}" for text in messages if text]


def point_of(sample: Sample | Cone, where: Overburden) -> BlowCount | ConeTest:
    """Return the input of a method on a test; a blow count without fines counts as clean sand, which is on the safe
    side."""
    if isinstance(sample, Cone):
        return ConeTest(
            sample.depth, sample.qc / KPA, sample.fs / KPA, where.total / KPA, where.effective / KPA, sample.fines
        )
    return BlowCount(
        sample.depth,
        sample.N,
        where.total / KPA,
        where.effective / KPA,
        sample.fines or 0.0,
        None if sample.d50 is None else 1000.0 * sample.d50,
        sample.plasticity,
        sample.energy_ratio,
    )


def normalised_counts(test: TestResult, settings: TriggeringSettings) -> tuple[float, float]:
    """Return (N1)60 and (N1)60cs of a test, for residual strength and strain.

    Parameters
    ----------
    test : test below the ground
    settings : energy ratio of the hammer where the test has none, and length of the rods above the ground

    Returns
    -------
    Both blow counts (per 30 cm) by Idriss & Boulanger (2008); for a cone test, those of sand of the same relative
    density.
    """
    point = point_of(test.sample, test.overburden)
    if isinstance(point, ConeTest):
        resistance, clean = boulanger_idriss.normalised(point)
        return boulanger_idriss.equivalent_count(resistance), boulanger_idriss.equivalent_count(clean)
    return idriss_boulanger.normalised(point, point.energy_ratio or settings.energy_ratio, settings.rods_above)


def fines_of(test: TestResult) -> float:
    """Return the fines content (%) of the tested soil: measured; else from the index of a cone, or 0 of a blow
    count, which is on the safe side."""
    point = point_of(test.sample, test.overburden)
    if isinstance(point, ConeTest):
        return boulanger_idriss.fines_of(point.index) if point.fines is None else point.fines
    return point.fines


def _ranges_of_tests(section: Section, boring: Boring, depths: list[float]) -> list[tuple[float, float, Overburden]]:
    """Return the range of depth that each test represents: half-way to the neighbouring tests, not beyond its stratum
    or the water table.
    """
    levels = section.layering.interfaces(np.array([boring.x]))[0]
    depth_of = levels[0] - levels
    stresses = [overburden(section, boring.x, depth) for depth in depths]
    pieces = []
    for number, (depth, where) in enumerate(zip(depths, stresses, strict=True)):
        top, bottom = float(depth_of[where.stratum]), float(depth_of[where.stratum + 1])
        water = water_level(section, boring.x, where.stratum)
        if where.below_water and water is not None:
            top = max(top, float(levels[0]) - water)
        if number > 0 and stresses[number - 1].stratum == where.stratum:
            top = max(top, 0.5 * (depths[number - 1] + depth))
        if number + 1 < len(depths) and stresses[number + 1].stratum == where.stratum:
            bottom = min(bottom, 0.5 * (depth + depths[number + 1]))
        pieces.append((top, bottom, where))
    return pieces


def judged_in_stratum(names: Sequence[str], number: int, tests: Sequence[TestResult]) -> list[TestResult]:
    """Return the tests in a stratum. If the stratum has no tests, return the tests in other parts of the same soil on
    the same side of the water table.

    ``names`` are the names of all strata, ``number`` is the index of the stratum.
    """
    tests_in_stratum = [test for test in tests if test.overburden.stratum == number]
    return tests_in_stratum or [
        test for test in tests if soil_of(names[test.overburden.stratum]) == soil_of(names[number])
    ]


def _of_stratum(section: Section, number: int, tests: list[TestResult], wanted: float) -> StratumResult:
    tests_in_stratum = judged_in_stratum([stratum.name for stratum in section.strata], number, tests)
    share = (
        sum(test.area for test in tests_in_stratum if test.liquefies) / sum(test.area for test in tests_in_stratum)
        if tests_in_stratum
        else None
    )
    factors = [test.factor for test in tests_in_stratum if test.factor is not None]
    enough = share is not None and share >= wanted
    reasons = reasons_in_one(test.reason for test in tests_in_stratum if test.reason)
    if section.strata[number].name.endswith(BELOW_WATER) and len(reasons) > 1:
        reasons = [why for why in reasons if why != ABOVE_WATER]  # of a test at the very level of the water
    if any("plasticity index" in why for why in reasons if why != CLAY):
        reasons = [why for why in reasons if why != CLAY]  # of a test whose plasticity was not measured in this clay
    reason = "; ".join(reasons)
    if not tests_in_stratum:
        reason = "no test lies in it" if reaches_water(section, number) else ABOVE_WATER
    return StratumResult(
        section.strata[number].name,
        len(tests_in_stratum),
        len(factors),
        share,
        min(factors, default=None),
        enough,
        reason,
    )


def _stretches(section: Section, x: list[float]) -> dict[float, float]:
    """Return for every boring, by its x, the length (m) of the stretch of the section for which this boring is the
    nearest one."""
    left, right = section.given_extent
    limits = [left, *(0.5 * (a + b) for a, b in pairwise(x)), right]
    return {place: max(limits[k + 1] - limits[k], 1e-9) for k, place in enumerate(x)}
