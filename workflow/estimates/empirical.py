"""Estimates the displacement by empirical relations from earthquake, blow counts or the overlying layer, each within
its range of validity."""

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from meshes.borings.boring import Sample
from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.stratum import cases_of
from workflow.config.tables import Tables
from workflow.earthquake.attenuation import PeakMotion
from workflow.earthquake.column import MAKDISI, column_of
from workflow.earthquake.triggering.assessment import TestResult, assess, normalised_counts
from workflow.earthquake.triggering.consequences import mean_of_tests
from workflow.estimates import truss
from workflow.estimates.estimate import LEAST_GRADIENT, Estimate, depth_below_ground, flow_words, mean_inclination
from workflow.estimates.lateral_spread import (
    LOOSE_BLOW_COUNT,
    YOUD,
    ZHANG,
    Spreading,
    displacement_index,
    maximum_shear_strain,
    why_not_youd,
    youd,
    zhang,
    zhang_free_face,
)
from workflow.estimates.sliding_block import newmark

BRAY_TRAVASAROU = "J. D. Bray, T. Travasarou, J. Geotech. Geoenviron. Eng. 133 (2007) 381-392"
BRAY_MACEDO = "J. D. Bray, J. Macedo, J. Geotech. Geoenviron. Eng. 145 (2019) 04019106"
CM = 0.01  # m
# Seismic coefficients and magnitudes for which both were fitted.
COEFFICIENTS, MAGNITUDES_2007, MAGNITUDES_2019 = (0.01, 0.5), (5.5, 7.6), (5.5, 7.9)
SPREAD_2007, SPREAD_2019 = 0.66, 0.72  # standard deviation of the natural logarithm


def bray_travasarou(kc: float, peak: float, magnitude: float) -> float:
    """Return the median displacement (m) of a rigid mass by Bray & Travasarou (2007), Eq. 5 with a period of 0.

    ln D = -0.22 - 2.83 ln ky - 0.333 (ln ky)² + 0.566 ln ky ln a + 3.04 ln a - 0.244 (ln a)² + 0.278 (M - 7), D in cm,
    ``peak`` a over g.
    """
    k, a = math.log(kc), math.log(peak)
    value = -0.22 - 2.83 * k - 0.333 * k**2 + 0.566 * k * a + 3.04 * a - 0.244 * a**2 + 0.278 * (magnitude - 7.0)
    return CM * math.exp(value)


def bray_macedo(kc: float, peak: float, magnitude: float) -> float:
    """Return the median displacement (m) of a rigid mass under ordinary motions of shallow crustal earthquakes by Bray
    & Macedo (2019).

    ln D = -4.684 - 2.482 ln ky - 0.244 (ln ky)² + 0.344 ln ky ln a + 2.649 ln a - 0.090 (ln a)² + 0.603 M, D in cm,
    if it is not zero.
    """
    k, a = math.log(kc), math.log(peak)
    value = -4.684 - 2.482 * k - 0.244 * k**2 + 0.344 * k * a + 2.649 * a - 0.090 * a**2 + 0.603 * magnitude
    return CM * math.exp(value)


BLOCK = "a rigid mass on a slip surface of constant strength; no liquefaction"
YOUD_TITLE, ZHANG_TITLE = "Youd, Hansen & Bartlett (2002)", "Zhang, Robertson & Brachman (2004)"
YOUD_RANGE = (
    "M 6-8, slopes of 0.1-6 % or free faces of W = 1-20 %, 1-15 m with (N1)60 below 15, fines up to 50 %, "
    "D50 0.1-1 mm; accurate within a factor of 2"
)
ZHANG_RANGE = (
    "gently sloping ground of 0.2-3.5 %, or places at a distance L of 4-40 times the height H of a free face; strains "
    "down to 23 m of depth count; accurate within a factor of 2"
)


def empirical(section: Section, settings: Tables, kc: float | None, slip_surface: np.ndarray) -> Iterator[Estimate]:
    """Return the estimates of all relations for which the input has data. The displacement is None outside the range of
    a relation. ``slip_surface`` (n, 2) in m is the slip surface by the finite elements; it may be empty. ``section``:
    the section of the ground; ``settings``: settings of all tables; ``kc``: critical Kh, None without one.
    """
    try:
        motion = settings.earthquake.motion()
    except InputError:
        motion = None
    if motion is not None and settings.earthquake.magnitude is not None and kc is not None and kc > 0.0:
        yield from _blocks(kc, flow_words(section, settings.fem.flow), motion, settings.earthquake.magnitude)
    if settings.site_response.record and kc is not None and kc > 0.0:
        yield from _block_under_average(section, settings, kc, slip_surface)
    if settings.triggering.borings:
        try:
            tests = assess(section, settings.earthquake, settings.triggering).tests
        except InputError:
            tests = ()
        if tests:
            yield from _spreading(section, settings, tests)
    elif settings.earthquake.magnitude is not None:
        for title, source, validity in ((YOUD_TITLE, YOUD, YOUD_RANGE), (ZHANG_TITLE, ZHANG, ZHANG_RANGE)):
            yield Estimate("spread", title, None, "not computed: there are no borings", source, validity)
    for case in cases_of(section.strata)[:1]:
        bar = truss.truss_of(section, case)
        if bar is not None and 100.0 * math.tan(bar.inclination) >= LEAST_GRADIENT:
            words = (
                f"L = {bar.length:.0f} m, {math.degrees(bar.inclination):.1f}°, E/(1 - ν²) = {bar.modulus / 1e6:.3g} "
                f"MPa, {bar.density:.0f} kg/m³: displacement of the free end"
            )
            yield Estimate("truss", "Towhata's truss", bar.end, words, truss.SOURCE, truss.VALIDITY)


def _blocks(kc: float, resisting: str, motion: PeakMotion, magnitude: float) -> Iterator[Estimate]:
    """Yield the estimates by Bray & Travasarou (2007) and Bray & Macedo (2019) for a rigid mass (fundamental period 0).

    ``resisting`` names the flow rule of ``kc``.
    """
    peak = motion.median / GRAVITY
    for title, find, spread, magnitudes, source in (
        ("Bray & Travasarou (2007)", bray_travasarou, SPREAD_2007, MAGNITUDES_2007, BRAY_TRAVASAROU),
        ("Bray & Macedo (2019)", bray_macedo, SPREAD_2019, MAGNITUDES_2019, BRAY_MACEDO),
    ):
        validity = f"{BLOCK}; ky {COEFFICIENTS[0]:g}-{COEFFICIENTS[1]:g}, M {magnitudes[0]:g}-{magnitudes[1]:g}"
        outside = _outside(("ky", kc, COEFFICIENTS), ("M", magnitude, magnitudes))
        slide = None if outside else find(kc, peak, magnitude)
        words = f"kc = {kc:.3f} {resisting}, peak {peak:.3g} g, M {magnitude:g}: "
        if slide is None:
            words += f"outside its range: {outside}"
        else:
            factor = math.exp(spread)
            words += f"{slide / factor:.2g} to {slide * factor:.2g} m within one standard deviation"
        yield Estimate("block regression", title, slide, words, source, validity)


def _block_under_average(section: Section, settings: Tables, kc: float, slip_surface: np.ndarray) -> Iterator[Estimate]:
    """Yield the slide of the block under the average acceleration of the mass above the slip surface (Makdisi & Seed
    1978)."""
    try:
        column = column_of(section, settings.site_response)
    except InputError:
        return
    depth = settings.site_response.slip_depth
    if depth is None:
        depth = _depth_of(slip_surface, section, column.x)
    if depth is None:
        return
    average = column.average_above(depth)
    time = column.step * np.arange(len(average))
    slides = [newmark(time, sign * average, kc).permanent for sign in (1.0, -1.0)]
    flow = flow_words(section, settings.fem.flow)
    words = (
        f"{column.record} through the layers at x = {column.x:g} m: k_max = {column.k_max(depth):.3f} "
        f"above {depth:.3g} m, resisted by kc = {kc:.3f} {flow}; {slides[0]:.2g} and {slides[1]:.2g} m either way"
    )
    validity = f"{BLOCK}; one-dimensional, equivalent linear site response"
    yield Estimate("block", "rigid block under the average acceleration", sum(slides) / 2.0, words, MAKDISI, validity)


def _depth_of(slip_surface: np.ndarray, section: Section, x: float) -> float | None:
    """Return the depth (m) of a slip surface below the ground at x, or its largest depth if it does not reach x."""
    if not len(slip_surface):
        return None
    depths = depth_below_ground(section, slip_surface)
    passes = slip_surface[0, 0] <= x <= slip_surface[-1, 0]
    depth = float(np.interp(x, slip_surface[:, 0], depths)) if passes else float(depths.max())
    return depth if depth > 0.0 else None


def _outside(*values: tuple[str, float, tuple[float, float]]) -> str:
    messages = [f"{name} = {value:.3g} is not within {low:g}-{high:g}" for name, value, (low, high) in values
            if not low <= value <= high]  # fmt: skip
    return "; ".join(messages)


def _spreading(section: Section, settings: Tables, tests: Sequence[TestResult]) -> Iterator[Estimate]:
    yield _zhang(section, settings, tests)
    distance, magnitude = settings.earthquake.distance, settings.earthquake.magnitude
    if magnitude is None or distance is None:
        return
    loose = [
        test
        for test in tests
        if test.outcome is not None and normalised_counts(test, settings.triggering)[0] < LOOSE_BLOW_COUNT
    ]
    known = [(test, test.sample) for test in loose if isinstance(test.sample, Sample)]
    known = [(test, soil) for test, soil in known if soil.fines is not None and soil.d50 is not None]
    if not known:
        words = "not computed: no blow count below 15 has both fines and D50"
        yield Estimate("spread", YOUD_TITLE, None, words, YOUD, YOUD_RANGE)
        return
    site = Spreading(
        magnitude,
        distance / 1000.0,
        _slope(section, settings),
        _mean_of_borings(tests, lambda tests_of_boring: sum(t.bottom - t.top for t in tests_of_boring if t in loose)),
        mean_of_tests([test for test, _ in known], [float(soil.fines or 0.0) for _, soil in known]),
        mean_of_tests([test for test, _ in known], [1000.0 * float(soil.d50 or 0.0) for _, soil in known]),
        bool(settings.free_face),
    )
    outside = why_not_youd(site)
    words = (
        f"M {magnitude:g}, R = {site.distance:g} km, {'W' if site.free_face else 'S'} = {site.slope:.3g} %, "
        f"T15 = {site.thickness:.1f} m, F15 = {site.fines:.0f} %, D50 = {site.d50:.2g} mm"
    )
    if settings.earthquake.contradiction():
        words += "; with the distance as given, which contradicts the peak acceleration that other methods take"
    words += f": outside its range: {outside}" if outside else ""
    yield Estimate("spread", YOUD_TITLE, None if outside else youd(site), words, YOUD, YOUD_RANGE)


def _slope(section: Section, settings: Tables) -> float:
    """Return W = 100 H/L (%) if there is a free face, else the mean slope of the ground (%)."""
    if settings.free_face:
        distance, height = settings.free_face.distance_and_height(section.ground)
        return 100.0 * height / distance
    return 100.0 * math.tan(mean_inclination(section))


def _zhang(section: Section, settings: Tables, tests: Sequence[TestResult]) -> Estimate:
    def index(tests_of_boring: Sequence[TestResult]) -> float:
        return displacement_index(
            [
                (t.top, t.bottom, maximum_shear_strain(t.factor, normalised_counts(t, settings.triggering)[1]))
                for t in tests_of_boring
                if t.factor is not None
            ]
        )

    ldi = _mean_of_borings(tests, index)
    words = f"LDI = {ldi:.2f} m, the mean of the borings, "
    if settings.free_face:
        distance, height = settings.free_face.distance_and_height(section.ground)
        words += f"{distance:.1f} m from the foot of a bank of {height:.1f} m"
        outside, slide = _outside(("L/H", distance / height, (4.0, 40.0))), zhang_free_face(ldi, distance, height)
    else:
        slope = _slope(section, settings)
        words += f"S = {slope:.2f} %"
        outside, slide = _outside(("slope (%)", slope, (0.2, 3.5))), zhang(ldi, slope)
    words += f": outside its range: {outside}" if outside else ""
    return Estimate("spread", ZHANG_TITLE, None if outside else slide, words, ZHANG, ZHANG_RANGE)


def _mean_of_borings(tests: Sequence[TestResult], of_one: Callable[[Sequence[TestResult]], float]) -> float:
    """Return a mean over the borings, weighted by the length of the section that is nearest to each boring."""
    borings: dict[str, list[TestResult]] = {}
    for test in tests:
        borings.setdefault(test.boring, []).append(test)
    lengths = [tests_of_boring[0].length for tests_of_boring in borings.values()]
    return sum(
        length * of_one(tests_of_boring) for length, tests_of_boring in zip(lengths, borings.values(), strict=True)
    ) / sum(lengths)
