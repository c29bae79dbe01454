"""Defines the stage `variants`: the critical Kh with one assumption changed at a time."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from fem.continuum.strength import Flow, flow_of, is_dilating_fully
from fem.errors import UnstableError
from fem.settings import WITHOUT_EFFECT, PathVerdict
from meshes.errors import NoAnswerError
from meshes.executor import Tell
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.continuum import FemAnswer, Variant, VariantsAnswer
from workflow.results.finished_parts import FinishedParts
from workflow.run.progress import Progress
from workflow.run.stage import Job, Stage
from workflow.run.store import Store

if TYPE_CHECKING:
    from fem.limit_load.limit_load import LimitLoadResult
    from fem.path.equilibrium_path import EquilibriumPath
    from fem.search.critical import CriticalResult
    from meshes.quad_mesh import QuadMesh

LARGEST_STEP = 0.1
# Cells of the answer's mesh beyond which a change that wants a path is looked at on the mesh it began with: a path
# takes minutes on 5,000 cells of bare sand, and the change is reported beside that mesh without it.
PATH_CELLS = 2500
FLOWS: Mapping[Flow, str] = {
    "davis": "Davis's estimate",
    "associated": "ψ = φ",
    "non-associated": "the flow rule of the given ψ (equilibrium path)",
}


def work(job: Job) -> None:
    """Compute the critical Kh with each requested change of assumptions; writes fem/variants.json."""
    from workflow.results.stored_mesh import fem_mesh

    config, store, progress = job.config, job.store, job.progress
    answer = FemAnswer.read(store)
    one_way = config.with_settings("fem", direction=answer.direction)
    last = fem_mesh(config.section, store, answer.mesh.method)
    changes = [
        on_a_mesh(change, config, store, answer, last)
        for name in config.variants.which
        if (change := changed(one_way, name, answer.element))
    ]
    changes = with_its_element(like_with_like(changes, one_way, progress), one_way, answer.element)
    finished: list[Variant] = []

    def heard(place: int, message: str) -> None:
        progress(f"{changes[place].description}: {message}", len(finished) / len(changes))

    parts: FinishedParts[Variant] = FinishedParts(store, "fem/variants", Variant)
    variants = parts.compute(job.executor, variant, changes, heard, lambda _, each: finished.append(each))
    VariantsAnswer(variants=tuple(by_one_element(variants, changes))).write(store)
    parts.remove()


@dataclass(frozen=True, eq=False)
class Change:
    """Holds one changed assumption.

    Attributes
    ----------
    name, description : name of the change, and its description.
    config : the config with the change.
    mesh : the mesh of the answer, or its initial mesh.
    halved : whether the cells of this mesh are halved.
    kc_without : critical Kh on the initial mesh without the change; None if it is that of the answer.
    against : place in the list of changes whose result is the critical Kh without this change, if the change requires
        another element than the answer has.
    requested : whether the change was requested; other changes are computed to be compared with.
    """

    name: str
    description: str
    config: Config
    mesh: "QuadMesh"
    halved: bool
    kc_without: float | None = None
    against: int | None = None
    requested: bool = True


def on_a_mesh(
    change: tuple[str, str, Config], config: Config, store: Store, answer: FemAnswer, last: "QuadMesh"
) -> Change:
    """Return the change, to be computed on the ``last`` mesh, which is the mesh of the answer, or on the first mesh if
    the last mesh has too many cells for an equilibrium path.

    ``config``: config of the run; ``store``: store of the folder with the results.
    """
    from fem.limit_load.limit_load import is_unique
    from workflow.results.stored_mesh import stored_mesh

    name, words, with_it = change
    first = answer.meshes[0] if answer.meshes else None
    many = answer.mesh.quadrilaterals > PATH_CELLS and not is_unique(with_it.section, with_it.fem)
    if first is None or not many:
        halved = with_it.mesh != config.mesh
        return Change(name, words, with_it, last, halved)
    words = f"{words}, on the first mesh of {first.cells} cells"
    return Change(name, words, with_it, stored_mesh(config.section, store), with_it.mesh != config.mesh, first.kc)


def like_with_like(changes: Sequence[Change], config: Config, progress: Progress) -> list[Change]:
    """Return the changes of assumptions, each to be compared with a result without this change by the same method. If
    the answer is a path, each change is computed on the first mesh, together with the path of the unchanged ``config``
    on this mesh.

    The critical Kh of a sequence of meshes are limit loads of the reduced element. Another element type has another
    critical Kh on the same mesh, and this difference is no effect of a changed assumption. Changed assumptions are
    therefore left out if the path of the unchanged config has no result.
    """
    from fem.limit_load.limit_load import is_unique

    first = [change for change in changes if change.kc_without is not None]
    if not first or is_unique(config.section, config.fem):
        return list(changes)
    words = "unchanged assumptions on the first mesh"
    unchanged = variant(
        Change("first", words, config, first[0].mesh, False), lambda text: progress(f"{words}: {text}", None)
    )
    return [change if change.kc_without is None else replace(change, kc_without=unchanged.kc)
            for change in changes if change.kc_without is None or unchanged.kc is not None]  # fmt: skip


def with_its_element(changes: Sequence[Change], config: Config, element: str) -> list[Change]:
    """Return the changes, those with another element than that of the answer together with the change to that element
    alone.

    Non-associated flow requires the quadratic element, which on a coarse mesh carries more than the reduced ``element``
    of the answer. Compared with the answer, ground that dilates less would seem to be stronger.
    """
    from fem.limit_load.limit_load import is_unique
    from fem.path.gravity import element_for

    result = list(changes)
    for place, change in enumerate(changes):
        used = element_for(change.config.section, change.config.fem)
        if change.name != "dilation" or used == element or is_unique(change.config.section, change.config.fem):
            continue
        alone = config.with_settings("fem", element=used)
        same = next((k for k, each in enumerate(changes) if each.config.fem == alone.fem and not each.halved), None)
        if same is None:
            same = len(result)
            result.append(replace(change, description=f"{used} element", config=alone, requested=False))
        result[place] = replace(change, description=f"{change.description}, both with the {used} element", against=same)
    return result


def by_one_element(variants: Sequence[Variant], changes: Sequence[Change]) -> list[Variant]:
    """Return the results of the requested changes, each beside the result with the same element; a result without one
    to compare with has no critical Kh."""
    result = []
    for computed, change in zip(variants, changes, strict=True):
        if not change.requested:
            continue
        if change.against is None or computed.kc is None:
            result.append(computed)
            continue
        without = variants[change.against]
        reason = f"no critical Kh without the change ({without.reason})"
        lost = {"kc": None, "kc_upper": None, "verdict": "no answer", "reason": reason}
        result.append(computed.model_copy(update=lost if without.kc is None else {"kc_without": without.kc}))
    return result


def changed(config: Config, name: str, element: str) -> tuple[str, str, Config] | None:
    """Return the name, description and config of a variant; None if it would change nothing.

    ``element`` is the finite element with which the answer was computed.
    """
    from fem.limit_load.limit_load import is_unique

    fem = config.fem
    if name == "mesh":
        return name, "cells of half the size", config.with_settings("mesh", refine=2 * config.mesh.refine)
    if name == "element":
        other = "quadratic" if element != "quadratic" else "bilinear"
        return name, f"the {other} element instead of the {element} element", config.with_settings("fem", element=other)
    if name == "step" and fem.first_step < LARGEST_STEP and not is_unique(config.section, fem):
        step = min(2.0 * fem.first_step, LARGEST_STEP)
        text = f"first step of Kh {step:g} instead of {fem.first_step:g}"
        return name, text, config.with_settings("fem", first_step=step)
    if name == "sides" and fem.sides != "periodic":
        sides = "free-field" if fem.sides == "fixed" else "fixed"
        return name, f"sides {sides} instead of {fem.sides}", config.with_settings("fem", sides=sides)
    if name == "dilation" and not is_dilating_fully(config.section.strata):
        own_flow = flow_of(config.section.strata, fem.flow)
        flow: Flow = "davis" if own_flow == "non-associated" else "non-associated"
        return name, f"{FLOWS[flow]} instead of {FLOWS[own_flow]}", config.with_settings("fem", flow=flow)
    if name == "tension" and (cracked := without_tension(config.section)) is not None:
        return name, "no tensile strength (open cracks)", config.model_copy(update={"section": cracked})
    return None


def without_tension(section: Section) -> Section | None:
    """Return the section with a tension cut-off of 0 in all strata with a cohesion; None if that changes nothing."""
    strata = [s.model_copy(update={"tension": 0.0}) if s.has_cohesion else s for s in section.strata]
    changes = any(s.has_cohesion and s.tension != 0.0 for s in section.strata)
    return section.with_strata(strata) if changes else None


def variant(change: Change, tell: Tell) -> Variant:
    """Return the critical Kh with one changed assumption, 0 if the ground then fails under its weight; None with the
    reason if there is no answer."""
    start = time.perf_counter()
    kc: float | None = None
    kc_upper: float | None = None
    verdict: PathVerdict | Literal["no answer"] = "no answer"
    try:
        result = _limit_load(change, tell)
    except UnstableError as error:
        kc, kc_upper, verdict, reason = 0.0, 0.0, "plateau", str(error)
    except NoAnswerError as error:
        reason = str(error)
    else:
        verdict, reason = result.verdict, result.reason
        if verdict in ("plateau", "peak"):
            kc, kc_upper = result.kc, result.upper
    return Variant(
        name=change.name, change=change.description, kc=kc, kc_upper=kc_upper, verdict=verdict, reason=reason,
        seconds=round(time.perf_counter() - start, 2), kc_without=change.kc_without,
    )  # fmt: skip


def _limit_load(change: Change, tell: Tell) -> "LimitLoadResult | CriticalResult":
    """Return the limit load by limit analysis where it is unique, else by a path; raise NoAnswerError."""
    from fem.limit_load.limit_load import critical_limit_load, is_unique
    from fem.search.critical import critical_coefficient
    from meshes.quad_mesh import divided

    def step(path: "EquilibriumPath") -> None:
        tell(f"step {len(path.steps)}, Kh = {path.factor:.4f}")

    mesh, settings = divided(change.mesh) if change.halved else change.mesh, change.config.fem
    if is_unique(change.config.section, settings):
        tell(f"limit load of {len(mesh.cells)} cells")
        return critical_limit_load(change.config.section, mesh, settings)
    return critical_coefficient(change.config.section, mesh, settings, listener=step)


STAGE = Stage(
    name="variants",
    description="critical Kh with other assumptions",
    work=work,
    needs=("fem",),
    reads=("mesh", "fem", "variants"),
    ignores=lambda config: (*WITHOUT_EFFECT, "fem.kh", "fem.rigid_box"),
    concurrent_after=("fem",),
    results=(VariantsAnswer.FILE,),
    read=VariantsAnswer.read,
    leftovers=("fem/variants_part*.json",),
    unwanted=lambda config: "" if config.variants.which else "variants.which is empty",
)
