"""Holds the fields of an equilibrium state by cell and by corner, for pictures and files, and decides whether the state
is a mechanism."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from meshes.quad_mesh import QuadMesh
from meshes.quality import areas

if TYPE_CHECKING:
    from fem.continuum.plane_strain import PlaneStrain

# A cell has failed if its mobilised strength exceeds this share of its strength.
FAILURE_STRENGTH_RATIO = 0.99
# A mechanism has formed if the plastic shear strain is this multiple of the elastic one; it reaches a side that moves
# by this share of the largest displacement.
MECHANISM_STRAIN_RATIO, SIDE_DISPLACEMENT_SHARE = 10.0, 0.1
# A failure slides to a side if this share of its horizontal displacement, over its area, is towards the side.
SLIDING_SHARE = 0.2


@dataclass(frozen=True)
class FieldState:
    """Holds the fields of the section at one Kh, in the numbering of the mesh; n points, m cells.

    Attributes
    ----------
    label : name of the state, shown in legends and used in file names
    kh : seismic coefficient of the state (-)
    displacement (n, 2) : displacement since the state under gravity alone (m)
    stress (m, 4) : stress [xx, yy, zz, xy], tension positive, mean over each cell (Pa)
    shear_strain, plastic_shear_strain (m,) : largest engineering shear strain in the plane, mean over the cell (-)
    mobilised (m,) : mobilised strength: shear stress over shear strength on the worst plane, 1 at failure (-). The
        paper calls this ratio the local safety factor.
    past_equilibrium : whether there is no equilibrium at ``kh``, so that the fields are those of the last state of the
        path
    repeats : whether the section is one period of an endless row of sections (periodic sides)
    """

    label: str
    kh: float
    displacement: np.ndarray
    stress: np.ndarray
    shear_strain: np.ndarray
    plastic_shear_strain: np.ndarray
    mobilised: np.ndarray
    past_equilibrium: bool = False
    repeats: bool = False

    @property
    def failed(self) -> np.ndarray:
        """Return which cells (m,) are at failure."""
        return self.mobilised >= FAILURE_STRENGTH_RATIO


def state_of(problem: "PlaneStrain", mesh: QuadMesh, label: str, kh: float) -> FieldState:
    """Return the fields of the accepted state of a problem, gathered on every rank.

    Parameters
    ----------
    problem : the elements with their accepted state; its displacement and strains count from the state under gravity
    mesh : the mesh from which the elements were made
    label : name of the state, shown in legends and used in file names
    kh : seismic coefficient of the state (-)

    Returns
    -------
    The fields by corner and by cell; the mobilised strength is at most 1.
    """
    from fem.kernels import mohr_coulomb  # not needed to read a stored state

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
    return FieldState(label, kh, displacement, stress, shear, plastic, factor, repeats=problem.repeats)


def _shear(strain: np.ndarray) -> np.ndarray:
    """Return the largest engineering shear strain in the plane (n,) of strains (n, 4)."""
    return np.hypot(strain[:, 0] - strain[:, 1], strain[:, 3])


def touched_sides(mesh: QuadMesh, state: FieldState) -> tuple[str, ...]:
    """Return the sides that move by more than a tenth of the largest displacement.

    Parameters
    ----------
    mesh : the mesh of the section, with its boundaries "left" and "right"
    state : the state whose displacements are compared

    Returns
    -------
    "left", "right", both or none; none with periodic sides, since the section repeats.
    """
    if state.repeats:
        return ()
    moved = np.hypot(*state.displacement.T)
    return tuple(
        side
        for side in ("left", "right")
        if moved[mesh.boundaries[side]].max(initial=0.0) > SIDE_DISPLACEMENT_SHARE * max(moved.max(), 1e-300)
    )


def sliding_sides(mesh: QuadMesh, state: FieldState) -> tuple[int, ...]:
    """Return the sides to which the ground slides in a state.

    A side counts if a fifth of the horizontal displacement, summed over the area of the cells, is towards it.

    Parameters
    ----------
    mesh : the mesh of the section
    state : the state at failure

    Returns
    -------
    -1 for left, 1 for right, or both if the ground spreads, as an embankment on soft ground does.
    """
    moved = areas(mesh.points, mesh.cells) * state.displacement[mesh.cells, 0].mean(axis=1)
    total = max(float(np.abs(moved).sum()), 1e-300)
    return tuple(side for side in (-1, 1) if np.maximum(side * moved, 0.0).sum() >= SLIDING_SHARE * total)


def is_mechanism(state: FieldState) -> bool:
    """Return whether the ground fails in a state.

    Parameters
    ----------
    state : the state of the ground

    Returns
    -------
    True if the largest plastic shear strain is more than ten times the largest elastic shear strain.
    """
    elastic = (state.shear_strain - state.plastic_shear_strain).max()
    return bool(state.plastic_shear_strain.max() > MECHANISM_STRAIN_RATIO * max(elastic, 1e-300))
