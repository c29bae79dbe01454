"""All that is said of a section: critical Kh to both sides, ψ as given beside ψ = φ, factors of safety, doubts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fem.critical import CriticalResult, critical_coefficient
from fem.errors import NoEquilibriumError, UnstableError
from fem.judges import Doubt, doubts_of
from fem.path import EquilibriumPath
from fem.settings import FemSettings
from fem.strength import is_dilating_fully
from fem.strength_reduction import SafetyFactor, safety_factor
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

# Is told what is being followed, and how far.
AssessmentListener = Callable[[str, EquilibriumPath], None]


@dataclass(frozen=True)
class Assessment:
    """The answers for a section, held against each other.

    Attributes
    ----------
    critical : CriticalResult
        The critical Kh, with that of the opposite direction in ``critical.other``.
    associated : CriticalResult or None
        The same direction with ψ = φ; None where that is what ``critical`` is.
    safety : list of SafetyFactor
        Factors of safety at the Kh asked for, the first without shaking.
    doubts : list of Doubt
        What contradicts the answer or is to be known.
    """

    critical: CriticalResult
    associated: CriticalResult | None
    safety: list[SafetyFactor]
    doubts: list[Doubt]


def assess(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, listener: AssessmentListener
) -> Assessment:
    """Find the critical Kh and what stands beside it.

    Raises InputError, NoEquilibriumError, and UnstableError with the factor of safety if the ground fails under its own
    weight.
    """

    def told(what: str) -> Callable[[EquilibriumPath], None]:
        return lambda path: listener(what, path)

    try:
        critical = critical_coefficient(section, mesh, settings, comm, told("Kh"))
    except NoEquilibriumError:
        raise
    except UnstableError as error:
        factor = safety_factor(section, mesh, settings, 0.0, comm, told("factor of safety")).factor
        raise UnstableError(f"{error}; its factor of safety is {factor:.2f}") from error
    one_way = settings.model_copy(update={"direction": critical.direction})
    associated = None
    if settings.flow != "associated" and not is_dilating_fully(section.strata):
        full = one_way.model_copy(update={"flow": "associated", "element": "auto"})
        associated = critical_coefficient(section, mesh, full, comm, told("Kh with ψ = φ"))
    doubts = doubts_of(critical, mesh, associated)
    safety = []
    for kh in settings.safety_factor_at:
        try:
            safety.append(safety_factor(section, mesh, one_way, kh, comm, told("factor of safety")))
        except UnstableError as error:
            doubts.append(
                Doubt(f"There is no factor of safety at Kh = {kh:g}: {error}.", "look at a smaller Kh", False)
            )
    return Assessment(critical, associated, safety, doubts)
