"""The K0 stress that stays on the sides of a section on rollers: the reaction to its weight while they are held."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fem.limit.limit_problem import edge_ends
from fem.limit.upper_bound import add_edge_loads, strain_rates
from meshes.bisection import bisect
from meshes.pore_loads import corner_pressure
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.triangles import TriMesh

# Cells of the elastic analysis, at least.
ENOUGH_CELLS = 3000
UPWARDS = np.array([[0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class SideStress:
    """The horizontal stress on a side, linear over the thickness of each of the k strata there.

    Attributes
    ----------
    strata : ndarray (k,)
        Numbers of the strata, from the top down.
    elevation : ndarray (k, 2)
        Elevation of the top and the bottom of each in m.
    stress : ndarray (k, 2)
        Horizontal stress at both in Pa, tension positive.
    """

    strata: np.ndarray
    elevation: np.ndarray
    stress: np.ndarray

    def at(self, elevation: np.ndarray, stratum: np.ndarray) -> np.ndarray:
        """The stress (Pa) at elevations (m) within strata."""
        place = np.searchsorted(self.strata, stratum)
        top, bottom = self.elevation[place].T
        share = np.clip((top - elevation) / (top - bottom), 0.0, 1.0)
        return (1.0 - share) * self.stress[place, 0] + share * self.stress[place, 1]


def side_stresses(section: Section, mesh: TriMesh) -> dict[str, SideStress]:
    """The stress on the "left" and the "right" side.

    It grows with depth as it does without horizontal strain, ν / (1 - ν) of the weight of the column above, times a
    factor for each stratum that makes its resultant there the one of plane elasticity under weight with the sides
    held horizontally, the gravity stage of ``fem.critical``: where the ground slopes, one side takes more and the
    other less.
    It stays nearer to the plain K0 stress than to Rankine's active and passive ones.
    """
    while len(mesh.cells) < ENOUGH_CELLS:
        mesh, _ = bisect(mesh, np.arange(len(mesh.cells)))
    stress = _elastic_stress(section, mesh)
    return {side: _side_stress(section, mesh, stress, side) for side in ("left", "right")}


def _side_stress(section: Section, mesh: TriMesh, stress: np.ndarray, side: str) -> SideStress:
    layers = section.layering
    elevation = layers.left[0] if side == "left" else layers.right[-1]
    effective = _vertical_stress(section, side, elevation)
    here = np.flatnonzero(elevation[:-1] > elevation[1:])
    wanted = _resultants(mesh, stress, side, len(section.strata))
    found = []
    for k in here:
        soil = section.strata[k]
        vertical = effective[k]
        ratio = soil.poissons_ratio / (1.0 - soil.poissons_ratio)
        plain = ratio * vertical
        force = 0.5 * plain.sum() * (elevation[k] - elevation[k + 1])
        factor = -wanted[k] / force if force > 0.0 else 1.0
        sin, cos = np.sin(soil.friction_angle), np.cos(soil.friction_angle)
        active = np.maximum(((1.0 - sin) * vertical - 2.0 * soil.cohesion * cos) / (1.0 + sin), 0.0)
        passive = ((1.0 + sin) * vertical + 2.0 * soil.cohesion * cos) / (1.0 - sin)
        # Half-way to either limit at most: loose ground at the limit at its surface would not stand any push.
        lowest, highest = (0.5 * (np.clip(plain, active, passive) + limit) for limit in (active, passive))
        found.append(-np.clip(factor * plain, lowest, highest))
    return SideStress(here, np.column_stack([elevation[here], elevation[here + 1]]), np.array(found))


def _vertical_stress(section: Section, side: str, elevation: np.ndarray) -> np.ndarray:
    """Vertical effective stress (strata, 2) in Pa at top and bottom of every stratum on a side, pressure positive.

    ``elevation`` (interfaces,) is that of the layers there. What presses on the ground counts as if it went on level.
    """
    water, layers = section.water_pressure, section.layering
    strata = len(section.strata)
    x, near = layers.x[0], layers.x[:2].mean()
    if side == "right":
        x, near = layers.x[-1], layers.x[-2:].mean()
    found = np.zeros((strata, 2))
    thickness = elevation[:-1] - elevation[1:]
    weight = GRAVITY * np.array([s.density_ordinary for s in section.strata]) * thickness
    found[:, 1] = np.cumsum(weight)
    found[1:, 0] = found[:-1, 1]
    if water.present or section.surcharges:
        places = np.column_stack([np.full(2 * strata, x), np.repeat(elevation, 2)[1:-1]])
        beside = np.column_stack([np.full(2 * strata, near), np.zeros(2 * strata)])
        ground = np.array([[x, elevation[0]]])
        on_ground = water.on_ground(ground, beside[:1]) - section.surface_loads.dead(ground, beside[:1], UPWARDS)[:, 1]
        pores = water.at_rest(places, beside, np.repeat(np.arange(strata), 2))
        found = np.maximum(found + on_ground - pores.reshape(strata, 2), 0.0)
    return found


def _resultants(mesh: TriMesh, stress: np.ndarray, side: str, strata: int) -> np.ndarray:
    """Force (N/m), tension positive, of the horizontal stress (m, 3 corners) in every stratum on a side."""
    ends = mesh.boundaries[side]
    cells = mesh.edge_cells[mesh.edge_numbers(ends), 0]
    mean = np.zeros(len(ends))
    for end in (0, 1):
        mean += 0.5 * stress[cells, np.argmax(mesh.cells[cells] == ends[:, end][:, None], axis=1)]
    length = np.hypot(*(mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]).T)
    return np.bincount(mesh.stratum[cells], weights=mean * length, minlength=strata)


def _elastic_stress(section: Section, mesh: TriMesh) -> np.ndarray:
    """Horizontal effective stress (Pa) at the corners (m, 3) at rest, quadratic triangles, sides held horizontally."""
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
    """Nodal forces (n, 2) in N/m of pore pressure, of water on the ground and of surcharges at rest."""
    water, surface = section.water_pressure, section.surface_loads
    pressure = corner_pressure(mesh, water.at_rest)
    mass = (np.ones((3, 3)) + np.eye(3)) / 12.0
    volumetric = np.zeros((len(mesh.cells), 3, 3))
    volumetric[:, :, :2] = (mesh.areas[:, None] * (pressure @ mass))[:, :, None]
    load = (strain.T @ volumetric.ravel()).reshape(-1, 2)
    ends = mesh.boundaries["surface"]
    edges = mesh.edge_numbers(ends)
    at = edge_ends(mesh, ends, mesh.edge_cells[edges, 0])
    pressed = surface.dead(at.points, at.near, at.normal)
    pressed = pressed - water.on_ground(at.points, at.near)[:, None] * at.normal
    add_edge_loads(load, mesh, np.column_stack([ends, len(mesh.points) + edges]), pressed.reshape(-1, 2, 2))
    return load
