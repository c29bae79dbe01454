"""Makes the table of the faces of structures, one row each: factor of safety, critical Kh and the slide of a block."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from workflow.config import Config
from workflow.estimates.comparison import BlockSlide, block_slide
from workflow.estimates.structures import structures_of
from workflow.results.faces import FacesAnswer, FaceValue
from workflow.results.governing import governing_face_value
from workflow.results.slices import FacePart, SlicesAnswer
from workflow.texts.report_texts import listed

# Said of faces where shaking raises the pore pressure, which acts with Kh alone.
BEFORE_SHAKING = (
    "Factors of safety of the faces are those before shaking, without its excess pore pressure, which acts with Kh."
)


@dataclass(frozen=True)
class FaceRow:
    """Holds one face: its factors of safety at each Kh and its critical Kh by slices, and the critical Kh and
    the slide of a rigid block."""

    face: FacePart
    factors: tuple[tuple[float, float | None], ...]
    kc: float | None
    block_kh: float | None
    block: BlockSlide | None
    counts: bool  # whether its critical Kh, by slip circles or by finite elements, is the smallest of all faces

    @property
    def name(self) -> str:
        """Return the structure, and the side to which the face slides."""
        return f"{self.face.structure}, towards the {self.face.towards}"

    @property
    def description(self) -> str:
        """Return the row as a sentence without its full stop."""
        if self.face.reason:
            return f"{self.name}: {self.face.reason}"
        phrases = [f"factor of safety {value:.2f} at Kh = {kh:g}" for kh, value in self.factors if value is not None]
        phrases += [] if self.kc is None else [f"critical Kh {self.kc:.3f}"]
        phrases += [] if self.block is None else [f"a rigid block slides {self.block.span} ({self.block.description})"]
        return f"{self.name}: {listed(phrases)}"


def face_rows(config: Config, answer: SlicesAnswer | None, elements: FacesAnswer | None = None) -> list[FaceRow]:
    """Return all faces of all structures; none without slices. The block of a face has the critical Kh of its slip
    circle, or that of its finite ``elements`` if it is smaller."""
    faces = answer.faces if answer is not None else ()
    rows: list[FaceRow] = []
    for face in faces:
        kc = None if face.critical is None else face.critical.bishop
        factors = tuple((group.kh, face.factor(group.kh)) for group in face.factors)
        strength = elements.of(face.structure, face.towards) if elements is not None else None
        block_kh = smaller_kh(kc, strength.critical if strength is not None else None)
        block = None if block_kh is None or block_kh <= 0.0 else block_slide(config, block_kh)
        rows.append(FaceRow(face, factors, kc, block_kh, block, False))
    least = min((row.block_kh for row in rows if row.block_kh is not None), default=None)
    return [replace(row, counts=least is not None and row.block_kh == least) for row in rows]


def smaller_kh(circle: float | None, value: FaceValue | None, davis: bool = False) -> float | None:
    """Return the smaller critical Kh of a face by its slip ``circle`` and by finite elements, with ψ = φ or by Davis's
    estimate; None without a circle."""
    if circle is None or value is None or not value.reaches_crest:
        return circle
    kh = value.davis if davis else governing_face_value(value)
    return circle if kh is None else min(circle, kh)


def structure_sentences(config: Config, answer: SlicesAnswer) -> Iterator[str]:
    """Yield sentences on every face of a structure, on the face that governs, and on failures away from the
    structures."""
    rows = face_rows(config, answer)
    for row in rows:
        yield f"{row.description}."
    for row in rows:
        if row.counts and sum(other.kc is not None for other in rows) > 1:
            yield f"The smallest counts: {row.name}."
    yield from circles_without_crest(config, answer)
    if rows and config.section.water_pressure.rises_by_shaking:
        yield BEFORE_SHAKING


def circles_without_crest(config: Config, answer: SlicesAnswer | None) -> Iterator[str]:
    """Yield the critical slip circles of the section that do not reach a crest."""
    if answer is None or not answer.faces:
        return
    structures = structures_of(config.section)
    at_rest = [("factor of safety at Kh = 0", slip, 2) for group in answer.factors[:1] for slip in group.circles]
    for quantity, circle, digits in [*at_rest, *(("critical Kh", slip, 3) for slip in answer.critical)]:
        if not any(structure.slides_on(circle.surface_m) for structure in structures):
            yield (
                f"Elsewhere, from x = {circle.surface_m[0][0]:.0f} to {circle.surface_m[-1][0]:.0f} m towards the "
                f"{circle.towards}, {quantity} is {circle.bishop:.{digits}f}: no crest is part of this failure."
            )
