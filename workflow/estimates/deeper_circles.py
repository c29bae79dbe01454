"""Finds slip circles in ground with cohesionless faces: faces with a governing shallow failure are strengthened, as in
the finite elements.
"""

import numpy as np

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.loads import Direction, sign_of
from fem.continuum.shallow_failure import ShallowFailure, least_rolling_factor, shallow_failures
from fem.settings import FemSettings
from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.slip_circles import NO_CRACK, SlipCircle, critical_circle

# A circle with at most so many times the factor of safety of a face, or so much more Kh, is the shallow failure of this
# face: where the pore pressure rises along the face, a circle has a little less than the straight face.
SAME_FACTOR, SAME_KH = 1.03, 0.005


def ground_of_circles(
    section: Section,
    towards: int,
    kh: float | None,
    least_depth: float,
    vertical: float = 0.0,
    crack: TensionCrack = NO_CRACK,
) -> tuple[Section, SlipCircle | None]:
    """Find the ground in which slip circles are searched, and the critical circle in it.

    If a cohesionless face fails before any circle slides, as an infinite slope, the critical circle would be the
    shallowest one of the search. The ground below such a face therefore gets an apparent cohesion, as in finite
    elements and bounds, so that all methods describe the whole slope.

    Parameters
    ----------
    section : strata cut at the water
    towards : LEFT or RIGHT, the side to which the mass slides
    kh : horizontal seismic coefficient at which the factor of safety is sought; None to seek the critical Kh
    least_depth : smallest depth of circles, and depth to which faces are strengthened (m)
    vertical : vertical seismic coefficient, positive upwards
    crack : depth of the crack at which circles end, and the water in it

    Returns
    -------
    ground : the section, or the section with its faces strengthened
    circle : the critical circle in this ground; None if no circle slides
    """
    circle = critical_circle(section, towards, kh, least_depth, vertical, crack=crack)
    direction: Direction = "downhill" if sign_of(section, "downhill") == towards else "uphill"
    settings = FemSettings(direction=direction, least_depth=least_depth, vertical=vertical)
    faces = shallow_failures(section, settings, excess_pressure=kh != 0.0)
    if circle is None or not _slides_first(section, faces, kh, circle.bishop):
        return section, circle
    ground = strengthened(section, faces, settings)
    return ground, critical_circle(ground, towards, kh, least_depth, vertical, crack=crack)


def _slides_first(section: Section, faces: list[ShallowFailure], kh: float | None, circle: float) -> bool:
    """Return whether one of the faces has a smaller factor of safety, or critical Kh, than the ``circle``."""
    if kh is None:
        return any(face.kh < circle + SAME_KH for face in faces)
    friction = np.array([stratum.friction_angle for stratum in section.strata])
    factor = least_rolling_factor(section, faces, kh, friction)
    return factor is not None and factor < SAME_FACTOR * circle
