"""All that is said of a section: critical Kh to both sides, ψ as given beside ψ = φ, factors of safety, doubts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fem.adaptive import AdaptiveResult, adapted_answer, adapted_safety
from fem.critical import AtOnce, CriticalResult, critical_coefficient
from fem.errors import NoEquilibriumError, UnstableError
from fem.judges import Doubt, doubts_of
from fem.path import EquilibriumPath
from fem.settings import FemSettings
from fem.strength import is_associated, is_dilating_fully
from fem.strength_reduction import SafetyFactor, safety_factor
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from meshes.settings import MeshSettings

# Is told what is being done, and, where a path is followed, how far it is.
AssessmentListener = Callable[[str, EquilibriumPath | None], None]


@dataclass(frozen=True)
class Assessment:
    """The answers for a section, held against each other.

    Attributes
    ----------
    critical : CriticalResult
        The critical Kh, with the path to it.
    mesh : QuadMesh
        The mesh that it was found on.
    adapted : AdaptiveResult or None
        The limit loads of the meshes that led to this one; None where the flow is not associated.
    opposite : AdaptiveResult or None
        The opposite direction, where both were asked for.
    associated : AdaptiveResult or None
        The same direction with ψ = φ, on meshes of its own; None where that is what ``critical`` is.
    rigid_box : AdaptiveResult or None
        Between fixed sides, pushed the same way, on meshes of its own; None where it was not asked for.
    safety : list of SafetyFactor
        Factors of safety at the Kh asked for, the first without shaking.
    doubts : list of Doubt
        What contradicts the answer or is to be known.
    """

    critical: CriticalResult
    mesh: QuadMesh
    adapted: AdaptiveResult[AtOnce] | None
    opposite: AdaptiveResult[AtOnce] | AdaptiveResult[CriticalResult] | None
    associated: AdaptiveResult[AtOnce] | None
    rigid_box: AdaptiveResult[CriticalResult] | None
    safety: list[SafetyFactor]
    doubts: list[Doubt]


def assess(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    comm: Any,
    listener: AssessmentListener,
) -> Assessment:
    """Find the critical Kh and what stands beside it, beginning with a ``first`` mesh.

    Raises InputError, NoEquilibriumError, and UnstableError with the factor of safety if the ground fails under its own
    weight.
    """

    def told(what: str) -> Callable[[EquilibriumPath], None]:
        return lambda path: listener(what, path)

    def at_once(what: str, wish: FemSettings) -> AdaptiveResult[AtOnce]:
        return adapted_answer(section, meshing, first, wish, comm, lambda words: listener(f"{what}: {words}", None))

    def safety(wish: FemSettings, kh: float) -> SafetyFactor:
        if is_associated(section.strata, wish.flow):
            try:
                return adapted_safety(section, meshing, first, wish, kh, comm, lambda what: listener(what, None)).result
            except UnstableError:
                raise
            except NoAnswerError:  # the solver left none: a path has to do
                pass
        return safety_factor(section, mesh, wish, kh, comm, told("factor of safety"))

    mesh = first
    try:
        adapted = _limit_loads(section, settings, at_once)
        mesh = adapted.mesh if adapted else first
        one_way = settings.model_copy(update={"direction": adapted.result.direction}) if adapted else settings
        critical = critical_coefficient(section, mesh, one_way, comm, told("Kh"))
    except NoEquilibriumError:
        raise
    except UnstableError as error:
        factor = safety(settings, 0.0).factor
        raise UnstableError(f"{error}; its factor of safety is {factor:.2f}") from error
    one_way = settings.model_copy(update={"direction": critical.direction})
    opposite: AdaptiveResult[AtOnce] | AdaptiveResult[CriticalResult] | None = adapted.other if adapted else None
    if critical.other is not None:
        opposite = AdaptiveResult(critical.other, mesh)
    associated = None
    if settings.flow != "associated" and not is_dilating_fully(section.strata):
        associated = at_once("Kh with ψ = φ", one_way.model_copy(update={"flow": "associated"}))
    box: AdaptiveResult[CriticalResult] | None = None
    if settings.rigid_box and settings.sides != "fixed" and critical.verdict != "undecided":
        # the discs are pushed where the ground fails, and so is this
        fixed = one_way.model_copy(update={"sides": "fixed", "kh": ()})
        its_mesh = at_once("Kh, fixed sides", fixed).mesh if adapted else mesh
        held = critical_coefficient(section, its_mesh, fixed, comm, told("fixed sides: Kh"))
        box = AdaptiveResult(held, its_mesh)
    doubts = doubts_of(critical, mesh, associated.result if associated else None)
    factors = [found for kh in settings.safety_factor_at if (found := _or_doubt(safety, one_way, kh, doubts))]
    return Assessment(critical, mesh, adapted, opposite, associated, box, factors, doubts)


def _or_doubt(
    safety: Callable[[FemSettings, float], SafetyFactor], wish: FemSettings, kh: float, doubts: list[Doubt]
) -> SafetyFactor | None:
    """The factor of safety at ``kh``; where there is none, one of the doubts says why."""
    try:
        return safety(wish, kh)
    except NoAnswerError as error:
        doubts.append(Doubt(f"There is no factor of safety at Kh = {kh:g}: {error}.", "look at a smaller Kh", False))
        return None


def _limit_loads(
    section: Section, settings: FemSettings, at_once: Callable[[str, FemSettings], AdaptiveResult[AtOnce]]
) -> AdaptiveResult[AtOnce] | None:
    """The limit loads of meshes made for the mechanism; None where there are none and a path has to do alone."""
    if not is_associated(section.strata, settings.flow):
        return None
    try:
        return at_once("Kh", settings)
    except UnstableError:
        raise
    except NoAnswerError:
        return None
