"""Fields of a state of equilibrium for pictures and files, by cell and by corner, and the slip surface in them."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.kernels import mohr_coulomb
from meshes.quad_mesh import QuadMesh

if TYPE_CHECKING:
    from fem.plane_strain import PlaneStrain

# A cell counts as failed when its mobilised strength is within this of the whole.
AT_FAILURE = 0.99
# A mechanism: plastic shear strain this many times the elastic one; a side takes part if it moves this share of the
# largest displacement.
STANDS_OUT, TOUCHES = 10.0, 0.1
# A slip surface ends where the strain is below this share of the largest; a jump from column to column costs so much
# for each unit of slope beyond the steep one.
FAINT, JUMP, STEEP = 0.1, 0.5, 1.5


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
    mobilised : ndarray (m,)
        Mobilised share of strength: shear stress over shear strength on the worst plane, 1 at failure (-). The paper
        calls it the local safety factor.
    past_equilibrium : bool
        Whether there is no equilibrium at ``kh`` and the last state of the path stands in its place.
    """

    label: str
    kh: float
    displacement: np.ndarray
    stress: np.ndarray
    shear_strain: np.ndarray
    plastic_shear_strain: np.ndarray
    mobilised: np.ndarray
    past_equilibrium: bool = False

    @property
    def failed(self) -> np.ndarray:
        """Which cells (m,) are at failure."""
        return self.mobilised >= AT_FAILURE


def state_of(problem: "PlaneStrain", mesh: QuadMesh, label: str, kh: float) -> State:
    """The fields of a problem's accepted state, gathered on every rank."""
    grid = problem.grid
    share = grid.weights / grid.weights.sum(axis=1, keepdims=True)

    def mean(values: np.ndarray) -> np.ndarray:
        by_cell = values.reshape(*grid.weights.shape, *values.shape[1:])
        return np.einsum("cq,cq...->c...", share, by_cell)

    mobilised = mohr_coulomb.mobilised_strength(problem.stress, problem.material, problem.table)
    local = problem.exchange.to_local(problem.displacement)
    corner_values = local[grid.dofs[:, :8]].reshape(-1, 4, 2)
    parts = grid.comm.allgather(
        (
            grid.cell,
            mean(problem.stress),
            mean(_shear(problem.strain)),
            mean(_shear(problem.plastic_strain)),
            mean(np.minimum(mobilised, 1.0)),
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


def touched_sides(mesh: QuadMesh, state: State) -> tuple[str, ...]:
    """Which of the sides, "left" and "right", move by more than a tenth of the largest displacement."""
    moved = np.hypot(*state.displacement.T)
    return tuple(
        side for side in ("left", "right") if moved[mesh.boundaries[side]].max() > TOUCHES * max(moved.max(), 1e-300)
    )


def is_mechanism(state: State) -> bool:
    """Whether the plastic shear strain of a state stands out from the elastic one, as it does once the ground fails."""
    elastic = (state.shear_strain - state.plastic_shear_strain).max()
    return bool(state.plastic_shear_strain.max() > STANDS_OUT * max(elastic, 1e-300))


def slip_surface(mesh: QuadMesh, state: State, columns: int = 100) -> np.ndarray:
    """The ridge of plastic shear strain along x, (k, 2) in m, in the ground that fails; empty without a mechanism.

    Of all lines with one point in each column, it is the one with the largest product of strains less a penalty for
    jumps, found by dynamic programming. It ends where the strain is below a tenth of the largest.
    """
    if not is_mechanism(state):
        return np.zeros((0, 2))
    strain = state.plastic_shear_strain / state.plastic_shear_strain.max()
    middle = mesh.points[mesh.cells].mean(axis=1)
    half = np.ptp(mesh.points[mesh.cells][:, :, 0], axis=1) / 2.0
    edges = np.linspace(mesh.points[:, 0].min(), mesh.points[:, 0].max(), columns + 1)
    places = 0.5 * (edges[1:] + edges[:-1])
    inside = [np.flatnonzero((np.abs(middle[:, 0] - x) <= half) & (strain > FAINT)) for x in places]
    best: list[tuple[float, np.ndarray]] = [(0.0, np.zeros((0, 2)))]
    run: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # cells, best sum up to each, and where that came from
    for cells in [*inside, np.zeros(0, dtype=int)]:
        if len(cells) and run:
            jump = np.abs(middle[cells, 1][:, None] - middle[run[-1][0], 1][None, :]) / (edges[1] - edges[0])
            sums = run[-1][1][None, :] - JUMP * np.maximum(jump - STEEP, 0.0)
            run.append((cells, sums.max(axis=1) + np.log(strain[cells] / FAINT), sums.argmax(axis=1)))
        elif len(cells):
            run = [(cells, np.log(strain[cells] / FAINT), np.zeros(len(cells), dtype=int))]
            first = places[next(k for k, here in enumerate(inside) if here is cells)]
        elif run:
            best.append(_traced(run, middle, first + (edges[1] - edges[0]) * np.arange(len(run))))
            run = []
    return max(best, key=lambda line: line[0])[1]


def _traced(
    run: list[tuple[np.ndarray, np.ndarray, np.ndarray]], middle: np.ndarray, x: np.ndarray
) -> tuple[float, np.ndarray]:
    """The best line through a run of columns, from its end to its start, and its sum."""
    at = int(run[-1][1].argmax())
    total, heights = float(run[-1][1][at]), []
    for cells, _, before in reversed(run):
        heights.append(middle[cells[at], 1])
        at = int(before[at])
    return total, np.column_stack([x, heights[::-1]])
