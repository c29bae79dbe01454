"""Compares a given line with the computed slip surface, by the critical Kh of ground that can fail only above the line.

Two mechanisms that need almost the same Kh may lie far apart. Two slip surfaces are therefore compared not only by
their distance, but also by the critical Kh of ground that can fail only above one of them.
"""

from dataclasses import dataclass

import numpy as np

from fem.limit_load.conic_limit_load import conic_limit_load
from fem.limit_load.limit_load import critical_limit_load
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


@dataclass(frozen=True)
class PrescribedSurface:
    """Holds critical seismic coefficients of one mesh, with and without a prescribed slip surface.

    Attributes
    ----------
    kc : critical Kh without restriction (-)
    kc_above : critical Kh with the ground below the line fixed (-); infinite if no mechanism is possible
    """

    kc: float
    kc_above: float

    @property
    def excess(self) -> float:
        """Return the relative increase of the critical Kh if the ground cannot fail below the line (-)."""
        return self.kc_above / self.kc - 1.0


def critical_above(section: Section, mesh: QuadMesh, settings: FemSettings, line: np.ndarray) -> PrescribedSurface:
    """Compute the limit loads with and without fixing the nodes on and below ``line`` (k, 2), points [x, elevation] in
    m.

    Beyond its ends the line continues at the depth of these ends below the ground. Raises the errors of
    ``critical_limit_load``. ``section``: the section of the ground; ``mesh``: a mesh of the section; ``settings``:
    settings of the finite elements.
    """
    ground = critical_limit_load(section, mesh, settings).ground
    assert ground.limit is not None
    problem, below = ground.problem, _below(section, line, ground.problem.grid.node_points)
    problem.fix_components(~problem.free | np.repeat(below, 2))
    above = conic_limit_load(problem, mesh, ground.constant, ground.load)
    return PrescribedSurface(ground.limit.multiplier, above.multiplier)


def _below(section: Section, line: np.ndarray, points: np.ndarray) -> np.ndarray:
    x, z = points.T
    ground_at_line, ground = (np.interp(at, *section.ground.T) for at in (line[:, 0], x))
    return ground - z >= np.interp(x, line[:, 0], ground_at_line - line[:, 1]) * (1.0 - 1e-9)
