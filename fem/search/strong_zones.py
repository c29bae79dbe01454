"""Defines zones of the ground with so much cohesion that nothing fails there. The failure of one face of a structure is
then computed, and not an earlier failure elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from fem.continuum.face_reinforcement import strip_bottom
from meshes.section.polyline import Line
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.stratum import Stratum

ZONE_SUFFIX = ", strengthened from x = "  # between the name of the stratum and the start of the zone
COHESION_RATIO = 10.0  # of the largest overburden pressure: the additional cohesion of a strong zone
UNLIMITED_DEPTH = 1e6  # m: a depth below the base


@dataclass(frozen=True)
class StrongZone:
    """Holds a zone along the ground in which nothing fails.

    Attributes
    ----------
    start, end : both ends of the zone (m)
    depth : depth of the zone below the ground (m); ``UNLIMITED_DEPTH`` for the whole depth down to the base
    """

    start: float
    end: float
    depth: float = UNLIMITED_DEPTH


def with_strong_zones(section: Section, zones: Sequence[StrongZone]) -> Section:
    """Return the section with an additional cohesion, at which nothing fails, in zones that do not overlap.

    Loads, pore pressures and elastic stiffness stay the same. Failures that do not cut through a zone keep their
    critical Kh and factor of safety; all others are excluded. A zone may move as a rigid body.

    Parameters
    ----------
    section : the ground
    zones : zones in which nothing fails

    Returns
    -------
    The section with additional strata, without tension cut-off, and 10 times the largest overburden pressure as
    cohesion in addition to their own.
    """
    layers, strata = section.layering, section.strata
    heaviest = max(max(stratum.density_ordinary, stratum.density_seismic) for stratum in strata)
    height = float((layers.left[:, 0] - layers.left[:, -1]).max())
    added = COHESION_RATIO * GRAVITY * heaviest * height
    divided: list[Stratum] = []
    for k, soil in enumerate(strata):
        for zone in zones:
            points = strip_bottom(layers, zone.start, zone.end, k, zone.depth)
            if points:
                name = f"{soil.name}{ZONE_SUFFIX}{zone.start:.10g} m"
                change = {"cohesion": soil.cohesion + added, "tension": None}
                divided.append(soil.model_copy(update={"name": name, "bottom": Line(elevation=points), **change}))
        divided.append(soil)
    return section.with_strata(divided)
