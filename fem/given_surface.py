"""How good a given line is as a slip surface: what the ground bears if it may fail no deeper than it.

Two mechanisms that need almost the same Kh may lie far apart. So two answers are compared by this number rather than by
the distance of their slip surfaces alone.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.at_once import cohesionless_faces
from fem.direct_limit import direct_limit
from fem.gravity import at_the_sides
from fem.loads import push
from fem.nodal_loads import seismic_load
from fem.settings import FemSettings
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


@dataclass(frozen=True)
class GivenSurface:
    """Critical seismic coefficients of the same mesh.

    Attributes
    ----------
    kc : float
        Wherever the ground fails (-).
    kc_above : float
        Where nothing below the line moves (-); infinite if then nothing can.
    """

    kc: float
    kc_above: float

    @property
    def excess(self) -> float:
        """By which share the ground bears more Kh if it may not fail below the line (-)."""
        return self.kc_above / self.kc - 1.0


def critical_above(
    section: Section, mesh: QuadMesh, settings: FemSettings, line: np.ndarray, comm: Any
) -> GivenSurface:
    """The limit loads with and without the nodes on and below ``line`` (k, 2), points [x, elevation] in m, held.

    Beyond its ends the line goes on at their depth below the ground. For one rank; raises what ``at_the_sides``
    does, NoAnswerError where the flow has no unique limit load or the solver leaves none.
    """
    settings = settings.model_copy(update={"element": "reduced"})
    faces = cohesionless_faces(section, settings)
    problem, _, constant = at_the_sides(section, mesh, settings, comm, faces)
    if not problem.associated:
        raise NoAnswerError("without normality there is no unique limit load", 'set fem.flow = "davis"')
    load = seismic_load(problem, mesh, section, push(section, settings))
    anywhere = direct_limit(problem, mesh, constant, load)
    below = _below(section, line, problem.grid.node_points)
    problem.hold_components(~problem.free | np.repeat(below, 2))
    return GivenSurface(anywhere.multiplier, direct_limit(problem, mesh, constant, load).multiplier)


def _below(section: Section, line: np.ndarray, points: np.ndarray) -> np.ndarray:
    x, z = points.T
    ground_at_line, ground = (np.interp(at, *section.ground.T) for at in (line[:, 0], x))
    return ground - z >= np.interp(x, line[:, 0], ground_at_line - line[:, 1]) * (1.0 - 1e-9)
