"""Finds the critical seismic coefficient of a section, and the equilibrium path to it.

Gravity acts on the ordinary density, Kh g on the seismic density. If the limit load is unique, the critical Kh is the
limit load by finite element limit analysis, and Kh is raised in steps to just below it (``load_stepping.py``).
Otherwise Kh is an unknown on the path, and the critical Kh is the largest Kh in equilibrium. The control displacement,
prescribed step by step, is work-conjugate to the horizontal load: the mean horizontal displacement weighted by the
seismic mass (m).
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, get_args

import numpy as np

from fem.continuum.fields import FieldState, state_of, touched_sides
from fem.continuum.loads import Direction, counting_directions, direction_of, seismic_sign
from fem.continuum.plane_strain import PlaneStrain
from fem.continuum.shallow_failure import ShallowFailure
from fem.continuum.strength import Flow, flow_of
from fem.errors import NoEquilibriumError, UnstableError
from fem.limit_load.limit_load import (
    LimitLoadResult,
    LoadedGround,
    cohesionless_faces,
    faces_failing_at_rest,
    loaded_ground,
)
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.gravity import bring_to_rest, path_settings
from fem.path.load_stepping import step_to_limit
from fem.path.newton import ProportionalLoad
from fem.path.path_step import PathStep
from fem.path.plateau import LimitLoad, PathListener, find_limit_load
from fem.settings import Element, FemSettings, PathVerdict
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

# The elastic displacement under this Kh is the unit of the arc length.
REFERENCE_KH = 0.25
# Shares of the critical Kh at which fields are stored unless the settings list values of Kh.
STORED_KH_SHARES = (0.5, 0.8)
# The path of the other direction ends at this multiple of the critical Kh: beyond it, the other direction does not
# govern.
OTHER_DIRECTION_RATIO = 2.0


@dataclass(frozen=True)
class CriticalResult:
    """Holds the critical seismic coefficient, its accuracy, and the path to it.

    Attributes
    ----------
    kc : float
        Largest Kh at which an equilibrium was found (-); for associated flow the limit load of the mesh
        (``conic_limit_load.py``).
    lower : float
        Largest Kh of a state of equilibrium on the path (-).
    upper : float
        Largest Kh of the path, or its extrapolation to twice the displacement (-): the limit load of this mesh, no
        bound of the section.
    verdict : PathVerdict
        "plateau", "peak", "no failure" or "undecided".
    element : Element
        The element that was used.
    flow : Flow
        The flow rule: "davis", "associated" or "non-associated".
    direction : Direction
        Direction of the seismic force, "downhill" or "uphill" by the ends of the surface.
    sign : int
        +1 if this direction is to the right, -1 if to the left.
    reason, remedy : str
        Reason why the path ended, and what to change if there is no answer.
    steps : list of PathStep
        Steps of the path: Kh and the mean horizontal displacement (m).
    states : list of FieldState
        The fields at the Kh of the settings, and at the end of the path.
    solves : int
        Linear systems factorised.
    gravity_iterations : int
        Linear systems factorised under gravity.
    gravity_plastic_share : float
        Share of the quadrature points that yield under gravity (-).
    shallow_failures : list of ShallowFailure
        Cohesionless faces that fail at a smaller Kh; ``kc`` is that of a deeper failure.
    limit_mechanism : FieldState or None
        The mechanism by finite element limit analysis.
    opposite : CriticalResult or None
        The answer for the opposite direction, where both directions were analysed.
    """

    kc: float
    lower: float
    upper: float
    verdict: PathVerdict
    element: Element
    flow: Flow
    direction: Direction
    sign: int
    reason: str
    remedy: str
    steps: list[PathStep]
    states: list[FieldState]
    solves: int
    gravity_iterations: int
    gravity_plastic_share: float
    shallow_failures: list[ShallowFailure]
    limit_mechanism: FieldState | None = None
    opposite: "CriticalResult | None" = None

    @property
    def value(self) -> float:
        """Return the critical Kh (-)."""
        return self.kc

    @property
    def mechanism(self) -> FieldState:
        """Return the mechanism if the section fails: the mechanism of the limit load, or else the last state of the
        path."""
        if self.limit_mechanism is not None:
            return self.limit_mechanism
        return next(state for state in reversed(self.states) if not state.past_equilibrium)

    def at_limit_load(self, limit: LimitLoadResult) -> "CriticalResult":
        """Return this result with the critical Kh and the mechanism of a ``limit`` load, maybe of another mesh, if the
        path reached a limit load by limit analysis."""
        if self.limit_mechanism is None or limit.mechanism is None:
            return self
        return replace(
            self,
            kc=limit.kc,
            lower=min(self.lower, limit.kc),
            upper=limit.upper,
            shallow_failures=[face for face in limit.ground.faces if face.kh < limit.kc],
            limit_mechanism=limit.mechanism,
        )


def critical_coefficient(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    comm: Any = None,
    listener: PathListener | None = None,
    ground: LoadedGround | None = None,
) -> CriticalResult:
    """Find the critical seismic coefficient of a meshed section, in the direction in which it is smaller.

    Mechanisms that leave the section through a side count as in `counting_directions`.

    Parameters
    ----------
    section : Section
        The section.
    mesh : QuadMesh
        Its mesh.
    settings : FemSettings
        Sides, direction, flow rule and largest Kh of the path.
    comm : MPI.Comm, optional
        The communicator of the ranks that share the finite elements; by default this process alone.
    listener : callable, optional
        Called with every converged step of the path.
    ground : LoadedGround, optional
        Ground at rest from which the path starts, if already known for the direction of the settings.

    Returns
    -------
    CriticalResult

    Raises
    ------
    InputError
        If the section lacks what the analysis needs.
    UnstableError
        If the section fails under its own weight.
    NoEquilibriumError
        If no state on the path is in equilibrium.
    """

    critical_in = partial(_critical_in_direction, section, mesh, comm=comm, listener=listener, ground=ground)
    if settings.direction != "both":
        return critical_in(settings=settings)
    first = critical_in(settings=settings.changed(direction="downhill"))
    largest_kh = min(settings.kh_limit, OTHER_DIRECTION_RATIO * max(first.kc, settings.first_step))
    second = critical_in(settings=settings.changed(direction="uphill", kh_limit=largest_kh))
    sides = (touched_sides(mesh, result.mechanism) for result in (first, second))
    counting = counting_directions(section, settings.sides, dict(zip(get_args(Direction), sides, strict=True)))
    if "downhill" not in counting or ("uphill" in counting and second.kc < first.kc):
        return replace(second, opposite=first)
    return replace(first, opposite=second)


def _critical_in_direction(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    comm: Any,
    listener: PathListener | None,
    ground: LoadedGround | None,
) -> CriticalResult:
    """Return the critical seismic coefficient in the direction of the ``settings``, which is not "both"."""
    sign = seismic_sign(section, settings)
    ground = ground or loaded_ground(section, mesh, settings, comm)
    while True:
        if ground.gravity is None:
            ground = replace(ground, gravity=_at_rest(ground))
        result = _followed_path(ground, mesh, sign, settings, listener)
        sand = cohesionless_faces(section, settings)
        strengthened = any(face in ground.faces for face in sand)
        if ground.limit is not None or strengthened or all(face.kh >= result.kc for face in sand):
            break
        ground = loaded_ground(section, mesh, settings, comm, sand + faces_failing_at_rest(section, settings))
    return replace(result, shallow_failures=[face for face in ground.faces if face.kh < result.kc])


def _at_rest(ground: LoadedGround) -> EquilibriumPath:
    """Bring ``ground`` to equilibrium under its weight; return the path of its weight.

    Raises UnstableError if the ground fails, NoEquilibriumError if limit analysis finds that it stands.
    """
    try:
        return bring_to_rest(ground.problem, ground.weight, ground.constant, ground.settings)
    except UnstableError as error:
        if ground.limit is None:
            raise
        raise NoEquilibriumError(
            "the iteration for equilibrium under the weight did not converge, although the ground stands on the same "
            f"mesh up to Kh = {ground.limit.multiplier:.4f} by limit analysis",
            "use another mesh.size",
        ) from error


def _followed_path(
    ground: LoadedGround, mesh: QuadMesh, sign: int, settings: FemSettings, listener: PathListener | None
) -> CriticalResult:
    """Follow the path from ``ground``; returns its result."""
    problem, known, gravity = ground.problem, ground.limit, ground.gravity
    assert gravity is not None
    start = problem.state()
    path = seismic_path(problem, ground.constant, ground.load, sign, settings)
    if known is not None:
        wanted = _stored_kh(settings, min(known.multiplier, settings.kh_limit))
        limit, states = step_to_limit(path, mesh, known.multiplier, settings.kh_limit, wanted, listener)
        in_equilibrium, relaxed = limit.in_equilibrium, True
        kc = known.multiplier if limit.verdict == "plateau" else in_equilibrium
    else:
        limit = find_limit_load(path, _ductility, settings.kh_limit, listener=listener)
        relaxed = path.relax()
        in_equilibrium = kc = max(limit.in_equilibrium, path.factor) if relaxed else limit.in_equilibrium
    last = state_of(problem, mesh, _label_of_last(limit, path.factor, relaxed), path.factor)
    if known is None:  # the fields that are wanted are known only now
        problem.restore(start)
        again = seismic_path(problem, ground.constant, ground.load, sign, settings)
        states = states_at(again, mesh, _stored_kh(settings, kc))
    reached = {state.kh for state in states}
    beyond = [
        replace(
            last,
            label=f"{'there is no equilibrium' if kh > kc else 'no equilibrium was found'} at Kh = {kh:g}",
            kh=kh,
            past_equilibrium=True,
        )
        for kh in sorted(settings.kh)
        if kh not in reached and limit.verdict != "undecided"
    ]
    return CriticalResult(
        kc=kc,
        lower=min(in_equilibrium, kc),
        upper=max(kc, limit.upper),
        verdict=limit.verdict,
        element=problem.grid.element,
        flow=flow_of(problem.strata, settings.flow),
        direction=direction_of(settings),
        sign=sign,
        reason=limit.reason,
        remedy=limit.remedy,
        steps=path.steps,
        states=[*states, last, *beyond],
        solves=path.solves,
        gravity_iterations=gravity.solves,
        gravity_plastic_share=gravity.steps[-1].plastic_share,
        shallow_failures=[],
        limit_mechanism=known.mechanism if known is not None and limit.verdict == "plateau" else None,
    )


def _stored_kh(settings: FemSettings, kc: float) -> list[float]:
    """Return the Kh up to ``kc`` at which fields are stored."""
    return [kh for kh in settings.kh or tuple(float(f"{share * kc:.3g}") for share in STORED_KH_SHARES) if kh <= kc]


def _label_of_last(limit: LimitLoad, kh: float, relaxed: bool) -> str:
    end = limit.verdict if limit.verdict in ("plateau", "peak") else "end of the path"
    return f"{end}, Kh = {kh:.3f}" + ("" if relaxed else ", under overstress")


def _ductility(path: EquilibriumPath) -> float:
    """Return the control displacement over the elastic one at this Kh (-)."""
    return path.displacement / (max(path.factor, 1e-9) / REFERENCE_KH * path.reference)


def states_at(path: EquilibriumPath, mesh: QuadMesh, wanted: list[float]) -> list[FieldState]:
    """Return the fields at every ``wanted`` Kh that the path reaches, in rising order."""
    states: list[FieldState] = []
    for kh in sorted(kh for kh in wanted if kh > 0.0):
        while not (reached := path.reach(kh)):
            mark = path.mark()
            if not path.advance() or path.factor >= kh:
                path.back(mark)
                break
        if reached:
            states.append(state_of(path.problem, mesh, f"Kh = {kh:g}", kh))
    return states


def seismic_path(
    problem: PlaneStrain, constant: np.ndarray, load: np.ndarray, sign: int, settings: FemSettings
) -> EquilibriumPath:
    """Return the path of rising Kh at its start; displacement is positive in the direction of the ``load`` of Kh = 1.

    ``problem`` are the elements at rest; ``constant`` are the constant nodal forces (N/m); ``sign`` is 1 if Kh acts to
    the right, -1 to the left; ``settings`` are those of the finite elements. Raises InputError if no stratum has a
    seismic density.
    """
    mass = problem.exchange.dot(load, _horizontal(problem, sign))
    if mass == 0.0:
        raise InputError("section", ["density_seismic is 0 in all strata, so that Kh causes no force"])
    control = load / mass
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = problem.exchange.dot(control, problem.solve(load))
    follow = replace(path_settings(problem, settings), first_step=settings.first_step / REFERENCE_KH)
    scale = problem.exchange.norm(constant)
    return EquilibriumPath(problem, ProportionalLoad(constant, load), control, REFERENCE_KH * elastic, scale, follow)


def _horizontal(problem: PlaneStrain, sign: int) -> np.ndarray:
    unit = np.zeros(problem.grid.size)
    unit[0::2] = sign
    return problem.exchange.owned_part(unit)
