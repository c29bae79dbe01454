"""The search between fixed sides, as the stages keep it that look there: `fem`, and what discs are compared with."""

from typing import TYPE_CHECKING

from fem.search.slip_surface import slip_surface
from workflow.results.answer import line
from workflow.results.continuum import RigidBox

if TYPE_CHECKING:
    from fem.search.critical import CriticalResult
    from fem.search.mesh_sequence import AdaptiveResult


def rigid_box_of(found: "AdaptiveResult[CriticalResult]", depth: float | None = None) -> RigidBox:
    """What is kept of a search with fixed sides; ``depth`` (m): failures of cohesionless faces that are less deep were
    left out."""
    return RigidBox(
        kc=found.result.kc,
        kc_upper=found.result.upper,
        flow=found.result.flow,
        verdict=found.result.verdict,
        reason=found.result.reason,
        slip_surface=line(slip_surface(found.mesh, found.result.mechanism)),
        curve=tuple(found.result.steps),
        deeper_than_m=depth,
    )
