"""Strengthens the ground just below the ends of surcharges on ground without cohesion, which has no bearing capacity at
these ends.

The bearing capacity of sand below a strip load comes from its weight alone, and is zero at the edge of the load
(Terzaghi 1943: γ B Nγ / 2 is the mean of a pressure that falls to zero at the edge). Therefore no stress field balances
the pressure of a surcharge that ends in a step, whatever Kh is, and there is no strict lower bound. Only a little sand
yields at the edge of the load. As below cohesionless faces, the ground within the least depth of the end of the load is
given an apparent cohesion, and carries the load with this cohesion. A larger failure that passes the end of the load
cuts through this strengthened ground.
"""

from collections.abc import Mapping

from fem.continuum.face_reinforcement import STRIP_SUFFIX, strip_bottom
from meshes.section.polyline import Line
from meshes.section.section import Section, Stratum

# Part of the name of ground around a point of the surface, between the name of its stratum and the x of the point.
POINT_SUFFIX = ", strengthened at x = "
# Cohesion over the pressure of the load. A strip load on weightless ground without friction fails at (2 + π) c (Prandtl
# 1920), so that this cohesion also resists a horizontal force of the load.
COHESION_SHARE = 0.5


def with_strengthened_load_ends(section: Section, least_depth: float) -> Section:
    """Return the section with an additional cohesion near the ends of surcharges on bare sand.

    Parameters
    ----------
    section : the ground
    least_depth : half of the width, and the depth, of the ground that is strengthened (m)

    Returns
    -------
    The strengthened section; ``section`` itself where no surcharge ends on bare ground without cohesion. The cohesion
    is half of the pressure of the load at its end.
    """
    cohesion: dict[float, float] = {}
    for number, x, _ in section.surface_loads.bare_ends():
        load = section.surcharges[number - 1]
        pressure = float(load.pressure[0 if x == load.start else 1])
        cohesion[x] = max(cohesion.get(x, 0.0), COHESION_SHARE * pressure)
    return with_cohesion_around(section, cohesion, least_depth)


def with_cohesion_around(section: Section, cohesion: Mapping[float, float], least_depth: float) -> Section:
    """Return the section with a cohesion (Pa) of ground without cohesion around points of the surface.

    Parameters
    ----------
    section : the ground
    cohesion : the cohesion (Pa) of each point by its x (m)
    least_depth : half of the width, and the depth, of the ground that is strengthened (m)

    Returns
    -------
    The strengthened section; ``section`` itself without points.
    """
    if not cohesion:
        return section
    left, right = section.extent
    strata: list[Stratum] = []
    for k, stratum in enumerate(section.strata):
        for x, strength in cohesion.items() if not stratum.has_cohesion else ():
            start, end = max(x - least_depth, left), min(x + least_depth, right)
            points = strip_bottom(section.layering, start, end, k, least_depth)
            if points:
                name, bottom = f"{stratum.name}{POINT_SUFFIX}{x:.10g} m", Line(elevation=points)
                strata.append(stratum.model_copy(update={"name": name, "bottom": bottom, "cohesion": strength}))
        strata.append(stratum)
    return section.with_strata(strata)


def soil_of_strip(name: str) -> str:
    """Return the name of the stratum from which strengthened ground was cut.

    Parameters
    ----------
    name : name of a stratum of a section that is strengthened below faces or around points of the surface

    Returns
    -------
    The name of the original stratum; ``name`` itself if the stratum is not strengthened.
    """
    for mark in (STRIP_SUFFIX, POINT_SUFFIX):
        name = name.rpartition(mark)[0] or name
    return name
