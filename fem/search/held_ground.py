"""Ground that is held in places, so that the failure of one face of a structure is found and not an earlier one
elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from fem.continuum.shallow_failure import strip_bottom
from meshes.section.polyline import Line
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.stratum import Stratum

HELD = ", held from x = "  # what the name of held ground has behind that of its stratum
TIMES = 10.0  # of the largest overburden pressure: the cohesion that held ground has in addition
ALL = 1e6  # m: a depth below the base


@dataclass(frozen=True)
class Held:
    """A stretch of the ground in which nothing fails.

    Attributes
    ----------
    start, end : float
        Its ends (m).
    depth : float
        Its depth below the ground (m); ``ALL`` down to the base.
    """

    start: float
    end: float
    depth: float = ALL


def with_held_ground(section: Section, stretches: Sequence[Held]) -> Section:
    """The section with an additional cohesion, at which nothing fails, in stretches that do not overlap.

    Loads, pore pressures and elastic stiffness stay the same. Failures that do not cut through held ground keep their
    critical Kh and factor of safety; all others are excluded. Held ground may move as a rigid body.

    Parameters
    ----------
    section : Section
        The ground.
    stretches : sequence of Held
        Where it is held.

    Returns
    -------
    Section
    """
    layers, strata = section.layering, section.strata
    heaviest = max(max(stratum.density_ordinary, stratum.density_seismic) for stratum in strata)
    height = float((layers.left[:, 0] - layers.left[:, -1]).max())
    added = TIMES * GRAVITY * heaviest * height
    divided: list[Stratum] = []
    for k, soil in enumerate(strata):
        for held in stretches:
            points = strip_bottom(layers, held.start, held.end, k, held.depth)
            if points:
                name = f"{soil.name}{HELD}{held.start:.10g} m"
                change = {"cohesion": soil.cohesion + added, "tension": None}
                divided.append(soil.model_copy(update={"name": name, "bottom": Line(elevation=points), **change}))
        divided.append(soil)
    return section.with_strata(divided)
