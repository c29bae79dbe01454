"""Defines the stage `bounds`: strict bounds of the critical seismic coefficient, their file and their pictures."""

import math
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, assert_never

from fem.errors import UnstableError
from fem.settings import LEAST_KH, BoundsSettings
from meshes.errors import NoAnswerError
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.answer import FORCE, SectionLabel, way_out
from workflow.results.bounds import (
    BoundsAnswer,
    BoundsRound,
    BoundsVerdict,
    BracketPart,
    DirectionPart,
    Residuals,
    SafetyPart,
    ShallowBoundPart,
    StressResiduals,
    VelocityResiduals,
)
from workflow.run.stage import Job, Stage
from workflow.run.store import Store

if TYPE_CHECKING:
    from fem.limit.bounds import KhBounds
    from fem.limit.bracket import Bracket, EndReason, OpenEnd
    from fem.limit.directions import DirectionBounds, SmallerKhBounds
    from fem.limit.safety_bounds import SafetyBounds


class NoBracketError(NoAnswerError):
    """One of the strict bounds is missing. The finite elements may have an answer all the same."""

    MISSING = "No strict bounds"


def work(job: Job) -> None:
    """Compute strict bounds of the critical Kh, with ψ = φ and by Davis's estimate; writes fem/bounds.json,
    figures/bounds_*.png.

    The verdict is "bracketed", "wide" (the gap is larger than required), "no bracket" (a bound is missing), or
    "unstable" (the upper bound is below 0). Raises InputError, BadMeshError, and, when all is written, UnstableError if
    the section is proven to fail without a seismic force, and NoAnswerError if a bound is missing.
    """
    from fem.continuum.loads import ADVICE_ON_UPLIFT
    from fem.limit.bounds import ProvenUnstableError, kh_bounds

    config, settings = job.config, job.config.bounds
    started = time.perf_counter()
    job.progress("first mesh", None)
    # Kh with ψ = φ and with Davis's estimate may take as much as each factor of safety.
    of_kh = settings.model_copy(update={"seconds": 2.0 * settings.seconds / (2 + len(_factor_places(config)))})
    failure = None
    try:
        bounds = kh_bounds(config.section, config.fem, of_kh, lambda so_far: job.progress(in_words(so_far), None))
    except ProvenUnstableError as error:
        bounds, failure = error.bounds, error
    factors, after_shaking = _factors(job, settings, bounds, is_start=failure is None)
    answer = answer_of(config, bounds, settings, time.perf_counter() - started)
    answer = answer.model_copy(update={"safety": factors, "after_shaking": after_shaking})
    answer.write(job.store)
    job.executor.submit(_draw, config, bounds, job.store).result()  # where the pictures of the stage before were drawn
    if failure is not None:
        parts = (*factors, *([after_shaking] if after_shaking is not None else []))
        raise UnstableError("; ".join([str(failure), *(part.description for part in parts)]))
    if answer.verdict == "no bracket":
        uplift = config.section.uplift
        why, remedy = "", _remedy(bounds.end_reason)
        if uplift is not None and bounds.stress is None:  # as a rule there is none, however fine the triangles
            why, remedy = f". {uplift.description[0].upper()}{uplift.description[1:]}", ADVICE_ON_UPLIFT
        raise NoBracketError(answer.reason.rstrip(".") + why, remedy)


def _draw(config: Config, bounds: "KhBounds", store: Store) -> None:
    """Draw the pictures of the bounds."""
    from workflow.figures.bounds import draw_all

    draw_all(config, bounds, store)


def _factor_places(config: Config) -> list[tuple[Section, float]]:
    """Return the sections and Kh of which factors of safety are wanted: that of the file at every Kh of the settings
    and, last, the section after shaking if it has excess pore pressure."""
    if not config.bounds.safety_factor:
        return []
    places = [(config.section, kh) for kh in config.fem.safety_factor_at]
    if config.section.water_pressure.rises_by_shaking and 0.0 in config.fem.safety_factor_at:
        places.append((config.section.after_shaking(), 0.0))
    return places


def _factors(
    job: Job, settings: BoundsSettings, of_kh: "KhBounds", is_start: bool
) -> tuple[tuple[SafetyPart, ...], SafetyPart | None]:
    """Return the factors of safety at every Kh of the settings, and the one after shaking, if they are wanted. All
    factors share the computing work that the search for the bounds ``of_kh`` did not use. If these bounds are a start
    (``is_start``), the searches begin on their triangles. Without shaking, sides that are not fixed are held
    horizontally, as in the finite elements.
    """
    from fem.limit.safety_bounds import safety_bounds

    config, known = job.config, of_kh if is_start else None
    places, parts = _factor_places(config), list[SafetyPart]()
    left = settings.seconds - of_kh.work
    for position, (section, kh) in enumerate(places):
        job.progress(f"factor of safety at Kh = {kh:g}{'' if section is config.section else ', after shaking'}", None)
        share = settings.of_factors.model_copy(update={"seconds": max(left, 0.0) / (len(places) - position)})
        bounds = safety_bounds(section, config.fem, share, kh, smooth_sides=kh == 0.0, known=known)
        left -= sum(trial.work for trial in bounds.trials)
        parts.append(
            SafetyPart(
                kh=kh,
                lower=bounds.lower or None,
                upper=bounds.upper if math.isfinite(bounds.upper) else None,
                cells=bounds.cells,
                shallow_failure=bounds.shallow_failure,
                direction=bounds.direction,
                after_shaking=section is not config.section,
                reason=_reason(bounds, settings),
                work=sum(trial.work for trial in bounds.trials),
            )
        )
    at_kh = tuple(part for part in parts if not part.after_shaking)
    return at_kh, next((part for part in parts if part.after_shaking), None)


def _reason(bounds: "SafetyBounds", settings: BoundsSettings) -> str:
    """Return why the bounds of a factor of safety are not closer, or one is missing; empty if the gap is small
    enough."""
    match bounds.end_reason:
        case "gap":
            return ""
        case "range":
            return "The search ended there."
        case "triangles":
            why = f"{bounds.cells} triangles, {settings.max_cells} allowed"
        case "time":
            why = f"the share of the allowed computing work ({settings.seconds:g} s) is used up"
        case "solver":
            why = f"the solver of cone programs fails with up to {bounds.cells} triangles"
        case _:
            assert_never(bounds.end_reason)
    missing = [name for name, proven in (("lower", bounds.lower > 0.0), ("upper", math.isfinite(bounds.upper)))
               if not proven]  # fmt: skip
    if missing:
        return f"There is no {' and no '.join(missing)} bound of the factor of safety: {why}."
    wanted = f"{100 * settings.of_factors.gap:g} %"
    return f"The bounds of the factor of safety are wider than the required {wanted}: {why}."


def answer_of(config: Config, bounds: "KhBounds", settings: BoundsSettings, seconds: float) -> BoundsAnswer:
    """Return the answer: brackets, residuals of the bounds, and every mesh; ``seconds``: computing time.

    ``config``: config of the run; ``bounds``: result of the analysis; ``settings``: settings of the bounds.
    """
    from fem.continuum.shallow_failure import merged_faces

    return BoundsAnswer(
        **vars(bracket_part(bounds, settings)),
        section=SectionLabel.of(config.section),
        flow="associated, ψ = φ",
        substitute=bracket_part(bounds.substitute, settings) if bounds.substitute else None,
        shallow_failures=tuple(ShallowBoundPart.model_validate(face) for face in merged_faces(bounds.shallow_failures)),
        shallow=bounds.shallow,
        load_ends=tuple(sorted({x for _, x, _ in config.section.surface_loads.bare_ends()})),
        water_exits=bounds.water_exits,
        least_depth=config.fem.least_depth,
        sides=config.fem.sides,
        vertical=config.fem.vertical,
        seconds=round(seconds, 2),
        settings=settings,
    )


def bracket_part(bounds: "SmallerKhBounds", settings: BoundsSettings) -> BracketPart:
    """Return one bracket of bounds in the form of the stored answer."""
    verdict, reason = _verdict(bounds, settings)
    directions = tuple(_direction_part(direction) for direction in bounds.directions)
    return BracketPart(
        lower=bounds.stress.multiplier if bounds.stress else None,
        upper=bounds.mechanism.multiplier if bounds.mechanism else None,
        direction=directions[0].direction,
        directions=directions,
        gap=bounds.gap if math.isfinite(bounds.gap) else None,
        verdict=verdict,
        reason=reason,
        description="; ".join(
            [in_words(bounds) + way_out(directions[0].leaves), *(direction.description for direction in directions[1:])]
        ),
        cells=bounds.meshes[-1].cells,
        residuals=Residuals(
            lower=StressResiduals.model_validate(bounds.stress.check) if bounds.stress else None,
            upper=VelocityResiduals.model_validate(bounds.mechanism.check) if bounds.mechanism else None,
        ),
        history=directions[0].history,
    )


def _direction_part(bounds: "DirectionBounds") -> DirectionPart:
    return DirectionPart(
        direction=bounds.direction,
        towards=bounds.towards,
        lower=bounds.stress.multiplier if bounds.stress else None,
        upper=bounds.mechanism.multiplier if bounds.mechanism else None,
        leaves=bounds.leaves,
        history=tuple(BoundsRound.model_validate(mesh) for mesh in bounds.meshes),
    )


def _verdict(bracket: "Bracket", settings: BoundsSettings) -> tuple[BoundsVerdict, str]:
    gap = f"The gap of {_gap(bracket)}"
    if bracket.upper < 0.0 or bracket.end_reason == "enough":
        limit = f": the critical Kh is at most {bracket.upper:.4f}" if bracket.upper > -1.0 else ""
        return "unstable", f"The section fails under its own weight{limit}."
    if bracket.end_reason == "gap":
        return "bracketed", f"{gap} is within the required {_required_gap(bracket, settings)}."
    last = bracket.meshes[-1]
    x, z = bracket.open_at or (math.nan, math.nan)
    why = (
        f"{_end_reason(bracket.end_reason, last.cells, settings)}; the gap is widest near x = {x:.1f} m, z = {z:.1f} m."
    )
    if math.isfinite(bracket.gap):
        why += _notes_of_last_mesh(bracket)
        return "wide", f"{gap} is above the required {_required_gap(bracket, settings)}: {why}"
    why += _sentences(last.notes)
    bounds = (("lower", bracket.stress), ("upper", bracket.mechanism))
    missing = " and no ".join(name for name, bound in bounds if bound is None)
    return "no bracket", f"There is no {missing} bound: {why}{''.join(_bracketed_directions(bracket))}"


def _sentences(notes: Sequence[str]) -> str:
    return "".join(f" {note[0].upper()}{note[1:]}." for note in notes)


def _notes_of_last_mesh(bracket: "Bracket") -> str:
    """Return the notes of the last mesh as sentences, after a blank; a bound that this mesh did not give is that of a
    coarser mesh, and holds."""
    last = bracket.meshes[-1]
    missing = [side for side, bound in (("lower", last.lower), ("upper", last.upper)) if bound is None]
    if not missing:
        return _sentences(last.notes)
    stated = f"The {missing[0]} bound is that" if len(missing) == 1 else "The bounds are those"
    return f" {stated} of a coarser mesh. On the last mesh: {'; '.join(last.notes)}."


def _bracketed_directions(bracket: "Bracket") -> Iterator[str]:
    """Yield a sentence, after a blank, on each direction that has both bounds, if the smaller Kh of all directions has
    not."""
    for direction in getattr(bracket, "directions", ()):
        if direction.stress is not None and direction.mechanism is not None:
            yield (
                f" With the seismic force {FORCE[direction.direction]} the critical Kh is bounded: "
                f"{direction.lower:.4f} <= Kh <= {direction.upper:.4f}."
            )


def _gap(bracket: "Bracket") -> str:
    """Return the gap of the bounds as a share of their mean, or as a difference of Kh if the mean is small or zero lies
    between them.
    """
    difference = f"{bracket.upper - bracket.lower:.4f} in Kh"
    if bracket.lower * bracket.upper <= 0.0:
        return difference
    small = 0.5 * (bracket.upper + bracket.lower) < LEAST_KH
    return f"{difference} ({100 * bracket.gap:.1f} %)" if small else f"{100 * bracket.gap:.2f} %"


def _required_gap(bracket: "Bracket", settings: BoundsSettings) -> str:
    """Return in words the required gap of the bounds: as a share of Kh, or for small Kh as a difference of Kh."""
    small = 0.5 * (abs(bracket.upper) + abs(bracket.lower)) < LEAST_KH
    return f"{settings.gap * LEAST_KH:.4f} in Kh" if small else f"{100 * settings.gap:g} %"


def _end_reason(ended: "OpenEnd | None", cells: int, settings: BoundsSettings) -> str:
    """Return the reason why there is no finer mesh although the gap is larger than required."""
    from fem.limit.bracket import FAILED_MESHES

    match ended:
        case None:
            return f"{cells} triangles, and the other direction fails first"
        case "triangles":
            return f"{cells} triangles, {settings.max_cells} allowed"
        case "time":
            return (
                f"{cells} triangles, and a finer mesh would take more than the allowed computing work "
                f"({settings.seconds:g} s)"
            )
        case "stalled":
            return f"finer meshes, up to {cells} triangles, no longer reduce the gap"
        case "solver":
            return f"the solver of cone programs failed on the last {FAILED_MESHES} meshes, up to {cells} triangles"
    assert_never(ended)


def _remedy(ended: "EndReason | None") -> str:
    """Return advice on what may help if a bound is missing."""
    match ended:
        case "time":
            return "allow more: seconds in the table [bounds]"
        case None | "triangles" | "gap" | "enough":
            return "allow more: max_cells in the table [bounds]"
        case "stalled" | "solver":
            return "more work does not help: rely on the finite elements (noshiro fem)"
    assert_never(ended)


def in_words(bounds: "SmallerKhBounds") -> str:
    """Return the bracket in words."""
    if bounds.mechanism and bounds.upper < -1.0:  # no seismic force of that size is meant
        return f"it fails under its own weight, {bounds.meshes[-1].cells} triangles"
    low = f"{bounds.lower:.4f}" if bounds.stress else "no lower bound"
    high = f"{bounds.upper:.4f}" if bounds.mechanism else "no upper bound"
    gap = f", gap {_gap(bounds)}" if math.isfinite(bounds.gap) else ""
    first = bounds.directions[0]
    to = f"force {FORCE[first.direction]} (to the {first.towards})"
    return f"{low} <= Kh <= {high}{gap}, {to}, {bounds.meshes[-1].cells} triangles"


STAGE = Stage(
    name="bounds",
    description="strict bounds of the critical Kh",
    work=work,
    reads=(
        "bounds", "fem.direction", "fem.flow", "fem.least_depth", "fem.safety_factor_at", "fem.sides", "fem.vertical",
    ),
    ignores=lambda config: ("bounds.run", *(() if config.bounds.safety_factor else ("fem.safety_factor_at",))),
    adds=("bounds.safety_factor", "fem.safety_factor_at"),
    concurrent_after=("fem",),
    results=(BoundsAnswer.FILE,),
    read=BoundsAnswer.read,
    pictures=("figures/bounds_*.png",),
    unwanted=lambda config: "bounds.run is false" if config.bounds.run is False else "",
)  # fmt: skip
