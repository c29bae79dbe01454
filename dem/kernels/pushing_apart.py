"""Pushes overlapping discs apart, and discs too near the outline inwards (kernel)."""

import numpy as np
from numba import njit

from dem.kernels.period import Period, image


@njit(cache=True, nogil=True, error_model="numpy")
def nearest_edge(px: float, pz: float, outline: np.ndarray) -> tuple[float, float, float]:
    """Return the distance of a point to the outline, positive inside, and the unit vector from the point inwards."""
    n = len(outline)
    best = np.inf
    bx = bz = ex = ez = 0.0
    inside = False
    for k in range(n):
        ax, az = outline[k]
        cx, cz = outline[(k + 1) % n]
        if (az > pz) != (cz > pz) and px < ax + (cx - ax) * (pz - az) / (cz - az):
            inside = not inside
        dx, dz = cx - ax, cz - az
        share = min(1.0, max(0.0, ((px - ax) * dx + (pz - az) * dz) / (dx * dx + dz * dz)))
        qx, qz = px - ax - share * dx, pz - az - share * dz
        if qx * qx + qz * qz < best:
            best, bx, bz, ex, ez = qx * qx + qz * qz, qx, qz, dx, dz
    distance = np.sqrt(best)
    if distance < 1e-12:
        length = np.sqrt(ex * ex + ez * ez)
        return 0.0, -ez / length, ex / length
    sign = 1.0 if inside else -1.0
    return sign * distance, sign * bx / distance, sign * bz / distance


@njit(cache=True, nogil=True, error_model="numpy")
def deepest_in_pairs(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, i: np.ndarray, j: np.ndarray, period: Period
) -> float:
    """Return the largest overlap of pairs of discs.

    Parameters
    ----------
    x, z (n,) : positions (m)
    radius (n,) : radii (m)
    i, j (pairs,) : pairs that may overlap
    period : length along x and rise along z of a period (m)

    Returns
    -------
    Overlap (m), 0 if none overlap.
    """
    deepest = 0.0
    for c in range(len(i)):
        a, b = i[c], j[c]
        dx, dz = image(x[b] - x[a], z[b] - z[a], period)
        deepest = max(deepest, radius[a] + radius[b] - np.hypot(dx, dz))
    return deepest


@njit(cache=True, nogil=True, error_model="numpy")
def spread_out(
    x: np.ndarray,
    z: np.ndarray,
    radius: np.ndarray,
    i: np.ndarray,
    j: np.ndarray,
    outline: np.ndarray,
    sweeps: int,
    period: Period,
) -> None:
    """Push overlapping discs apart, and discs too near the outline inwards.

    Parameters
    ----------
    x, z (n,) : positions (m), changed here
    radius (n,) : radii (m)
    i, j (pairs,) : pairs that may overlap
    outline (corners, 2) : corners of a polygon (m), counter-clockwise
    sweeps : number of sweeps over all pairs, then all discs
    period : length along x and rise along z of a period (m), infinite for a box
    """
    for _ in range(sweeps):
        for c in range(len(i)):
            a, b = i[c], j[c]
            dx, dz = image(x[b] - x[a], z[b] - z[a], period)
            reach = radius[a] + radius[b]
            square = dx * dx + dz * dz
            if square >= reach * reach:
                continue
            distance = max(np.sqrt(square), 1e-9)
            over = reach - distance
            shift = 0.5 * over / distance
            x[a] -= shift * dx
            z[a] -= shift * dz
            x[b] += shift * dx
            z[b] += shift * dz
        for a in range(len(x)):
            inside, nx, nz = nearest_edge(x[a], z[a], outline)
            if inside < radius[a]:
                x[a] += (radius[a] - inside) * nx
                z[a] += (radius[a] - inside) * nz


@njit(cache=True, nogil=True, error_model="numpy")
def clearance(x: np.ndarray, z: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Return the distance of points to an outline.

    Parameters
    ----------
    x, z (n,) : points (m)
    outline (corners, 2) : corners of a polygon (m), counter-clockwise

    Returns
    -------
    Distance (n,) in m, negative outside.
    """
    out = np.empty(len(x))
    for a in range(len(x)):
        out[a] = nearest_edge(x[a], z[a], outline)[0]
    return out
