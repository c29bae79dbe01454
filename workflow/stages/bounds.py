"""The stage `bounds`: strict bounds of the critical seismic coefficient, their file and their pictures."""

import math
import time
from typing import TYPE_CHECKING

from workflow.results.answer import SectionLabel
from workflow.results.bounds import BoundsAnswer, MeshRound, Residuals, StressResiduals, VelocityResiduals, Verdict
from workflow.run.errors import NoAnswerError
from workflow.run.stage import Job, Stage
from workflow.settings import Input

if TYPE_CHECKING:
    from fem.limit.adaptive_bounds import Bracket

PROXY = (
    "by Davis's substitute for ψ < φ: c and tan φ are reduced and the flow is associated. It is a proxy: its bounds "
    "are strict for the reduced ground, and none of the section's."
)


def work(job: Job) -> None:
    """Bracket the critical Kh with ψ = φ; leaves fem/bounds.json and figures/bounds_*.png.

    The verdict is "bracketed", "wide" (no more cells allowed), or "no bracket" (a bound is missing). Raises InputError,
    BadMeshError, UnstableError if the section is proven to fail under its own weight, and, when all is written,
    NoAnswerError if a bound is missing.
    """
    from fem.limit.bounds import kh_bounds
    from workflow.figures.bounds import draw_all

    run = job.given
    started = time.perf_counter()
    job.progress("first mesh", None)
    found = kh_bounds(run, run.fem, run.bounds, lambda so_far: job.progress(in_words(so_far), None))
    answer = answer_of(run, found, time.perf_counter() - started)
    answer.write(job.store)
    draw_all(run, found, job.store)
    if answer.verdict == "no bracket":
        raise NoAnswerError(answer.reason, "allow more triangles: max_cells in the table [bounds]")


def answer_of(run: Input, found: "Bracket", seconds: float) -> BoundsAnswer:
    """The bracket of an input, how far each bound was checked, and every mesh; ``seconds`` it took to compute."""
    verdict, reason = _verdict(run, found)
    return BoundsAnswer(
        section=SectionLabel.of(run),
        lower=found.stress.multiplier if found.stress else None,
        upper=found.mechanism.multiplier if found.mechanism else None,
        gap=found.gap if math.isfinite(found.gap) else None,
        verdict=verdict,
        reason=reason,
        words=in_words(found),
        flow=PROXY if run.bounds.davis else "associated, ψ = φ.",
        davis=run.bounds.davis,
        sides=run.fem.sides,
        direction=run.fem.direction,
        vertical=run.fem.vertical,
        cells=found.meshes[-1].cells,
        seconds=round(seconds, 2),
        residuals=Residuals(
            lower=StressResiduals.model_validate(found.stress.check) if found.stress else None,
            upper=VelocityResiduals.model_validate(found.mechanism.check) if found.mechanism else None,
        ),
        history=tuple(MeshRound.model_validate(one) for one in found.meshes),
        settings=run.bounds,
    )


def _verdict(run: Input, found: "Bracket") -> tuple[Verdict, str]:
    last = "; ".join(found.meshes[-1].notes)
    if not math.isfinite(found.gap):
        missing = " and ".join(
            name for name, bound in (("lower", found.stress), ("upper", found.mechanism)) if bound is None
        )
        return "no bracket", f"there is no {missing} bound on {found.meshes[-1].cells} cells: {last}."
    if found.gap <= run.bounds.gap:
        return "bracketed", f"The gap of {100 * found.gap:.2f} % is below the {100 * run.bounds.gap:g} % asked for."
    wish = f"The gap of {100 * found.gap:.2f} % is above the {100 * run.bounds.gap:g} % asked for"
    return "wide", f"{wish}: {found.meshes[-1].cells} cells, {run.bounds.max_cells} allowed." + (
        f" {last}." * bool(last)
    )


def in_words(found: "Bracket") -> str:
    """The bracket as a person reads it."""
    low = f"{found.lower:.4f}" if found.stress else "no lower bound"
    high = f"{found.upper:.4f}" if found.mechanism else "no upper bound"
    gap = f", gap {100 * found.gap:.2f} %" if math.isfinite(found.gap) else ""
    return f"{low} <= Kh <= {high}{gap}, {found.meshes[-1].cells} triangles"


STAGE = Stage(
    name="bounds",
    what="strict bounds of the critical Kh",
    module=__name__,
    work=work,
    tables=("fem", "bounds"),
    ignores=("bounds.run",),
    results=(BoundsAnswer.FILE,),
    read=BoundsAnswer.read,
    pictures=("figures/bounds_*.png",),
    wanted=lambda given: given.bounds.run,
)
