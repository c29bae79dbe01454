"""Brings ground to equilibrium under its weight, and computes the critical Kh of its mesh by finite element limit
analysis.

The limit load of one mesh can be computed repeatedly, with another flow rule or other sides. Loads and side stresses
stay the same, so that the results differ only by the flow rule or the sides: the limit load by Davis's estimate, with
less strength, is never above the limit load with ψ = φ.
"""

from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.continuum.fields import FieldState
from fem.continuum.loads import Direction, direction_of, seismic_sign
from fem.continuum.nodal_loads import seismic_load
from fem.continuum.plane_strain import PlaneStrain
from fem.continuum.shallow_failure import ShallowFailure, faces_at, failing_at_rest, shallow_failures
from fem.continuum.strength import Flow, flow_of, is_associated, strength_of
from fem.errors import UnstableError, accepting_no_answer
from fem.limit_load.conic_limit_load import ConicLimitLoad, conic_limit_load
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.gravity import at_the_sides, element_for, fixed_components, gravity_equilibrium, under_weight
from fem.settings import FemSettings, PathVerdict
from meshes.errors import NoAnswerError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

FIRST_WEIGHT_SHARE = 1e-3  # share of the weight that is applied first: limit loads are multiples of it


@dataclass(frozen=True, eq=False)
class LoadedGround:
    """Holds the ground at rest, and the limit load of the seismic force in one direction.

    Attributes
    ----------
    problem : the ground: in equilibrium under its weight, or without stress where ``gravity`` is None
    weight (dofs,) : nodal forces of the weight of the ground (N/m)
    constant (dofs,) : nodal forces that are constant (N/m)
    gravity : the path under gravity; None if the ground was not brought to rest
    faces : cohesionless faces that were strengthened, since such faces fail first
    load (dofs,) : nodal forces of Kh = 1 (N/m)
    limit : limit load of the seismic force, if it is unique and the element suits limit analysis
    settings : settings of flow rule, sides and direction
    """

    problem: PlaneStrain
    weight: np.ndarray
    constant: np.ndarray
    gravity: EquilibriumPath | None
    faces: list[ShallowFailure]
    load: np.ndarray
    limit: ConicLimitLoad | None
    settings: FemSettings


@dataclass(frozen=True, eq=False)
class LimitLoadResult:
    """Holds the critical Kh of a mesh by finite element limit analysis (``conic_limit_load.py``).

    Attributes
    ----------
    kc : the limit load (-), but at most ``kh_limit``
    verdict : "plateau" or "no failure"
    flow : the flow rule: "davis" or "associated"
    direction : direction of the seismic force
    reason : explanation of the verdict in words
    mechanism : the mechanism; None without a limit load
    shallow_failures : cohesionless faces that fail at a smaller Kh
    ground : the ground, with the loads
    """

    kc: float
    verdict: PathVerdict
    flow: Flow
    direction: Direction
    reason: str
    mechanism: FieldState | None
    shallow_failures: list[ShallowFailure]
    ground: LoadedGround

    @property
    def value(self) -> float:
        """Return the critical Kh (-)."""
        return self.kc

    @property
    def upper(self) -> float:
        """Return the limit load of the mesh, equal to ``kc`` (-)."""
        return self.kc


def critical_limit_load(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any = None, faces: list[ShallowFailure] | None = None
) -> LimitLoadResult:
    """Compute the limit load of the seismic force in one direction, always with the "reduced" element.

    Parameters
    ----------
    section : the ground
    mesh : a mesh of the section
    settings : settings of the finite elements, with the direction of the seismic force; of "both", downhill
    comm : MPI communicator; None for this process alone
    faces : cohesionless faces to be strengthened; None to choose them as in `loaded_ground`

    Returns
    -------
    The critical Kh of the mesh with its mechanism, and the ground with its loads for further limit loads.

    Raises
    ------
    InputError
        If the section cannot be analysed.
    UnstableError
        If the ground fails without a seismic force.
    NoAnswerError
        If the solver leaves no answer, or the limit load is not unique (ψ < φ).
    """
    ground = loaded_ground(section, mesh, settings.changed(element="reduced"), comm, faces)
    if ground.limit is None:
        raise NoAnswerError("the limit load by finite elements was not found", "use another mesh")
    return _limit_load_of(section, mesh, settings, ground)


def with_other_flow(
    result: LimitLoadResult, section: Section, mesh: QuadMesh, settings: FemSettings
) -> LimitLoadResult:
    """Compute the limit load of the same ground with another flow rule or other sides.

    Parameters
    ----------
    result : a limit load of the ground
    section : the ground
    mesh : the mesh of ``result``
    settings : settings with the other flow rule and sides

    Returns
    -------
    The limit load. The loads, and the K0 stress on the sides, are those of ``result``.

    Raises
    ------
    NoAnswerError
        If the solver leaves no answer.
    """
    ground = result.ground
    problem = copy(ground.problem)  # a path may go on with this one
    problem.flow = settings.flow
    problem.use_strength(1.0)
    problem.hold(fixed_components(settings))
    start = ground.limit.start if ground.limit else None
    limit = conic_limit_load(problem, mesh, ground.constant, ground.load, start)
    return _limit_load_of(section, mesh, settings, replace(ground, limit=limit))


def in_order(weak: LimitLoadResult, strong: LimitLoadResult) -> tuple[LimitLoadResult, LimitLoadResult]:
    """Order two limit loads of one mesh under one load, so that the first is not above the second.

    The second ground resists every load that the first one resists (lower bound theorem). Therefore the bracket of the
    first limit load is cut off at the upper end of the second bracket, and the second bracket at the lower end of the
    first. The means of both brackets are then in the same order.

    Parameters
    ----------
    weak : limit load of ground whose strength is nowhere larger than that of the other ground
    strong : limit load of the other ground

    Returns
    -------
    Both limit loads, each the mean of its cut bracket; unchanged if one of them is missing.
    """
    low, high = weak.ground.limit, strong.ground.limit
    if low is None or high is None:
        return weak, strong
    return (
        _mean_of_bracket(weak, low.bracket[0], min(low.bracket[1], high.bracket[1])),
        _mean_of_bracket(strong, max(low.bracket[0], high.bracket[0]), high.bracket[1]),
    )


def _mean_of_bracket(result: LimitLoadResult, lower: float, upper: float) -> LimitLoadResult:
    """Return the limit load with the mean of a bracket as its value; return it unchanged if the bracket is that of the
    solver."""
    limit = result.ground.limit
    if limit is None or limit.bracket == (lower, upper) or result.verdict != "plateau":
        return result
    middle = 0.5 * (lower + upper)
    limit = replace(limit, multiplier=middle, bracket=(lower, upper))
    return replace(result, kc=middle, ground=replace(result.ground, limit=limit))


def _limit_load_of(section: Section, mesh: QuadMesh, settings: FemSettings, ground: LoadedGround) -> LimitLoadResult:
    """Return the critical Kh that the limit load of a ground gives, with its mechanism and shallow failures."""
    assert ground.limit is not None
    kc, cells = min(ground.limit.multiplier, settings.kh_limit), len(mesh.cells)
    verdict: PathVerdict = "plateau" if kc == ground.limit.multiplier else "no failure"
    reason = f"the limit load of a mesh of {cells} cells" if verdict == "plateau" else f"no failure up to {kc:g}"
    sand = [*cohesionless_faces(section, settings), *faces_failing_at_rest(section, settings)]
    rolling = [face for face in sand if ground.faces and face.kh < kc]
    flow = flow_of(section.strata, settings.flow)
    mechanism = ground.limit.mechanism
    return LimitLoadResult(kc, verdict, flow, direction_of(settings), reason, mechanism, rolling, ground)


def loaded_ground(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any = None, faces: list[ShallowFailure] | None = None
) -> LoadedGround:
    """Return the ground with its loads, and the limit load of the seismic force if it is unique.

    If the faces are not given, all cohesionless faces are strengthened if any of them fails at a smaller Kh than the
    ground below, as in the bounds. All of them are strengthened, since where a layer thins out at a face, cells of the
    mesh there may belong to the neighbouring layer. Where the limit load is not unique, they are strengthened if one of
    them fails under its weight.

    Parameters
    ----------
    section, mesh, settings, comm : as in `critical_limit_load`
    faces : cohesionless faces that are strengthened in any case; None to find them

    Returns
    -------
    The ground without stress and its limit load; the ground at rest without limit load where that is not unique.

    Raises
    ------
    UnstableError
        If the ground fails without a seismic force.
    InputError
        If the section cannot be analysed.
    """
    first = 0.0  # Kh at which the first face fails
    if faces is None:
        sand, faces_at_rest = cohesionless_faces(section, settings), faces_failing_at_rest(section, settings)
        first = min((face.kh for face in sand), default=np.inf)
        faces = sand + faces_at_rest if first <= 0.0 or is_unique(section, settings) else faces_at_rest
    if not is_unique(section, settings):
        problem, constant, gravity = gravity_equilibrium(section, mesh, settings, comm, faces)
        load = seismic_load(problem, mesh, section, seismic_sign(section, settings))
        return LoadedGround(problem, constant, constant, gravity, faces, load, None, settings)
    while True:
        problem, weight, constant = at_the_sides(section, mesh, settings, comm, faces)
        load = seismic_load(problem, mesh, section, seismic_sign(section, settings))
        limit = None
        with accepting_no_answer():
            limit = conic_limit_load(problem, mesh, constant, load)
        if limit is not None and limit.multiplier < 0.0:
            raise UnstableError("the section fails under its own weight")
        if limit is None or not limit.multiplier <= first < np.inf or first <= 0.0:
            return LoadedGround(problem, weight, constant, None, faces, load, limit, settings)
        faces, first = faces_at_rest, 0.0  # the ground below fails before them


def is_unique(section: Section, settings: FemSettings) -> bool:
    """Return whether the limit load is unique and the element suits limit analysis.

    The answer then does not depend on step sizes.

    Parameters
    ----------
    section : the ground
    settings : settings with the flow rule and the element

    Returns
    -------
    True for associated flow, Davis's estimate included, with the "reduced" element.
    """
    return is_associated(section.strata, settings.flow) and element_for(section, settings) == "reduced"


def cohesionless_faces(section: Section, settings: FemSettings) -> list[ShallowFailure]:
    """Find the cohesionless faces inclined in the direction of the seismic force, with the strength of the analysis.

    Parameters
    ----------
    section : the ground
    settings : settings with the flow rule, the direction of the seismic force and the least depth

    Returns
    -------
    The faces from left to right, with the Kh at which each of them fails.
    """
    return shallow_failures(section, settings, strength_of(section.strata, settings.flow).friction)


def faces_failing_at_rest(section: Section, settings: FemSettings) -> list[ShallowFailure]:
    """Find the cohesionless faces inclined against the seismic force that fail by their weight alone.

    Parameters
    ----------
    section, settings : as in `cohesionless_faces`

    Returns
    -------
    The faces, with the strength of the analysis; their Kh, against the direction of the settings, is negative.
    """
    return failing_at_rest(section, settings, strength_of(section.strata, settings.flow).friction)


def weight_borne(section: Section, mesh: QuadMesh, settings: FemSettings) -> float:
    """Return the multiple of its weight that the ground resists between sides that are held horizontally (limit load).

    Cohesionless faces that fail by themselves are strengthened, as in the search for the critical Kh: they bear no
    share of their weight, whatever the ground below them does. The flow is associated.

    Parameters
    ----------
    section : the ground
    mesh : a mesh of the section
    settings : settings of the finite elements

    Returns
    -------
    The multiple of the weight, surcharges and static water included (-); below 1 the ground flows, infinite if no
    multiple of the weight causes failure.

    Raises
    ------
    UnstableError
        If not even a thousandth of the weight is in equilibrium.
    NoAnswerError
        If the solver leaves no answer.
    """
    faces = [face for face in faces_at(section, settings, 0.0) if face.kh < 0.0]
    problem, weight = under_weight(section, mesh, settings.changed(element="reduced"), faces=faces)
    return FIRST_WEIGHT_SHARE + conic_limit_load(problem, mesh, FIRST_WEIGHT_SHARE * weight, weight).multiplier
