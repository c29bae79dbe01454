"""The critical seismic coefficient of a section: gravity first, then the horizontal load with Kh as an unknown.

Gravity acts on the ordinary density, Kh g on the seismic one. The control displacement, prescribed step by step, is
the one work-conjugate to the horizontal load: the mean horizontal displacement weighted by the seismic mass (m).
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.continuation import ProportionalLoad
from fem.fields import State, state_of, touched_sides
from fem.gravity import gravity_equilibrium, path_settings
from fem.loads import Direction, sign_of
from fem.nodal_loads import shaken_load
from fem.path import EquilibriumPath, PathStep
from fem.plane_strain import PlaneStrain
from fem.plateau import LimitLoad, PathListener, PlateauRule, Verdict, find_limit_load
from fem.settings import Element, FemSettings
from fem.skin import Skin, skins
from fem.strength import Flow, strength_of
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

# The elastic displacement under this Kh is the unit of the arc length.
REFERENCE_KH = 0.25
# Shares of the critical Kh whose fields are kept unless Kh are given.
FRACTIONS = (0.5, 0.8)
# Beyond this multiple of the critical Kh in one direction, the other direction cannot matter and is not followed.
OTHER_LIMIT = 2.0
# Where the flow is associated the path is followed until hardly anything is left to gain: long steps make it cheap.
ASSOCIATED_RULE = PlateauRule(growth=0.002, latest=60.0)


@dataclass(frozen=True)
class CriticalResult:
    """The critical seismic coefficient, how good it is, and how it was found.

    Attributes
    ----------
    kc : float
        Largest Kh at which an equilibrium was found (-).
    upper : float
        Kh that the path rose to, or would with its last growth if the displacement doubled once more (-): the limit
        load of this mesh, and no bound of the section.
    verdict : Verdict
        "plateau", "peak", "no failure" or "undecided".
    element : Element
        The element that was used.
    flow : Flow
        The flow rule: "davis", "associated" or "section".
    direction : Direction
        Where the ground is pushed, "downhill" or "uphill" by the ends of its surface.
    sign : int
        +1 if that is to the right, -1 if to the left.
    reason, remedy : str
        Why the path ended, and what to do if it has no answer.
    steps : list of PathStep
        The path: Kh over the mean horizontal displacement.
    states : list of State
        The fields at the Kh asked for, and at the end of the path.
    solves : int
        Linear systems factorised.
    gravity_iterations : int
        Linear systems factorised under gravity.
    gravity_plastic_share : float
        Share of the quadrature points that yield under gravity (-).
    skins : list of Skin
        Cohesionless faces whose grains roll down before; the ground below was searched for deeper failures.
    other : CriticalResult or None
        The answer for the opposite direction, where both were asked for.
    """

    kc: float
    upper: float
    verdict: Verdict
    element: Element
    flow: Flow
    direction: Direction
    sign: int
    reason: str
    remedy: str
    steps: list[PathStep]
    states: list[State]
    solves: int
    gravity_iterations: int
    gravity_plastic_share: float
    skins: list[Skin]
    other: "CriticalResult | None" = None

    @property
    def lower(self) -> float:
        """Lower end of the interval, ``kc`` itself (-)."""
        return self.kc

    @property
    def mechanism(self) -> State:
        """The last state of the path, which shows the mechanism if the section fails."""
        return next(state for state in reversed(self.states) if not state.past_equilibrium)


def critical_coefficient(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, listener: PathListener | None = None
) -> CriticalResult:
    """The critical seismic coefficient of a meshed section, in the direction in which it is smaller.

    A push uphill whose mechanism leaves through a side counts only if there is nothing else: what fails there is the
    ground in front of the neighbour's K0 stress, and no slope. Raises InputError if the section lacks what the analysis
    needs, UnstableError if it fails under its own weight, NoEquilibriumError if no state on the path balances.
    """
    if settings.direction != "both":
        return _towards(section, mesh, settings, settings.direction, comm, listener)
    first = _towards(section, mesh, settings, "downhill", comm, listener)
    limit = min(settings.kh_limit, OTHER_LIMIT * max(first.kc, settings.first_step))
    narrower = settings.model_copy(update={"kh_limit": limit})
    second = _towards(section, mesh, narrower, "uphill", comm, listener)
    if second.kc < first.kc and not touched_sides(mesh, second.mechanism):
        return replace(second, other=first)
    return replace(first, other=second)


def _towards(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    direction: Direction,
    comm: Any,
    listener: PathListener | None,
) -> CriticalResult:
    """The critical seismic coefficient for a push in one direction."""
    settings, sign = settings.model_copy(update={"direction": direction}), sign_of(section, direction)
    sand = skins(section, settings, strength_of(section.strata, settings.flow).friction)
    faces = [face for face in sand if face.kh <= 0.0]
    while True:
        problem, constant, gravity = gravity_equilibrium(section, mesh, settings, comm, faces)
        at_rest, load = problem.state(), seismic_load(problem, mesh, section, sign)
        path = seismic_path(problem, constant, load, sign, settings)
        rule = ASSOCIATED_RULE if problem.associated else PlateauRule()
        limit = find_limit_load(path, _ductility, settings.kh_limit, rule, listener)
        relaxed = path.relax()
        kc = max(limit.held, path.factor) if relaxed else limit.held
        first = [face for face in sand if face.kh < kc]
        if len(first) <= len(faces):
            break
        faces = first  # their grains roll before: on with the ground below them
    last = state_of(problem, mesh, _label_of_last(limit, path.factor, relaxed), path.factor)
    problem.restore(at_rest)
    wanted = settings.kh or tuple(float(f"{share * kc:.3g}") for share in FRACTIONS)
    kept = states_at(seismic_path(problem, constant, load, sign, settings), mesh, [kh for kh in wanted if kh <= kc])
    reached = {state.kh for state in kept}
    beyond = [
        replace(last, label=f"past equilibrium: Kh = {kh:g} is out of reach", kh=kh, past_equilibrium=True)
        for kh in sorted(wanted)
        if kh not in reached and limit.verdict != "undecided"
    ]
    return CriticalResult(
        kc=kc,
        upper=max(kc, limit.upper),
        verdict=limit.verdict,
        element=problem.grid.element,
        flow=settings.flow,
        direction=direction,
        sign=sign,
        reason=limit.reason,
        remedy=limit.remedy,
        steps=path.steps,
        states=[*kept, last, *beyond],
        solves=path.solves,
        gravity_iterations=gravity.solves,
        gravity_plastic_share=gravity.steps[-1].plastic_share,
        skins=faces,
    )


def _label_of_last(limit: LimitLoad, kh: float, relaxed: bool) -> str:
    end = limit.verdict if limit.verdict in ("plateau", "peak") else "end of the path"
    return f"{end}, Kh = {kh:.3f}" + ("" if relaxed else ", under overstress")


def _ductility(path: EquilibriumPath) -> float:
    """The control displacement over the elastic one at this Kh (-)."""
    return path.displacement / (max(path.factor, 1e-9) / REFERENCE_KH * path.reference)


def states_at(path: EquilibriumPath, mesh: QuadMesh, wanted: list[float]) -> list[State]:
    """The fields at those of the ``wanted`` Kh that the path reaches, in rising order."""
    kept: list[State] = []
    for kh in sorted(kh for kh in wanted if kh > 0.0):
        while not (reached := path.reach(kh)):
            mark = path.mark()
            if not path.advance() or path.factor >= kh:
                path.back(mark)
                break
        if reached:
            kept.append(state_of(path.problem, mesh, f"Kh = {kh:g}", kh))
    return kept


def seismic_path(
    problem: PlaneStrain, constant: np.ndarray, load: np.ndarray, sign: int, settings: FemSettings
) -> EquilibriumPath:
    """The path of rising Kh, ready to start; displacement is positive in the direction of the ``load`` of Kh = 1.

    Raises InputError if no stratum has a seismic density.
    """
    mass = problem.exchange.dot(load, _horizontal(problem, sign))
    if mass == 0.0:
        raise InputError("section", ["density_seismic is 0 in all strata: there is nothing to accelerate"])
    control = load / mass
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = problem.exchange.dot(control, problem.solve(load))
    follow = replace(path_settings(problem, settings), first=settings.first_step / REFERENCE_KH)
    scale = problem.exchange.norm(constant)
    return EquilibriumPath(problem, ProportionalLoad(constant, load), control, REFERENCE_KH * elastic, scale, follow)


def seismic_load(problem: PlaneStrain, mesh: QuadMesh, section: Section, sign: int) -> np.ndarray:
    """Nodal forces (N/m) of Kh = 1 towards the right (``sign`` 1) or the left (-1), on soil and on what it carries."""
    soil = problem.body_force([s.density_seismic for s in problem.strata], (sign * GRAVITY, 0.0))
    return soil + shaken_load(problem, mesh, section, sign)


def _horizontal(problem: PlaneStrain, sign: int) -> np.ndarray:
    unit = np.zeros(problem.grid.size)
    unit[0::2] = sign
    return problem.exchange.owned_part(unit)
