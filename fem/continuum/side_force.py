"""Nodal forces of the K0 stress (``side_stress.py``) and of the pore water on free-field sides."""

import numpy as np

from fem.continuum.nodal_loads import ground_force
from fem.continuum.plane_strain import PlaneStrain
from fem.continuum.side_stress import SideStress, k0_stress
from fem.kernels import assembly
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


def side_force(problem: PlaneStrain, mesh: QuadMesh, section: Section, weight: np.ndarray) -> np.ndarray:
    """Nodal forces (dofs,) in N/m of the K0 stress on both sides of ``section``.

    ``problem``: the elements of ``mesh``, held as under gravity; ``weight``: nodal forces of gravity (N/m).
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
        here = np.isin(grid.global_dofs[grid.dofs[:, 0::2]] // 2, grid.sides[name])
        on_side = np.bincount(grid.stratum, (by_cell * here).sum(axis=1), minlength=len(section.strata))
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
