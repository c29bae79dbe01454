"""States why ground fails without a seismic force: with its factors of safety, and the place where it slips."""

from collections.abc import Callable

import numpy as np

from fem.continuum.loads import excess_pressure_advice
from fem.continuum.strength import davis_words, is_dilating_fully
from fem.errors import FailureAtRest, UnstableError
from fem.limit_load.conic_safety_factor import LARGEST_FACTOR
from fem.search.mesh_sequence import AdaptiveResult
from fem.search.slip_surface import slip_surface
from fem.search.strength_reduction import SafetyFactor
from fem.settings import FemSettings, FlowSetting
from meshes.section.section import Section
from meshes.section.stratum import Stratum
from meshes.slip_line import extent_in_words

Factor = AdaptiveResult[SafetyFactor]


def with_factors(
    section: Section,
    settings: FemSettings,
    error: UnstableError,
    factor: Factor,
    after_shaking: float | None,
    full: Callable[[], float],
) -> UnstableError:
    """Return an ``error`` with the factor of safety in its message, by both flow rules if ψ < φ, and the place where
    the ground slips.

    Parameters
    ----------
    section : the section of the ground
    settings : settings of the finite elements
    error : the error of the search for Kh
    factor : factor of safety before shaking
    after_shaking : factor of safety with the excess pore pressure of shaking (-); None if it is not known
    full : function that returns the factor of safety before shaking with ψ = φ (-), if the flow rule is another one
    """
    result = factor.result
    line = _slip_surface(factor) if result.factor <= 1.0 else np.empty((0, 2))
    place = f"; the ground {extent_in_words(line)}" if len(line) else ""
    message, remedy = f"{error.reason}; its factor of safety is {result.factor:.2f}", error.remedy
    if result.factor > 1.0 and section.water_pressure.rises_by_shaking:
        known = after_shaking is not None and after_shaking <= 1.0
        at = f", with a factor of safety of {after_shaking:.2f}," if known else ""
        message = (
            f"the section fails at any Kh by excess pore pressure{at} and stands without this pressure, with "
            f"a factor of safety of {result.factor:.2f}"
        )
        remedy = excess_pressure_advice(section.strata)
    elif result.factor > 1.0 and settings.sides == "free-field":  # the factor is that between held sides
        message = (
            f"{error.reason} with the K0 stress on its free-field sides, and stands with its sides held "
            f"horizontally, with a factor of safety of {result.factor:.2f}"
        )
        remedy = 'make the section longer, or take fem.sides = "smooth"'
    by_weight = result.factor < 1.0 and not section.water_pressure.rises_by_shaking

    def failure(davis: float | None = None, associated: float | None = None) -> FailureAtRest | None:
        """Return the factor of safety of ground that fails by its weight alone."""
        return FailureAtRest(result.factor, settings.flow, davis, associated, line) if by_weight else None

    if is_dilating_fully(section.strata):
        return UnstableError(message + place, remedy, failure())
    if settings.flow == "associated":
        low = ""
        if result.by_other_flow is not None:
            least = f"below {1.0 / LARGEST_FACTOR:g}" if result.by_other_flow == 0.0 else f"{result.by_other_flow:.2f}"
            low = f", and {least} {by(section.strata, 'davis')}"
        message += f" {by(section.strata, 'associated')}{low}{place}"
        return UnstableError(message, remedy, failure(davis=result.by_other_flow or None))
    of_full = result.by_other_flow if result.by_other_flow is not None else full()
    rule = f" {by(section.strata, 'davis')}" if settings.flow == "davis" else ""
    by_other_cause = result.factor > 1.0 and (section.water_pressure.rises_by_shaking or settings.sides == "free-field")
    if of_full > 1.0 and not by_other_cause:
        remedy = 'with fem.flow = "associated" the ground stands, and has a critical Kh'
    message += f"{rule}, and {of_full:.2f} {by(section.strata, 'associated')}{place}"
    return UnstableError(message, remedy, failure(associated=of_full))


def by(strata: tuple[Stratum, ...], flow: FlowSetting) -> str:
    """Return the name of a flow rule, such as "by Davis's estimate"."""
    return f"by {davis_words(s.dilation for s in strata)}" if flow == "davis" else "with ψ = φ"


def _slip_surface(weakened: Factor) -> np.ndarray:
    """Return where the ground slips with its strength divided by the factor of safety, (k, 2) in m; empty without a
    mechanism."""
    mechanism = weakened.result.mechanism
    return slip_surface(weakened.mesh, mechanism) if mechanism is not None else np.empty((0, 2))
