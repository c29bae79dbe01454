"""Slip circles in ground with cohesionless faces: faces that would slide first in a thin layer are strengthened, as in
the finite elements.
"""

import numpy as np

from fem.continuum.loads import Direction, sign_of
from fem.continuum.shallow_failure import ShallowFailure, least_rolling_factor, shallow_failures, strengthened
from fem.settings import FemSettings
from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.slip_circles import NO_CRACK, SlipCircle, critical_circle


def ground_of_circles(
    section: Section,
    towards: int,
    kh: float | None,
    least_depth: float,
    vertical: float = 0.0,
    crack: TensionCrack = NO_CRACK,
) -> tuple[Section, SlipCircle | None]:
    """The ground in which slip circles are sought, and the critical circle in it.

    Where a cohesionless face slides before any circle does, by the infinite slope, the circles would be the shallowest
    that are sought. There the ground is that of the finite elements and of the bounds, with an apparent cohesion below
    such faces, so that all methods speak of the slope as a whole.

    Parameters
    ----------
    section : Section
        Strata cut at the water.
    towards : int
        LEFT or RIGHT, where the mass slides to.
    kh : float or None
        Horizontal seismic coefficient at which the factor of safety is sought; None to seek the critical Kh.
    least_depth : float
        Shallower circles are left out, and faces are strengthened down to it (m).
    vertical : float
        Vertical seismic coefficient, positive upwards.
    crack : TensionCrack
        Where circles end at a crack, and the water in it.

    Returns
    -------
    ground : Section
        The section, or the section with its faces strengthened.
    circle : SlipCircle or None
        The critical circle in it; None where no circle slides.
    """
    circle = critical_circle(section, towards, kh, least_depth, vertical, crack=crack)
    direction: Direction = "downhill" if sign_of(section, "downhill") == towards else "uphill"
    settings = FemSettings(direction=direction, least_depth=least_depth, vertical=vertical)
    faces = shallow_failures(section, settings, shaken=kh != 0.0)
    if circle is None or not _slides_first(section, faces, kh, circle.bishop):
        return section, circle
    ground = strengthened(section, faces, settings)
    return ground, critical_circle(ground, towards, kh, least_depth, vertical, crack=crack)


def _slides_first(section: Section, faces: list[ShallowFailure], kh: float | None, circle: float) -> bool:
    """Whether one of the faces has a smaller factor of safety, or critical Kh, than the ``circle``."""
    if kh is None:
        return any(face.kh < circle for face in faces)
    friction = np.array([stratum.friction_angle for stratum in section.strata])
    factor = least_rolling_factor(section, faces, kh, friction)
    return factor is not None and factor < circle
