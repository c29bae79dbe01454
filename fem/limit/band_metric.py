"""Measures lengths across the shear bands of a mechanism, so that triangles become long along the bands.

Where velocities jump across a slip line, the strain of a mechanism of continuous velocities is spread over one row of
triangles. The error of the upper bound is proportional to the width of this row; the length of the triangles along the
line only has to follow its curvature. The metric follows from the second derivatives of the velocities, which are large
across a band and small along it, as in the adaptation of Castro-Díaz, Hecht, Mohammadi & Pironneau (1997), which
Lyamin, Sloan, Krabbenhoft & Hjiaj (2005) used for lower bounds.
"""

import numpy as np

from fem.limit.limit_problem import LimitProblem
from fem.limit.upper_bound import UpperBound
from meshes.triangles import TriMesh

# Largest ratio of length to width of the triangles along a band. With 4 the gap of eight sections was 0.5 to 0.8 of the
# gap of triangles without direction on as many triangles; 8 and 16 were no better.
LARGEST_STRETCH = 4.0
# Number of times that second derivatives are averaged over the triangles around every point: within one triangle in the
# middle of a band the velocity may be linear.
AVERAGINGS = 2


def band_metric(problem: LimitProblem, high: UpperBound) -> np.ndarray:
    """Return the metric (m, 2, 2) of every cell in which lengths along the shear bands of a mechanism count less than
    lengths across them, by at most ``LARGEST_STRETCH``. Without a mechanism lengths are those of the plane."""
    mesh = problem.mesh
    everywhere = np.broadcast_to(np.eye(2), (len(mesh.cells), 2, 2))
    if high.solution.none or not np.isfinite(high.velocity).all():
        return everywhere
    second = second_derivatives(mesh, high.velocity)
    squares = averaged(mesh, np.einsum("mcab,mcbd->mad", second, second))
    values, directions = np.linalg.eigh(squares)
    smallest = np.maximum(values[:, 0], LARGEST_STRETCH**-4.0 * values[:, 1])
    # An error h² |u''| that is equal in both directions has lengths in the ratio of the roots of |u''|.
    stretch = np.divide(values[:, 1], smallest, out=np.ones(len(smallest)), where=smallest > 0.0) ** 0.25
    along = directions[:, :, 0]
    return everywhere - np.einsum("m,ma,mb->mab", 1.0 - stretch**-2.0, along, along)


def second_derivatives(mesh: TriMesh, velocity: np.ndarray) -> np.ndarray:
    """Return the second derivatives (m, 2 components, 2, 2) of velocities (m, 6 nodes, 2) that are quadratic in every
    cell: with area coordinates L, the shape functions are L_i (2 L_i - 1) at corners and 4 L_i L_j at middles."""
    gradient = mesh.gradients
    second = np.zeros((len(mesh.cells), 2, 2, 2))
    for i in range(3):
        first, other = gradient[:, i], gradient[:, (i + 1) % 3]
        second += 4.0 * np.einsum("mc,ma,mb->mcab", velocity[:, i], first, first)
        for left, right in ((first, other), (other, first)):
            second += 4.0 * np.einsum("mc,ma,mb->mcab", velocity[:, 3 + i], left, right)
    return second


def averaged(mesh: TriMesh, values: np.ndarray) -> np.ndarray:
    """Return values of the cells (m, 2, 2), averaged with their areas over the cells around every point, and then over
    the points of every cell, ``AVERAGINGS`` times."""
    weight = np.bincount(mesh.cells.ravel(), np.repeat(mesh.areas, 3))
    for _ in range(AVERAGINGS):
        total = np.zeros((len(weight), 2, 2))
        np.add.at(total, mesh.cells, (mesh.areas[:, None, None] * values)[:, None])
        values = (total / np.maximum(weight, np.finfo(float).tiny)[:, None, None])[mesh.cells].mean(axis=1)
    return values
