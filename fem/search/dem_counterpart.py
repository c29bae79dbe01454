"""Computes the FEM model with the sides of the DEM box, fixed or periodic, and non-associated flow with the given ψ.

Davis's estimate weakens sand but not clay, which moves the slip surface towards the sand: in S-13 (the section of the
paper) between fixed sides the slip surface by Davis's estimate lies 5 m from the slip surface with the given ψ. Discs
have the strength of the soil and dilate little. The slip surface of discs is therefore compared with that of the
non-associated equilibrium path.
"""

from dataclasses import replace

import numpy as np

from fem.continuum.fields import state_of
from fem.limit_load.limit_load import is_unique, loaded_ground
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.plateau import PathListener
from fem.search.critical import CriticalResult, critical_coefficient
from fem.search.slip_surface import slip_surface
from fem.settings import YIELDED, FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.recorded_kh import LARGEST_KH
from meshes.section.section import Section


def non_associated_path(
    section: Section, mesh: QuadMesh, settings: FemSettings, listener: PathListener | None = None
) -> tuple[CriticalResult, np.ndarray]:
    """Compute the path with non-associated flow between the sides and in the direction of the ``settings``. Return it
    with the line (k, 2) between moving ground and ground at rest (m), which is empty without failure.

    ``section``: the section of the ground; ``mesh``: a mesh of the section; ``listener`` is called after every step.
    Raises InputError, UnstableError and NoEquilibriumError.
    """
    # fields beyond the path only, so that the path is not computed again for fields along it
    path_settings = settings.changed(flow="non-associated", kh=(LARGEST_KH,))
    recorded_path: list[tuple[float, np.ndarray]] = []  # Kh and displacements (points, 2) in m

    def step(path: EquilibriumPath) -> None:
        recorded_path.append((path.factor, state_of(path.problem, mesh, "", path.factor).displacement))
        if listener is not None:
            listener(path)

    result = critical_coefficient(section, mesh, path_settings, listener=step)
    line = np.zeros((0, 2))
    if result.verdict != "no failure":
        last = next(state for state in reversed(result.states) if not state.past_equilibrium)
        yielding = next((moved for kh, moved in recorded_path if kh >= YIELDED * result.kc), recorded_path[-1][1])
        line = slip_surface(mesh, replace(last, displacement=last.displacement - yielding))
    return result, line


def associated_kc(
    section: Section, mesh: QuadMesh, settings: FemSettings, listener: PathListener | None = None
) -> float:
    """Compute the critical Kh between the sides of the ``settings`` with ψ = φ: ground that dilates less does not
    resist more (Radenkovic 1961). The critical Kh is the limit load of the mesh or, if the cone solver finds none, the
    limit load of an equilibrium path.

    ``section``, ``mesh``, ``settings``, ``listener``: as in ``non_associated_path``. Raises InputError,
    UnstableError and NoEquilibriumError.
    """
    associated_settings = settings.changed(flow="associated", kh=())
    if associated_settings.direction != "both" and is_unique(section, associated_settings):
        ground = loaded_ground(section, mesh, associated_settings)
        if ground.limit is not None:
            return min(ground.limit.multiplier, associated_settings.kh_limit)
    return critical_coefficient(section, mesh, associated_settings, listener=listener).upper
