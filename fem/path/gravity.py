"""Brings the section to equilibrium under its weight (K0 stage), from which the seismic load starts."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fem.continuum.cohesion_levels import assign_levels, cohesion_levels
from fem.continuum.face_reinforcement import strengthened
from fem.continuum.load_ends import with_strengthened_load_ends
from fem.continuum.loads import soils
from fem.continuum.nodal_loads import excess_pressure_load, ground_force, hydrostatic_load, pressed_sides
from fem.continuum.plane_strain import PlaneStrain
from fem.continuum.repetition import refuse_other_water
from fem.continuum.shallow_failure import ShallowFailure
from fem.continuum.side_stress import SideStress, k0_stress
from fem.continuum.strength import is_associated
from fem.errors import UnstableError
from fem.kernels import assembly
from fem.path.equilibrium_path import EquilibriumPath, PathSettings
from fem.path.newton import NewtonSettings, ProportionalLoad
from fem.settings import Element, FemSettings, Sides
from fem.solvers import dolfinx_api as api
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum

# Displacement components that are fixed under gravity, so that the sides carry the K0 stress.
FIXED_UNDER_GRAVITY = {"base": "xy", "left": "x", "right": "x"}
# Displacement components that are fixed at both sides after gravity is applied; none at periodic sides.
FIXED_AT_SIDES: Mapping[Sides, str] = {"free-field": "y", "smooth": "x", "fixed": "xy", "periodic": ""}
# Arc length, in elastic displacements under the whole load, after which applying a load is given up.
LONGEST_LOADING = 10.0
# Newton's method while a load is applied. From zero stress, cohesionless ground yields everywhere for every load,
# however small, so that smaller load steps do not help. Ground close to failure takes hundreds of descents of its
# potential.
LOADING_NEWTON = NewtonSettings(iterations=60, line_search=8, descents=600)
# Largest steps of a path, in reference displacements: associated flow follows long ones as well as short ones.
LARGEST_ASSOCIATED_STEP, LARGEST_STEP = 3.0, 0.3


def element_for(section: Section, settings: FemSettings) -> Element:
    """Return the element of an analysis.

    Parameters
    ----------
    section : the ground, whose dilation angles decide whether the flow is associated
    settings : settings with the element and the flow rule

    Returns
    -------
    The element of the settings; for "auto" the one that suits the flow rule (docs/theory/continuum.md): "reduced" for
    associated flow, else "quadratic".
    """
    if settings.element != "auto":
        return settings.element
    return "reduced" if is_associated(section.strata, settings.flow) else "quadratic"


def path_settings(problem: PlaneStrain, settings: FemSettings) -> PathSettings:
    """Return settings of paths in this ground: long steps and no overstress if its flow is associated.

    Parameters
    ----------
    problem : the elements with their flow rule
    settings : settings with the tolerance of equilibrium and, for non-associated flow, the relaxation

    Returns
    -------
    Settings of Newton's method, step lengths and relaxation.
    """
    newton = NewtonSettings(tolerance=settings.tolerance)
    if problem.associated:
        return PathSettings(newton=newton, largest_step=LARGEST_ASSOCIATED_STEP)
    return PathSettings(newton=newton, largest_step=LARGEST_STEP, relaxation=settings.relaxation)


def gravity_equilibrium(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    comm: Any,
    faces: Sequence[ShallowFailure] = (),
    strength_factor: float = 1.0,
    excess_pressure: bool = True,
) -> tuple[PlaneStrain, np.ndarray, EquilibriumPath]:
    """Bring the section to equilibrium under its weight (K0 stage).

    Under gravity the sides are held horizontally (K0); sides that are released afterwards keep their reactions as
    forces. Periodic sides are periodic from the start and have no reactions (``repetition.py``). Displacement and
    strain are then set to zero.

    Parameters
    ----------
    section : the ground
    mesh : a mesh of the section
    settings : settings of the finite elements
    comm : MPI communicator; None for this process alone
    faces : cohesionless faces below which the ground is strengthened
    strength_factor : divisor of cohesion and tan φ (-)
    excess_pressure : whether the excess pore pressure by shaking acts

    Returns
    -------
    The elements in equilibrium, the constant nodal forces (dofs,) on them in N/m, and the path of equilibria under the
    rising weight.

    Raises
    ------
    InputError
        If the section cannot be analysed, for example since it has no weight.
    UnstableError
        If the ground fails under its weight.
    """
    problem, weight = under_weight(section, mesh, settings, comm, faces)
    problem.use_strength(strength_factor)
    path, constant = apply_load(problem, np.zeros_like(weight), weight, settings), weight
    if excess_pressure and (excess := excess_pressure_load(problem, mesh, section)) is not None:
        apply_load(problem, constant, excess, settings)  # level ground does not move sideways as its pressure rises
        constant = constant + excess
    constant = np.where(problem.free, constant, problem.forces_of(problem.stress))
    problem.hold(fixed_components(settings))
    if settings.vertical != 0.0:
        inertia = vertical_inertia(problem, settings)
        apply_load(problem, constant, inertia, settings)
        constant = constant + inertia
    _begin_here(problem)
    return problem, constant, path


def at_the_sides(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    comm: Any,
    faces: Sequence[ShallowFailure] = (),
    excess_pressure: bool = True,
) -> tuple[PlaneStrain, np.ndarray, np.ndarray]:
    """Return the section without stress, with the sides of the search for Kh, and the nodal forces on it.

    On free-field sides the K0 stress is that of ``side_stress.py``, as in the bounds. Excess pore pressure by shaking
    acts on the K0 stress, too: the effective horizontal stress of level ground falls with the vertical one, while the
    total horizontal stress rises.

    Parameters
    ----------
    section, mesh, settings, comm, faces : as in `gravity_equilibrium`
    excess_pressure : whether the excess pore pressure by shaking acts

    Returns
    -------
    The elements, the nodal forces (dofs,) of weight, static water and surcharges in N/m, and all constant nodal forces
    (dofs,) in N/m, which also contain excess pore pressure, K0 stress and vertical inertia.

    Raises
    ------
    InputError, UnstableError
        As in `under_weight`.
    """
    problem, weight = under_weight(section, mesh, settings, comm, faces)
    constant, at_sides = weight, section
    if excess_pressure and (excess := excess_pressure_load(problem, mesh, section)) is not None:
        constant, at_sides = weight + excess, section.after_shaking()
    if settings.sides == "free-field":
        constant = constant + side_force(problem, mesh, at_sides, constant)
    problem.hold(fixed_components(settings))
    if settings.vertical != 0.0:
        constant = constant + vertical_inertia(problem, settings)
    return problem, weight, constant


def bring_to_rest(
    problem: PlaneStrain, weight: np.ndarray, constant: np.ndarray, settings: FemSettings
) -> EquilibriumPath:
    """Load the unstressed ground by its weight with sides held horizontally, then by the other constant forces.

    Displacement and strain are then set to zero.

    Parameters
    ----------
    problem : the elements without stress, which are in equilibrium afterwards
    weight, constant (dofs,) : nodal forces of gravity alone, and all constant nodal forces, as of `at_the_sides` (N/m)
    settings : settings of the finite elements

    Returns
    -------
    The path of equilibria under the rising weight.

    Raises
    ------
    UnstableError
        If the ground fails under these forces.
    """
    if settings.sides != "periodic":
        problem.hold(FIXED_UNDER_GRAVITY)
    path = apply_load(problem, np.zeros_like(weight), weight, settings)
    internal_force = np.where(problem.free, weight, problem.forces_of(problem.stress))
    problem.hold(fixed_components(settings))
    missing_force = np.where(problem.free, constant - internal_force, 0.0)
    if problem.exchange.norm(missing_force) > settings.tolerance * problem.exchange.norm(constant):
        apply_load(problem, constant - missing_force, missing_force, settings)
    _begin_here(problem)
    return path


def _begin_here(problem: PlaneStrain) -> None:
    """Set displacement and strain to zero."""
    problem.displacement[:] = 0.0
    problem.plastic_strain[:] = 0.0
    problem.strain[:] = 0.0


def fixed_components(settings: FemSettings) -> dict[str, str]:
    """Return the displacement components that are fixed on the boundaries after loading by the weight.

    Parameters
    ----------
    settings : settings with the sides of the section

    Returns
    -------
    Components such as {"base": "xy", "left": "x", "right": "x"}, as ``PlaneStrain.hold`` reads them.
    """
    fixed = FIXED_AT_SIDES[settings.sides]
    return {"base": "xy", "left": fixed, "right": fixed}


def under_weight(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any = None, faces: Sequence[ShallowFailure] = ()
) -> tuple[PlaneStrain, np.ndarray]:
    """Return the elements of a section without stress, and the nodal forces of its weight.

    Displacements are fixed as under gravity. Below the faces, and below the ends of loads on bare sand, the ground is
    strengthened.

    Parameters
    ----------
    section, mesh, settings, comm, faces : as in `gravity_equilibrium`

    Returns
    -------
    The elements, and the nodal forces (dofs,) in N/m of the weight, of static pore pressure, free water and surcharges.

    Raises
    ------
    InputError
        If the ground has no weight or a stratum no strength, or if sides that differ are periodic.
    UnstableError
        If pore water lifts sand without cohesion.
    """
    api.require()
    strata = soils(section)
    element, strong = element_for(section, settings), strengthened(section, faces, settings) if faces else section
    strong = with_strengthened_load_ends(strong, settings.least_depth)
    strips = [s for s in strong.strata if s.name not in mesh.strata]
    soil = [*strata, *strips, *cohesion_levels(section, mesh)]
    problem = PlaneStrain(mesh, soil, element, comm, settings.threads, settings.flow, settings.davis)
    _assign_strips(strata if mesh.method == "free" else [], strong, problem)
    _assign_strips(strips, strong, problem)
    assign_levels(problem, section, len(strata) + len(strips))
    if settings.sides == "periodic":
        refuse_other_water(section)
        problem.tie("left", "right", section)
    else:
        problem.hold(FIXED_UNDER_GRAVITY)
    weight = problem.body_force([s.density_ordinary for s in problem.strata], (0.0, -GRAVITY))
    weight = weight + hydrostatic_load(problem, mesh, section)
    if settings.sides == "periodic":
        weight = weight + pressed_sides(problem, mesh, section)
    if problem.exchange.norm(weight) == 0.0:
        raise InputError(section.name, ["density_ordinary is 0 in all strata, so that the ground has no weight"])
    return problem, weight


def vertical_inertia(problem: PlaneStrain, settings: FemSettings) -> np.ndarray:
    """Return the nodal forces of vertical inertia, which the vertical seismic coefficient causes.

    Parameters
    ----------
    problem : the elements, with the seismic densities of their strata
    settings : settings with Kv, positive upwards

    Returns
    -------
    Forces (dofs,) in N/m, upwards if Kv is positive.
    """
    return problem.body_force([s.density_seismic for s in problem.strata], (0.0, settings.vertical * GRAVITY))


def _assign_strips(strips: Sequence[Stratum], strong: Section, problem: PlaneStrain) -> None:
    """Assign the soils of ``strips``, strata of the strengthened section ``strong``, to the quadrature points inside
    them.

    In a free mesh ``strips`` are all strata, since the cells do not follow the thin tips of layers.
    """
    strip_of_points = strong.stratum_at(*problem.points().T)
    names, stratum_names = ([stratum.name for stratum in strata] for strata in (strong.strata, problem.strata))
    for strip in strips:
        if strip.name in names:  # one that is strengthened as a whole is not
            problem.material[strip_of_points == names.index(strip.name)] = stratum_names.index(strip.name)


def apply_load(problem: PlaneStrain, constant: np.ndarray, load: np.ndarray, settings: FemSettings) -> EquilibriumPath:
    """Apply a load in addition to constant forces, in one step if Newton's method converges, along a path if not.

    If the flow is associated, one step finds equilibrium if there is any.

    Parameters
    ----------
    problem : the elements in equilibrium with ``constant``, which are in equilibrium with both forces afterwards
    constant, load (dofs,) : nodal forces that act already, and those to be applied (N/m)
    settings : settings with the tolerance, and the steps of a path

    Returns
    -------
    The path on which the load was applied; its multiplier is 1 at the end.

    Raises
    ------
    UnstableError
        If the ground fails under the load.
    """
    norm, dot = problem.exchange.norm, problem.exchange.dot
    problem.use_elastic_tangent()
    problem.factorise()
    control = load / norm(load)
    newton = replace(LOADING_NEWTON, tolerance=settings.tolerance)
    follow = replace(path_settings(problem, settings), first_step=0.2, largest_step=0.2, newton=newton)
    path = EquilibriumPath(
        problem, ProportionalLoad(constant, load), control, dot(control, problem.solve(load)),
        norm(load) + norm(constant), follow,
    )  # fmt: skip
    resisted, reached = 0.0, path.reach(1.0)
    while not reached:
        if not path.advance() or path.factor >= 1.0 or path.length > LONGEST_LOADING:
            share = f", of which the ground supports about {100 * resisted:.0f} %" if resisted > 0.0 else ""
            raise UnstableError(
                f"the section fails under its own weight{share}; check strengths and densities, or compute the "
                "factor of safety at Kh = 0"
            )
        if path.relax():
            resisted = path.factor
        reached = not problem.associated and path.reach(1.0)
    return path


def side_force(problem: PlaneStrain, mesh: QuadMesh, section: Section, weight: np.ndarray) -> np.ndarray:
    """Return the nodal forces (dofs,) in N/m of the K0 stress on both sides of ``section``.

    ``problem`` are the elements of ``mesh``, fixed as under gravity; ``weight`` are the nodal forces of gravity (N/m).
    """
    problem.use_elastic_tangent()
    problem.factorise()
    moved = problem.exchange.to_local(problem.solve(weight))
    grid, water = problem.grid, section.water_pressure
    strain = np.zeros((grid.weights.size, 4))
    assembly.strains(grid.matrix, grid.dofs, moved, strain)
    stress = np.einsum("pij,pj->pi", problem.elastic_stiffness()[problem.material], strain)
    stress = stress.reshape(*grid.weights.shape, 4)
    by_cell = np.einsum("cq,cqk,cqkd->cd", grid.weights, stress, grid.matrix)[:, 0::2]
    force = np.zeros_like(weight)
    for name, outwards in (("left", -1.0), ("right", 1.0)):
        side_nodes = np.isin(grid.global_dofs[grid.dofs[:, 0::2]] // 2, grid.sides[name])
        on_side = np.bincount(grid.stratum, (by_cell * side_nodes).sum(axis=1), minlength=len(section.strata))
        pressed = k0_stress(section, name, outwards * grid.comm.allreduce(on_side))

        def traction(
            points: np.ndarray, near: np.ndarray, normal: np.ndarray, pressed: SideStress = pressed
        ) -> np.ndarray:
            stratum = pressed.stratum_at(near[:, 1])
            total = pressed.at(points[:, 1], stratum)
            if water.present:
                total = total - water.at_rest(points, near, stratum)
            return np.column_stack([total * np.sign(normal[:, 0]), np.zeros(len(points))])

        force = force + ground_force(problem, mesh, traction, name)
    return force
