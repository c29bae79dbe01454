"""Condenses the displacement components inside a cell, which no other cell shares, out of its stiffness matrix
(kernels).

With the components b on the border of a cell and i inside it,

    (K_bb - K_bi K_ii⁻¹ K_ib) u_b = f_b - K_bi K_ii⁻¹ f_i,    u_i = K_ii⁻¹ (f_i - K_ib u_b)    (Guyan 1965).
"""

import numba as nb
import numpy as np


@nb.njit(cache=True, nogil=True, error_model="numpy")
def condense(elements: np.ndarray, inverse: np.ndarray) -> None:
    """Eliminate the last two displacement components of every stiffness matrix (static condensation).

    Parameters
    ----------
    elements (nc, nd, nd) : stiffness matrices (Pa), whose border blocks become the condensed matrices. The blocks K_bi
        and K_ib stay, for `condense_force` and `expand`.
    inverse (nc, 2, 2) : set to K_ii⁻¹ (1/Pa); not finite for a cell that has no stiffness inside
    """
    cells, entries, _ = elements.shape
    inside = 2
    border = entries - inside
    row = np.empty(inside)
    for cell in range(cells):
        matrix = elements[cell]
        a, b, c, d = matrix[border, border], matrix[border, -1], matrix[-1, border], matrix[-1, -1]
        determinant = a * d - b * c
        inverse[cell, 0, 0], inverse[cell, 0, 1] = d / determinant, -b / determinant
        inverse[cell, 1, 0], inverse[cell, 1, 1] = -c / determinant, a / determinant
        for m in range(border):
            for i in range(inside):
                row[i] = matrix[m, border] * inverse[cell, 0, i] + matrix[m, border + 1] * inverse[cell, 1, i]
            for n in range(border):
                matrix[m, n] -= row[0] * matrix[border, n] + row[1] * matrix[border + 1, n]


@nb.njit(cache=True, nogil=True)
def condense_force(
    elements: np.ndarray, inverse: np.ndarray, dofs: np.ndarray, force: np.ndarray, change: np.ndarray
) -> None:
    """Compute the force -K_bi K_ii⁻¹ f_i that the forces inside the cells exert on the borders of the cells.

    Parameters
    ----------
    elements (nc, nd, nd) : stiffness matrices of `condense`, borders first (Pa)
    inverse (nc, 2, 2) : K_ii⁻¹ of every cell (1/Pa)
    dofs (nc, nd) : numbers of the displacement components of each cell
    force (needed,) : nodal forces (N/m)
    change (needed,) : set to the forces to be added on the borders (N/m)
    """
    cells, entries, _ = elements.shape
    inside = inverse.shape[1]
    border = entries - inside
    change[:] = 0.0
    for cell in range(cells):
        for i in range(inside):
            solved = 0.0
            for j in range(inside):
                solved += inverse[cell, i, j] * force[dofs[cell, border + j]]
            for a in range(border):
                change[dofs[cell, a]] -= elements[cell, a, border + i] * solved


@nb.njit(cache=True, nogil=True)
def expand(
    elements: np.ndarray, inverse: np.ndarray, dofs: np.ndarray, force: np.ndarray, displacement: np.ndarray
) -> None:
    """Compute the displacement inside the cells from the displacement of their borders.

    Parameters
    ----------
    elements, inverse, dofs, force : as in `condense_force`
    displacement (needed,) : displacements (m), of which those inside the cells are set
    """
    cells, entries, _ = elements.shape
    inside = inverse.shape[1]
    border = entries - inside
    left = np.empty(inside)
    for cell in range(cells):
        for i in range(inside):
            left[i] = force[dofs[cell, border + i]]
            for a in range(border):
                left[i] -= elements[cell, border + i, a] * displacement[dofs[cell, a]]
        for i in range(inside):
            total = 0.0
            for j in range(inside):
                total += inverse[cell, i, j] * left[j]
            displacement[dofs[cell, border + i]] = total
