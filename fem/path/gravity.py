"""Brings the section to equilibrium under its weight (K0 stage), from which the seismic load starts."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

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
# Number of levels by which a varying cohesion of a stratum is represented, and the lowest level over the highest.
# Levels differ by a constant factor, since at a bare cut the smallest cohesions matter as much as the large ones.
COHESION_LEVELS, LOWEST_COHESION_RATIO = 512, 1e-3


def element_for(section: Section, settings: FemSettings) -> Element:
    """Return the element of the settings; by default the element that suits the flow rule
    (docs/theory/continuum.md)."""
    if settings.element != "auto":
        return settings.element
    return "reduced" if is_associated(section.strata, settings.flow) else "quadratic"


def path_settings(problem: PlaneStrain, settings: FemSettings) -> PathSettings:
    """Return settings of paths in this ground: long steps and no overstress if its flow is associated."""
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
    """Bring the section to equilibrium under its weight; return the section in equilibrium, the constant nodal forces
    (N/m) on it, and the path of equilibria under the rising weight.

    Under gravity the sides are held horizontally (K0); sides that are released afterwards keep their reactions as
    forces. Periodic sides are periodic from the start and have no reactions (``repetition.py``). Displacement and
    strain are then set to zero. ``faces`` as in ``under_weight``; ``strength_factor`` divides cohesion and tan φ.
    Excess pore pressure by shaking acts with ``excess_pressure``. Raises InputError, UnstableError. ``section``: the
    section of the ground; ``mesh``: a mesh of the section; ``settings``: settings of the finite elements; ``comm``: MPI
    communicator.
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
    """Return the section without stress, with the sides of the search for Kh; the nodal forces (N/m) of its weight; and
    all constant nodal forces.

    On free-field sides the K0 stress is that of ``side_stress.py``, as in the bounds. Excess pore pressure by shaking
    acts with ``excess_pressure``, on the K0 stress, too: the effective horizontal stress of level ground falls with the
    vertical one, while the total horizontal stress rises. Raises InputError.
    ``section``, ``mesh``, ``settings``, ``comm``, ``faces``: as in ``gravity_equilibrium``.
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
    """Load the unstressed ground by its weight with fixed sides, then by the other constant forces; return the path
    under the weight.

    Displacement and strain are then set to zero. Raises UnstableError. ``problem`` are the elements; ``weight`` and
    ``constant`` are the nodal forces of gravity alone, and all constant nodal forces (N/m); ``settings`` are those of
    the finite elements.
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
    """Return the displacement components that are fixed on the boundaries after loading by the weight."""
    fixed = FIXED_AT_SIDES[settings.sides]
    return {"base": "xy", "left": fixed, "right": fixed}


def under_weight(
    section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any = None, faces: Sequence[ShallowFailure] = ()
) -> tuple[PlaneStrain, np.ndarray]:
    """Return the elements of the section on a ``mesh`` without stress, with the displacements that are fixed under
    gravity, and the nodal forces (N/m) of the weight. Below ``faces``, and below the ends of loads on bare sand, the
    ground is strengthened. ``settings``: settings of the finite elements; ``comm``: MPI communicator."""
    api.require()
    strata = soils(section)
    element, strong = element_for(section, settings), strengthened(section, faces, settings) if faces else section
    strong = with_strengthened_load_ends(strong, settings.least_depth)
    strips = [s for s in strong.strata if s.name not in mesh.strata]
    soil = [*strata, *strips, *levels(section, mesh)]
    problem = PlaneStrain(mesh, soil, element, comm, settings.threads, settings.flow, settings.davis)
    _assign_strips(strata if mesh.method == "free" else [], strong, problem)
    _assign_strips(strips, strong, problem)
    _lay_levels(len(strata) + len(strips), section, problem)
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
    """Return the nodal forces (N/m) of vertical inertia, which the vertical seismic coefficient causes."""
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


def levels(section: Section, mesh: QuadMesh) -> list[Stratum]:
    """For every stratum whose cohesion varies, return ``COHESION_LEVELS`` soils of constant cohesion from the smallest
    to the largest."""
    field, strata = section.cohesion_field, []
    corners = mesh.points[mesh.cells]
    for k in np.flatnonzero(field.varies):
        # All cells are considered: in a free mesh, cells at the tip of a layer belong to its neighbours.
        points, near = corners.reshape(-1, 2), np.repeat(corners.mean(axis=1), corners.shape[1], axis=0)
        in_stratum = np.repeat(mesh.stratum == k, corners.shape[1]) if (mesh.stratum == k).any() else slice(None)
        cohesion = field.at(points[in_stratum], near[in_stratum], np.full(len(points[in_stratum]), k))
        largest_cohesion = max(float(cohesion.max()), 1e-9)  # Pa
        bins = np.linspace(
            0.0,
            np.log(max(float(cohesion.min()), LOWEST_COHESION_RATIO * largest_cohesion) / largest_cohesion),
            COHESION_LEVELS,
        )[::-1]
        strata += [section.strata[k].with_cohesion(float(c)) for c in largest_cohesion * np.exp(bins)]
    return strata


def _lay_levels(first: int, section: Section, problem: PlaneStrain) -> None:
    """Assign the soil of the nearest cohesion to every quadrature point of strata whose cohesion varies.

    ``first`` is the number, in the strata of the problem, of the first of the soils that `levels` returned.
    """
    field, points = section.cohesion_field, problem.points()
    for k in np.flatnonzero(field.varies):
        in_stratum = problem.material == k
        cohesion = field.at(points[in_stratum], points[in_stratum], np.full(int(in_stratum.sum()), k))
        levels = np.array([soil.cohesion for soil in problem.strata[first : first + COHESION_LEVELS]])
        problem.material[in_stratum] = first + np.searchsorted(0.5 * (levels[1:] + levels[:-1]), cohesion)
        first += COHESION_LEVELS


def apply_load(problem: PlaneStrain, constant: np.ndarray, load: np.ndarray, settings: FemSettings) -> EquilibriumPath:
    """Apply a whole load (N/m) in addition to ``constant`` forces, in one step if Newton's method converges, along a
    path if not.

    If the flow is associated, one step finds equilibrium if there is any. Raises UnstableError if the ground fails
    under the load. ``problem`` are the elements; ``settings`` contain tolerance and steps.
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
