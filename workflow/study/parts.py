"""Defines the parts of a study: the results that can be computed for a sample, by the continuum (critical Kh by finite
elements, and its strict bounds) and by discs (all stages of a run up to `slide`, of which a few numbers are stored).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from rich.console import Console

from fem.continuum.strength import is_associated
from fem.errors import UnstableError, accepting_no_answer
from fem.limit.bounds import kh_bounds
from fem.search.adaptive import AdaptiveSearch
from fem.search.critical import critical_coefficient
from fem.settings import WITHOUT_EFFECT
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.results.cases import QUANTITIES, CasesAnswer
from workflow.run import pipeline
from workflow.run.display import Display
from workflow.run.plan import Choice
from workflow.run.progress import Verbosity
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages import calibrate, fem, mesh, slide
from workflow.stages.liquefaction import refuse_unless_liquefying
from workflow.study.task import Numbers, StudySample

if TYPE_CHECKING:
    from fem.limit_load.limit_load import LimitLoadResult
    from fem.search.critical import CriticalResult
    from meshes.quad_mesh import QuadMesh


@dataclass(frozen=True)
class StudyPart:
    """Holds a part of a study: a result that the study computes for every sample, such as the critical Kh.

    Attributes
    ----------
    name : name of the part on the command line
    function : function that computes the part for one sample
    tables : tables of settings that the part reads; it is not computed again after changes of other tables
    ignores : settings in these tables without effect on the numbers of the part, as "table.key"
    keeps : whether the part takes so long that it stores a folder from which it continues
    """

    name: str
    function: Callable[[StudySample], Numbers]
    tables: tuple[str, ...]
    ignores: tuple[str, ...] = ()
    keeps: bool = False


def continuum(sample: StudySample) -> Numbers:
    """Return the critical Kh by finite elements; 0 for ground that does not stand without shaking.

    The critical Kh is that with ψ = φ or by Davis's estimate, as ``fem.flow`` says. By both flow rules the critical Kh
    is the limit load on meshes adapted to the mechanism; for non-associated flow it follows from an equilibrium path.
    """
    config = Config.parse(sample.data)
    first = generate(config.section, config.mesh)
    try:
        critical, used = _critical(config, first)
    except UnstableError:
        return Numbers(numbers={"kc": 0.0}, texts={"verdict": "fails under its own weight"})
    if critical.verdict == "undecided":
        raise NoAnswerError(f"the finite elements found no limit load: {critical.reason}")
    texts: dict[str, str] = {"verdict": critical.verdict, "direction": critical.direction, "flow": critical.flow}
    return Numbers(numbers={"kc": critical.kc, "cells": len(used.cells)}, texts=texts)


def _critical(config: Config, first: "QuadMesh") -> "tuple[LimitLoadResult | CriticalResult, QuadMesh]":
    if is_associated(config.section.strata, config.fem.flow):
        search = AdaptiveSearch(config.section, config.mesh, first)
        with accepting_no_answer():
            critical = search.critical(config.fem)
            return critical.result, critical.mesh
    return critical_coefficient(config.section, first, config.fem), first


def bounds(sample: StudySample) -> Numbers:
    """Return strict lower and upper bounds of the critical Kh, ψ = φ."""
    config = Config.parse(sample.data)
    bounds_settings = config.bounds.changed(davis=False)
    try:
        bracket = kh_bounds(config.section, config.fem, bounds_settings)
    except UnstableError:
        return Numbers(numbers={"kc_lower_bound": 0.0, "kc_upper_bound": 0.0})
    return Numbers(numbers={
        "kc_lower_bound": bracket.stress.multiplier if bracket.stress else None,
        "kc_upper_bound": bracket.mechanism.multiplier if bracket.mechanism else None,
    })  # fmt: skip


STAGES = (mesh.STAGE, fem.STAGE, calibrate.STAGE, slide.STAGE)


def discs(sample: StudySample) -> Numbers:
    """Compute the slides of every case: all stages of a run up to `slide`, in a folder that is removed afterwards.

    Raises NoAnswerError if the discs cannot be calibrated.
    """
    config = config_after_triggering(Config.parse(sample.data))
    refuse_unless_liquefying(config.section)
    with TemporaryDirectory(prefix="noshiro-") as folder:
        store = Store(Path(sample.folder or folder))
        job, silence = Job(config, store, STAGES), Display(Console(), STAGES, Verbosity.QUIET)
        pipeline.execute(job, Choice(tuple(stage.name for stage in job.stages)), silence, "noshiro study")
        answer = CasesAnswer.read(store)
        numbers = _numbers(answer)
        store.remove(["**/*"])
    return numbers


def _numbers(answer: CasesAnswer) -> Numbers:
    """Return the numbers of every case: means over its packings, or the values of the only packing."""
    numbers: dict[str, float | None] = {}
    errors = {}
    over_packings = answer.random.cases if answer.random is not None else {}
    for number, case in sorted(answer.sets[answer.first_set].items()):
        for name in QUANTITIES:
            key = f"case{number}_{name}"
            spread = getattr(over_packings.get(number), name, None)
            numbers[key] = getattr(case, name) if spread is None else spread.mean
            if spread is not None and spread.mean_ci95 is not None:
                errors[key] = 0.5 * (spread.mean_ci95[1] - spread.mean_ci95[0])
    return Numbers(numbers=numbers, errors=errors)


# What the stages of slides read, and what decides on their cases.
OF_SLIDES = (*dict.fromkeys(name.split(".")[0] for stage in STAGES for name in stage.reads), "earthquake", "triggering")
PARTS = (
    StudyPart("fem", continuum, ("mesh", "fem"), (*WITHOUT_EFFECT, "fem.rigid_box")),
    StudyPart("bounds", bounds, ("fem", "bounds"), (*WITHOUT_EFFECT, "fem.rigid_box", "bounds.safety_factor")),
    StudyPart("slide", discs, OF_SLIDES, keeps=True),
)

# What the sliding block of a sample reads, which needs no part of its own.
OF_THE_BLOCK = ("fem", "sliding_block", "slide", "site_response")
# What every study reads, whatever it computes.
OF_ALL = ("study", "uncertain", "earthquake", "triggering", "figures", "report", "dem.workers")


def read_by(parts: Sequence[str]) -> tuple[str, ...]:
    """Return the tables of settings that some parts of a study read.

    Parameters
    ----------
    parts : names of parts, "block" among them

    Returns
    -------
    Names of tables, also of those that every study reads; a table may be named twice.
    """
    tables = [table for part in PARTS if part.name in parts for table in part.tables]
    return (*OF_ALL, *tables, *(OF_THE_BLOCK if "block" in parts else ()))
