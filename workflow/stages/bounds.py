"""The stage `bounds`: strict bounds of the critical seismic coefficient, their file and their pictures."""

import math
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem.errors import UnstableError
from fem.loads import Direction
from fem.settings import BoundsSettings
from meshes.errors import InputError
from workflow.results.answer import SectionLabel
from workflow.results.bounds import (
    BoundsAnswer,
    BracketPart,
    MeshRound,
    Residuals,
    SafetyPart,
    SkinPart,
    StressResiduals,
    VelocityResiduals,
    Verdict,
)
from workflow.results.continuum import FemAnswer
from workflow.run.errors import NoAnswerError
from workflow.run.stage import Job, Stage
from workflow.run.store import Store
from workflow.settings import Input

if TYPE_CHECKING:
    from fem.limit.adaptive_bounds import Bracket
    from fem.limit.bounds import KhBounds


def work(job: Job) -> None:
    """Bracket the critical Kh with ψ = φ and that of Davis's substitute; leaves fem/bounds.json, figures/bounds_*.png.

    The verdict is "bracketed", "wide" (the gap was not closed as far as was asked), or "no bracket" (a bound is
    missing). Raises InputError, BadMeshError, UnstableError if the section is proven to fail under its own weight, and,
    when all is written, NoAnswerError if a bound is missing.
    """
    from fem.limit.bounds import kh_bounds
    from workflow.figures.bounds import draw_all

    given, asked = job.given, job.given.bounds.in_a_run
    started = time.perf_counter()
    job.progress("first mesh", None)
    one_way = given.fem.model_copy(update={"direction": direction_of(given, job.store)})
    given = given.model_copy(update={"fem": one_way})
    factors = tuple(_factors(job, given, asked)) if asked.safety_factor else ()
    try:
        found = kh_bounds(given, given.fem, asked, lambda so_far: job.progress(in_words(so_far), None))
    except UnstableError as error:
        if not factors:
            raise
        raise UnstableError(f"{error}; {'; '.join(one.words for one in factors)}") from None
    answer = answer_of(given, found, asked, time.perf_counter() - started)
    answer = answer.model_copy(update={"safety": factors})
    answer.write(job.store)
    draw_all(given, found, job.store)
    if answer.verdict == "no bracket":
        raise NoAnswerError(answer.reason, "allow more triangles: max_cells in the table [bounds]")


def _factors(job: Job, given: Input, asked: BoundsSettings) -> Iterator[SafetyPart]:
    """Factors of safety at every Kh at which one is wanted; without shaking sides that are not fixed are held, as the
    elements hold them."""
    from fem.limit.safety_bounds import safety_bounds

    for kh in given.fem.safety_factor_at:
        job.progress(f"factor of safety at Kh = {kh:g}", None)
        found = safety_bounds(given, given.fem, asked, kh, held=kh == 0.0)
        lower, upper = found.lower or None, found.upper if math.isfinite(found.upper) else None
        yield SafetyPart(kh=kh, lower=lower, upper=upper, cells=found.cells, skin=found.skin)


def direction_of(given: Input, store: Store) -> Direction:
    """Where the ground is pushed; of both sides that to which it fails first, as the finite elements have found."""
    if given.fem.direction != "both":
        return given.fem.direction
    try:
        return FemAnswer.read(store).direction
    except InputError:  # they have not run
        return "downhill"


def answer_of(given: Input, found: "KhBounds", asked: BoundsSettings, seconds: float) -> BoundsAnswer:
    """The brackets of an input, how far each bound was checked, and every mesh; ``seconds`` it took to compute."""
    return BoundsAnswer(
        **vars(bracket_part(found, asked)),
        section=SectionLabel.of(given),
        flow="associated, ψ = φ",
        substitute=bracket_part(found.substitute, asked) if found.substitute else None,
        skins=tuple(SkinPart.model_validate(face) for face in found.skins),
        least_depth=given.fem.least_depth,
        sides=given.fem.sides,
        direction="uphill" if given.fem.direction == "uphill" else "downhill",
        vertical=given.fem.vertical,
        seconds=round(seconds, 2),
        settings=asked,
    )


def bracket_part(found: "Bracket", asked: BoundsSettings) -> BracketPart:
    """One bracket as it is kept."""
    verdict, reason = _verdict(found, asked)
    return BracketPart(
        lower=found.stress.multiplier if found.stress else None,
        upper=found.mechanism.multiplier if found.mechanism else None,
        gap=found.gap if math.isfinite(found.gap) else None,
        verdict=verdict,
        reason=reason,
        words=in_words(found),
        cells=found.meshes[-1].cells,
        residuals=Residuals(
            lower=StressResiduals.model_validate(found.stress.check) if found.stress else None,
            upper=VelocityResiduals.model_validate(found.mechanism.check) if found.mechanism else None,
        ),
        history=tuple(MeshRound.model_validate(one) for one in found.meshes),
    )


def _verdict(found: "Bracket", asked: BoundsSettings) -> tuple[Verdict, str]:
    if found.ended == "gap":
        return "bracketed", f"The gap of {100 * found.gap:.2f} % is below the {100 * asked.gap:g} % asked for."
    last = found.meshes[-1]
    x, z = found.open_at or (math.nan, math.nan)
    why = {
        "triangles": f"{last.cells} triangles, {asked.max_cells} allowed",
        "time": f"{last.cells} triangles, and a finer mesh would take more than the work allowed ({asked.seconds:g} s)",
        "stalled": f"finer meshes, up to {last.cells} triangles, no longer close it",
    }[found.ended]
    why += f"; it is widest near x = {x:.1f} m, z = {z:.1f} m." + "".join(f" {note}." for note in last.notes)
    if math.isfinite(found.gap):
        wish = f"The gap of {100 * found.gap:.2f} % is above the {100 * asked.gap:g} % asked for"
        return "wide", f"{wish}: {why}"
    bounds = (("lower", found.stress), ("upper", found.mechanism))
    return "no bracket", f"There is no {' and no '.join(name for name, bound in bounds if bound is None)} bound: {why}"


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
    reads=(
        "bounds", "fem.direction", "fem.flow", "fem.least_depth", "fem.safety_factor_at", "fem.sides", "fem.vertical",
    ),
    ignores=lambda given: () if given.bounds.safety_factor else ("fem.safety_factor_at",),
    beside=("fem",),
    seconds=lambda given: 15.0,
    results=(BoundsAnswer.FILE,),
    read=BoundsAnswer.read,
    pictures=("figures/bounds_*.png",),
    wanted=lambda given: given.bounds.run is not False,
)  # fmt: skip
