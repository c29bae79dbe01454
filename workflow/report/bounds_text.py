"""Puts the strict bounds of fem/bounds.json into sentences of the console and the report."""

from collections.abc import Iterator, Sequence

from meshes.section.cutting import shown_name
from workflow.report.numbers import coefficient
from workflow.results.bounds import BoundsAnswer, SafetyPart
from workflow.results.continuum import FemAnswer, ShallowFailurePart


def edge_sentence(stratum: str, start: float, end: float, kh: float) -> str:
    """Return a sentence on the edge of a ``stratum`` without cohesion, from ``start`` to ``end`` (m), that fails
    locally at ``kh``."""
    width = f"{end - start:.2g} m wide where it comes out of the ground at x = {start:g} m"
    local = f"The edge of {shown_name(stratum)}, {width}, has no cohesion and fails locally {failing_at(kh)}"
    return f"{local}: this is no slope failure."


def face_words(stratum: str, start: float, end: float) -> str:
    """Return the shallow failure of the face of a stratum from ``start`` to ``end`` (m) in words."""
    return f"Shallow failure of the face of {shown_name(stratum)} from x = {start:g} to {end:g} m"


def failing_at(kh: float) -> str:
    """Return when a face fails: at a Kh, or by its own weight."""
    return f"at Kh = {coefficient(kh)}" if kh > 0.0 else "by its own weight"


def proven(faces: bool, load_ends: bool, water_exits: bool) -> str:
    """Return the name of bounds: of the ground as it is, or of ground with strengthened cohesionless ``faces`` or
    strengthened bare ground at ``load_ends`` and ``water_exits``."""
    places = {"the faces": faces, "the ends of loads": load_ends, "the points where water comes out": water_exits}
    strengthened = [place for place, is_strengthened in places.items() if is_strengthened]
    failures = "Bounds of failures below the cohesionless faces" if faces else "Bounds"
    return f"{failures} ({' and '.join(strengthened)} given a cohesion)" if strengthened else "Strict bounds"


def _is_known(factor: SafetyPart, reported: FemAnswer) -> bool:
    """Return whether the finite elements report the factor of the shallow failure of a ``factor`` with bounds."""
    at = {(item.kh, item.after_shaking): item.shallow_failure for item in reported.factors}
    known = at.get((factor.kh, factor.after_shaking))
    if known is None or factor.shallow_failure is None:
        return False
    return f"{known:.3f}" == f"{factor.shallow_failure:.3f}"


def _face_sentences(answer: BoundsAnswer, reported_faces: Sequence[ShallowFailurePart]) -> Iterator[str]:
    """Yield sentences on the shallow failures of faces, and on the depth of the failures of the bounds."""
    reported = {(face.stratum, face.start_x_m, face.end_x_m, failing_at(face.kh)) for face in reported_faces}
    for face in answer.shallow_failures:
        if (face.stratum, face.start, face.end, failing_at(face.kh)) in reported:
            continue
        if face.is_edge(answer.least_depth):
            yield edge_sentence(face.stratum, face.start, face.end, face.kh)
            continue
        yield f"{face_words(face.stratum, face.start, face.end)} {failing_at(face.kh)}."
    if any(not face.is_edge(answer.least_depth) for face in answer.shallow_failures):
        yield f"The bounds below are for failures deeper than {answer.least_depth:g} m."


def bounds_sentences(answer: BoundsAnswer, reported: FemAnswer | None = None) -> Iterator[str]:
    """Yield sentences on the strict bounds of fem/bounds.json, and the shallow failures of faces before them, except
    those of the finite elements that are ``reported`` already."""
    yield from _face_sentences(answer, () if reported is None else reported.shallow_failures)
    if answer.shallow is not None:
        when = f"at Kh of {answer.shallow:.3f} or less" if answer.shallow > 0.0 else "by its own weight"
        water = "water seeps out of bare ground or stands close below"
        place_words = "two cohesionless faces meet" if answer.shallow_failures else water
        yield (
            f"Where {place_words}, ground less than {answer.least_depth:g} m deep slips {when}: this ground requires "
            "cohesion, or protection."
        )
    ends = bool(answer.load_ends)
    if ends:
        place_words = ", ".join(f"{x:g}" for x in answer.load_ends)
        yield (
            f"Sand without cohesion has no bearing capacity below the end of a load next to bare ground (x = "
            f"{place_words} m). In elements and bounds, this sand has a cohesion of half the pressure of the load, "
            f"down to {answer.least_depth:g} m."
        )
    exits = bool(answer.water_exits)
    if exits:
        place_words = ", ".join(f"{x:g}" for x in answer.water_exits)
        yield (
            f"Where water comes out of a face without cohesion (x = {place_words} m), a small part of the sand is at "
            f"its limit before the slope is. In the bounds below, the sand within {answer.least_depth:g} m has an "
            "apparent cohesion."
        )
    name = proven(answer.strengthened_faces, ends, exits)
    yield f"{name} with ψ = φ (the upper bound holds for every ψ ≤ φ): {answer.description}."
    if answer.verdict != "bracketed":
        yield answer.reason
    for factor in answer.factors:
        name_of_factor = proven(factor.shallow_failure is not None, ends, False)
        known = reported is not None and _is_known(factor, reported)
        words = factor.bracket_words if known else factor.description
        yield f"{name_of_factor} for the factor of safety, ψ = φ: {words}."
        if factor.reason:
            yield factor.reason
    if answer.substitute:
        yield f"{name} of Davis's estimate for ψ < φ: {answer.substitute.description}."
        if answer.substitute.verdict != "bracketed":
            yield answer.substitute.reason
