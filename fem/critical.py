"""At which seismic coefficient a section fails: gravity, then the horizontal load with its coefficient unknown.

Kh acts on the seismic density, gravity on the ordinary one. The displacement that is prescribed step by step is the
work-conjugate one of the horizontal load, the mean horizontal displacement weighted by the seismic mass (m).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem import dolfinx_api as api
from fem.continuation import Forces, NewtonSettings
from fem.errors import UnstableError
from fem.fields import State, state_of
from fem.loads import GRAVITY, push, soils
from fem.path import PathSettings, Step, Walk
from fem.plane_strain import PlaneStrain
from fem.plateau import Plateau, Progress, Verdict, walk_to_plateau
from fem.settings import Element, FemSettings
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section, Stratum

# Elastic displacements under all of a load after which bringing it on is given up.
LONGEST_LOADING = 10.0

# Kh in whose elastic displacement the path is measured.
REFERENCE_KH = 0.25


@dataclass(frozen=True)
class CriticalResult:
    """The critical seismic coefficient, and how good it is.

    ``kc`` is the largest Kh at which an equilibrium was found, ``upper`` what the path rises to or would with its last
    growth if the displacement doubled once more.
    """

    kc: float
    upper: float
    verdict: Verdict
    element: Element
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
    walk = seismic_walk(problem, fixed, push(section, settings), settings)
    states: list[State] = []

    def keep(kh: float) -> None:
        states.append(state_of(problem, mesh, f"Kh = {kh:g}", kh))

    def stretch(walk: Walk) -> float:
        return walk.displacement / (max(walk.factor, 1e-9) / REFERENCE_KH * walk.reference)

    outcome = walk_to_plateau(walk, stretch, settings.kh_limit, Plateau(), settings.kh, keep, progress)
    at_rest = walk.rest()
    held = max(outcome.held, walk.factor) if at_rest else outcome.held
    end = outcome.verdict if outcome.verdict in ("plateau", "peak") else "end of the walk"
    label = f"{end}, Kh = {walk.factor:.3f}" + ("" if at_rest else ", under overstress")
    last = state_of(problem, mesh, label, walk.factor)
    states.append(last)
    for kh in sorted(settings.kh):
        if kh > held and outcome.verdict != "undecided":
            label = f"past equilibrium: Kh = {kh:g} is out of reach"
            states.append(replace(last, label=label, kh=kh, past_equilibrium=True))
    return CriticalResult(
        kc=held,
        upper=max(held, outcome.upper),
        verdict=outcome.verdict,
        element=problem.grid.element,
        reason=outcome.reason,
        remedy=outcome.remedy,
        steps=walk.steps,
        states=states,
        solves=walk.solves,
        gravity_iterations=gravity_walk.solves,
        gravity_plastic_share=gravity_walk.steps[-1].plastic_share,
    )


def is_associated(strata: Sequence[Stratum]) -> bool:
    """Whether ψ = φ everywhere."""
    return all(s.dilation_angle == s.friction_angle for s in strata)


def element_for(strata: Sequence[Stratum], settings: FemSettings) -> Element:
    """The element as set, or the one that suits the flow of the strata; fem/README.md says why."""
    if settings.element != "auto":
        return settings.element
    dilates = any(s.dilation_angle > 0.0 for s in strata)
    return "reduced" if dilates and is_associated(strata) else "quadratic"


def at_rest_under_gravity(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, strength_factor: float = 1.0
) -> tuple[PlaneStrain, np.ndarray, Walk]:
    """The section in equilibrium under its weight, with its sides as the settings say, and the forces that act on it.

    Under gravity the sides are held horizontally (K0). When they are set free the reactions stay as forces. Tied sides
    are tied from the start, and nothing is left on them: such a section is one of many in a row. Displacements
    count from here. ``strength_factor`` divides cohesion and tan φ.
    """
    api.require()
    strata = soils(section, settings)
    problem = PlaneStrain(mesh, strata, element_for(strata, settings), comm, settings.threads)
    problem.use_strength(strength_factor)
    if settings.sides == "tied":
        problem.tie("left", "right", section)
    else:
        problem.hold({"base": "xy", "left": "x", "right": "x"})
    weight = problem.body_force([s.density_ordinary for s in strata], (0.0, -GRAVITY))
    if problem.exchange.norm(weight) == 0.0:
        raise InputError(section.name, ["density_ordinary is 0 in all strata: there is no weight to carry"])
    walk = carry(problem, np.zeros_like(weight), weight, settings)
    fixed = np.where(problem.free, weight, problem.forces_of(problem.stress))
    if settings.sides != "tied":
        held = "y" if settings.sides == "roller" else "xy"
        problem.hold({"base": "xy", "left": held, "right": held})
    if settings.vertical != 0.0:
        lift = problem.body_force([s.density_seismic for s in strata], (0.0, settings.vertical * GRAVITY))
        carry(problem, fixed, lift, settings)
        fixed = fixed + lift
    problem.displacement[:] = 0.0
    problem.plastic_strain[:] = 0.0
    problem.strain[:] = 0.0
    return problem, fixed, walk


def carry(problem: PlaneStrain, fixed: np.ndarray, load: np.ndarray, settings: FemSettings) -> Walk:
    """Bring a load on whole, in one go if Newton's method can, along its path if not."""
    norm, dot = problem.exchange.norm, problem.exchange.dot
    problem.use_elastic_tangent()
    problem.factorise()
    control = load / norm(load)
    walk = Walk(
        problem, Forces(fixed, load), control, dot(control, problem.solve(load)), norm(load) + norm(fixed),
        replace(path_settings(problem, settings), first=0.2, largest=0.2),
    )  # fmt: skip
    carried = 0.0
    while not walk.reach(1.0):
        if not walk.advance() or walk.factor >= 1.0 or walk.length > LONGEST_LOADING:
            share = f", of which it carries about {100 * carried:.0f} %" if carried > 0.0 else ""
            raise UnstableError(
                f"the section fails under its own weight{share}; check strengths and densities, or ask for the "
                "factor of safety at Kh = 0"
            )
        if walk.rest():
            carried = walk.factor
    return walk


def seismic_walk(problem: PlaneStrain, fixed: np.ndarray, sign: int, settings: FemSettings) -> Walk:
    """The path of rising Kh, ready to start; displacement is positive in the direction of the push."""
    load = seismic_load(problem, sign)
    mass = problem.exchange.dot(load, _horizontal(problem, sign))
    if mass == 0.0:
        raise InputError("section", ["density_seismic is 0 in all strata: there is nothing to accelerate"])
    control = load / mass
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = problem.exchange.dot(control, problem.solve(load))
    path = replace(path_settings(problem, settings), first=settings.first_step / REFERENCE_KH)
    return Walk(problem, Forces(fixed, load), control, REFERENCE_KH * elastic, problem.exchange.norm(fixed), path)


def seismic_load(problem: PlaneStrain, sign: int) -> np.ndarray:
    """Nodal forces (N/m) of Kh = 1 towards the right (``sign`` 1) or the left (-1)."""
    return problem.body_force([s.density_seismic for s in problem.strata], (sign * GRAVITY, 0.0))


def _horizontal(problem: PlaneStrain, sign: int) -> np.ndarray:
    unit = np.zeros(problem.grid.size)
    unit[0::2] = sign
    return problem.exchange.owned_part(unit)


def path_settings(problem: PlaneStrain, settings: FemSettings) -> PathSettings:
    associated = is_associated(problem.strata)
    return PathSettings(
        newton=NewtonSettings(tolerance=settings.tolerance), relaxation=0.0 if associated else settings.relaxation
    )
