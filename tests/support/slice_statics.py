"""Finds all forces between slices that equilibrium and strength permit; every method of slices assumes one set of
them."""

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import lil_matrix

from workflow.estimates.slices import Slices

FORCE_UNIT = 1e5  # N/m, so that all numbers of the program are about as large


def range_of_kh(slices: Slices, cohesion: np.ndarray, friction: np.ndarray, height: np.ndarray) -> tuple[float, float]:
    """Return the smallest and the largest Kh at which a slip surface slides with its full strength, by linear
    programming.

    Every slice is in equilibrium of forces and moments with forces E, X and the moment of E on its sides. |X| is at
    most ``cohesion`` (n - 1,) in N/m and ``friction`` times E; E acts within the ``height`` (m) of the side. Spencer's
    and Bishop's methods select one of all these states.
    """
    x, angle, length = (getattr(slices, name)[0] for name in ("x", "angle", "length"))
    order = np.argsort(x)
    n = len(x)
    half = 0.5 * length * np.cos(angle)
    rows, right = lil_matrix((4 * n, 5 * n + 4)), np.zeros(4 * n)
    normal, shear, force, cross, moment, kh = 0, n, 2 * n, 3 * n + 1, 4 * n + 2, 5 * n + 3
    for i, k in enumerate(order):
        sin, cos = np.sin(angle[k]), np.cos(angle[k])
        rise = half[k] * np.tan(angle[k])
        rows[4 * i, [normal + i, shear + i, force + i, force + i + 1, kh]] = [
            -sin, cos, 1.0, -1.0, slices.inertia[0, k] / FORCE_UNIT,
        ]  # fmt: skip
        right[4 * i] = -slices.horizontal[0, k] / FORCE_UNIT
        rows[4 * i + 1, [normal + i, shear + i, cross + i, cross + i + 1]] = [cos, sin, 1.0, -1.0]
        right[4 * i + 1] = -slices.vertical[0, k] / FORCE_UNIT
        rows[4 * i + 2, [force + i, cross + i, moment + i, force + i + 1, cross + i + 1, moment + i + 1, kh]] = [
            rise, -half[k], -1.0, rise, -half[k], 1.0, slices.inertia_moment[0, k] / FORCE_UNIT,
        ]  # fmt: skip
        right[4 * i + 2] = -slices.moment[0, k] / FORCE_UNIT
        rows[4 * i + 3, [shear + i, normal + i]] = [1.0, -slices.friction[0, k]]
        strength = slices.cohesion[0, k] - slices.pressure[0, k] * slices.friction[0, k]
        right[4 * i + 3] = strength * length[k] / FORCE_UNIT
    limits, most = lil_matrix((4 * (n - 1), 5 * n + 4)), np.zeros(4 * (n - 1))
    for i in range(n - 1):
        for row, sign in ((4 * i, 1.0), (4 * i + 1, -1.0)):
            limits[row, [cross + i + 1, force + i + 1]] = [sign, -friction[i]]
            most[row] = cohesion[i] / FORCE_UNIT
        limits[4 * i + 2, moment + i + 1] = -1.0
        limits[4 * i + 3, [moment + i + 1, force + i + 1]] = [1.0, -height[i]]
    free: list[tuple[float | None, float | None]] = [(None, None)] * (5 * n + 4)
    for end in (force, cross, moment):
        free[end] = free[end + n] = (0.0, 0.0)
    ends = []
    for sign in (1.0, -1.0):
        cost = np.zeros(5 * n + 4)
        cost[kh] = sign
        result = linprog(cost, limits.tocsr(), most, rows.tocsr(), right, free, method="highs")
        assert result.status == 0, result.message
        ends.append(float(result.x[kh]))
    return ends[0], ends[1]
