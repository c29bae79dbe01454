"""The critical seismic coefficient of a section: gravity first, then the horizontal load with Kh as an unknown.

Gravity acts on the ordinary density, Kh g on the seismic one. The control displacement, prescribed step by step, is
the one work-conjugate to the horizontal load: the mean horizontal displacement weighted by the seismic mass (m).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem import dolfinx_api as api
from fem.continuation import NewtonSettings, ProportionalLoad
from fem.errors import UnstableError
from fem.fields import State, state_of
from fem.loads import push, soils
from fem.path import EquilibriumPath, PathSettings, PathStep
from fem.plane_strain import PlaneStrain
from fem.plateau import PathListener, PlateauRule, Verdict, find_limit_load
from fem.settings import Element, FemSettings
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum

# Arc length, in elastic displacements under the whole load, after which applying a load is given up.
LONGEST_LOADING = 10.0

# Iterations and halvings of a step in Newton's method while a load is brought on: from no stress at all, ground without
# cohesion yields everywhere in the same way however small the load, and smaller steps of the load do not help.
PATIENT = 60, 8

# The elastic displacement under this Kh is the unit of the arc length.
REFERENCE_KH = 0.25


@dataclass(frozen=True)
class CriticalResult:
    """The critical seismic coefficient, how good it is, and how it was found.

    Attributes
    ----------
    kc : float
        Largest Kh at which an equilibrium was found (-).
    upper : float
        Kh that the path rose to, or would with its last growth if the displacement doubled once more (-).
    verdict : Verdict
        "plateau", "peak", "no failure" or "undecided".
    element : Element
        The element that was used.
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
    """

    kc: float
    upper: float
    verdict: Verdict
    element: Element
    reason: str
    remedy: str
    steps: list[PathStep]
    states: list[State]
    solves: int
    gravity_iterations: int
    gravity_plastic_share: float

    @property
    def lower(self) -> float:
        """Lower end of the interval, ``kc`` itself (-)."""
        return self.kc


def critical_coefficient(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, listener: PathListener | None = None
) -> CriticalResult:
    """The critical seismic coefficient of a meshed section.

    Raises InputError if the section lacks what the analysis needs, UnstableError if it fails under its own weight.
    """
    problem, constant, gravity_path = gravity_equilibrium(section, mesh, settings, comm)
    path = seismic_path(problem, constant, push(section, settings), settings)
    states: list[State] = []

    def keep(kh: float) -> None:
        states.append(state_of(problem, mesh, f"Kh = {kh:g}", kh))

    def ductility(path: EquilibriumPath) -> float:
        return path.displacement / (max(path.factor, 1e-9) / REFERENCE_KH * path.reference)

    found = find_limit_load(path, ductility, settings.kh_limit, PlateauRule(), settings.kh, keep, listener)
    relaxed = path.relax()
    held = max(found.held, path.factor) if relaxed else found.held
    end = found.verdict if found.verdict in ("plateau", "peak") else "end of the path"
    label = f"{end}, Kh = {path.factor:.3f}" + ("" if relaxed else ", under overstress")
    last = state_of(problem, mesh, label, path.factor)
    states.append(last)
    for kh in sorted(settings.kh):
        if kh > held and found.verdict != "undecided":
            label = f"past equilibrium: Kh = {kh:g} is out of reach"
            states.append(replace(last, label=label, kh=kh, past_equilibrium=True))
    return CriticalResult(
        kc=held,
        upper=max(held, found.upper),
        verdict=found.verdict,
        element=problem.grid.element,
        reason=found.reason,
        remedy=found.remedy,
        steps=path.steps,
        states=states,
        solves=path.solves,
        gravity_iterations=gravity_path.solves,
        gravity_plastic_share=gravity_path.steps[-1].plastic_share,
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


def gravity_equilibrium(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any, strength_factor: float = 1.0
) -> tuple[PlaneStrain, np.ndarray, EquilibriumPath]:
    """The section in equilibrium under its weight, the nodal forces (N/m) that act on it, and the path that led there.

    Under gravity the sides are held horizontally (K0); sides that are released afterwards keep their reactions as
    forces. Tied sides are tied from the start and have no reactions: such a section is one period of a row of equal
    ones. Displacement and strain are counted from here. ``strength_factor`` divides cohesion and tan φ. Raises
    InputError, UnstableError.
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
    path = apply_load(problem, np.zeros_like(weight), weight, settings)
    constant = np.where(problem.free, weight, problem.forces_of(problem.stress))
    if settings.sides != "tied":
        held = "y" if settings.sides == "roller" else "xy"
        problem.hold({"base": "xy", "left": held, "right": held})
    if settings.vertical != 0.0:
        lift = problem.body_force([s.density_seismic for s in strata], (0.0, settings.vertical * GRAVITY))
        apply_load(problem, constant, lift, settings)
        constant = constant + lift
    problem.displacement[:] = 0.0
    problem.plastic_strain[:] = 0.0
    problem.strain[:] = 0.0
    return problem, constant, path


def apply_load(problem: PlaneStrain, constant: np.ndarray, load: np.ndarray, settings: FemSettings) -> EquilibriumPath:
    """Apply a whole load (N/m) on top of ``constant`` forces, in one step if Newton's method can, along a path if not.

    Raises UnstableError if the ground does not carry it.
    """
    norm, dot = problem.exchange.norm, problem.exchange.dot
    problem.use_elastic_tangent()
    problem.factorise()
    control = load / norm(load)
    path = EquilibriumPath(
        problem, ProportionalLoad(constant, load), control, dot(control, problem.solve(load)),
        norm(load) + norm(constant),
        replace(
            path_settings(problem, settings), first=0.2, largest=0.2,
            newton=NewtonSettings(tolerance=settings.tolerance, iterations=PATIENT[0], line_search=PATIENT[1]),
        ),
    )  # fmt: skip
    carried = 0.0
    while not path.reach(1.0):
        if not path.advance() or path.factor >= 1.0 or path.length > LONGEST_LOADING:
            share = f", of which it carries about {100 * carried:.0f} %" if carried > 0.0 else ""
            raise UnstableError(
                f"the section fails under its own weight{share}; check strengths and densities, or ask for the "
                "factor of safety at Kh = 0"
            )
        if path.relax():
            carried = path.factor
    return path


def seismic_path(problem: PlaneStrain, constant: np.ndarray, sign: int, settings: FemSettings) -> EquilibriumPath:
    """The path of rising Kh, ready to start; displacement is positive in the direction of the horizontal load.

    Raises InputError if no stratum has a seismic density.
    """
    load = seismic_load(problem, sign)
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


def seismic_load(problem: PlaneStrain, sign: int) -> np.ndarray:
    """Nodal forces (N/m) of Kh = 1 towards the right (``sign`` 1) or the left (-1)."""
    return problem.body_force([s.density_seismic for s in problem.strata], (sign * GRAVITY, 0.0))


def _horizontal(problem: PlaneStrain, sign: int) -> np.ndarray:
    unit = np.zeros(problem.grid.size)
    unit[0::2] = sign
    return problem.exchange.owned_part(unit)


def path_settings(problem: PlaneStrain, settings: FemSettings) -> PathSettings:
    """How paths of this ground are followed: without overstress where its flow is associated."""
    associated = is_associated(problem.strata)
    return PathSettings(
        newton=NewtonSettings(tolerance=settings.tolerance), relaxation=0.0 if associated else settings.relaxation
    )
