"""Makes the table of critical Kh and factors of safety by all methods: one row each, with its conditions."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fem.continuum.shallow_failure import merged_faces, shallow_failures
from fem.continuum.strength import Flow, strength_of
from meshes.section.section import Section
from workflow.estimates.estimate import depth_below_ground
from workflow.estimates.slip_circles import least_balance
from workflow.estimates.structures import structures_of
from workflow.report.circles import longer_circle
from workflow.report.first_page import SIDES
from workflow.report.flow_rule import FLOW
from workflow.report.numbers import coefficient, lower_limit, number, rough_coefficient
from workflow.report.slices import KH_DIGITS
from workflow.results.accuracy import exceeds, falls_below, strict_factor, strict_kh
from workflow.results.bounds import SafetyPart
from workflow.results.continuum import FailureAnswer, FemAnswer, OtherCriticalKh
from workflow.results.governing import is_limited_by_kh
from workflow.results.results import Results
from workflow.results.slices import CirclePart
from workflow.texts.report_texts import Texts


@dataclass(frozen=True)
class StabilityRow:
    """Holds a row of the table: quantity, value, interval, and conditions."""

    quantity: str
    value: str
    interval: str
    conditions: str


def stability_rows(results: Results, _: Texts) -> list[StabilityRow]:
    """Return the rows of the table, those of one method after the other."""
    return [*_elements(results, _), *_bounds(results, _), *_slices(results, _), *_discs(results, _)]


def _elements(results: Results, _: Texts) -> Iterator[StabilityRow]:
    fem, name = results.fem, _("critical Kh, finite elements")
    if results.failure is not None:
        yield from _of_failure(results.failure, _)
    if fem is None:
        return
    sides = _(SIDES[fem.settings.sides])
    if results.kc is not None:
        most = _("at most {kc} on this mesh", kc=coefficient(fem.kc_upper)) if _more(fem.kc_upper, fem.kc) else ""
        above = _bound_words(fem.kc, strict_kh(results, fem, fem.flow, fem.direction), _)
        yield StabilityRow(name, coefficient(fem.kc), most, f"{sides}, {_(FLOW[fem.flow])}{above}")
    others: tuple[tuple[OtherCriticalKh | None, Flow], ...] = ((fem.davis, "davis"), (fem.associated, "associated"))
    for other, flow in others:
        if other is not None and other.verdict in ("plateau", "peak"):
            above = _bound_words(other.kc, strict_kh(results, fem, flow, other.direction), _)
            value = coefficient(other.kc) if other.kc > 0.0 else "< 0"  # it fails under its own weight
            yield StabilityRow(name, value, "", f"{sides}, {_(FLOW[flow])}{above}")
    third = fem.own_dilation
    if third is not None and third.kc is not None:
        interval = _("{low} to {high}", low=number(third.low, 3), high=number(third.high, 3))
        angles = _("the given ψ") if any(fem.dilation_deg.values()) else _("ψ = 0")
        how = _("{angles}; depends on element and mesh by 5 to 15 %", angles=angles)
        about = _("about {kc}", kc=coefficient(third.kc))
        yield StabilityRow(name, about, interval, f"{sides}, {how}")
    other = fem.opposite
    if other is not None:
        value = f"> {coefficient(other.kc)}" if other.verdict == "no failure" else coefficient(other.kc)
        value = _("about {kc}", kc=rough_coefficient(other.kc)) if fem.is_rough(other) else value
        side_words = _("; the failing ground reaches the side of the section") if other.at_sides else ""
        if structures_of(results.config.section):
            force = _("seismic force to the {side}", side=_("left" if fem.towards == "right" else "right"))
        else:
            force = _("seismic force upslope") if other.direction == "uphill" else _("seismic force downslope")
        above = _bound_words(other.kc, strict_kh(results, fem, fem.flow, other.direction), _)
        yield StabilityRow(name, value, "", force + side_words + above)
    for shallow_failure in fem.shallow_failures:
        if shallow_failure.is_edge(fem.settings.least_depth):
            continue
        face_words = _("shallow failure of the face from x = {start} to {end} m",
                  start=f"{shallow_failure.start_x_m:g}", end=f"{shallow_failure.end_x_m:g}")  # fmt: skip
        yield StabilityRow(name, coefficient(max(shallow_failure.kh, 0.0)), "", f"{face_words}, {_(FLOW[fem.flow])}")
    yield from _shallow_by_davis(results, fem, name, _)
    yield from _factors(results, fem, _)


def _of_failure(failure: FailureAnswer, _: Texts) -> Iterator[StabilityRow]:
    """Yield the factors of safety of ground that fails without a seismic force."""
    of = _("factor of safety at Kh = {kh}, finite elements", kh="0")
    yield StabilityRow(of, f"{failure.factor:.2f}", "", _(FLOW[failure.flow]))
    for factor, flow in ((failure.davis, "davis"), (failure.associated, "associated")):
        if factor is not None:
            yield StabilityRow(of, f"{factor:.2f}", "", _(FLOW[flow]))


def _factors(results: Results, fem: FemAnswer, _: Texts) -> Iterator[StabilityRow]:
    """Yield the factors of safety by finite elements, by the flow rule of the analysis and by the other one."""
    for factor in fem.factors:
        of = _("factor of safety at Kh = {kh}, finite elements", kh=f"{factor.kh:g}")
        if factor.after_shaking:
            of = _("factor of safety after shaking, finite elements")
        value = f"> {lower_limit(factor.factor)}" if factor.verdict == "no failure" else f"{factor.factor:.2f}"
        strict = strict_factor(results, fem, factor, fem.flow)
        above = _factor_bound_words(factor.factor, strict, _)
        if is_limited_by_kh(results, factor) and exceeds(factor.factor, 1.0):
            above = _("; above 1.00, which the strict upper bound of the critical Kh excludes, and which counts")
        yield StabilityRow(of, value, "", _(FLOW[fem.flow]) + above)
        if factor.davis is not None:
            yield StabilityRow(of, f"{factor.davis:.2f}", "", _(FLOW["davis"]))
        elif factor.associated is not None:
            above = _factor_bound_words(factor.associated, strict_factor(results, fem, factor, "associated"), _)
            yield StabilityRow(of, f"{factor.associated:.2f}", "", _(FLOW["associated"]) + above)


def _bound_words(kc: float, strict: tuple[float | None, float | None] | None, _: Texts) -> str:
    """Return, for the conditions of a critical Kh by finite elements, that it lies beyond a strict bound, which counts;
    empty otherwise."""
    return "" if strict is None else _beyond(kc, *strict, 3, _)


def _factor_bound_words(factor: float, strict: SafetyPart | None, _: Texts) -> str:
    """Return, for the conditions of a factor of safety by finite elements, that it lies beyond a strict bound, which
    counts; empty otherwise."""
    return "" if strict is None else _beyond(factor, strict.lower, strict.upper, 2, _)


def _beyond(value: float, lower: float | None, upper: float | None, digits: int, _: Texts) -> str:
    if upper is not None and exceeds(value, upper):
        return _("; above the strict upper bound of {upper}, which counts", upper=number(upper, digits))
    if lower is not None and falls_below(value, lower):
        return _("; below the strict lower bound of {lower}, which counts", lower=number(lower, digits))
    return ""


def _shallow_by_davis(results: Results, fem: FemAnswer, name: str, _: Texts) -> Iterator[StabilityRow]:
    """Yield the shallow failures of cohesionless faces with Davis's reduced strength, in closed form, if they come
    before the failure of the slope."""
    section, settings = results.config.section, fem.settings.changed(direction=fem.direction)
    if fem.davis is None:
        return
    for face in merged_faces(shallow_failures(section, settings, strength_of(section.strata, "davis").friction)):
        if face.kh >= fem.davis.kc or face.end - face.start < settings.least_depth:
            continue
        ends = {"start": f"{face.start:g}", "end": f"{face.end:g}"}
        face_words = _("shallow failure of the face from x = {start} to {end} m", **ends)
        yield StabilityRow(name, coefficient(max(face.kh, 0.0)), "", f"{face_words}, {_(FLOW['davis'])}")


def _bounds(results: Results, _: Texts) -> Iterator[StabilityRow]:
    bounds = results.bounds
    if bounds is None:
        return
    interval = _("{low} to {high}", low=number(bounds.lower, 3), high=number(bounds.upper, 3))
    conditions = f"{_(SIDES[bounds.sides])}, {_(FLOW['associated'])}"
    if bounds.strengthened:
        conditions += _("; failures deeper than {depth} m", depth=f"{bounds.least_depth:g}")
    yield StabilityRow(_("critical Kh, strict bounds"), "", interval, conditions)
    if (davis := bounds.substitute) is not None:
        interval = _("{low} to {high}", low=number(davis.lower, 3), high=number(davis.upper, 3))
        of_davis = conditions.replace(_(FLOW["associated"]), _(FLOW["davis"]))
        yield StabilityRow(_("critical Kh, strict bounds"), "", interval, of_davis)
    for factor in bounds.factors:
        interval = _("{low} to {high}", low=number(factor.lower, 2), high=number(factor.upper, 2))
        of = _("factor of safety at Kh = {kh}, strict bounds", kh=f"{factor.kh:g}")
        if factor.after_shaking:
            of = _("factor of safety after shaking, strict bounds")
        yield StabilityRow(of, "", interval, conditions)


def _slices(results: Results, _: Texts) -> Iterator[StabilityRow]:
    if results.slices is None:
        return
    section = results.config.section
    for group in results.slices.factors:
        of = _("factor of safety at Kh = {kh}, slip circles", kh=f"{group.kh:g}")
        yield from (_circle(of, circle, section, 2, _) for circle in group.circles)
    circles_after = results.slices.after_shaking
    for circle in circles_after.circles if circles_after is not None else ():
        yield _circle(_("factor of safety after shaking, slip circles"), circle, section, 2, _)
    for circle in results.slices.critical:
        row = _circle(_("critical Kh, slip circles"), circle, section, KH_DIGITS, _)
        if (longer := longer_circle(circle, results.slices.critical)) is not None:
            words = _("; {value} in a longer section", value=coefficient(longer.bishop))
            row = replace(row, conditions=row.conditions + words)
        yield row
    for factor in results.fem.safety_factors if results.fem is not None else ():
        surface, vertical = np.array(factor.slip_surface), results.config.fem.vertical
        if (spencer := least_balance(section, surface, factor.kh, vertical)) is not None:
            of = _("factor of safety at Kh = {kh}, Spencer", kh=f"{factor.kh:g}")
            yield StabilityRow(of, f"{spencer:.2f}", "", _("slip surface of the finite elements"))


def _circle(of: str, circle: CirclePart, section: Section, digits: int, _: Texts) -> StabilityRow:
    depth = float(depth_below_ground(section, np.array(circle.surface_m)).max())
    conditions = _("Bishop, towards the {side}, {depth} m deep", side=_(circle.towards), depth=f"{depth:.1f}")
    if circle.spencer is not None:
        conditions += _("; by Spencer {value}", value=f"{circle.spencer:.{digits}f}")
    elif circle.frictionless:
        conditions += _("; without friction it follows from moments alone (no balance of forces by Spencer)")
    else:
        conditions += _("; no balance by Spencer")
    if circle.strengthened:
        conditions += _(
            "; the cohesionless face has a cohesion added, because without cohesion it fails at a smaller Kh"
        ) if digits == KH_DIGITS else _(
            "; the cohesionless face has a cohesion added, because without cohesion it fails at a smaller factor of "
            "safety"
        )  # fmt: skip
    return StabilityRow(of, f"{circle.bishop:.{digits}f}", "", conditions)


def _discs(results: Results, _: Texts) -> Iterator[StabilityRow]:
    """Yield the rows of the discs and of the FEM model with the boundary conditions of the discs."""
    counterpart, calibration, discs = results.dem_counterpart, results.calibration, results.dem
    if counterpart is not None:
        most = (
            _("up to {kc}", kc=coefficient(counterpart.kc_upper)) if _more(counterpart.kc_upper, counterpart.kc) else ""
        )
        conditions = _(
            "boundary conditions of the disc box: {terms}",
            terms=f"{_(SIDES[counterpart.sides])}, {_(FLOW[counterpart.flow])}",
        )
        yield StabilityRow(
            _("critical Kh, finite elements with the boundary conditions of the discs"),
            coefficient(counterpart.kc),
            most,
            conditions,
        )
    compared = _("compare with the row above, not with the first row") if counterpart is not None else ""
    if calibration is not None and calibration.predicted_kc is not None:
        yield StabilityRow(_("critical Kh, discs, uncalibrated"), coefficient(calibration.predicted_kc), "", compared)
        compared = ""
    if discs is not None and discs.after.kc is not None:
        interval = ""
        if discs.after.kc_upper is not None:
            interval = _(
                "{low} to {high}", low=coefficient(discs.after.kc_lower), high=coefficient(discs.after.kc_upper)
            )
        if calibration is not None and calibration.verdict == "calibrated":
            factor = _(
                "factor {value} on {what}", value=f"{calibration.value:.3g}", what=_parameter(calibration.parameter, _)
            )
            compared = f"{factor}; {compared}" if compared else factor
        name = _("critical Kh, discs, calibrated")
        if calibration is not None and calibration.verdict == "out of reach":
            name = _("critical Kh, discs, the nearest that calibration reaches")
        yield StabilityRow(name, coefficient(discs.after.kc), interval, compared)


def _parameter(name: str, _: Texts) -> str:
    return {"all": _("all contact constants"), "strength": _("contact strength")}.get(name, name.replace("_", " "))


def _more(value: float, than: float) -> bool:
    return coefficient(value) != coefficient(than)
