"""Computes a third, approximate critical Kh for the ψ of the strata, in addition to those with ψ = φ and by Davis's
estimate.

The limit load with these angles (``nonassociated_limit_load.py``) depends on element and mesh by 5 to 15 %, and on some
ground it is not found at all. The critical Kh is therefore computed on three meshes, on the first mesh from two starts,
and reported only if all four results agree.
"""

import math
from dataclasses import dataclass

import numpy as np

from fem.limit_load.limit_load import LimitLoadResult, critical_limit_load
from fem.limit_load.nonassociated_limit_load import nonassociated_limit_load
from fem.settings import FemSettings
from meshes.errors import InputError, NoAnswerError
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings

# Number of cells of the three meshes; largest factor on these numbers for thin layers; largest computing work on all
# three meshes (s on the reference machine of ``cone_program``).
MESH_CELLS, LARGEST_CELL_RATIO, MOST_WORK = (300, 375, 450), 1.8, 15.0
# Largest difference between the meshes, as a share of the last answer, up to which the answer is reported.
LARGEST_SPREAD = 0.15


@dataclass(frozen=True)
class OwnDilation:
    """Holds the critical Kh for the dilation angles of the strata.

    Attributes
    ----------
    cells : cells of the meshes
    kc : the critical Kh on the last mesh (-); None if the iteration has no answer
    low, high : smallest and largest value of the three meshes (-)
    reason : reason why there is no answer; empty otherwise
    """

    cells: tuple[int, ...]
    kc: float | None = None
    low: float | None = None
    high: float | None = None
    reason: str = ""


def own_dilation(section: Section, settings: FemSettings, known: LimitLoadResult) -> OwnDilation:
    """Compute the critical Kh of a section for the dilation angles of its strata, in the direction of the limit load
    ``known``. The cohesionless faces that were strengthened for ``known`` are also strengthened for this critical Kh.

    ``settings``: settings of the finite elements.
    """
    settings = settings.changed(flow="associated", direction=known.direction)
    values: list[float] = []
    sizes: list[int] = []
    left = MOST_WORK
    area = float(section.layering.areas().sum())
    for cells in MESH_CELLS:
        try:
            mesh = generate(section, MeshSettings(size=math.sqrt(area / cells)))
            sizes.append(len(mesh.cells))
            if sizes[-1] > LARGEST_CELL_RATIO * cells:
                return OwnDilation(tuple(sizes), reason="thin layers need too many cells")
            full = critical_limit_load(section, mesh, settings, faces=known.ground.faces)
        except (NoAnswerError, InputError) as error:
            return OwnDilation(tuple(sizes), reason=str(error))
        if full.mechanism is None or full.kc <= 0.0 or np.isfinite(full.ground.problem.strength.tension).any():
            return OwnDilation(tuple(sizes), reason="there is no failure, or a stratum has a tension cut-off")
        ground = full.ground
        second = None if values else full.mechanism.stress
        result = nonassociated_limit_load(ground.problem, mesh, ground.constant, ground.load, second, left)
        left -= result.work
        if result.kh is None:
            return OwnDilation(tuple(sizes), reason=result.reason)
        values.append(result.kh)
    low, high = min(values), max(values)
    if high - low > LARGEST_SPREAD * abs(values[-1]):
        return OwnDilation(tuple(sizes), None, low, high, "the values on the three meshes differ too much")
    return OwnDilation(tuple(sizes), values[-1], low, high)
