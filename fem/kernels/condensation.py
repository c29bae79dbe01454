"""Condenses the displacement components inside a cell, which no other cell shares, out of its stiffness matrix
(kernels).

With the components b on the border of a cell and i inside it,

    (K_bb - K_bi K_ii⁻¹ K_ib) u_b = f_b - K_bi K_ii⁻¹ f_i,    u_i = K_ii⁻¹ (f_i - K_ib u_b)    (Guyan 1965).
"""

import numba as nb
import numpy as np


@nb.njit(cache=True, nogil=True, error_model="numpy")
def condense(elements: np.ndarray, inverse: np.ndarray) -> None:
    """Eliminate the last two components of every stiffness matrix in ``elements`` (nc, nd, nd), in place (static
    condensation).

    The blocks K_bi and K_ib stay in the matrices, for ``condense_force`` and ``expand``. K_ii⁻¹ is written to
    ``inverse`` (nc, 2, 2), and is not finite for a cell that has no stiffness inside. The border block becomes the
    condensed matrix.
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
    """Compute the ``change`` (needed,) of the force on the borders of cells, -K_bi K_ii⁻¹ f_i, from the ``force``
    (needed,).

    ``elements`` (nc, nd, nd) are the stiffness matrices of the cells, borders first; ``inverse`` is K_ii⁻¹ of every
    cell; ``dofs`` (nc, nd) are the components of each cell.
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
    """Compute the ``displacement`` (needed,) inside the cells from that of the borders of the cells and the ``force``.

    ``elements``, ``inverse`` and ``dofs`` are those of `condense_force`.
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
