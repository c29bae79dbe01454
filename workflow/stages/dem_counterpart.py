"""Computes the FEM model that the DEM is calibrated to: sides of the discs, non-associated flow with the given ψ."""

import math
from typing import TYPE_CHECKING

import numpy as np

from fem.continuum.strength import is_dilating_fully
from fem.settings import YIELDED, FemSettings, Sides
from meshes.errors import NoAnswerError
from meshes.executor import Tell
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.answer import line
from workflow.results.continuum import FemAnswer, displacement_at
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.stored_mesh import stored_mesh
from workflow.run.store import Store
from workflow.stages.discs_at_rest import sides_of_discs

if TYPE_CHECKING:
    from fem.path.equilibrium_path import EquilibriumPath
    from fem.path.plateau import PathListener
    from fem.search.critical import CriticalResult

# Cells times factorisations of a path at most, a minute or so: in bare sand it may take many more.
WORK = 1.2e6


# Radii of discs down to which they cannot fail like a cohesionless face, grain by grain: two discs.
DISCS_DEEP = 4.0


class _TakesTooLongError(NoAnswerError):
    """The equilibrium path takes more work than ``WORK``."""


def dem_counterpart_piece(config: Config, store: Store, tell: Tell) -> None:
    """Write the answer of the FEM counterpart to the folder, unless an interrupted run has written it."""
    if not store.has(DemCounterpart.FILE):
        find_dem_counterpart(config, store, tell).write(store)


def find_dem_counterpart(config: Config, store: Store, tell: Tell) -> DemCounterpart:
    """Return the path with the given ψ, on the initial mesh, since discs have the strength of the soil and hardly
    dilate. If the path still rises at its end, the critical Kh lies between its last equilibrium and the limit load
    with ψ = φ. If the path takes too long, or gives less than Davis's estimate, Davis's estimate replaces the path.
    This estimate is low, so that the critical Kh then lies between the estimate and the limit load with ψ = φ. A path
    on a mesh that is too coarse does not count above the critical Kh with ψ = φ of the meshes of the section. The
    given ψ is also used if the critical Kh of the section is with ψ = φ, since the dilation of discs does not depend on
    the flow rule of the continuum.
    """
    from fem.search.dem_counterpart import associated_kc

    fem = FemAnswer.read(store)
    known = _in_the_box_of_discs(config, store, fem, tell) or DemCounterpart.of(fem)
    sides = sides_of_discs(config)
    if known.sides != sides or known.flow == "non-associated" or is_dilating_fully(config.section.strata):
        return known
    mesh = stored_mesh(config.section, store)
    depth = known.deeper_than_m or config.fem.least_depth
    settings = config.fem.changed(direction=fem.direction, least_depth=depth, sides=sides)
    davis = known.kc if known.flow == "davis" else 0.0
    answer = _with_own_psi(config.section, mesh, settings, davis, tell)
    path, surface = (None, None) if isinstance(answer, str) else answer
    most = known.kc_upper if path is None else path.upper
    instead = answer if isinstance(answer, str) else ""
    if path is None or path.upper > path.kc + config.dem.tolerance:
        try:
            most = associated_kc(config.section, mesh, settings, _path_listener("ψ = φ", mesh, tell))
        except NoAnswerError as error:
            instead += f"; with ψ = φ there is no answer ({error.reason}): the upper limit is not known"
    if path is None or surface is None:
        return known.model_copy(update={"instead": instead, "kc_upper": max(known.kc_upper, most)})
    curve, limit = tuple(path.steps), _limit_inside(fem, known, sides)
    kc, reason = path.kc, path.reason
    if kc > limit:
        kc, reason = limit, f"{reason}, at Kh = {kc:.3f}, above that of finer meshes with ψ = φ, which counts"
    return known.model_copy(
        update={
            "kc": kc, "kc_upper": max(kc, min(path.upper, most, limit)), "verdict": path.verdict, "reason": reason,
            "flow": "non-associated", "curve": curve, "yielding_m": displacement_at(curve, kc, YIELDED),
            "slip_surface": line(surface),
        }
    )  # fmt: skip


def _limit_inside(fem: FemAnswer, known: DemCounterpart, sides: Sides) -> float:
    """Return the critical Kh with ψ = φ of the section if its mechanism moves neither side, so that it is also one
    between fixed sides, where no smaller ψ resists more; infinite otherwise, or if ``known`` is of deeper failures."""
    inside = fem.flow == "associated" and fem.has_kc and not fem.at_sides and fem.settings.sides in ("smooth", "fixed")
    return fem.kc if inside and sides == "fixed" and known.deeper_than_m is None else math.inf


def _in_the_box_of_discs(config: Config, store: Store, fem: FemAnswer, tell: Tell) -> DemCounterpart | None:
    """Return the critical Kh of the finite elements with the sides of the box of discs, for failures that are deep
    enough for discs to resolve. Return None if the critical Kh with these sides is not requested, was already computed
    by the stage `fem`, or was not found.
    """
    from fem.search.dem_counterpart import critical_of_dem_counterpart
    from fem.search.slip_surface import slip_surface

    dilates_more = fem.flow == "associated" and not is_dilating_fully(config.section.strata)
    sides = sides_of_discs(config)
    if not config.fem.rigid_box or (config.fem.sides == sides and not dilates_more):
        return None
    deep = DISCS_DEEP * config.dem.mean_radius(config.section)
    depth = deep if fem.shallow_failures and deep > config.fem.least_depth else None
    least = depth or config.fem.least_depth
    settings = config.fem.changed(direction=fem.direction, least_depth=least, sides=sides)

    def report(what: str, path: "EquilibriumPath | None") -> None:
        tell((f"the continuum: {what}" + (f" = {path.factor:.4f}" if path is not None else ""), None))

    try:
        mesh = stored_mesh(config.section, store)
        box = critical_of_dem_counterpart(config.section, config.mesh, mesh, settings, report)
    except NoAnswerError:
        return None
    result = box.result
    if result.verdict not in ("plateau", "peak"):
        return None
    return DemCounterpart.taken(
        result,
        kc_upper=result.upper,
        sides=sides,
        deeper_than_m=depth,
        instead="",
        yielding_m=displacement_at(result.steps, result.kc, YIELDED),
        curve=tuple(result.steps),
        slip_surface=line(slip_surface(box.mesh, result.mechanism)),
    )


def _with_own_psi(
    section: Section, mesh: QuadMesh, settings: FemSettings, davis: float, tell: Tell
) -> "tuple[CriticalResult, np.ndarray] | str":
    """Return the path and its slip surface, or the reason why Davis's estimate (critical Kh = ``davis``) has to replace
    it."""
    from fem.search.dem_counterpart import non_associated_path

    try:
        path, surface = non_associated_path(section, mesh, settings, _path_listener("the given ψ", mesh, tell))
    except NoAnswerError as error:
        return f"with the given ψ there is no answer: {error.reason}"
    if path.verdict == "no failure":
        return f"with the given ψ there is {path.reason}"
    if path.kc < davis:
        return f"the path with the given ψ ended at Kh = {path.kc:.3f}, below Davis's estimate"
    return path, surface


def _path_listener(flow: str, mesh: QuadMesh, tell: Tell) -> "PathListener":
    """Return a listener that reports the progress of a path, and ends a path that takes too long."""

    def step(path: "EquilibriumPath") -> None:
        tell((f"the continuum with {flow}: path at Kh = {path.factor:.4f}", None))
        if path.solves * len(mesh.cells) > WORK:
            raise _TakesTooLongError("the equilibrium path takes too long", "")

    return step
