"""The critical seismic coefficient of a section: gravity first, then the horizontal load with Kh as an unknown.

Gravity acts on the ordinary density, Kh g on the seismic one. The control displacement, prescribed step by step, is
the one work-conjugate to the horizontal load: the mean horizontal displacement weighted by the seismic mass (m).
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.continuation import ProportionalLoad
from fem.direct_limit import DirectLimit, direct_limit
from fem.fields import State, state_of, touched_sides
from fem.gravity import gravity_equilibrium, path_settings
from fem.loads import Direction, push, sign_of
from fem.nodal_loads import shaken_load
from fem.path import EquilibriumPath, PathStep
from fem.plane_strain import PlaneStrain
from fem.plateau import LimitLoad, PathListener, PlateauRule, Verdict, find_limit_load
from fem.settings import Element, FemSettings
from fem.skin import Skin, skins
from fem.strength import Flow, strength_of
from meshes.errors import InputError, NoAnswerError
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
        Largest Kh at which an equilibrium was found (-): where the flow is associated that of ``fem/direct_limit.py``,
        to which the path comes near.
    lower : float
        Largest Kh of a state of equilibrium on the path (-).
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
    at_once : State or None
        The mechanism of the limit load that was found at once.
    other : CriticalResult or None
        The answer for the opposite direction, where both were asked for.
    """

    kc: float
    lower: float
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
    at_once: State | None = None
    other: "CriticalResult | None" = None

    @property
    def value(self) -> float:
        """The critical Kh (-)."""
        return self.kc

    @property
    def mechanism(self) -> State:
        """The mechanism if the section fails: that of the limit load, else the last state of the path."""
        if self.at_once is not None:
            return self.at_once
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


@dataclass(frozen=True)
class AtOnce:
    """The critical Kh of a mesh found at once, without a path (``fem/direct_limit.py``).

    Attributes
    ----------
    kc : float
        The limit load (-); ``kh_limit`` where it is larger than that.
    verdict : Verdict
        "plateau" or "no failure".
    flow : Flow
        The flow rule: "davis" or "associated".
    direction : Direction
        Where the ground is pushed.
    reason : str
        What the verdict means.
    mechanism : State or None
        The mechanism; None without a limit load.
    skins : list of Skin
        Cohesionless faces whose grains roll down before.
    """

    kc: float
    verdict: Verdict
    flow: Flow
    direction: Direction
    reason: str
    mechanism: State | None
    skins: list[Skin]

    @property
    def value(self) -> float:
        """The critical Kh (-)."""
        return self.kc

    @property
    def upper(self) -> float:
        """The limit load of the mesh, which ``kc`` is (-)."""
        return self.kc


def critical_at_once(section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any) -> AtOnce:
    """The limit load for a push in the one direction of ``settings``, with the "reduced" element whatever they say.

    Raises what ``critical_coefficient`` does, NoAnswerError if the solver leaves no answer.
    """
    direction: Direction = "uphill" if settings.direction == "uphill" else "downhill"
    ground = _at_rest(section, mesh, settings.model_copy(update={"element": "reduced"}), comm)
    if ground.limit is None:
        raise NoAnswerError("the limit load of the elements was not found", "use another mesh")
    kc, cells = min(ground.limit.multiplier, settings.kh_limit), len(mesh.cells)
    verdict: Verdict = "plateau" if kc == ground.limit.multiplier else "no failure"
    reason = f"it is the limit load of {cells} cells" if verdict == "plateau" else f"no failure up to {kc:g}"
    rolling = [face for face in ground.faces if face.kh < kc]
    return AtOnce(kc, verdict, settings.flow, direction, reason, ground.limit.mechanism, rolling)


@dataclass(frozen=True)
class _Ground:
    """The section at rest before a push to one side, and what is known of the push.

    Attributes
    ----------
    problem : PlaneStrain
        The ground in equilibrium under its weight.
    constant : ndarray (dofs,)
        Nodal forces that stay (N/m).
    gravity : EquilibriumPath
        How the weight was brought on.
    faces : list of Skin
        Cohesionless faces that were strengthened, since their grains roll down first.
    load : ndarray (dofs,)
        Nodal forces of Kh = 1 (N/m).
    limit : DirectLimit or None
        The limit load of the push where it is unique and the element is one for it.
    """

    problem: PlaneStrain
    constant: np.ndarray
    gravity: EquilibriumPath
    faces: list[Skin]
    load: np.ndarray
    limit: DirectLimit | None


def _at_rest(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, faces: list[Skin] | None = None
) -> _Ground:
    """The section under its weight, with ``faces`` strengthened; with all cohesionless ones if grains of any roll down
    before the limit load, as in the bounds: where a layer thins out its neighbour may come to the face in the mesh."""
    sand = cohesionless_faces(section, settings)
    if faces is None:
        faces = sand if any(face.kh <= 0.0 for face in sand) else []
    strong = faces
    while True:
        problem, constant, gravity = gravity_equilibrium(section, mesh, settings, comm, strong)
        load = seismic_load(problem, mesh, section, push(section, settings))
        if not (problem.associated and problem.grid.element == "reduced"):
            return _Ground(problem, constant, gravity, strong, load, None)
        try:
            limit = direct_limit(problem, mesh, constant, load)
        except NoAnswerError:  # a path has to do
            return _Ground(problem, constant, gravity, strong, load, None)
        if strong or all(face.kh >= limit.multiplier for face in sand):
            return _Ground(problem, constant, gravity, strong, load, limit)
        strong = sand  # grains roll before: on with the ground below


def cohesionless_faces(section: Section, settings: FemSettings) -> list[Skin]:
    """The cohesionless faces that fall in the direction of the push, with the strength of the analysis."""
    return skins(section, settings, strength_of(section.strata, settings.flow).friction)


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
    faces: list[Skin] | None = None
    while True:
        ground = _at_rest(section, mesh, settings, comm, faces)
        problem, faces = ground.problem, ground.faces
        at_rest = problem.state()
        path = seismic_path(problem, ground.constant, ground.load, sign, settings)
        rule = ASSOCIATED_RULE if problem.associated else PlateauRule()
        if ground.limit is not None:
            rule = replace(rule, known=ground.limit.multiplier)
        limit = find_limit_load(path, _ductility, settings.kh_limit, rule, listener)
        relaxed = path.relax()
        held = max(limit.held, path.factor) if relaxed else limit.held
        kc, found = held, ground.limit if limit.verdict == "plateau" else None
        if found is not None and found.multiplier < settings.kh_limit:
            kc = max(held, found.multiplier)
        sand = cohesionless_faces(section, settings)
        if faces or all(face.kh >= kc for face in sand):
            break
        faces = sand
    last = state_of(problem, mesh, _label_of_last(limit, path.factor, relaxed), path.factor)
    problem.restore(at_rest)
    wanted = settings.kh or tuple(float(f"{share * kc:.3g}") for share in FRACTIONS)
    again = seismic_path(problem, ground.constant, ground.load, sign, settings)
    kept = states_at(again, mesh, [kh for kh in wanted if kh <= kc])
    reached = {state.kh for state in kept}
    beyond = [
        replace(last, label=f"past equilibrium: Kh = {kh:g} is out of reach", kh=kh, past_equilibrium=True)
        for kh in sorted(wanted)
        if kh not in reached and limit.verdict != "undecided"
    ]
    return CriticalResult(
        kc=kc,
        lower=held,
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
        gravity_iterations=ground.gravity.solves,
        gravity_plastic_share=ground.gravity.steps[-1].plastic_share,
        skins=[face for face in faces if face.kh < kc],
        at_once=found.mechanism if found is not None else None,
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
