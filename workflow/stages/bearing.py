"""Computes the stability of ground with another strength: whether it stands without shaking, its factor of safety and
its critical Kh.
"""

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TypeVar

from fem.errors import UnstableError
from fem.settings import BoundsSettings, FemSettings
from meshes.errors import InputError, NoAnswerError
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.stability import Bearing, BearingVerdict

if TYPE_CHECKING:
    from fem.limit.directions import SmallerKhBounds
    from fem.limit.safety_bounds import SafetyBounds
    from fem.limit_load.limit_load import LimitLoadResult
    from fem.search.critical import CriticalResult
    from meshes.quad_mesh import QuadMesh

# Triangles and gap of the bounds: enough to tell standing from flowing, in seconds, as a rule; by how much finer they
# are taken where they are not.
CELLS, GAP, SECONDS = 2500, 0.08, 30.0
REFINEMENT = 2
SUPPORTED_WEIGHT_SHARE = (
    0.01  # least share of its weight that ground must carry: cohesionless sand steeper than φ carries none
)
# Settings that have no effect here, for bounds and elements have their own.
WITHOUT_EFFECT = (
    "fem.threads", "fem.safety_factor_at", "fem.accuracy", "fem.kh", "fem.max_cells", "fem.rigid_box",
    "bounds.max_cells", "bounds.gap", "bounds.seconds", "bounds.davis",
)  # fmt: skip
Result = TypeVar("Result")


def bearing_of(section: Section, config: Config, mesh: "QuadMesh", no_strength: bool = False) -> Bearing:
    """Compute factor of safety and critical Kh of a section whose strength differs from the strength in the input.

    Parameters
    ----------
    section : section whose strata have their strength after liquefaction or after large strains
    config : config of the run; the flow rule follows from its section
    mesh : initial mesh of the section
    no_strength : whether the layers have no strength at all, so that there is no factor of safety

    Returns
    -------
    The results, and notes on missing ones.
    """
    from fem.continuum.strength import flow_of

    flow = flow_of(config.section.strata, config.fem.flow)
    fem = config.fem.changed(kh=(), flow=flow, accuracy=0.0)  # the mesh of the stage, and no other
    bounds_settings = config.bounds.changed(max_cells=CELLS, gap=GAP, seconds=SECONDS, davis=False)
    notes: list[str] = []
    weight = _weight_borne(section, mesh, fem)
    critical = _critical(section, config, mesh, fem, notes) if weight >= 1.0 else None
    kc = critical.kc if critical is not None and critical.verdict in ("plateau", "peak") and critical.kc > 0.0 else None
    factor, strict = (None, None) if no_strength else _factors(section, mesh, fem, bounds_settings, notes)
    # Bounds with the sides of the settings, and why ground that stands between held sides fails with them. They come
    # first where free sides may let ground slide out: closer bounds of the factor take several times as long.
    bracket, unstable = None, ""
    if strict is not None:
        undecided = strict.lower <= 1.0 <= strict.upper < math.inf
        own_first = undecided and fem.sides == "free-field" and factor is not None and factor > 1.0
        if own_first:
            bracket, unstable = _between_own_sides(section, fem, bounds_settings, notes)
        if undecided and not unstable:
            strict = _closer(section, fem, bounds_settings, strict, notes)
        if strict.lower > 1.0 and not own_first:
            bracket, unstable = _between_own_sides(section, fem, bounds_settings, notes)
    lower = strict.lower if strict is not None and strict.lower > 0.0 else None
    upper = strict.upper if strict is not None and math.isfinite(strict.upper) else None
    notes += _on_factors(no_strength, weight, strict)
    notes += _on_bounds(fem, kc, strict, bracket)
    verdict, reason = _stands(kc, lower, upper)
    if unstable:
        verdict, reason = "flows", f"a mechanism that leaves the section at a side, which fem.sides permits: {unstable}"
        if lower is not None and lower > 1.0:
            notes.append(f"between sides held horizontally a lower bound proves a factor of safety above {lower:.2f}")
        factor = lower = upper = None
    return Bearing(
        verdict=verdict,
        reason=reason,
        kc=kc,
        direction=critical.direction if critical is not None and kc is not None else None,
        kc_lower=bracket.lower if bracket is not None and bracket.stress else None,
        kc_upper=bracket.upper if bracket is not None and bracket.mechanism else None,
        factor=factor,
        factor_lower=lower,
        factor_upper=upper,
        notes=tuple(dict.fromkeys(notes)),
    )


def _on_factors(no_strength: bool, weight: float, strict: "SafetyBounds | None") -> Iterator[str]:
    """Yield notes on missing factors of safety, and on ground that supports only a multiple of its ``weight``."""
    if no_strength:
        yield "the layers have no residual strength, so that there is no factor of safety; see slide.cases, residual"
    if weight < 1.0 and not (strict is not None and strict.upper < 1.0):  # else the factor of safety says so
        most = f", only under {100.0 * weight:.0f} % of it at most" if weight >= SUPPORTED_WEIGHT_SHARE else ""
        yield f"the finite elements find no equilibrium under the weight of the ground{most}"
    if strict is not None and strict.lower <= 0.0 and not math.isfinite(strict.upper):
        yield "strict bounds of the factor of safety: none within the allowed computing work"


def _on_bounds(
    fem: FemSettings, kc: float | None, strict: "SafetyBounds | None", bracket: "SmallerKhBounds | None"
) -> Iterator[str]:
    """Yield notes on failures above those of the bounds, and on a critical Kh above its upper bound."""
    if strict is not None and strict.shallow_failure is not None:
        yield (
            "shallow ground without cohesion, of one face or where two meet, fails at a factor of safety of "
            f"{strict.shallow_failure:.2f}; the bounds are of failures deeper than {fem.least_depth:g} m"
        )
    if kc is not None and bracket is not None and kc > bracket.upper:
        yield (
            f"the finite elements give a critical Kh of {kc:.3f}, above the strict upper bound of "
            f"{bracket.upper:.3f}: the mesh is too coarse for the weak layer, and the bounds govern"
        )


def _critical(
    section: Section, config: Config, mesh: "QuadMesh", fem: FemSettings, notes: list[str]
) -> "LimitLoadResult | CriticalResult | None":
    """Return the critical Kh by finite elements; if there is no answer, return None and add a note."""
    from fem.continuum.strength import is_associated
    from fem.search.adaptive import AdaptiveSearch
    from fem.search.critical import critical_coefficient

    if not is_associated(section.strata, fem.flow):
        return answer_or_note("finite elements", notes, lambda: critical_coefficient(section, mesh, fem))
    return answer_or_note(
        "finite elements", notes, lambda: AdaptiveSearch(section, config.mesh, mesh).critical(fem).result
    )


def _weight_borne(section: Section, mesh: "QuadMesh", fem: FemSettings) -> float:
    """Return the multiple of its weight that the ground resists by finite elements. The multiple is infinite if the
    flow is not associated, or if there is no result: a path would search for an equilibrium for minutes, and ground
    that flows has none.
    """
    from fem.continuum.strength import is_associated
    from fem.limit_load.limit_load import weight_borne

    if not is_associated(section.strata, fem.flow):
        return math.inf
    borne = answer_or_note("finite elements", [], lambda: weight_borne(section, mesh, fem))
    return math.inf if borne is None else borne


def _factors(
    section: Section, mesh: "QuadMesh", fem: FemSettings, bounds_settings: BoundsSettings, notes: list[str]
) -> "tuple[float | None, SafetyBounds | None]":
    """Return the factor of safety at Kh = 0 between held sides by finite elements, and its strict bounds. If the finite
    elements have no answer, return None and add a note."""
    from fem.limit.safety_bounds import safety_bounds
    from fem.search.strength_reduction import safety_factor

    safety = answer_or_note("finite elements", notes, lambda: safety_factor(section, mesh, fem, 0.0))
    guess = safety.factor if safety is not None else 1.0
    strict = answer_or_note(
        "strict bounds", notes, lambda: safety_bounds(section, fem, bounds_settings, 0.0, guess, smooth_sides=True)
    )
    return safety.factor if safety is not None and safety.verdict != "undecided" else None, strict


def _closer(
    section: Section, fem: FemSettings, bounds_settings: BoundsSettings, strict: "SafetyBounds", notes: list[str]
) -> "SafetyBounds":
    """Return closer bounds of a factor of safety than ``strict``, which do not decide whether the ground stands."""
    from fem.limit.safety_bounds import safety_bounds

    fine = bounds_settings.changed(max_cells=REFINEMENT * CELLS, gap=GAP / REFINEMENT)
    guess = 0.5 * (strict.lower + strict.upper)
    closer = answer_or_note(
        "finer bounds", notes, lambda: safety_bounds(section, fem, fine, 0.0, guess, smooth_sides=True)
    )
    return closer or strict


def _between_own_sides(
    section: Section, fem: FemSettings, bounds_settings: BoundsSettings, notes: list[str]
) -> "tuple[SmallerKhBounds | None, str]":
    """Return the strict bounds of the critical Kh with the sides of the section. If the ground with these sides fails
    under its weight, return the reason.
    """
    from fem.limit.bounds import kh_bounds

    try:
        return kh_bounds(section, fem, bounds_settings), ""
    except UnstableError as error:
        return None, str(error)
    except (NoAnswerError, InputError) as error:
        notes.append(_note("strict bounds of Kh", error))
        return None, ""


def answer_or_note(what: str, notes: list[str], find: Callable[[], Result]) -> Result | None:
    """Return the answer of an analysis. If the analysis has no answer, return None and add a note with the reason."""
    try:
        return find()
    except (NoAnswerError, InputError) as error:
        notes.append(_note(what, error))
        return None


def _note(what: str, error: NoAnswerError | InputError) -> str:
    """Return a note on why an analysis has no answer."""
    return f"{what}: {'; '.join(error.problems) if isinstance(error, InputError) else error}"


def _stands(kc: float | None, lower: float | None, upper: float | None) -> tuple[BearingVerdict, str]:
    """Return whether the ground stands without shaking: by strict bounds if they decide it, else by finite elements."""
    if upper is not None and upper < 1.0:
        return "flows", f"an upper bound proves a factor of safety below {upper:.2f}"
    if lower is not None and lower > 1.0:
        return "stands", f"a lower bound proves a factor of safety above {lower:.2f}"
    if kc is None:
        return "flows", "the finite elements find no equilibrium under the weight of the ground"
    return "stands", f"the finite elements find equilibrium up to Kh = {kc:.3f}"
