"""Computes the answers of the program for a published slope: finite elements with ψ = φ and with Davis's estimate, and
strict bounds."""

import math
import time
from collections.abc import Collection
from dataclasses import replace
from typing import Any, Literal

from docs.verify.case import Case
from docs.verify.record import PARTS, Answer, Part
from fem.continuum.strength import is_associated, is_dilating_fully
from fem.limit.bounds import kh_bounds
from fem.limit.safety_bounds import safety_bounds
from fem.search.adaptive import AdaptiveSearch
from fem.search.critical import CriticalResult, critical_coefficient
from fem.search.strength_reduction import SafetyFactor, safety_factor
from fem.settings import BoundsSettings, FemSettings
from meshes.errors import InputError, NoAnswerError
from meshes.gmsh_model import generate
from meshes.quad_mesh import BadMeshError, QuadMesh

# Gap and largest number of triangles of the bounds; largest number of cells of the finite elements, unless a file says.
BOUNDS, MOST_CELLS = BoundsSettings(gap=0.02, max_cells=10_000), 2500


def answer(
    case: Case, parts: Collection[Part] = PARTS, known: Answer | None = None, bounds: BoundsSettings = BOUNDS
) -> Answer:
    """Compute some parts of the answer, and keep the parts of an earlier answer.

    Parameters
    ----------
    case : the published slope
    parts : parts of the answer to compute
    known : earlier answer, whose other parts are kept
    bounds : settings of the bounds

    Returns
    -------
    The answer; its ``failures`` have the reasons of missing parts.
    """
    result = known or Answer(case.name)
    failures = tuple(text for text in result.failures if text.split(":")[0] not in parts)
    result = replace(result, failures=failures)
    for part in sorted(parts, key=lambda part: part == "bounds"):  # the bounds start from the factor of the elements
        started = time.process_time()
        try:
            numbers = _bounds(case, result, bounds) if part == "bounds" else _elements(case, part, result)
        except (NoAnswerError, InputError, BadMeshError) as error:
            numbers = dict.fromkeys(_fields(part))
            result = replace(result, failures=(*result.failures, f"{part}: {error}"))
        numbers[f"{part}_seconds"] = round(time.process_time() - started, 1)
        result = replace(result, **numbers)
    return result


def _fields(part: Part) -> tuple[str, ...]:
    return ("lower", "upper", "shallow_failure") if part == "bounds" else (part, f"{part}_upper")


def _bounds(case: Case, known: Answer, settings: BoundsSettings) -> dict[str, Any]:
    if case.published.expected == "kc":
        bounds = kh_bounds(case.section, case.fem, settings)
        shallow = min((face.kh for face in bounds.shallow_failures), default=None)
        lower, upper = bounds.stress and bounds.lower, bounds.mechanism and bounds.upper
        return {"lower": lower, "upper": upper, "shallow_failure": shallow}
    guess = known.associated or case.published.values[0].ends[0]
    factor = safety_bounds(case.section, case.fem, settings, case.published.kh, guess)
    upper = factor.upper if factor.upper < math.inf else None
    return {"lower": factor.lower or None, "upper": upper, "shallow_failure": factor.shallow_failure}


def _elements(case: Case, part: Part, known: Answer) -> dict[str, Any]:
    if part == "davis" and known.associated is not None and is_dilating_fully(case.section.strata):
        return {"davis": known.associated, "davis_upper": known.associated_upper}
    flow: Literal["associated", "davis"] = "associated" if part == "associated" else "davis"
    most = case.fem.max_cells if "max_cells" in case.fem.model_fields_set else MOST_CELLS
    settings = case.fem.changed(flow=flow, kh=(), max_cells=most)
    mesh = generate(case.section, case.mesh)
    result = _adapted(case, mesh, settings)
    if result is not None:
        return {part: result, f"{part}_upper": result}
    if case.published.expected == "kc":
        path: CriticalResult | SafetyFactor = critical_coefficient(case.section, mesh, settings)
    else:
        path = safety_factor(case.section, mesh, settings, case.published.kh)
    return {part: path.value, f"{part}_upper": path.upper}


def _adapted(case: Case, mesh: QuadMesh, wish: FemSettings) -> float | None:
    """Return the result on adapted meshes, as `noshiro fem` computes it. Return None if the flow is not associated or
    the solver finds no answer, so that an equilibrium path has to be followed."""
    if not is_associated(case.section.strata, wish.flow):
        return None
    try:
        if case.published.expected == "kc":
            return AdaptiveSearch(case.section, case.mesh, mesh).critical(wish).result.kc
        kh = case.published.kh
        return AdaptiveSearch(case.section, case.mesh, mesh).safety(wish, kh).result.factor
    except NoAnswerError:
        return None
