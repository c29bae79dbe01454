"""The K0 stress that stays on the sides of a section on rollers."""

import numpy as np

from fem.loads import GRAVITY
from meshes.section import Section


def k0_profile(section: Section, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Strata (k,), their borders (k, 2 ends, top and bottom) in m, and the horizontal stress there (k, 2) in Pa,
    tension positive, at the "left" or "right" side.

    Under the weight of the column above, without horizontal strain: ν / (1 - ν) of the vertical stress, or as much more
    as Mohr-Coulomb asks for (Rankine's active pressure). The finite elements find the same as the reaction of their
    gravity stage, but for what a sloping ground and unlike neighbours do to it.
    """
    layers = section.layering
    elevation = layers.left[0] if side == "left" else layers.right[-1]
    here = np.flatnonzero(elevation[:-1] > elevation[1:])
    vertical, stresses = 0.0, []
    for k in here:
        soil = section.strata[k]
        ratio = soil.poissons_ratio / (1.0 - soil.poissons_ratio)
        sin, cos = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
        below = vertical + soil.density_ordinary * GRAVITY * (elevation[k] - elevation[k + 1])
        ends = np.array([vertical, below])
        active = ((1.0 - sin) * ends - 2.0 * soil.cohesion * cos) / (1.0 + sin)
        stresses.append(-np.maximum(ratio * ends, active))
        vertical = below
    return here, np.column_stack([elevation[here], elevation[here + 1]]), np.array(stresses)
