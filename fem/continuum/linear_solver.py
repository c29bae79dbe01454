"""Solves the linear system of a Newton iteration. The pattern of the sparse matrix is constant; its entries are
assembled and factorised in every iteration. The solver is MUMPS, or CHOLMOD, which is faster, on one rank and for
associated flow."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from petsc4py import PETSc

from fem.continuum.discretisation import Discretisation
from fem.kernels import assembly, condensation
from fem.kernels.lower_triangle import add_matrices
from fem.solvers import cholmod
from fem.solvers.blas_threads import use_one_thread
from fem.solvers.lower_triangle import LowerTriangle

use_one_thread()


class SingularMatrixError(ArithmeticError):
    """The stiffness matrix could not be factorised: there is a mechanism, or a part of the mesh is not supported."""


class Exchange:
    """Copies displacement components from the rank that owns them to the ranks whose cells need them, and adds up the
    contributions of all ranks to a component.

    Vectors of the components that a rank owns have the shape (owned,), vectors of the components that its cells need
    the shape (needed,).

    Attributes
    ----------
    first_owned, end_owned : int
        Global number of the first owned component, and of the one behind the last.
    """

    def __init__(self, d: Discretisation) -> None:
        self._owned = PETSc.Vec().createMPI((d.owned, d.size), comm=d.comm)
        self._local = PETSc.Vec().createSeq(len(d.global_dofs))
        needed = PETSc.IS().createGeneral(d.global_dofs, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(self._owned, needed, self._local, None)
        self.first_owned, self.end_owned = self._owned.getOwnershipRange()
        self._comm = d.comm

    def to_local(self, owned: np.ndarray) -> np.ndarray:
        """Return values (needed,) from the values (owned,)."""
        self._owned.array[:] = owned
        self._scatter.scatter(self._owned, self._local)
        return self._local.array.copy()

    def sum_to_owned(self, local: np.ndarray) -> np.ndarray:
        """Return the sum of the contributions (needed,) of all ranks to the owned components."""
        self._local.array[:] = local
        self._owned.set(0.0)
        self._scatter.scatter(
            self._local, self._owned, addv=PETSc.InsertMode.ADD_VALUES, mode=PETSc.ScatterMode.REVERSE
        )
        return self._owned.array.copy()

    def dot(self, a: np.ndarray, b: np.ndarray) -> float:
        """Return the scalar product of two vectors that are distributed over all ranks."""
        return float(self._comm.allreduce(float(a @ b)))

    def norm(self, a: np.ndarray) -> float:
        """Return the Euclidean norm of a vector that is distributed over all ranks."""
        return float(np.sqrt(self.dot(a, a)))

    def owned_part(self, everything: np.ndarray) -> np.ndarray:
        """Return the owned part of a vector (all components,)."""
        return everything[self.first_owned : self.end_owned]


class LinearSolver:
    """Solves K x = b. The rows and columns of fixed components are those of the unit matrix.

    Displacement components inside a cell are condensed statically: they are not in the matrix, and are computed after
    all other components. The matrix of associated flow is ``symmetric`` and, apart from rounding, positive definite.
    """

    def __init__(self, d: Discretisation, exchange: Exchange, symmetric: bool) -> None:
        self._grid, self._exchange, self._symmetric = d, exchange, symmetric
        border = d.dofs.shape[1] - d.inside
        self._inside = d.global_dofs[d.dofs[:, border:]].ravel() - exchange.first_owned
        in_matrix = np.ones(exchange.end_owned - exchange.first_owned, dtype=bool)
        in_matrix[self._inside] = False
        self._owned_rows = np.flatnonzero(in_matrix)  # of the owned components those in the matrix
        first = d.comm.scan(len(self._owned_rows)) - len(self._owned_rows)
        self._number = np.full(len(in_matrix), -1.0)
        self._number[self._owned_rows] = first + np.arange(len(self._owned_rows))
        self._rows = exchange.to_local(self._number)[d.dofs[:, :border]].astype(PETSc.IntType)
        self._inverse = np.zeros((len(d.dofs), d.inside, d.inside))
        self._elements = np.zeros((*d.dofs.shape, d.dofs.shape[1]))
        alone, size = symmetric and d.comm.size == 1 and CholmodMatrix.suits(self._rows), len(self._owned_rows)
        self._matrix: CholmodMatrix | _ByMumps = CholmodMatrix(self._rows, size) if alone else self._by_mumps()

    def factorise(self, tangent: np.ndarray, hourglass: np.ndarray, free: np.ndarray, fixed: np.ndarray) -> None:
        """Assemble the stiffness matrix from the ``tangent`` (points, 4, 4) in Pa and the ``hourglass`` stiffness, and
        factorise it.

        ``hourglass`` is (nc or 0, nd, nd) in Pa. ``free`` (needed,) marks the displacement components that can move;
        ``fixed`` are the global numbers of the fixed components of this rank. Raises SingularMatrixError.
        """
        d = self._grid
        self._elements[:] = hourglass if len(hourglass) else 0.0
        assembly.element_stiffness(d.matrix, d.weights, tangent, free, d.dofs, self._elements)
        if d.inside:
            condensation.condense(self._elements, self._inverse)
            if not np.all(np.isfinite(self._inverse)):
                raise SingularMatrixError("a cell has no stiffness for its inner displacement components")
        ones = self._number[fixed - self._exchange.first_owned].astype(PETSc.IntType)
        try:
            self._matrix.factorise(self._elements, ones)
        except cholmod.NotPositiveDefiniteError:  # rounding, where hardly anything is left of the stiffness
            self._matrix = self._by_mumps()
            self._matrix.factorise(self._elements, ones)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the solution x of K x = b; ``b`` and ``x`` contain the components that this rank owns. Raises
        SingularMatrixError."""
        d, exchange = self._grid, self._exchange
        x = np.array(right)
        if d.inside:
            force = exchange.to_local(right)
            change = np.empty_like(force)
            condensation.condense_force(self._elements, self._inverse, d.dofs, force, change)
            x += exchange.sum_to_owned(change)
        x[self._owned_rows] = self._matrix.solve(x[self._owned_rows])
        if d.inside:
            local = exchange.to_local(x)
            condensation.expand(self._elements, self._inverse, d.dofs, force, local)
            x[self._inside] = local[d.dofs[:, -d.inside :].ravel()]
        if not np.all(np.isfinite(x)):
            raise SingularMatrixError("the stiffness matrix is singular")
        return x

    def _by_mumps(self) -> "_ByMumps":
        return _ByMumps(self._grid, self._exchange, self._rows, self._owned_rows, self._symmetric)


class CholmodMatrix:
    """Holds the stiffness matrix on one rank by its lower triangle, which CHOLMOD factorises.

    Parameters
    ----------
    rows (nc, border) : numbers of the displacement components of each cell that are in the matrix
    size : number of all displacement components in the matrix
    nested : whether the components are ordered by nested dissection, see ``Cholesky``
    """

    @staticmethod
    def suits(rows: np.ndarray) -> bool:
        """Return whether CHOLMOD is installed and can be used here. CHOLMOD cannot be used if a cell contains the same
        component twice, which happens if one cell is as wide as a periodic section.
        """
        return not (np.diff(np.sort(rows, axis=1), axis=1) == 0).any() and cholmod.available()

    def __init__(self, rows: np.ndarray, size: int, nested: bool = True) -> None:
        self._order = np.argsort(rows, axis=1)
        starts = rows.shape[1] * np.arange(len(rows) + 1)
        self._lower = LowerTriangle(starts, np.take_along_axis(rows, self._order, axis=1).ravel(), size, nested)

    def factorise(self, elements: np.ndarray, ones: np.ndarray) -> None:
        """Factorise the sum of all matrices ``elements``, with a one on the diagonal at the components ``ones``. Raises
        NotPositiveDefiniteError."""
        lower = self._lower
        lower.entries[:] = 0.0
        add_matrices(elements, self._order, lower.places, lower.entries)
        lower.entries[lower.diagonal[ones]] += 1.0
        lower.factorise()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the solution for a right-hand side."""
        return self._lower.solve(right)


class _ByMumps:
    """Factorises the matrix by MUMPS on any number of ranks; every rank stores the rows that it owns. If the matrix is
    ``symmetric``, only one triangle is factorised, in three quarters of the time.
    """

    def __init__(
        self, d: Discretisation, exchange: Exchange, rows: np.ndarray, owned: np.ndarray, symmetric: bool
    ) -> None:
        PETSc.garbage_cleanup(d.comm)  # PETSc frees released objects only if all ranks call this function
        size, border = d.comm.allreduce(len(owned)), rows.shape[1]
        self._rows = rows
        self._matrix = PETSc.Mat().createAIJ(((len(owned), size), (len(owned), size)), comm=d.comm)
        cells = exchange.sum_to_owned(np.bincount(d.dofs[:, :border].ravel(), minlength=len(d.global_dofs)))
        entries = np.clip(border * cells[owned], 1, size).astype(PETSc.IntType)  # all that those cells have
        self._matrix.setPreallocationNNZ((np.minimum(entries, len(owned)), entries))
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRY_ETERNAL, symmetric)
        self._ksp = PETSc.KSP().create(d.comm)
        self._ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = self._ksp.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY if symmetric else PETSc.PC.Type.LU)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        self._ksp.setErrorIfNotConverged(False)
        self._x, self._b = self._matrix.createVecs()

    def factorise(self, elements: np.ndarray, ones: np.ndarray) -> None:
        """Factorise the sum of all matrices ``elements``, with a one on the diagonal at the components ``ones``. Raises
        SingularMatrixError."""
        border = self._rows.shape[1]
        block = np.ascontiguousarray(elements[:, :border, :border]).reshape(len(self._rows), -1)
        self._matrix.zeroEntries()
        self._matrix.setValuesRCV(self._rows, self._rows, block, addv=PETSc.InsertMode.ADD_VALUES)
        at = ones[:, None]
        self._matrix.setValuesRCV(at, at, np.ones(at.shape), addv=PETSc.InsertMode.ADD_VALUES)
        self._matrix.assemble()
        with _as_singular():
            self._ksp.setOperators(self._matrix)
            self._ksp.setUp()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the solution x of K x = b; ``b`` and ``x`` contain the components that this rank owns. Raises
        SingularMatrixError."""
        self._b.array[:] = right
        with _as_singular():
            self._ksp.solve(self._b, self._x)
        if self._ksp.getConvergedReason() < 0:
            raise SingularMatrixError("the stiffness matrix is singular")
        return np.array(self._x.array)


@contextmanager
def _as_singular() -> Iterator[None]:
    try:
        yield
    except PETSc.Error as error:
        raise SingularMatrixError(f"the stiffness matrix could not be factorised ({error})") from error
