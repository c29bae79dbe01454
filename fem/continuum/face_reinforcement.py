"""Gives cohesionless faces an apparent cohesion down to the least depth, so that they do not fail alone.

Where the shallow failure of a face (`shallow_failure`) governs, any other failure then lies below the strengthened
ground, or cuts through it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from fem.continuum.shallow_failure import ShallowFailure
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.cutting import BELOW_WATER
from meshes.section.layering import Layering
from meshes.section.polyline import Line
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum

# Part of the name of a strip between the name of its stratum and the x of its start.
STRIP_SUFFIX = ", strengthened face at x = "
# Two shares of the length of a stretch of the ground are equal within this difference.
SHARE_TOLERANCE = 1e-9


def strengthened(section: Section, faces: Sequence[ShallowFailure], settings: FemSettings) -> Section:
    """Return the section in which the ground below faces, down to the least depth, is strengthened by a cohesion.

    The section gets additional strata, with the soil of the face and an apparent cohesion Δγ d sin 2β / (2 cos² φ) with
    Δγ = γ - Kv γs and d the least depth, vertically. With this cohesion they resist Kh = (γ / γs - Kv) tan φ, at which
    the same sand would fail on level ground. The cohesion goes to zero with the inclination: a depth of 0.5 m of dry
    sand with φ = 33° at 1:3 gets 3.7 kPa. A stratum that is nowhere thicker than the least depth gets this cohesion as
    a whole.

    Parameters
    ----------
    section : the ground
    faces : faces of the section, as `shallow_failures` returns them
    settings : settings of the finite elements, with the least depth (m)

    Returns
    -------
    The strengthened section; names of additional strata are those of their soils and `STRIP_SUFFIX` with the x of the
    face.
    """
    strata: list[Stratum] = []
    for k, stratum in enumerate(section.strata):
        for face in faces:
            strata += _strip(section, face, k, settings)
        strata.append(stratum)
    return section.with_strata(strata)


def cohesion_of_stratum(section: Section, face: ShallowFailure, k: int, depth: float) -> float | None:
    """Return the apparent cohesion of a stratum below a face, above or below water.

    Parameters
    ----------
    section : the ground
    face : a cohesionless face
    k : number of the stratum
    depth : depth down to which the ground is strengthened (m)

    Returns
    -------
    The cohesion (Pa) of `apparent_cohesion`; None for strata of another soil than that of the face.
    """
    soil = section.strata[k]
    if soil.name not in (face.stratum, face.stratum + BELOW_WATER):
        return None
    of_face = next(stratum for stratum in section.strata if stratum.name == face.stratum)
    return apparent_cohesion(face, of_face, soil.friction_angle, depth)


def apparent_cohesion(face: ShallowFailure, soil: Stratum, friction: float, depth: float) -> float:
    """Return the cohesion with which the ground below a face does not fail alone: that of `strengthened`.

    Parameters
    ----------
    face : a cohesionless face
    soil : stratum of the face
    friction : friction angle of the ground that is strengthened (rad)
    depth : depth down to which the ground is strengthened (m)

    Returns
    -------
    The cohesion (Pa), at least 0.
    """
    weight = GRAVITY * face.ratio * soil.density_seismic
    return max(float(weight * depth * np.sin(2.0 * face.angle) / (2.0 * np.cos(friction) ** 2)), 0.0)


def without_strips(mesh: QuadMesh, section: Section) -> QuadMesh:
    """Return a mesh of a strengthened section with the stratum numbers of the section without strengthening.

    Parameters
    ----------
    mesh : a mesh of the strengthened section
    section : the section without strengthening

    Returns
    -------
    The same cells; those of additional strata have the stratum from which these were cut.
    """
    names = [stratum.name for stratum in section.strata]
    stratum_of = [names.index(name if name in names else name.rpartition(STRIP_SUFFIX)[0]) for name in mesh.strata]
    return replace(mesh, stratum=np.array(stratum_of)[mesh.stratum], strata=tuple(names))


def _strip(section: Section, face: ShallowFailure, k: int, settings: FemSettings) -> Iterator[Stratum]:
    """Yield the outlines of the ground of stratum k below a face, down to the least depth or to the bottom of the
    stratum; nothing if there is no such ground, or if it is of another soil."""
    cohesion = cohesion_of_stratum(section, face, k, settings.least_depth)
    if cohesion is None:
        return
    points = strip_bottom(section.layering, face.start, face.end, k, settings.least_depth)
    if points:
        soil = section.strata[k]
        yield soil.model_copy(
            update={
                "name": f"{soil.name}{STRIP_SUFFIX}{face.start:.10g} m",
                "bottom": Line(elevation=points),
                "cohesion": cohesion,
            }
        )


def strip_bottom(layers: Layering, start: float, end: float, k: int, depth: float) -> list[list[float]]:
    """Return the bottom of a strip of one stratum from the ground surface down to a depth.

    Parameters
    ----------
    layers : layers of the section
    start, end : ends of the strip, start < end (m)
    k : number of the stratum
    depth : vertical depth below the ground (m)

    Returns
    -------
    Points [x, elevation] (m) from left to right: at the depth where the stratum contains it, else at the top or the
    bottom of the stratum; empty if the stratum has no ground above the depth.
    """
    x = np.unique(np.concatenate([[start, end], layers.x]))
    x = x[(x >= start) & (x <= end)]
    points: list[list[float]] = []
    is_thicker = False
    for start, end in pairwise(x):
        x_of_ends = np.array([start, end])
        ground, top, bottom = layers.interfaces(x_of_ends, near=np.full(2, x_of_ends.mean()))[:, [0, k, k + 1]].T
        shares = {0.0, 1.0}
        for line in (top, bottom):  # where the least depth crosses it
            excess_depth = ground - depth - line
            if excess_depth[0] * excess_depth[1] < 0.0:
                shares.add(float(excess_depth[0] / (excess_depth[0] - excess_depth[1])))
        inner = {part for part in shares if SHARE_TOLERANCE < part < 1.0 - SHARE_TOLERANCE}
        share = np.array(sorted({0.0, 1.0} | inner))
        ground, top, bottom = (line[0] + share * (line[1] - line[0]) for line in (ground, top, bottom))
        level = np.clip(ground - depth, bottom, top)
        is_thicker = is_thicker or bool((top - level > layers.tolerance).any())
        for place, z in zip((1.0 - share) * start + share * end, level, strict=True):  # both ends exactly
            if not points or place > points[-1][0] or abs(z - points[-1][1]) > layers.tolerance:
                points.append([float(place), float(z)])
    return points if is_thicker else []
