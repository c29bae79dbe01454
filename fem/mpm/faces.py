"""Gives the ground below cohesionless faces an apparent cohesion, so that material points come to rest on them.

On a cohesionless face that is hardly flatter than its friction angle the points next to the surface creep, because
their stresses are not exact, and on a steeper one they roll down before the slide begins. As in the search for the
critical Kh, the failure of such a face alone is excluded (`fem.continuum.face_reinforcement`).
"""

from dataclasses import replace

import numpy as np

from fem.continuum.face_reinforcement import cohesion_of_stratum
from fem.continuum.shallow_failure import faces_at
from fem.mpm.ground import PointGround
from fem.settings import FemSettings

# Faces that fail at a Kh below this one are strengthened: at 45 degrees points creep down to 0.04 and come to rest from
# 0.09 on, at 27 degrees from 0.02 on.
LEAST_KH = 0.1


def with_firm_faces(ground: PointGround, settings: FemSettings) -> PointGround:
    """Return the ground with an apparent cohesion below all faces on which points do not come to rest.

    These are faces in either direction, down to the least depth of failures; the cohesion is that of
    `fem.continuum.face_reinforcement.cohesion_of_stratum`.

    Parameters
    ----------
    ground : ground of material points in the order in which it was filled; strengths of its points are changed
    settings : settings of the finite elements, with the least depth of failures (m)

    Returns
    -------
    The ground, with the strengthened faces.
    """
    faces = [face for face in faces_at(ground.section, settings, 0.0) if face.kh < LEAST_KH]
    points, places = ground.points, ground.points.x + ground.offset
    depth = ground.section.layering.interface(0, np.clip(places[:, 0], *ground.section.extent)) - places[:, 1]
    for face in faces:
        near = (places[:, 0] >= face.start) & (places[:, 0] <= face.end) & (depth <= settings.least_depth)
        for k, soil in enumerate(ground.section.strata):
            cohesion = cohesion_of_stratum(ground.section, face, k, settings.least_depth)
            if cohesion is not None:
                tension = np.inf if soil.tension is None else soil.tension
                points.set_strength(cohesion, soil.friction_angle, tension, near & (points.stratum == k))
    return replace(ground, firm_faces=tuple(faces))
