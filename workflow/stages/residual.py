"""Defines the stage `residual`: whether a failure continues with the residual strength after large shear strains.

The verdict has two steps. With peak strength the ground fails along a surface; soil that has slid along this surface
has residual strength (Skempton 1964, Géotechnique 14, 77-102), as has a slope that slid before. Between peak and
residual strength, failure is progressive and starts at the place of the largest shear strain.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from meshes.errors import InputError
from workflow.config import Config
from workflow.results.answer import SectionLabel, line
from workflow.results.stability import AlongSurface, PeakAndResidual, ResidualAnswer, ResidualVerdict, SoftenedStratum
from workflow.run.stage import Job, Stage
from workflow.stages.bearing import WITHOUT_EFFECT, answer_or_note, bearing_of

if TYPE_CHECKING:
    from fem.search.mesh_sequence import AdaptiveResult
    from fem.search.strength_reduction import SafetyFactor
    from meshes.quad_mesh import QuadMesh
    from meshes.section.section import Section
    from workflow.results.stability import Bearing


def work(job: Job) -> None:
    """Compute factors of safety with peak and with residual strength; writes fem/residual.json."""
    from workflow.results.stored_mesh import stored_mesh

    config, section = job.config, job.config.section
    if without := _without_residual(config):
        raise InputError(
            "strata", [f"{without}; expected residual_cohesion and residual_friction_angle in at least one stratum"]
        )
    mesh = stored_mesh(section, job.store)
    softened = section.with_strata([stratum.softened() for stratum in section.strata])
    job.progress("peak strength", None)
    notes: list[str] = []
    peak = _peak(config, mesh, notes)
    factor = None if peak is None else peak.result.factor
    job.progress("residual strength", None)
    everywhere = bearing_of(softened, config, mesh)
    along = None if peak is None else _along(section, softened, peak, config.fem.vertical)
    steps = PeakAndResidual(
        strata=tuple(
            SoftenedStratum(
                name=stratum.name,
                cohesion_kPa=stratum.cohesion / 1e3,
                friction_deg=math.degrees(stratum.friction_angle),
            )
            for stratum in softened.strata
            if stratum.softens
        ),
        verdict=verdict_of(factor, along, everywhere),
        peak=factor,
        along=along,
        everywhere=everywhere,
        notes=tuple(notes),
    )
    ResidualAnswer(section=SectionLabel.of(section), sides=config.fem.sides, steps=steps).write(job.store)


def _peak(config: Config, mesh: "QuadMesh", notes: list[str]) -> "AdaptiveResult[SafetyFactor] | None":
    """Return the factor of safety of the section at Kh = 0 with peak strength, and its mesh. If the finite elements
    have no answer, return None and add a note with the reason.
    """
    from fem.continuum.strength import is_associated
    from fem.search.adaptive import AdaptiveSearch
    from fem.search.mesh_sequence import AdaptiveResult
    from fem.search.strength_reduction import safety_factor

    section, fem = config.section, config.fem

    def find() -> "AdaptiveResult[SafetyFactor]":
        if is_associated(section.strata, fem.flow):
            return AdaptiveSearch(section, config.mesh, mesh).safety(fem, 0.0)
        return AdaptiveResult(safety_factor(section, mesh, fem, 0.0), mesh)

    answer = answer_or_note("finite elements, peak strength", notes, find)
    if answer is not None and answer.result.verdict == "undecided":
        notes.append(f"finite elements, peak strength: {answer.result.reason}")
        return None
    return answer


def _along(
    section: "Section", softened: "Section", peak: "AdaptiveResult[SafetyFactor]", vertical: float
) -> AlongSurface | None:
    """Return Spencer's factors of safety along the slip surface of the finite elements with peak strength."""
    from fem.search.slip_surface import slip_surface
    from workflow.estimates.slip_circles import least_balance

    mechanism = peak.result.mechanism
    surface = slip_surface(peak.mesh, mechanism) if mechanism is not None else np.empty((0, 2))
    if not len(surface):
        return None
    factors = [least_balance(ground, surface, 0.0, vertical) for ground in (section, softened)]
    return AlongSurface(surface_m=line(surface), peak=factors[0], residual=factors[1])


def _without_residual(config: Config) -> str:
    """Return the reason why the stage is not needed, which is that no stratum has a post-peak strength."""
    return "" if any(stratum.softens for stratum in config.section.strata) else "no stratum has a post-peak strength"


def verdict_of(factor: float | None, along: AlongSurface | None, everywhere: "Bearing") -> ResidualVerdict:
    """Return the verdict from the factors of safety with peak strength, with residual strength along the slip surface
    of peak strength, and with residual strength everywhere.
    """
    if everywhere.verdict == "stands":
        return "stands"
    if factor is None:
        return "undecided"
    if factor < 1.0:
        return "fails"
    return "would continue" if along is None or along.residual is None or along.residual < 1.0 else "would stop"


STAGE = Stage(
    name="residual",
    description="factors of safety with peak strength and with residual strength",
    work=work,
    needs=("mesh",),
    reads=("fem",),
    ignores=lambda config: (*WITHOUT_EFFECT, "fem.own_dilation"),
    concurrent_after=("mesh",),
    results=(ResidualAnswer.FILE,),
    read=ResidualAnswer.read,
    unwanted=_without_residual,
)
