"""Solves the few cells whose forces are far from balance first, while all other cells are held (nonlinear elimination).

The stress in sand without cohesion may be very small, for example at a toe under water or under a crest. A few cells
there alternate between shear yield and tensile yield from one Newton iteration to the next, and the line search
shortens the corrections of the whole section. Newton's method needs a fifth of the iterations if the same potential is
first minimised over these cells alone
(nonlinear elimination: Lanzkron, Rose & Wilkes 1996, SIAM J. Sci. Comput. 17, 538).

Stress is positive in tension; Pa, m, N per metre out of plane.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from fem.continuum.linear_solver import CholmodMatrix
from fem.continuum.plane_strain import PartialProblem, PlaneStrain
from fem.kernels import assembly, mohr_coulomb
from fem.path.line_search import LineSearch

# The subproblem has the nodes whose unbalanced force exceeds this share of the largest one, and this number of rings of
# cells around them.
NODE_FORCE_SHARE, CELL_RINGS = 0.2, 5
# Largest number of corrections of a subproblem. It ends earlier when its unbalanced force is this ratio of the largest
# unbalanced force outside; with smaller ratios, paths of five sections took 9 to 18 % more time.
MOST_CORRECTIONS, FINAL_FORCE_RATIO = 20, 1.0


class LocalSubproblem:
    """Solves the cells around the nodes with the largest unbalanced forces for the displacement components that are
    free in these cells.

    The subproblem is for one rank, associated flow and no overstress. ``unbalanced`` (dofs,) is the resultant of
    internal and external forces at the last evaluation of the ``problem`` (N/m).
    """

    def __init__(self, problem: PlaneStrain, unbalanced: np.ndarray) -> None:
        nodes = problem.grid.global_dofs[problem.grid.dofs[:, 0::2]] // 2
        size = np.abs(unbalanced).reshape(-1, 2).max(axis=1)
        reached = size > NODE_FORCE_SHARE * size.max()
        for _ in range(CELL_RINGS):
            cells = reached[nodes].any(axis=1)
            reached[nodes[cells]] = True
        at_edge = np.zeros_like(reached)
        at_edge[nodes[~cells]] = True
        inside = problem.free & np.repeat(reached & ~at_edge, 2)
        self.cells = problem.part(np.flatnonzero(cells))
        self.free = np.flatnonzero(inside[self.cells.components])
        self.components = self.cells.components[self.free]
        self._outside = float(np.abs(unbalanced[~inside]).max(initial=0.0))

    def at_rest(self, increment: np.ndarray, unbalanced: np.ndarray) -> np.ndarray:
        """Solve the subproblem until its unbalanced force is about as small as in the ground around it. Return the
        displacement ``increment`` (dofs,) since the accepted state; return it unchanged if there is no solution.
        """
        moving, moved = self.free, increment[self.cells.components]
        dofs = self.cells.dofs
        matrix = CholmodMatrix(dofs, len(moved), nested=False) if CholmodMatrix.suits(dofs) else None
        internal, tangent = _response(self.cells, moved)
        left = unbalanced[self.components]
        force = left + internal[moving]
        number = np.full(len(moved), -1)
        number[moving] = np.arange(len(moving))
        fixed = np.flatnonzero(number < 0)
        for _ in range(MOST_CORRECTIONS):
            if not np.abs(left).max(initial=0.0) > FINAL_FORCE_RATIO * self._outside:
                break
            force_left, step = np.zeros((2, len(moved)))
            force_left[moving] = left
            elements = _elements(self.cells, tangent, number >= 0)
            try:
                if matrix is not None:
                    matrix.factorise(elements, fixed)
                    step[moving] = matrix.solve(force_left)[moving]
                else:
                    step[moving] = _factors(self.cells, elements, number).solve(left)
            except (RuntimeError, ArithmeticError):  # the stiffness is singular
                break
            search = LineSearch(float(left @ step[moving]))
            while True:
                internal, tangent = _response(self.cells, moved + search.step_length * step)
                left = force - internal[moving]
                if search.ends(float(left @ step[moving])):
                    break
            moved = moved + search.step_length * step
        changed = increment.copy()
        changed[self.components] = moved[moving]
        return changed if np.all(np.isfinite(changed)) else increment


def _response(part: PartialProblem, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodal forces (components,) of the stress after a displacement, and the tangent (points, 4, 4) of this
    stress."""
    points = len(part.stress)
    strain, stress, plastic = (np.zeros((points, 4)) for _ in range(3))
    tangent, forces = np.zeros((points, 4, 4)), np.zeros(len(moved))
    assembly.strains(part.matrix, part.dofs, moved, strain)
    mohr_coulomb.update(
        strain, part.stress, part.material, part.table, stress,
        tangent=tangent, plastic_strain_increment=plastic, region=np.zeros(points, dtype=np.int8), threads=1,
    )  # fmt: skip
    assembly.internal_forces(part.matrix, part.weights, part.dofs, stress, forces)
    assembly.add_forces(part.hourglass, part.dofs, moved, forces)
    return forces, tangent


def _elements(part: PartialProblem, tangent: np.ndarray, moves: np.ndarray) -> np.ndarray:
    """Return the stiffness matrices (nc, nd, nd) of the cells, with zero for components that ``moves`` (components,)
    leaves out."""
    elements = part.hourglass.copy()
    assembly.element_stiffness(part.matrix, part.weights, tangent + part.regularisation, moves, part.dofs, elements)
    return elements


def _factors(part: PartialProblem, elements: np.ndarray, number: np.ndarray) -> SuperLU:
    """Return the factors of the stiffness of the free components, which are those whose ``number`` (components,) is not
    negative.

    Raises RuntimeError if the stiffness is singular.
    """
    numbers = number[part.dofs]
    rows, columns = (np.broadcast_to(axis, elements.shape) for axis in (numbers[:, :, None], numbers[:, None, :]))
    moving = (rows >= 0) & (columns >= 0)
    size = int(number.max()) + 1
    matrix = sparse.csc_matrix((elements[moving], (rows[moving], columns[moving])), shape=(size, size))
    # Pivots on the diagonal, and the minimum degree ordering that SuperLU wants for them.
    options = {"SymmetricMode": True}
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
