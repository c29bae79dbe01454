"""Computes what one Newton iteration needs (kernels): strains from displacements, forces from stresses, element
stiffness matrices."""

import numba as nb
import numpy as np


@nb.njit(cache=True, nogil=True)
def strains(matrix: np.ndarray, dofs: np.ndarray, displacement: np.ndarray, out: np.ndarray) -> None:
    """Compute the strain at every quadrature point, B u.

    Parameters
    ----------
    matrix (nc, nq, 4, nd) : strain-displacement matrix B (1/m)
    dofs (nc, nd) : numbers of the displacement components of each cell
    displacement (needed,) : displacement components (m)
    out (nc * nq, 4) : set to the strain [xx, yy, zz, xy], engineering shear
    """
    cells, points, _, entries = matrix.shape
    for cell in range(cells):
        for point in range(points):
            row = cell * points + point
            for i in range(4):
                total = 0.0
                for a in range(entries):
                    total += matrix[cell, point, i, a] * displacement[dofs[cell, a]]
                out[row, i] = total


@nb.njit(cache=True, nogil=True)
def internal_forces(
    matrix: np.ndarray, weights: np.ndarray, dofs: np.ndarray, stress: np.ndarray, out: np.ndarray
) -> None:
    """Compute the nodal forces ∫ Bᵀσ dA of a stress.

    Parameters
    ----------
    matrix (nc, nq, 4, nd) : strain-displacement matrix B (1/m)
    weights (nc, nq) : areas of the quadrature points (m²)
    dofs (nc, nd) : numbers of the displacement components of each cell
    stress (nc * nq, 4) : stress [xx, yy, zz, xy], tension positive (Pa)
    out (needed,) : set to the forces (N/m)
    """
    cells, points, _, entries = matrix.shape
    out[:] = 0.0
    for cell in range(cells):
        for a in range(entries):
            total = 0.0
            for point in range(points):
                row = cell * points + point
                part = 0.0
                for i in range(4):
                    part += matrix[cell, point, i, a] * stress[row, i]
                total += part * weights[cell, point]
            out[dofs[cell, a]] += total


@nb.njit(cache=True, nogil=True)
def _leave_out(matrix: np.ndarray, free: np.ndarray, dofs: np.ndarray) -> None:
    """Set the rows and columns of an element matrix that are not ``free`` to zero."""
    for a in range(len(dofs)):
        if not free[dofs[a]]:
            matrix[a, :] = 0.0
            matrix[:, a] = 0.0


@nb.njit(cache=True, nogil=True)
def element_stiffness(
    matrix: np.ndarray,
    weights: np.ndarray,
    tangent: np.ndarray,
    free: np.ndarray,
    dofs: np.ndarray,
    out: np.ndarray,
) -> None:
    """Add ∫ BᵀCB dA of every cell to its stiffness matrix; rows and columns of fixed components become zero.

    Parameters
    ----------
    matrix (nc, nq, 4, nd) : strain-displacement matrix B (1/m)
    weights (nc, nq) : areas of the quadrature points (m²)
    tangent (nc * nq, 4, 4) : tangent stiffness C (Pa)
    free (needed,) : mask of the displacement components that can move
    dofs (nc, nd) : numbers of the displacement components of each cell
    out (nc, nd, nd) : stiffness matrices of the cells, which are changed (Pa)
    """
    cells, points, _, entries = matrix.shape
    product = np.empty((4, entries))
    for cell in range(cells):
        for point in range(points):
            row = cell * points + point
            weight = weights[cell, point]
            for i in range(4):
                for b in range(entries):
                    total = 0.0
                    for j in range(4):
                        total += tangent[row, i, j] * matrix[cell, point, j, b]
                    product[i, b] = weight * total
            for a in range(entries):
                for b in range(entries):
                    total = 0.0
                    for i in range(4):
                        total += matrix[cell, point, i, a] * product[i, b]
                    out[cell, a, b] += total
        _leave_out(out[cell], free, dofs[cell])


@nb.njit(cache=True, nogil=True)
def add_forces(stiffness: np.ndarray, dofs: np.ndarray, displacement: np.ndarray, out: np.ndarray) -> None:
    """Add the nodal forces K u of every cell.

    Parameters
    ----------
    stiffness (nc, nd, nd) : stiffness matrix K of every cell (Pa)
    dofs (nc, nd) : numbers of the displacement components of each cell
    displacement (needed,) : displacement components (m)
    out (needed,) : increased by the forces (N/m)
    """
    for cell in range(len(stiffness)):
        for a in range(dofs.shape[1]):
            total = 0.0
            for b in range(dofs.shape[1]):
                total += stiffness[cell, a, b] * displacement[dofs[cell, b]]
            out[dofs[cell, a]] += total
