"""Computes supernodal Cholesky factors by CHOLMOD (Chen, Davis, Hager & Rajamanickam 2008), which comes with PETSc on
Debian.

The library is called through ctypes, so that neither MPI nor a compiler is needed, and Python's global lock is released
during a factorisation. The layout of its settings differs from version to version: the entries to be changed are
identified by the default values around them. ``available`` is false if the library is missing, its version is unknown,
or its solution of a test system is wrong.
"""

import ctypes
import sys
from ctypes import POINTER, byref, c_double, c_int, c_size_t, c_void_p
from functools import cache
from pathlib import Path

import numpy as np
from scipy import sparse

from fem.solvers.blas_threads import use_one_thread

# Names under which systems have it, and versions whose matrices look as they are declared here.
LIBRARY_NAMES, VERSIONS = ("libcholmod.so.5", "libcholmod.so.4", "libcholmod.so.3", "libcholmod.so"), (3, 4, 5)
# Bytes of the table of settings, several times what any version has.
SETTINGS_SIZE = 1 << 16
# Its defaults around the entries that are changed: supernodal, final_asis, final_super, final_ll, final_pack,
# final_monotonic, final_resymbol and padding; up to which share of zeros and how many columns supernodes are merged;
# prefer_zomplex, prefer_upper, quick_return_if_not_posdef, prefer_binary, print, precise, try_catch.
DEFAULT_SETTINGS = (
    np.array([1, 1, 1, 0, 1, 1, 0, 0], dtype=np.int32),
    np.array([0.8, 0.1, 0.05]),
    np.array([4, 16, 48], dtype=np.uint64),
    np.array([0, 1, 0, 0, 3, 0, 0], dtype=np.int32),
)
# Their places, counted in int32: always supernodal, whose pivots have to be positive; end at the first one that is not;
# print nothing, not even that.
CHANGED_SETTINGS = {0: 2, 22: 1, 24: 0, 26: 1}


# Functions that find an order of elimination by METIS, which draws from the random numbers of the process: they keep
# Python's lock, so that no other thread draws between.
ORDERING_FUNCTIONS = ("cholmod_metis", "cholmod_analyze_p")


class _Sparse(ctypes.Structure):
    _fields_ = (
        *((name, c_size_t) for name in ("nrow", "ncol", "nzmax")),
        *((name, c_void_p) for name in ("p", "i", "nz", "x", "z")),
        *((name, c_int) for name in ("stype", "itype", "xtype", "dtype", "sorted", "packed")),
    )


class _Dense(ctypes.Structure):
    _fields_ = (
        *((name, c_size_t) for name in ("nrow", "ncol", "nzmax", "d")),
        *((name, c_void_p) for name in ("x", "z")),
        *((name, c_int) for name in ("xtype", "dtype")),
    )


class _Factor(ctypes.Structure):  # its beginning
    _fields_ = (("n", c_size_t), ("minor", c_size_t))


REAL, LOWER, SOLVE_ALL = 1, -1, 0


class NotPositiveDefiniteError(ArithmeticError):
    """The matrix is not positive definite: it has no Cholesky factors."""


class Cholesky:
    """Factorises symmetric positive definite matrices of one pattern, one after the other.

    Parameters
    ----------
    pattern (n, n) : pattern of the lower triangle, with sorted rows in each column; the values are not used
    nested : whether the unknowns are ordered by nested dissection, which takes as long as one to three factorisations
        and then saves time in each; else by minimum degree
    """

    def __init__(self, pattern: sparse.csc_matrix, nested: bool = True) -> None:
        self._library, self._size = _library(), pattern.shape[0]
        self._settings = _new_settings(self._library)
        self._pointers = np.ascontiguousarray(pattern.indptr, dtype=np.int32)
        self._rows = np.ascontiguousarray(pattern.indices, dtype=np.int32)
        self._work = tuple(c_void_p() for _ in range(3))  # solution and work space, kept for the next call
        matrix, order = self._matrix(np.zeros(len(self._rows))), self._nested_order(pattern) if nested else None
        chosen = None if order is None else order.ctypes.data_as(c_void_p)
        self._factor = c_void_p(self._library.cholmod_analyze_p(byref(matrix), chosen, None, 0, self._settings))
        if not self._factor:
            raise MemoryError("CHOLMOD could not analyse a matrix")

    def _nested_order(self, pattern: sparse.csc_matrix) -> np.ndarray | None:
        """Return an order of elimination (n,) by nested dissection of groups of unknowns with equal neighbours, such
        as the components of a node: a graph with a quarter of the edges and an order as good. None if METIS fails.
        """
        lower = sparse.csc_matrix((np.ones(pattern.nnz, dtype=np.int8), pattern.indices, pattern.indptr), pattern.shape)
        first, group = np.unique(_neighbourhoods(lower), return_index=True, return_inverse=True)[1:]
        whole = (lower + sparse.triu(lower.T, 1, format="csc")).tocsc()
        graph = sparse.tril(whole[first][:, first], format="csc")
        graph.sort_indices()
        pointers, rows = (np.ascontiguousarray(part, dtype=np.int32) for part in (graph.indptr, graph.indices))
        values, order = np.zeros(len(rows)), np.zeros(len(first), dtype=np.int32)
        data = (part.ctypes.data for part in (pointers, rows))
        matrix = _Sparse(
            len(first), len(first), len(rows), *data, None, values.ctypes.data, None, LOWER, 0, REAL, 0, 1, 1
        )
        at = order.ctypes.data_as(c_void_p)
        if not self._library.cholmod_metis(byref(matrix), None, 0, 1, at, self._settings):
            return None
        place = np.empty_like(order)
        place[order] = np.arange(len(order), dtype=np.int32)
        return np.argsort(place[group], kind="stable").astype(np.int32)

    def factorise(self, values: np.ndarray) -> None:
        """Factorise the matrix with these ``values`` (entries of the pattern,); raise NotPositiveDefiniteError."""
        _forbid_threads(self._library)
        matrix, beta = self._matrix(values), (c_double * 2)()  # no shift of the diagonal
        done = self._library.cholmod_factorize_p(byref(matrix), beta, None, 0, self._factor, self._settings)
        if not done or ctypes.cast(self._factor, POINTER(_Factor)).contents.minor < self._size:
            raise NotPositiveDefiniteError

    def solve(self, sides: np.ndarray) -> np.ndarray:
        """Return solutions (n, k) for the right-hand sides (n, k)."""
        sides = np.asfortranarray(sides, dtype=float)
        count = sides.shape[1]
        right = _Dense(self._size, count, sides.size, self._size, sides.ctypes.data, None, REAL, 0)
        solution, *work = self._work
        done = self._library.cholmod_solve2(
            SOLVE_ALL, self._factor, byref(right), None, byref(solution), None, *map(byref, work), self._settings
        )
        if not done:
            raise MemoryError("CHOLMOD could not solve equations")
        dense = ctypes.cast(solution, POINTER(_Dense)).contents
        values = ctypes.cast(dense.x, POINTER(c_double))
        return np.ctypeslib.as_array(values, shape=(count, self._size)).T.copy(order="F")

    def _matrix(self, values: np.ndarray) -> _Sparse:
        self._values = np.ascontiguousarray(values, dtype=float)  # CHOLMOD holds on to it during the call
        pointers = (part.ctypes.data for part in (self._pointers, self._rows))
        size, count = self._size, len(self._rows)
        return _Sparse(size, size, count, *pointers, None, self._values.ctypes.data, None, LOWER, 0, REAL, 0, 1, 1)

    def __del__(self) -> None:
        if getattr(self, "_factor", None):
            for part in self._work:
                self._library.cholmod_free_dense(byref(part), self._settings)
            self._library.cholmod_free_factor(byref(self._factor), self._settings)
            self._library.cholmod_finish(self._settings)


def _neighbourhoods(lower: sparse.csc_matrix) -> np.ndarray:
    """Return a number (n,) for every unknown, equal for unknowns that are coupled with the same unknowns: the sum of
    random numbers of 64 bits of these unknowns, from the pattern of the ``lower`` triangle."""
    numbers = np.random.default_rng(0).integers(1, 2**63, lower.shape[0], dtype=np.uint64)
    ones = sparse.csc_matrix((np.ones(lower.nnz, dtype=np.uint64), lower.indices, lower.indptr), lower.shape)
    return np.asarray(ones @ numbers + ones.T @ numbers - numbers)


@cache
def available() -> bool:
    """Return whether CHOLMOD is installed and solves equations whose solution is known.

    Returns
    -------
    False if the library is missing, its version is unknown or its solution is wrong; it is tried once in a process.
    """
    try:
        size = 400
        matrix = sparse.diags([-1.0, 4.0, -1.0], [-20, 0, 20], shape=(size, size))
        matrix = (matrix + sparse.diags([-1.0, -1.0], [-1, 1], shape=(size, size))).tocsc()
        wanted, lower = np.cos(np.arange(2.0 * size)).reshape(size, 2), sparse.tril(matrix, format="csc")
        lower.sort_indices()
        factors = Cholesky(lower)
        factors.factorise(lower.data)
        solution = factors.solve(matrix @ wanted)
        return bool(np.abs(solution - wanted).max() < 1e-12)
    except (OSError, MemoryError, ArithmeticError):
        return False


@cache
def _library() -> ctypes.CDLL:
    """Return the library, with the types of its functions; raise OSError if it is missing or its version is unknown."""
    for name in (*LIBRARY_NAMES, *(str(Path(sys.prefix) / "lib" / name) for name in LIBRARY_NAMES)):
        try:
            library = ctypes.CDLL(name)
            break
        except OSError:
            continue
    else:
        raise OSError("the library libcholmod is missing")
    version = (c_int * 3)()
    if not hasattr(library, "cholmod_version") or (library.cholmod_version(version), version[0])[1] not in VERSIONS:
        raise OSError("this version of CHOLMOD is not supported")
    if not hasattr(library, "cholmod_metis"):
        raise OSError("CHOLMOD was built without METIS")
    pointer, flag = c_void_p, c_int
    types = {
        "cholmod_start": (flag, pointer),
        "cholmod_finish": (flag, pointer),
        "cholmod_metis": (flag, pointer, pointer, c_size_t, flag, pointer, pointer),
        "cholmod_analyze_p": (pointer, pointer, pointer, pointer, c_size_t, pointer),
        "cholmod_factorize_p": (flag, pointer, pointer, pointer, c_size_t, pointer, pointer),
        "cholmod_solve2": (flag, flag, *[pointer] * 8),
        "cholmod_free_factor": (flag, pointer, pointer),
        "cholmod_free_dense": (flag, pointer, pointer),
    }
    for name, (result, *arguments) in types.items():
        if name in ORDERING_FUNCTIONS:
            setattr(library, name, ctypes.PYFUNCTYPE(result, *arguments)((name, library)))
        else:
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    use_one_thread()  # its BLAS may have been loaded with it
    return library


def _new_settings(library: ctypes.CDLL) -> ctypes.Array:
    """Return settings that print nothing and end at the first pivot that is not positive; raise OSError if their layout
    is unknown."""
    settings = (ctypes.c_byte * SETTINGS_SIZE)()
    library.cholmod_start(settings)
    content = bytes(settings)
    wanted = b"".join(part.tobytes() for part in DEFAULT_SETTINGS)
    at = content.find(wanted)
    if at < 0:
        library.cholmod_finish(settings)
        raise OSError("the settings of this version of CHOLMOD have an unknown layout")
    numbers = (c_int * (len(wanted) // 4)).from_buffer(settings, at)
    for place, value in CHANGED_SETTINGS.items():
        numbers[place] = value
    return settings


def _forbid_threads(library: ctypes.CDLL) -> None:
    """Keep OpenMP from starting threads here, since CHOLMOD would start four for each of its small dense matrices."""
    if hasattr(library, "omp_set_max_active_levels"):
        library.omp_set_max_active_levels(0)
