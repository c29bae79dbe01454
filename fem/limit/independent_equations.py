"""Replaces equations that depend on each other at a point of a mesh by independent ones.

Where edges run straight through a point, the tractions of its cells (lower bound) and the volume strain rates of its
cells (upper bound, φ = 0) are linearly dependent; where edges run almost straight they are nearly dependent, and
factors of the whole system leave a residual (the singular vertices of Scott & Vogelius 1985).
"""

import numpy as np
from scipy import sparse

from fem.limit.point_freedom import DEPENDENT_SINGULAR_VALUE

# Ratio of the smallest to the largest eigenvalue of the Gram matrix of the equations of one point, above which the
# equations are used unchanged.
SMALLEST_EIGENVALUE_RATIO = 1e-6


def independent_combinations(
    matrix: sparse.csr_matrix, points: np.ndarray, dependent: float = DEPENDENT_SINGULAR_VALUE
) -> sparse.csr_matrix:
    """Return a matrix C: the rows of C ``matrix`` are linearly independent equations with the same solutions, found
    point by point. Rows of points without dependent equations stay unchanged, other rows become orthonormal.

    ``points``: number of the point of every equation, -1 for none; ``dependent``: ratio of singular values up to which
    equations depend on each other.
    """
    at_point = np.flatnonzero(points >= 0)
    at_point = at_point[np.argsort(points[at_point], kind="stable")]
    equations = matrix[at_point]
    gram = (equations @ equations.T).tocsr()
    start = np.flatnonzero(np.diff(points[at_point], prepend=-1))
    size = np.diff(start, append=len(at_point))
    changed: list[tuple[np.ndarray, np.ndarray]] = []  # numbers of equations, and their combinations in rows
    whole_rows = [np.flatnonzero(points < 0)]
    for count in np.unique(size):
        rows = start[size == count][:, None] + np.arange(count)
        flat = np.asarray(gram[np.repeat(rows, count, axis=1).ravel(), np.tile(rows, (1, count)).ravel()])
        values = np.linalg.eigvalsh(flat.reshape(len(rows), count, count))
        whole = values[:, 0] > SMALLEST_EIGENVALUE_RATIO * values[:, -1]
        whole_rows.append(at_point[rows[whole]].ravel())
        together = at_point[rows[~whole]]
        changed += zip(together, _orthonormal(matrix, together, dependent), strict=True)
    independent_rows = np.sort(np.concatenate(whole_rows))
    combinations = [sparse.identity(matrix.shape[0], format="csr")[independent_rows]]
    if changed:
        values = np.concatenate([combination.ravel() for _, combination in changed])
        columns = np.concatenate([np.tile(rows, len(combination)) for rows, combination in changed])
        length = np.concatenate([np.full(len(combination), len(rows)) for rows, combination in changed])
        starts = np.concatenate([[0], np.cumsum(length)])
        combinations.append(sparse.csr_matrix((values, columns, starts), shape=(len(length), matrix.shape[0])))
    return sparse.vstack(combinations).tocsr()


def _orthonormal(matrix: sparse.csr_matrix, groups: np.ndarray, dependent: float) -> list[np.ndarray]:
    """Return orthonormal combinations (r, k) of k equations with the same solutions, for ``groups`` (g, k); r is their
    rank, by the ratio ``dependent`` of singular values."""
    groups_count, k = groups.shape
    if groups_count == 0:
        return []
    part = matrix[groups.ravel()].tocoo()
    group = part.row // k
    # The unknowns of a group are numbered from 0 in each.
    unknowns, number = np.unique(group * matrix.shape[1] + part.col, return_inverse=True)
    first = np.searchsorted(unknowns // matrix.shape[1], np.arange(groups_count))
    dense = np.zeros((groups_count, k, int(np.diff(np.append(first, len(unknowns))).max())))
    dense[group, part.row % k, number - first[group]] = part.data
    left, values, _ = np.linalg.svd(dense, full_matrices=False)
    largest = values.max(axis=1, initial=0.0)
    ranks = np.count_nonzero(values > dependent * largest[:, None], axis=1)
    return [
        (most / value[:rank])[:, None] * vectors[:, :rank].T
        for most, value, vectors, rank in zip(largest, values, left, ranks, strict=True)
    ]
