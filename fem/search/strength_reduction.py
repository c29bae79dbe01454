"""Finds the factor of safety at a given seismic coefficient by strength reduction: the divisor of cohesion and tan φ at
which the ground fails (Zienkiewicz, Humpheson & Lewis 1975).

For associated flow the factor of safety follows from limit analysis (``conic_safety_factor.py``), otherwise from a path
of equilibria along which the factor is an unknown.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.continuum.fields import FieldState
from fem.continuum.loads import seismic_sign
from fem.continuum.nodal_loads import hydrostatic_load, seismic_load
from fem.continuum.plane_strain import PlaneStrain
from fem.continuum.shallow_failure import ShallowFailure, faces_at, least_rolling_factor
from fem.continuum.strength import is_associated, strength_of
from fem.errors import UnstableError, accepting_no_answer
from fem.limit_load.conic_safety_factor import LARGEST_FACTOR, FactorStart, conic_safety_factor, too_weak
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.gravity import (
    FIXED_UNDER_GRAVITY,
    apply_load,
    at_the_sides,
    gravity_equilibrium,
    path_settings,
    under_weight,
    vertical_inertia,
)
from fem.path.newton import StrengthReduction
from fem.path.path_step import PathStep
from fem.path.plateau import PathListener, find_limit_load
from fem.settings import FemSettings, PathVerdict
from meshes.quad_mesh import QuadMesh
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

# Divisors of the strength at which the path starts: the actual ground first, then ever stronger ground.
FIRST_DIVISORS = (1.0, 0.5, 0.2, 1.0 / LARGEST_FACTOR)
# Change of the factor whose contribution to the arc length equals that of the reference displacement.
FACTOR_UNIT = 0.1
# The reference displacement, in elastic displacements under all of the load.
DISPLACEMENT_UNIT = 0.1


@dataclass(frozen=True)
class SafetyFactor:
    """Holds the factor of safety at a seismic coefficient.

    Attributes
    ----------
    kh : float
        The seismic coefficient (-).
    factor : float
        Largest divisor of c and tan φ at which an equilibrium was found (-).
    upper : float
        Largest divisor of the path, or its extrapolation to twice the displacement (-).
    verdict : PathVerdict
        "plateau", "peak", "no failure" or "undecided".
    reason, remedy : str
        Reason why the path ended, and what to change if there is no answer.
    steps : list of PathStep
        Steps of the path: the factor over the control displacement.
    shallow_failure : float or None
        The factor at which a cohesionless face fails, if there is one (-).
    mechanism : FieldState or None
        The mechanism, where the factor follows from limit analysis.
    by_other_flow : float or None
        The factor by the other flow rule (-): Davis's estimate if ``factor`` has ψ = φ, the factor with ψ = φ if
        ``factor`` is Davis's estimate; 0 if the ground fails even with 20 times its strength; None if both are the
        same, or where it was not computed.
    start : FactorStart or None
        Start of the search for the factor by the other flow rule on the same mesh.
    """

    kh: float
    factor: float
    upper: float
    verdict: PathVerdict
    reason: str
    remedy: str
    steps: list[PathStep]
    shallow_failure: float | None = None
    mechanism: FieldState | None = None
    by_other_flow: float | None = None
    start: FactorStart | None = None

    @property
    def value(self) -> float:
        """Return the factor (-)."""
        return self.factor


def limit_load_safety_factor(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    kh: float,
    comm: Any = None,
    guess: float = 1.0,
    start: FactorStart | None = None,
) -> SafetyFactor:
    """Compute the factor of safety of a meshed section under its weight and ``kh``, for associated flow.

    The search begins at ``guess``, such as the factor of a coarser mesh, or at the ``start`` of the factor by another
    flow rule on this mesh. Strengthened faces, sides and errors are those of ``safety_factor``. ``section``: the
    section of the ground; ``mesh``: a mesh of the section; ``settings``: settings of the finite elements; ``comm``: MPI
    communicator.
    """
    settings = settings.changed(element="reduced")
    faces = faces_at(section, settings, kh)
    if kh == 0.0 and settings.sides != "periodic":  # sides that stay held have no stress of their own
        problem, constant = under_weight(section, mesh, settings, comm, faces)
        constant = constant + vertical_inertia(problem, settings)
    else:
        problem, _, constant = at_the_sides(section, mesh, settings, comm, faces, kh != 0.0)
    if kh != 0.0:
        constant = constant + kh * seismic_load(problem, mesh, section, seismic_sign(section, settings))
    limit = conic_safety_factor(problem, mesh, constant, kh, guess, start)
    shallow = least_rolling_factor(section, faces, kh, _friction(section, settings))
    reason = f"the factor of safety of a mesh of {len(mesh.cells)} cells"
    return SafetyFactor(
        kh, limit.factor, limit.factor, "plateau", reason, "", [], shallow, limit.mechanism, start=limit.start
    )


def safety_factor(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    kh: float,
    comm: Any = None,
    listener: PathListener | None = None,
) -> SafetyFactor:
    """Find the factor of safety of a meshed section under its weight and a seismic coefficient.

    With associated flow the factor of safety follows from the limit load, else from strength reduction along a path.
    Ground that does not stand is first strengthened, so that factors below 1 are found, too. Without shaking, sides
    that are not periodic are held horizontally, as is usual in strength reduction: under the K0 stress as a force,
    weakened ground could fail at a side before the slope.

    Parameters
    ----------
    section : Section
        The section.
    mesh : QuadMesh
        Its mesh.
    settings : FemSettings
        Sides, direction and flow rule.
    kh : float
        The seismic coefficient (-).
    comm : MPI.Comm, optional
        The communicator of the ranks that share the finite elements; by default this process alone.
    listener : callable, optional
        Called with every converged step of the path.

    Returns
    -------
    SafetyFactor

    Raises
    ------
    InputError
        As `critical_coefficient` does.
    UnstableError
        If the section fails even with 20 times its strength.
    NoEquilibriumError
        If no state on the path is in equilibrium.
    """
    if is_associated(section.strata, settings.flow):
        with accepting_no_answer():
            return limit_load_safety_factor(section, mesh, settings, kh, comm)
    faces = faces_at(section, settings, kh)
    problem, constant, load, start = _standing_ground(section, mesh, settings, kh, comm, faces)
    forces = constant + load
    norm, dot = problem.exchange.norm, problem.exchange.dot
    driving = load
    if kh == 0.0:
        driving = problem.body_force([s.density_ordinary for s in problem.strata], (0.0, -1.0))
        driving = driving + hydrostatic_load(problem, mesh, section) / GRAVITY
    control = driving / norm(driving)
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = abs(dot(control, problem.solve(forces)))
    follow = path_settings(problem, settings)
    path = EquilibriumPath(
        problem, StrengthReduction(forces), control, DISPLACEMENT_UNIT * elastic, norm(forces),
        replace(follow, first_step=0.2, largest_step=max(follow.largest_step, 0.5)), beta=1.0 / FACTOR_UNIT,
        factor=start,
    )  # fmt: skip

    def ductility(path: EquilibriumPath) -> float:
        return path.displacement / path.reference

    limit = find_limit_load(path, ductility, LARGEST_FACTOR, listener=listener)
    shallow = least_rolling_factor(section, faces, kh, _friction(section, settings))
    return SafetyFactor(
        kh, limit.in_equilibrium, limit.upper, limit.verdict, limit.reason, limit.remedy, path.steps, shallow
    )


def _standing_ground(
    section: Section, mesh: QuadMesh, settings: FemSettings, kh: float, comm: Any, faces: Sequence[ShallowFailure]
) -> tuple[PlaneStrain, np.ndarray, np.ndarray, float]:
    """Return the ground in equilibrium under its weight and ``kh``, its constant nodal forces and those of ``kh``
    (N/m), and the first of ``FIRST_DIVISORS`` by which its strength could be divided; raise UnstableError if there is
    none."""
    for start in FIRST_DIVISORS:
        try:
            problem, constant, _ = gravity_equilibrium(section, mesh, settings, comm, faces, start, kh != 0.0)
            load = kh * seismic_load(problem, mesh, section, seismic_sign(section, settings))
            if kh == 0.0 and settings.sides != "periodic":
                problem.hold(FIXED_UNDER_GRAVITY)
            if kh != 0.0:
                apply_load(problem, constant, load, settings)
            return problem, constant, load, start
        except UnstableError:
            pass
    raise too_weak(kh)


def _friction(section: Section, settings: FemSettings) -> np.ndarray:
    """Return the friction angle (rad) of the strata on a face, reduced in form A if the flow rule is Davis's."""
    return strength_of(section.strata, settings.flow, form="A").friction
