"""Finds the structures of a section with their crests, and the slip circles of each of their faces."""

from collections.abc import Sequence
from dataclasses import dataclass

from meshes.section.section import Section
from meshes.section.structure import Kind
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.crest import Crest, crest_between, embankments
from workflow.estimates.slip_circles import NO_CRACK, SlipCircle, critical_circle

EDGE = 1e-6  # m, up to which the end of a slip circle lies at the edge of a crest


@dataclass(frozen=True)
class CrestedStructure:
    """Holds a structure of the section file, or an embankment found in the ground surface, with its crest."""

    name: str
    kind: Kind
    crest: Crest

    def slides_with(self, surface: Sequence[tuple[float, float]]) -> bool:
        """Return whether a part of the crest lies above a slip surface, whose points (m) go from left to right.

        The points of a slip surface are the middles of columns, which reach half a column farther; two points are both
        ends of the ground that moves.
        """
        first, last = surface[0][0], surface[-1][0]
        if len(surface) > 2:
            first -= 0.5 * (surface[1][0] - surface[0][0])
            last += 0.5 * (surface[-1][0] - surface[-2][0])
        return first <= self.crest.right and last >= self.crest.left

    def slides_on(self, surface: Sequence[tuple[float, float]]) -> bool:
        """Return whether a part of the crest lies above a slip circle. A circle that ends at the edge of the crest has
        none above it: at a wall it lies in the ground before the wall."""
        return surface[0][0] < self.crest.right - EDGE and surface[-1][0] > self.crest.left + EDGE


def structures_of(section: Section) -> tuple[CrestedStructure, ...]:
    """Return the structures of a section: the structures in the section file or, if it has none, the embankments found
    in the ground surface."""
    ground = section.ground
    if section.structures:
        return tuple(
            CrestedStructure(structure.name, structure.kind, crest_between(ground, structure.start, structure.end))
            for structure in section.structures
        )
    return tuple(
        CrestedStructure(f"embankment at x = {0.5 * (crest.left + crest.right):.0f} m", "levee", crest)
        for crest in embankments(ground)
    )


def face_circle(
    section: Section,
    structure: CrestedStructure,
    towards: int,
    critical: SlipCircle | None,
    kh: float | None,
    least_depth: float,
    vertical: float,
    crack: TensionCrack = NO_CRACK,
) -> SlipCircle | None:
    """Find the critical slip circle of one face of a structure, which is a circle ``towards`` a side with which a part
    of the crest slides.

    ``critical`` is the critical circle of the ``section`` towards this side; it is also the circle of the face if a
    part of the crest slides with it. The other arguments, ``kh``, ``least_depth``, ``vertical`` and ``crack``, are
    those of `critical_circle`.
    """
    if critical is not None and structure.slides_on([(x, z) for x, z in critical.surface]):
        return critical
    crest = structure.crest.left, structure.crest.right
    return critical_circle(section, towards, kh, least_depth, vertical, crest, crack)
