"""Fields of a state of equilibrium for pictures and files, by cell and by corner, and the slip surface in them."""

from dataclasses import dataclass

import numpy as np

from fem.kernels import mohr_coulomb
from fem.plane_strain import PlaneStrain
from meshes.quad_mesh import QuadMesh

# A cell counts as failed when its mobilised strength is within this of the whole.
AT_FAILURE = 0.99


@dataclass(frozen=True)
class State:
    """Fields of the section at one Kh, in the numbering of the mesh; n points, m cells.

    Attributes
    ----------
    label : str
        What the state is.
    kh : float
        Its seismic coefficient (-).
    displacement : ndarray (n, 2)
        Since gravity (m).
    stress : ndarray (m, 4)
        Mean over the cell [xx, yy, zz, xy], tension positive (Pa).
    shear_strain, plastic_shear_strain : ndarray (m,)
        Largest engineering shear strain in the plane, mean over the cell (-).
    safety_factor : ndarray (m,)
        The paper's: mobilised over available shear strength on the worst plane, 1 at failure (-).
    past_equilibrium : bool
        Whether there is no equilibrium at ``kh`` and the last state of the path stands in its place.
    """

    label: str
    kh: float
    displacement: np.ndarray
    stress: np.ndarray
    shear_strain: np.ndarray
    plastic_shear_strain: np.ndarray
    safety_factor: np.ndarray
    past_equilibrium: bool = False

    @property
    def failed(self) -> np.ndarray:
        """Which cells (m,) are at failure."""
        return self.safety_factor >= AT_FAILURE


def state_of(problem: PlaneStrain, mesh: QuadMesh, label: str, kh: float) -> State:
    """The fields of a problem's accepted state, gathered on every rank."""
    grid = problem.grid
    share = grid.weights / grid.weights.sum(axis=1, keepdims=True)

    def mean(values: np.ndarray) -> np.ndarray:
        by_cell = values.reshape(*grid.weights.shape, *values.shape[1:])
        return np.einsum("cq,cq...->c...", share, by_cell)

    safety = mohr_coulomb.local_safety_factor(problem.stress, problem.material, problem.table)
    local = problem.exchange.to_local(problem.displacement)
    corner_values = local[grid.dofs[:, :8]].reshape(-1, 4, 2)
    parts = grid.comm.allgather(
        (
            grid.cell,
            mean(problem.stress),
            mean(_shear(problem.strain)),
            mean(_shear(problem.plastic_strain)),
            mean(np.minimum(safety, 1.0)),
            grid.corners,
            corner_values,
        )
    )
    cells = len(mesh.cells)
    stress, shear, plastic, factor = np.zeros((cells, 4)), np.zeros(cells), np.zeros(cells), np.zeros(cells)
    displacement = np.zeros((len(mesh.points), 2))
    for cell, s, g, p, f, corners, moved in parts:
        stress[cell], shear[cell], plastic[cell], factor[cell] = s, g, p, f
        displacement[corners] = moved
    return State(label, kh, displacement, stress, shear, plastic, factor)


def _shear(strain: np.ndarray) -> np.ndarray:
    """Largest engineering shear strain in the plane (n,) of strains (n, 4)."""
    return np.hypot(strain[:, 0] - strain[:, 1], strain[:, 3])


def slip_surface(mesh: QuadMesh, state: State, columns: int = 100) -> np.ndarray:
    """Elevation of the largest shear strain along x, (k, 2) in m; only where it stands out.

    In each column the cells are those whose middle is nearest; a column counts where its largest shear strain exceeds
    a tenth of the section's largest.
    """
    middle = mesh.points[mesh.cells].mean(axis=1)
    edges = np.linspace(mesh.points[:, 0].min(), mesh.points[:, 0].max(), columns + 1)
    half = np.ptp(mesh.points[mesh.cells][:, :, 0], axis=1) / 2.0
    found = []
    for x in 0.5 * (edges[1:] + edges[:-1]):
        here = np.flatnonzero(np.abs(middle[:, 0] - x) <= half)
        if not len(here):
            continue
        worst = here[np.argmax(state.shear_strain[here])]
        if state.shear_strain[worst] > 0.1 * state.shear_strain.max():
            found.append((x, middle[worst, 1]))
    return np.array(found).reshape(-1, 2)
