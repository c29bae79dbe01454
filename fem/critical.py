"""At which seismic coefficient a section fails: gravity, then the horizontal load with its coefficient unknown.

Kh acts on the seismic density, gravity on the ordinary one. The displacement that is prescribed step by step is the
work-conjugate one of the horizontal load, the mean horizontal displacement weighted by the seismic mass (m).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from fem.continuation import Forces, NewtonSettings
from fem.fields import State, state_of
from fem.path import PathSettings, Plateau, Step, Walk, growth_per_doubling
from fem.plane_strain import PlaneStrain
from fem.settings import FemSettings, Sides
from meshes.errors import InputError
from meshes.quadrilaterals import QuadMesh
from meshes.section import Section, Stratum

GRAVITY = 9.80665  # m/s², with which Table 1's tonnes-force turn into newtons

# Kh in whose elastic displacement the path is measured.
REFERENCE_KH = 0.25

Verdict = Literal["plateau", "peak", "no failure", "undecided"]
Progress = Callable[[Walk], None]


class UnstableError(RuntimeError):
    """The ground does not stand under its own weight; says what share of it it carries."""


@dataclass(frozen=True)
class CriticalResult:
    """The critical seismic coefficient, and how good it is.

    ``kc`` is the largest Kh at which an equilibrium was found, ``upper`` what the path rises to or would with its last
    growth if the displacement doubled once more.
    """

    kc: float
    upper: float
    verdict: Verdict
    reason: str
    remedy: str
    steps: list[Step]
    states: list[State]
    solves: int
    gravity_iterations: int
    gravity_plastic_share: float

    @property
    def lower(self) -> float:
        return self.kc


def critical_coefficient(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, progress: Progress | None = None
) -> CriticalResult:
    """The critical seismic coefficient of a meshed section.

    Raises InputError if the section lacks what the analysis needs, UnstableError if it fails under its own weight.
    """
    problem, fixed, gravity_walk = at_rest_under_gravity(section, mesh, settings, comm)
    walk = seismic_walk(problem, fixed, downhill(section) * (1 if settings.direction == "downhill" else -1), settings)
    outcome = _walk_to_plateau(walk, mesh, settings, progress, Plateau())
    states = [*outcome.states, state_of(problem, mesh, f"plateau, Kh = {walk.factor:.3f}", walk.factor)]
    reached = {state.kh for state in outcome.states}
    for kh in sorted(settings.kh):
        if kh not in reached and kh > outcome.kc:
            past = state_of(problem, mesh, f"past equilibrium: Kh = {kh:g} is out of reach", kh)
            states.append(replace(past, past_equilibrium=True))
    return CriticalResult(
        kc=outcome.kc,
        upper=outcome.upper,
        verdict=outcome.verdict,
        reason=outcome.reason,
        remedy=outcome.remedy,
        steps=walk.steps,
        states=states,
        solves=walk.solves,
        gravity_iterations=gravity_walk.solves,
        gravity_plastic_share=gravity_walk.steps[-1].plastic_share,
    )


def downhill(section: Section) -> int:
    """+1 if the ground falls to the right, -1 if it falls to the left, from one end of its surface to the other."""
    return 1 if section.surface[0][1] >= section.surface[-1][1] else -1


def soils(section: Section, settings: FemSettings) -> tuple[Stratum, ...]:
    """The strata with the flow rule that the settings ask for; raises InputError for one without strength."""
    weak = [
        f'strata {k} "{s.name}": cohesion and friction angle are both 0; expected some strength'
        for k, s in enumerate(section.strata, start=1)
        if s.cohesion == 0.0 and s.friction_angle == 0.0
    ]
    if weak:
        raise InputError(section.name, weak)
    if settings.flow == "associated":
        return tuple(s.model_copy(update={"dilation_angle": s.friction_angle}) for s in section.strata)
    return section.strata


def at_rest_under_gravity(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any
) -> tuple[PlaneStrain, np.ndarray, Walk]:
    """The section in equilibrium under its weight, with its sides as the settings say, and the forces that act on it.

    Under gravity the sides are held horizontally (K0). When they are set free the reactions stay as forces.
    Displacements count from here.
    """
    strata = soils(section, settings)
    problem = PlaneStrain(mesh, strata, settings.element, comm)
    problem.hold({"base": "xy", "left": "x", "right": "x"})
    weight = problem.body_force([s.density_ordinary for s in strata], (0.0, -GRAVITY))
    if problem.exchange.norm(weight) == 0.0:
        raise InputError(section.name, ["density_ordinary is 0 in all strata: there is no weight to carry"])
    walk = _carry(problem, np.zeros_like(weight), weight, settings)
    reactions = np.where(problem.free, 0.0, problem.forces_of(problem.stress) - weight)
    _release(problem, section, settings.sides)
    if settings.sides == "tied":
        reactions = problem.merge_tied(reactions)
        weight = problem.body_force([s.density_ordinary for s in strata], (0.0, -GRAVITY))
    fixed = weight + reactions
    if settings.vertical != 0.0:
        lift = problem.body_force([s.density_seismic for s in strata], (0.0, settings.vertical * GRAVITY))
        _carry(problem, fixed, lift, settings)
        fixed = fixed + lift
    problem.displacement[:] = 0.0
    problem.plastic_strain[:] = 0.0
    problem.strain[:] = 0.0
    return problem, fixed, walk


def _carry(problem: PlaneStrain, fixed: np.ndarray, load: np.ndarray, settings: FemSettings) -> Walk:
    """Bring a load on whole, in one go if Newton's method can, along its path if not."""
    norm, dot = problem.exchange.norm, problem.exchange.dot
    problem.use_elastic_tangent()
    problem.factorise()
    control = load / norm(load)
    walk = Walk(
        problem, Forces(fixed, load), control, dot(control, problem.solve(load)), norm(load) + norm(fixed),
        replace(_path_settings(problem, settings), first=0.2, largest=0.2),
    )  # fmt: skip
    while not walk.reach(1.0):
        if walk.length > 10.0 or not walk.advance():
            raise UnstableError(
                f"the section fails under its own weight: it carries no more than {100 * walk.factor:.0f} % of it. "
                "Check strengths and densities, or ask for the factor of safety at Kh = 0"
            )
    return walk


def _release(problem: PlaneStrain, section: Section, sides: Sides) -> None:
    if sides == "tied":
        problem.tie("left", "right", section)
    else:
        held = "y" if sides == "roller" else "xy"
        problem.hold({"base": "xy", "left": held, "right": held})


def seismic_walk(problem: PlaneStrain, fixed: np.ndarray, sign: int, settings: FemSettings) -> Walk:
    """The path of rising Kh, ready to start; displacement is positive in the direction of the push."""
    densities = [s.density_seismic for s in problem.strata]
    load = problem.body_force(densities, (sign * GRAVITY, 0.0))
    mass = problem.exchange.dot(load, _horizontal(problem, sign))
    if mass == 0.0:
        raise InputError("section", ["density_seismic is 0 in all strata: there is nothing to accelerate"])
    control = load / mass
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = problem.exchange.dot(control, problem.solve(load))
    path = replace(_path_settings(problem, settings), first=settings.first_step / REFERENCE_KH)
    return Walk(problem, Forces(fixed, load), control, REFERENCE_KH * elastic, problem.exchange.norm(fixed), path)


def _horizontal(problem: PlaneStrain, sign: int) -> np.ndarray:
    unit = np.zeros(problem.grid.size)
    unit[0::2] = sign
    return problem.exchange.owned_part(unit)


def _path_settings(problem: PlaneStrain, settings: FemSettings) -> PathSettings:
    associated = all(s.dilation_angle == s.friction_angle for s in problem.strata)
    return PathSettings(
        newton=NewtonSettings(tolerance=settings.tolerance), relaxation=0.0 if associated else settings.relaxation
    )


@dataclass
class _Outcome:
    """What a walk to the plateau found; filled in on the way."""

    kc: float = 0.0
    upper: float = math.inf
    verdict: Verdict = "undecided"
    reason: str = ""
    remedy: str = ""
    states: list[State] = field(default_factory=list)


def _walk_to_plateau(
    walk: Walk, mesh: QuadMesh, settings: FemSettings, progress: Progress | None, plateau: Plateau
) -> _Outcome:
    """Walk until the load no longer grows, keeping the wanted states and the largest Kh in equilibrium on the way."""
    found = _Outcome()
    wanted = sorted(kh for kh in settings.kh if kh > 0.0)
    every_step_at_rest = walk.settings.relaxation <= 0.0
    next_rest = plateau.first_rest
    while True:
        mark = walk.mark()
        if not walk.advance():
            found.reason, found.remedy = (
                walk.reason,
                "try another mesh, a larger relaxation, or the associated flow rule",
            )
            break
        if wanted and walk.factor >= wanted[0]:
            kh = wanted.pop(0)
            walk.back(mark)
            if walk.reach(kh):
                found.kc = max(found.kc, kh)
                found.states.append(state_of(walk.problem, mesh, f"Kh = {kh:g}", kh))
            continue
        stretch = walk.displacement / (walk.factor / REFERENCE_KH * walk.reference)
        if every_step_at_rest or (stretch >= next_rest and walk.rest()):
            found.kc = max(found.kc, walk.factor)
        if stretch >= next_rest:
            next_rest = plateau.next_rest * stretch
        if progress is not None:
            progress(walk)
        if _ended(walk, stretch, settings, plateau, found):
            break
    highest = max((step.factor for step in walk.steps), default=0.0)
    growth = max(growth_per_doubling(walk.steps), 0.0) if walk.steps else math.inf
    found.upper = max(highest, found.kc * (1.0 + growth))
    return found


def _ended(walk: Walk, stretch: float, settings: FemSettings, plateau: Plateau, found: _Outcome) -> bool:
    """Whether the walk is over, and with which verdict."""
    growth = growth_per_doubling(walk.steps)
    highest = max(step.factor for step in walk.steps)
    if walk.factor > settings.kh_limit:
        found.verdict, found.reason = "no failure", f"no failure up to Kh = {settings.kh_limit:g}"
        found.remedy = "raise kh_limit if larger coefficients are of interest"
        return True
    if stretch >= plateau.earliest and walk.factor < (1.0 - plateau.fall) * highest:
        found.verdict, found.reason = (
            "peak",
            f"Kh has fallen by {100 * (1 - walk.factor / highest):.0f} % from its peak",
        )
        return True
    if stretch >= plateau.earliest and growth < plateau.growth:
        found.verdict = "plateau"
        found.reason = f"Kh changed by {100 * growth:.1f} % while the displacement doubled"
        return True
    if stretch >= plateau.latest or len(walk.steps) >= walk.settings.longest:
        settled = growth < plateau.still_a_plateau
        found.verdict = "plateau" if settled else "undecided"
        found.reason = f"Kh still grew by {100 * growth:.1f} % while the displacement doubled"
        found.remedy = "refine the mesh, or use the quadratic element"
        return True
    return False
