"""Puts the faces of structures in one table: critical Kh and factor of safety by every method, displacements,
settlement."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.continuum.loads import sign_of
from workflow.config import Config
from workflow.estimates.comparison import block_slide
from workflow.estimates.slices import LEFT, RIGHT
from workflow.estimates.structures import structures_of
from workflow.report.faces_after import AfterLine, factors_after, strong_elsewhere
from workflow.report.structures import BEFORE_SHAKING, FaceRow, face_rows, smaller_kh
from workflow.results.cases import MovedSurface
from workflow.results.faces import FacesAnswer, FaceValue
from workflow.results.governing import (
    faces_with_bounds,
    governing_face_value,
    governing_value,
    section_factor_bounds,
    section_kh_bounds,
    value_of_face,
)
from workflow.results.results import Results
from workflow.results.slices import CirclePart

Side = Literal["left", "right"]
HALF_CREST_POINTS = 21  # points of half a crest, whose mean level settles
DIGITS_OF_KH = 3
STANDING_WATER = {"dam", "quay", "building"}  # kinds of structures beside a reservoir or a harbour
SMALLEST_SLIDE = 0.05  # m: less is written as 0


@dataclass(frozen=True)
class MethodValues:
    """Holds a critical Kh or factor of safety by every method: ψ = φ, and Davis's reduced strength where ψ < φ; and
    those of a face of a structure, by the method that counts for it."""

    elements: float | None = None
    davis: float | None = None
    lower: float | None = None
    upper: float | None = None
    circles: float | None = None
    davis_circles: float | None = None
    of_face: float | None = None
    davis_of_face: float | None = None

    @property
    def governing(self) -> float | None:
        """Return the value with ψ = φ that counts: the value by finite elements or, if this value lies beyond a strict
        bound, the bound; None without finite elements."""
        return None if self.elements is None else governing_value(self.elements, self.lower, self.upper)

    def pair(self, by: Literal["elements", "circles"], digits: int) -> tuple[str, str]:
        """Return the value with ψ = φ that counts, and the value with Davis's strength, as texts; empty if there is
        none."""
        values = (self.governing, self.davis) if by == "elements" else (self.circles, self.davis_circles)
        full, low = ("" if value is None else f"{value:.{digits}f}" for value in values)
        if by == "elements" and digits == DIGITS_OF_KH and self.davis is not None and self.davis <= 0.0:
            low = "< 0"  # it fails under its own weight
        return full, low

    def interval(self, digits: int) -> str:
        """Return the strict bounds as a text; empty without any."""
        if self.lower is None and self.upper is None:
            return ""
        low, high = ("–" if value is None else f"{value:.{digits}f}" for value in (self.lower, self.upper))
        return f"{low}–{high}"


@dataclass(frozen=True)
class FaceLine:
    """Holds one line of the table.

    Attributes
    ----------
    name : name of the structure, or place of a failure that belongs to no structure.
    side : side to which the face slides: "riverward" or "landward" with free water on one side, else "left" or "right".
    critical, safety : critical Kh, and factor of safety without shaking.
    block : slide (m) of a rigid block with the smaller critical Kh of slip circle and finite elements with ψ = φ, and
        in parentheses with Davis's strength; empty if there is none.
    slides, settles : slide of the face after liquefaction, and settlement of the half of the crest beside the face, by
        every method.
    after : factors of safety after shaking, and after liquefaction in each case.
    counts : whether the critical Kh of the face is the smallest of all faces.
    of_structure : whether the line is a face of a structure; a failure elsewhere is not.
    """

    name: str
    side: str
    critical: MethodValues
    safety: MethodValues
    block: str
    slides: tuple[str, ...]
    settles: tuple[str, ...]
    counts: bool
    of_structure: bool = True
    after: tuple[AfterLine, ...] = ()


def side_words(config: Config, start: float, end: float, towards: Side) -> str:
    """Return the side of a face of a structure in the section of ``config`` between its feet at ``start`` and ``end``
    (m). The side is called riverward or landward if water stands on one side, and towards the water if it is that of a
    dam, a quay or a building."""
    points, ground = config.section.water_points(), config.section.ground
    if points is None:
        return towards
    under = ground[np.interp(ground[:, 0], *points.T) > ground[:, 1] + 1e-6, 0]
    wet = {side for side, x in (("left", under[under <= start]), ("right", under[under >= end])) if len(x)}
    if len(wet) != 1:
        return towards
    if towards not in wet:
        return f"landward, {towards}"
    kinds = {item.kind for item in structures_of(config.section) if start <= item.crest.left <= item.crest.right <= end}
    return f"towards the water, {towards}" if kinds & STANDING_WATER else f"riverward, {towards}"


def face_lines(results: Results) -> list[FaceLine]:
    """Return the lines of all faces, and of a failure elsewhere that comes first; nothing without slip circles."""
    config, faces = results.config, faces_with_bounds(results)
    lines = [_line(results, row, faces) for row in face_rows(config, results.slices, faces)]
    return lines + list(_elsewhere(results)) if lines else []


def _line(results: Results, row: FaceRow, faces: FacesAnswer | None) -> FaceLine:
    face, config = row.face, results.config
    strength = faces.of(face.structure, face.towards) if faces is not None else None
    critical, safety = (None, None) if strength is None else (strength.critical, strength.safety)
    return FaceLine(
        name=face.structure,
        side=side_words(config, face.start_m, face.end_m, face.towards),
        critical=_strength(critical, row.kc, face.davis_critical),
        safety=_strength(safety, face.factor(0.0), face.davis_factor),
        block=_blocks(config, row, critical),
        slides=tuple(_slides(results, row)),
        settles=tuple(_settlements(results, row)),
        counts=row.counts,
        after=tuple(factors_after(results, row)),
    )


def _blocks(config: Config, row: FaceRow, elements: FaceValue | None) -> str:
    """Return the slides of rigid blocks as a text, with ψ = φ and with Davis's strength, each with the smaller critical
    Kh of slip circle and finite elements."""
    if row.block is None:
        return ""
    circle = row.face.davis_critical
    davis = smaller_kh(None if circle is None else circle.bishop, elements, davis=True)
    low = block_slide(config, davis) if davis is not None and davis > 0.0 else None
    return row.block.span + ("" if low is None else f" ({low.span})")


def _strength(value: FaceValue | None, circle: float | None, davis: CirclePart | None) -> MethodValues:
    of_face, by_elements = value_of_face(value, circle)
    low = None if davis is None else davis.bishop
    if value is None or not by_elements:
        return MethodValues(circles=circle, davis_circles=low, of_face=of_face, davis_of_face=low)
    return MethodValues(value.value, value.davis, value.lower, value.upper, circle, low, of_face, value.davis)


def _moved_surfaces(results: Results) -> Iterator[tuple[str, list[MovedSurface]]]:
    """Yield the slides by every method, over all cases of liquefaction."""
    cases, points = results.case_set()[1], results.mpm.cases if results.mpm is not None else {}
    if cases:
        yield "discs", [cases[number] for number in sorted(cases)]
    if points:
        yield "points", [points[number] for number in sorted(points)]


def _slides(results: Results, row: FaceRow) -> Iterator[str]:
    """Yield the largest slide of a face, with its half of the crest, towards its side by every method, over all cases
    of liquefaction."""
    face = row.face
    middle = 0.5 * (face.crest_m[0] + face.crest_m[1])
    start, end = (face.start_m, middle) if face.towards == "left" else (middle, face.end_m)
    falls = sign_of(results.config.section, "downhill") == (LEFT if face.towards == "left" else RIGHT)
    sign = 1.0 if falls else -1.0
    for method, cases in _moved_surfaces(results):
        values = []
        for case in cases:
            inside = case.slides_between(start, end)
            values += [max(float((sign * inside).max()), 0.0)] if len(inside) else []
        if values:
            yield f"{_spread(values)} {method}"


def _settlements(results: Results, row: FaceRow) -> Iterator[str]:
    """Yield the settlement of the half of the crest beside a face by every method, over all cases of liquefaction."""
    left, right = row.face.crest_m
    middle = 0.5 * (left + right)
    ends = (left, middle) if row.face.towards == "left" else (middle, right)
    x = np.linspace(*ends, HALF_CREST_POINTS)
    for method, cases in _moved_surfaces(results):
        values = []
        for case in cases:
            before, after = case.surfaces
            if len(before) and len(after):
                after = after[np.argsort(after[:, 0], kind="stable")]
                values.append(float(np.mean(np.interp(x, *before.T) - np.interp(x, *after.T))))
        if values:
            yield f"{_spread(values)} {method}"


def _spread(values: list[float]) -> str:
    low, high = (f"{0.0 if abs(value) < SMALLEST_SLIDE else value:.1f}" for value in (min(values), max(values)))
    return f"{low} m" if low == high else f"{low}–{high} m"


def _elsewhere(results: Results) -> Iterator[FaceLine]:
    """Yield the failure of the section by finite elements, if no crest is part of this failure."""
    fem, slices, config = results.fem, results.slices, results.config
    surface = [(float(x), float(z)) for x, z in results.slip_surface]
    if fem is None or slices is None or not fem.has_kc or results.no_answer("fem") is not None or not surface:
        return
    structures = structures_of(config.section)
    if any(structure.slides_with(surface) for structure in structures):
        return

    def is_this_failure(circle: CirclePart) -> bool:
        """Return whether a circle is the failure of the finite elements: it overlaps it, and slides with no crest."""
        line = circle.surface_m
        return _overlap(line, surface) and not any(structure.slides_on(line) for structure in structures)

    others = (None if other is None else other.kc for other in (fem.davis, fem.associated))
    full, low = _by_both_rules(fem.flow, fem.kc, *others)
    circle = next((c.bishop for c in slices.critical if c.towards == fem.towards and is_this_failure(c)), None)
    factor = next((f for f in fem.safety_factors if f.kh == 0.0 and _overlap(f.slip_surface, surface)), None)
    circles = [c for group in slices.factors if group.kh == 0.0 for c in group.circles if is_this_failure(c)]
    safety = MethodValues(circles=circles[0].bishop if circles else None)
    if factor is not None:
        results_of_rules = _by_both_rules(fem.flow, factor.factor, factor.davis, factor.associated)
        safety = MethodValues(*results_of_rules, *section_factor_bounds(results), safety.circles)
    yield FaceLine(
        name=f"x = {surface[0][0]:.0f} to {surface[-1][0]:.0f} m, no crest is part of this failure",
        side=fem.towards,
        critical=MethodValues(full, low, *section_kh_bounds(results, fem.towards), circle),
        safety=safety,
        block="",
        slides=(),
        settles=(),
        counts=False,
        of_structure=False,
    )


def _by_both_rules(
    flow: str, value: float | None, davis: float | None, associated: float | None
) -> tuple[float | None, float | None]:
    """Return an answer with ψ = φ and an answer with Davis's strength; ``value`` is the answer by the flow rule of the
    finite elements."""
    if flow == "associated":
        return value, davis
    return value if associated is None else associated, value


def _overlap(line: tuple[tuple[float, float], ...], surface: list[tuple[float, float]]) -> bool:
    """Return whether two slip surfaces overlap along x by more than half of the shorter surface."""
    if not line:
        return False
    shared = min(line[-1][0], surface[-1][0]) - max(line[0][0], surface[0][0])
    return shared > 0.5 * min(line[-1][0] - line[0][0], surface[-1][0] - surface[0][0])


def note_sentences(results: Results) -> Iterator[str]:
    """Yield sentences on the strong zones of the faces, values without an answer, and values left out of the table."""
    config, answer = results.config, results.faces
    for face in answer.faces if answer is not None else ():
        of = f"{face.structure}, towards the {face.towards}"
        values = {"critical Kh": face.critical, "factor of safety": face.safety}
        if (
            face.critical is not None
            and face.safety is not None
            and face.critical.strong_zones == face.safety.strong_zones
        ):
            values = {"critical Kh and factor of safety": face.critical}
        for what, value in values.items():
            if value is not None and value.strong_zones:
                where = " and ".join(
                    f"from x = {zone.start:.0f} to {zone.end:.0f} m"
                    + (f" down to {zone.depth:.1f} m" if zone.depth < 1e3 else "")
                    for zone in value.strong_zones
                )
                yield (
                    f"{what[0].upper()}{what[1:]} of {of}, by finite elements and bounds: the ground {where} is "
                    "taken as too strong to fail, because failures there come first."
                )
        for what, value in (("critical Kh", face.critical), ("factor of safety", face.safety)):
            if value is not None and not value.reaches_crest:
                yield (
                    f"{what[0].upper()}{what[1:]} of {of}: the finite elements fail at {value.value:.3g} first, in "
                    "ground that does not include a crest."
                )
        for reason in face.reasons:
            yield f"{of[0].upper()}{of[1:]}: no {reason.rstrip('.')}."
    yield from _beyond_bounds(face_lines(results))
    yield from strong_elsewhere(results)
    if config.section.water_pressure.rises_by_shaking:
        yield BEFORE_SHAKING
    if answer is None:
        reason = results.missing.get("faces", "")
        stage = next((stage for stage in results.stages if stage.name == "faces"), None)
        why = (stage.unwanted(config) if stage is not None else "") or reason or "the stage faces has no answer"
        yield f"Left out: finite elements and bounds of each face ({why})."
    elif not config.bounds.safety_factor:
        yield "Left out for their cost: strict bounds of factors of safety (bounds.safety_factor = true)."


def _beyond_bounds(lines: list[FaceLine]) -> Iterator[str]:
    """Yield a sentence on every value by finite elements that lies beyond a strict bound, which counts."""
    for line in lines:
        for quantity, values, digits in (("Critical Kh", line.critical, 3), ("Factor of safety", line.safety, 2)):
            if values.elements is not None and values.governing is not None and values.elements != values.governing:
                is_above = values.elements > values.governing
                side_words = "above the strict upper" if is_above else "below the strict lower"
                yield (
                    f"{quantity} of {line.name}, {line.side}: the finite elements give {values.elements:.{digits}f}, "
                    f"{side_words} bound, which counts."
                )


def faces_sentences(answer: FacesAnswer, results: Results | None = None) -> Iterator[str]:
    """Yield sentences on the critical Kh and the factor of safety of every face, as commands print them. A face that
    fails first has the bounds of the section, which are taken from the ``results``.
    """
    bounded = None if results is None else faces_with_bounds(results)
    for face in (bounded or answer).faces:
        phrases = []
        for name, value, digits in (("critical Kh", face.critical, 3), ("factor of safety", face.safety, 2)):
            if value is None:
                continue
            if not value.reaches_crest:
                phrases.append(
                    f"no {name}: with ψ = φ ground without the crest fails first, at {value.value:.{digits}f}"
                )
                continue
            low = "" if value.davis is None else f", {value.davis:.{digits}f} with Davis reduced strength"
            bounds = "" if value.lower is None or value.upper is None else (
                f", strict bounds {value.lower:.{digits}f} to {value.upper:.{digits}f}"
            )  # fmt: skip
            governing, bound_words = governing_face_value(value), ""
            if governing != value.value:
                end = "upper" if governing < value.value else "lower"
                bound_words = f" (the {end} bound counts: the finite elements give {value.value:.{digits}f})"
            phrases.append(f"{name} {governing:.{digits}f} with ψ = φ{low}{bounds}{bound_words}")
        reasons = [f"no {reason.rstrip('.')}" for reason in face.reasons]
        words = "; ".join([*phrases, *reasons]) or "no failure includes the crest"
        yield f"{face.structure}, towards the {face.towards}: {words}."
