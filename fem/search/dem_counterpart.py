"""Computes the FEM model with the sides of the DEM box, fixed or periodic, and non-associated flow with the given ψ.

Davis's estimate weakens sand but not clay, which moves the slip surface towards the sand: in S-13 (the section of the
paper) between fixed sides the slip surface by Davis's estimate lies 5 m from the slip surface with the given ψ. Discs
have the strength of the soil and dilate little. The slip surface of discs is therefore compared with that of the
non-associated equilibrium path.
"""

from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np

from fem.continuum.fields import state_of
from fem.continuum.strength import flow_of, is_associated, is_dilating_fully
from fem.limit_load.limit_load import is_unique, loaded_ground
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.plateau import PathListener
from fem.search.adaptive import AdaptiveSearch
from fem.search.assessment import AssessmentListener
from fem.search.critical import CriticalResult, critical_coefficient
from fem.search.mesh_sequence import AdaptiveResult
from fem.search.slip_surface import slip_surface
from fem.settings import YIELDED, FemSettings
from meshes.errors import NoAnswerError
from meshes.executor import check_cancelled
from meshes.quad_mesh import QuadMesh
from meshes.section.recorded_kh import LARGEST_KH
from meshes.section.section import Section
from meshes.settings import MeshSettings


def non_associated_path(
    section: Section, mesh: QuadMesh, settings: FemSettings, listener: PathListener | None = None
) -> tuple[CriticalResult, np.ndarray]:
    """Compute the equilibrium path with non-associated flow between the sides of the settings, and its slip surface.

    Parameters
    ----------
    section : the ground
    mesh : a mesh of the section
    settings : settings of the finite elements, with the sides and the direction of the seismic force
    listener : called with the path after every step

    Returns
    -------
    The critical Kh with the path, and the line (k, 2) between moving ground and ground at rest in m. The line is that
    of the displacements after 0.99 of the critical Kh, and is empty without failure.

    Raises
    ------
    InputError
        If the section cannot be analysed.
    UnstableError
        If the ground fails under its weight.
    NoEquilibriumError
        If no state on the path is in equilibrium.
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
    """Compute the critical Kh with ψ = φ between the sides of the settings.

    It is the limit load of the mesh or, if the cone solver finds none, the limit load of an equilibrium path. Ground
    that dilates less does not resist more (Radenkovic 1961).

    Parameters
    ----------
    section, mesh, settings, listener : as in `non_associated_path`

    Returns
    -------
    The critical Kh (-).

    Raises
    ------
    InputError, UnstableError, NoEquilibriumError
        As in `non_associated_path`.
    """
    associated_settings = settings.changed(flow="associated", kh=())
    if associated_settings.direction != "both" and is_unique(section, associated_settings):
        ground = loaded_ground(section, mesh, associated_settings)
        if ground.limit is not None:
            return min(ground.limit.multiplier, associated_settings.kh_limit)
    return critical_coefficient(section, mesh, associated_settings, listener=listener).upper


def critical_of_dem_counterpart(
    section: Section,
    meshing: MeshSettings,
    first: QuadMesh,
    settings: FemSettings,
    listener: AssessmentListener,
) -> AdaptiveResult[CriticalResult]:
    """Find the critical Kh in one direction with the sides of the settings, on meshes refined for it.

    The critical Kh follows from Davis's estimate instead of ψ = φ where the ground then stands under its weight: discs
    hardly dilate. Failures of cohesionless faces that are shallower than the least depth do not count.

    Parameters
    ----------
    section : the ground
    meshing : settings of the meshes
    first : the first mesh
    settings : settings of the finite elements, with the sides and the direction of the seismic force
    listener : called with the present task and, on an equilibrium path, with the path

    Returns
    -------
    The critical Kh with the path to it, and the mesh of the path.

    Raises
    ------
    InputError
        If the section cannot be analysed.
    UnstableError
        If the ground fails under its weight with ψ = φ.
    NoEquilibriumError
        If no state on the path is in equilibrium.
    """
    flow = flow_of(section.strata, settings.flow)
    critical = partial(_critical_on_meshes, section, meshing, first, listener=listener)
    if flow == "associated" and not is_dilating_fully(section.strata):
        with suppress(NoAnswerError):
            return critical(settings.changed(flow="davis", kh=()))
    return critical(settings.changed(flow=flow, kh=()))


def _critical_on_meshes(
    section: Section, meshing: MeshSettings, first: QuadMesh, settings: FemSettings, listener: AssessmentListener
) -> AdaptiveResult[CriticalResult]:
    """Return the critical Kh with the sides and the flow rule of the settings, on a mesh that is adapted to the limit
    load if the flow is associated."""
    mesh, start, task = first, None, f"{settings.sides} sides"

    def tell(words: str, path: EquilibriumPath | None = None) -> None:
        check_cancelled()
        listener(words, path)

    if is_associated(section.strata, settings.flow):
        search = AdaptiveSearch(section, meshing, first, tell=lambda words: tell(f"Kh, {task}: {words}"))
        limit = search.critical(settings)
        mesh, ground = limit.mesh, limit.result.ground
        start = ground if settings.element in ("auto", "reduced") else None
    result = critical_coefficient(
        section, mesh, settings, listener=lambda path: tell(f"{task}: Kh", path), ground=start
    )
    return AdaptiveResult(result, mesh)
