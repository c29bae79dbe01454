"""Computes the resultants of the K0 stress on free-field sides by plane elasticity on triangles."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fem.continuum.side_stress import SideStress, k0_stress
from fem.limit.limit_problem import edge_ends
from fem.limit.upper_bound import add_edge_loads, strain_rates
from meshes.bisection import bisect
from meshes.pore_loads import corner_pressure
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.triangles import TriMesh

# Smallest number of cells of the elastic analysis.
FEWEST_CELLS = 3000


def side_stresses(section: Section, mesh: TriMesh) -> dict[str, SideStress]:
    """Compute the K0 stress on the "left" and the "right" side (see ``fem/continuum/side_stress.py``) with the
    resultants of plane elasticity on triangles.
    """
    while len(mesh.cells) < FEWEST_CELLS:
        mesh, _ = bisect(mesh, np.arange(len(mesh.cells)))
    stress = _elastic_stress(section, mesh)
    strata = len(section.strata)
    return {side: k0_stress(section, side, _resultants(mesh, stress, side, strata)) for side in ("left", "right")}


def _resultants(mesh: TriMesh, stress: np.ndarray, side: str, strata: int) -> np.ndarray:
    """Return the force (N/m), tension positive, of the horizontal stress (m, 3 corners) in every stratum on a side."""
    ends = mesh.boundaries[side]
    cells = mesh.edge_cells[mesh.edge_numbers(ends), 0]
    mean = np.zeros(len(ends))
    for end in (0, 1):
        mean += 0.5 * stress[cells, np.argmax(mesh.cells[cells] == ends[:, end][:, None], axis=1)]
    length = np.hypot(*(mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]).T)
    return np.bincount(mesh.stratum[cells], weights=mean * length, minlength=strata)


def _elastic_stress(section: Section, mesh: TriMesh) -> np.ndarray:
    """Return the horizontal effective stress (Pa) at rest at the corners (m, 3), computed with elastic quadratic
    triangles whose sides are held horizontally.
    """
    nodes = mesh.six_nodes
    count = int(nodes.max()) + 1
    young = np.array([s.youngs_modulus for s in section.strata])
    poisson = np.array([s.poissons_ratio for s in section.strata])
    shear = young / (2.0 * (1.0 + poisson))
    lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson)
    law = np.zeros((len(young), 3, 3))
    law[:, 0, 0] = law[:, 1, 1] = lame + 2.0 * shear
    law[:, 0, 1] = law[:, 1, 0] = lame
    law[:, 2, 2] = shear
    strain = strain_rates(mesh, nodes)
    # The strain is linear: over a cell, the product of two such fields is A/12 (1 + δ_ij) of their corner values.
    mass = (np.ones((3, 3)) + np.eye(3)) / 12.0
    blocks = np.einsum("m,kl,mij->mkilj", mesh.areas, mass, law[mesh.stratum]).reshape(-1, 9, 9)
    size = len(blocks)
    weight = sparse.bsr_matrix((blocks, np.arange(size), np.arange(size + 1)), shape=(9 * size, 9 * size))
    stiffness = (strain.T @ weight @ strain).tocsc()
    load = np.zeros((count, 2))
    density = np.array([s.density_ordinary for s in section.strata])
    np.add.at(load[:, 1], nodes[:, 3:], (-GRAVITY * density[mesh.stratum] * mesh.areas / 3.0)[:, None])
    if section.water_pressure.present or section.surcharges:
        load += _water_and_surcharges(section, mesh, strain)
    moves = np.ones((count, 2), dtype=bool)
    for name, axes in (("base", [0, 1]), ("left", [0]), ("right", [0])):
        ends = mesh.boundaries[name]
        on_it = np.concatenate([ends.ravel(), len(mesh.points) + mesh.edge_numbers(ends)])
        moves[on_it[:, None], axes] = False
    free = moves.ravel()
    displacement = np.zeros(2 * count)
    factor = splu(stiffness[free][:, free], diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    displacement[free] = factor.solve(load.ravel()[free])
    strains = (strain @ displacement).reshape(-1, 3, 3)
    return np.einsum("mj,mkj->mk", law[mesh.stratum][:, 0], strains)


def _water_and_surcharges(section: Section, mesh: TriMesh, strain: sparse.csr_matrix) -> np.ndarray:
    """Return the nodal forces (n, 2) in N/m of pore pressure, of water on the ground and of surcharges at rest."""
    water, surface = section.water_pressure, section.surface_loads
    pressure = corner_pressure(mesh, water.at_rest)
    mass = (np.ones((3, 3)) + np.eye(3)) / 12.0
    volumetric = np.zeros((len(mesh.cells), 3, 3))
    volumetric[:, :, :2] = (mesh.areas[:, None] * (pressure @ mass))[:, :, None]
    load = (strain.T @ volumetric.ravel()).reshape(-1, 2)
    ends = mesh.boundaries["surface"]
    edges = mesh.edge_numbers(ends)
    at = edge_ends(mesh, ends, mesh.edge_cells[edges, 0])
    pressed = surface.dead(at.points, at.middles, at.normal)
    pressed = pressed - water.on_ground(at.points, at.middles)[:, None] * at.normal
    add_edge_loads(load, mesh, np.column_stack([ends, len(mesh.points) + edges]), pressed.reshape(-1, 2, 2))
    return load
