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
    """Holds a structure of the section file, or an embankment found in the ground surface.

    Attributes
    ----------
    name : name in the section file, or "embankment at x = … m"
    kind : kind in the section file; "levee" for an embankment of the ground surface
    crest : its crest and its feet
    """

    name: str
    kind: Kind
    crest: Crest

    def slides_with(self, surface: Sequence[tuple[float, float]]) -> bool:
        """Return whether a part of the crest may lie above a slip surface, whose points (m) go from left to right.

        The points of a slip surface are the middles of columns. The ground that moves ends somewhere between the last
        of them and the middle of the next column, which is at rest; two points are both ends of the ground that moves.
        """
        first, last = surface[0][0], surface[-1][0]
        if len(surface) > 2:
            first -= surface[1][0] - surface[0][0]
            last += surface[-1][0] - surface[-2][0]
        return first <= self.crest.right and last >= self.crest.left

    def slides_on(self, surface: Sequence[tuple[float, float]]) -> bool:
        """Return whether a part of the crest lies above a slip circle. A circle that ends at the edge of the crest has
        none above it: at a wall it lies in the ground before the wall."""
        return surface[0][0] < self.crest.right - EDGE and surface[-1][0] > self.crest.left + EDGE


def structures_of(section: Section) -> tuple[CrestedStructure, ...]:
    """Return the structures of a section with their crests.

    Parameters
    ----------
    section : the ground

    Returns
    -------
    The structures of the section file, in its order; if it has none, the embankments of the ground from left to right.
    """
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
    """Find the critical slip circle of one face of a structure, with which a part of the crest slides towards a side.

    Parameters
    ----------
    section : strata cut at the water, as `Section.parse` returns them
    structure : structure with its crest
    towards : LEFT or RIGHT, the side to which the face slides
    critical : critical circle of the section towards this side, which is also the circle of the face if a part of the
        crest slides with it; None if there is none
    kh : seismic coefficient (-) at which the factor of safety is sought; None to seek the least critical Kh
    least_depth : smallest depth of circles (m)
    vertical : vertical seismic coefficient (-), positive upwards
    crack : depth of the crack at which circles end, and the water in it

    Returns
    -------
    The circle; None if no part of the crest slides.
    """
    if critical is not None and structure.slides_on([(x, z) for x, z in critical.surface]):
        return critical
    crest = structure.crest.left, structure.crest.right
    return critical_circle(section, towards, kh, least_depth, vertical, crest, crack)
