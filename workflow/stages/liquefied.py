"""Defines the stage `liquefied`: stability of the continuum after liquefaction, before any slide."""

import math
from typing import TYPE_CHECKING

from meshes.errors import NoAnswerError
from meshes.section.liquefies import RemainingStrength
from workflow.config import Config
from workflow.results.answer import SectionLabel
from workflow.results.finished_parts import FinishedParts
from workflow.results.stability import LiquefiedAnswer, LiquefiedCase, LiquefiedStratum
from workflow.run.stage import Job, Stage, unless_it_liquefies
from workflow.stages.bearing import WITHOUT_EFFECT, bearing_of
from workflow.stages.face_values import faces_at_rest
from workflow.stages.liquefaction import (
    STRENGTH_KEYS,
    cases_as_data,
    different_cases,
    has_strength,
    liquefied_ground,
    remaining,
)
from workflow.stages.required_strength import bounds_of_multiple
from workflow.stages.slices import circles_at_rest

if TYPE_CHECKING:
    from meshes.quad_mesh import QuadMesh


def work(job: Job) -> None:
    """Compute factor of safety and critical Kh of every case with another strength; writes fem/liquefied.json."""
    from workflow.results.stored_mesh import stored_mesh

    mesh = stored_mesh(job.config.section, job.store)
    parts: FinishedParts[LiquefiedCase] = FinishedParts(job.store, "fem/liquefied", LiquefiedCase)
    answers = []
    for place, (remains, numbers) in enumerate(different_cases(job.config).items()):
        job.progress(f"case {', '.join(map(str, numbers))}", None)
        if (case := parts.read(place)) is None:
            case = _case(job.config, mesh, dict(remains), numbers)
            parts.add(place, case)
        answers.append(case)
    LiquefiedAnswer(
        section=SectionLabel.of(job.config.section),
        sides=job.config.fem.sides,
        cases=tuple(answers),
        **_required(job, mesh, answers),
    ).write(job.store)
    parts.remove()


def _required(job: Job, mesh: "QuadMesh", answers: list[LiquefiedCase]) -> dict[str, tuple[LiquefiedStratum, ...]]:
    """Return the liquefied strata with the residual strength for a factor of safety of 1 by finite elements, and strict
    bounds of it, in the proportions of the strongest case. The result is empty if some case stands, if the strength
    depends on friction, or if there is none.
    """
    from fem.continuum.strength import flow_of, is_associated
    from fem.search.required_strength import required_multiple

    config = job.config
    flow = flow_of(config.section.strata, config.fem.flow)
    if any(case.verdict == "stands" or case.factor is None for case in answers) or not answers:
        return {}
    strongest = max(answers, key=lambda case: case.factor or 0.0)
    remains = remaining(config)[strongest.cases[0]]
    section = liquefied_ground(config, remains)
    frictional = any(section.strata[k].friction_angle for k in remains)
    if frictional or not 0.0 < (strongest.factor or 0.0) < 1.0 or not is_associated(section.strata, flow):
        return {}
    fem = config.fem.changed(kh=(), flow=flow, accuracy=0.0)
    job.progress("residual strength with which the ground stands", None)
    try:
        multiple = required_multiple(section, list(remains), mesh, fem, strongest.factor or 0.0)
    except NoAnswerError:
        return {}
    job.progress("strict bounds of that strength", None)
    low, high = bounds_of_multiple(section, list(remains), fem, config.bounds, strongest.factor or 0.0, multiple)
    multiples = {"required": multiple, "required_lower": low, "required_upper": high}
    return {
        key: tuple(stratum.scaled(value) for stratum in strongest.strata)
        for key, value in multiples.items()
        if value is not None
    }


def _case(config: Config, mesh: "QuadMesh", remains: dict[int, RemainingStrength], numbers: list[int]) -> LiquefiedCase:
    """Return the stability of the ground in cases of equal residual strengths."""
    section = liquefied_ground(config, remains)
    mean = section.cohesion_field.means()
    bearing = bearing_of(section, config, mesh, no_strength=not has_strength(remains))
    circles = circles_at_rest(section, config) if has_strength(remains) else None
    cases = [config.cases[number - 1] for number in numbers]
    return LiquefiedCase.taken(
        bearing,
        cases=tuple(numbers),
        names=tuple(dict.fromkeys(case.name for case in cases if case.name)),
        strata=tuple(
            LiquefiedStratum(
                name=section.strata[k].name,
                cohesion_kPa=mean[k].cohesion / 1e3,
                friction_deg=math.degrees(section.strata[k].friction_angle),
                residual_strength_ratio=mean[k].cohesion / config.section.cohesion_field.mean_effective_stress(k),
            )
            for k in remains
        ),
        circles=circles,
        faces=faces_at_rest(section, config, circles),
    )


STAGE = Stage(
    name="liquefied",
    description="stability after liquefaction",
    work=work,
    needs=("mesh",),
    reads=("fem", "tension_crack", "mesh", "faces.run"),
    ignores=lambda config: (*WITHOUT_EFFECT, "fem.own_dilation"),
    takes=lambda config: {
        "what liquefies": cases_as_data(config, STRENGTH_KEYS),
        "structures": [item.model_dump(mode="json", exclude={"name", "kind"}) for item in config.section.structures],
    },
    concurrent_after=("mesh",),
    results=(LiquefiedAnswer.FILE,),
    read=LiquefiedAnswer.read,
    leftovers=("fem/liquefied_part*.json",),
    unwanted=unless_it_liquefies,
)
