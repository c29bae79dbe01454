"""Compares a given line with the computed slip surface, by the critical Kh of ground that can fail only above the line.

Two mechanisms that need almost the same Kh may lie far apart. Two slip surfaces are therefore compared not only by
their distance, but also by the critical Kh of ground that can fail only above one of them.
"""

import numpy as np

from fem.limit_load.conic_limit_load import conic_limit_load
from fem.limit_load.limit_load import critical_limit_load
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


def critical_above(section: Section, mesh: QuadMesh, settings: FemSettings, line: np.ndarray) -> tuple[float, float]:
    """Return the critical Kh without restriction, and that with the nodes on and below ``line`` fixed, (k, 2) points
    [x, elevation] in m; the latter is infinite if no mechanism is possible.

    Beyond its ends the line continues at the depth of these ends below the ground. Raises the errors of
    ``critical_limit_load``. ``section``: the section of the ground; ``mesh``: a mesh of the section; ``settings``:
    settings of the finite elements.
    """
    ground = critical_limit_load(section, mesh, settings).ground
    assert ground.limit is not None
    problem, below = ground.problem, _below(section, line, ground.problem.grid.node_points)
    problem.fix_components(~problem.free | np.repeat(below, 2))
    above = conic_limit_load(problem, mesh, ground.constant, ground.load)
    return ground.limit.multiplier, above.multiplier


def _below(section: Section, line: np.ndarray, points: np.ndarray) -> np.ndarray:
    x, z = points.T
    ground_at_line, ground = (np.interp(at, *section.ground.T) for at in (line[:, 0], x))
    return ground - z >= np.interp(x, line[:, 0], ground_at_line - line[:, 1]) * (1.0 - 1e-9)
