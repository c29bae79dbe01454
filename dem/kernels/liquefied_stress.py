"""Measures the shear stress at each liquefied disc, and its shear strain since the last neighbour list (kernel).

The stress at a disc follows from its pairs and their forces at the last evaluation (virial of Love 1927; half of each
pair belongs to either disc), tension positive. The displacement gradient is fitted to the displacements of the
neighbours by least squares. Stress and displacement gradient are means over the liquefied neighbours within reach,
since the stress of single discs scatters next to a slip plane. The shear stress of ground that flows in the plane
without change of volume is its plastic work over its shear strain, sigma : grad u / gamma (Tresca).
"""

import math

import numpy as np
from numba import njit

from dem.kernels import liquefied_pairs as bond
from dem.kernels.liquefied_bonds import BOND_LIMIT, EXTRA_STRENGTH, bond_lines
from dem.kernels.liquefied_laws import bond_kernel, density_kernel, force_share, stand_in_shares
from dem.kernels.period import Period, image

# sums over the pairs of a disc: stress, gradient and moment of its neighbours, mobilised strength
S_XX, S_XZ, S_ZZ, G_XX, G_XZ, G_ZX, G_ZZ, M_XX, M_XZ, M_ZZ, MOBILISED, WEIGHT = range(12)
SMALLEST_MOMENT_RATIO = 1e-6  # determinant over the square of a moment: neighbours on a line have no gradient


@njit(cache=True, nogil=True, error_model="numpy")
def measured_shear(
    discs: np.ndarray, way: np.ndarray, pairs: np.ndarray, memory: np.ndarray, reach: float, period: Period
) -> np.ndarray:
    """Measure the shear stress that liquefied ground carries as it strains.

    Parameters
    ----------
    discs : (n, FIELDS) Fields of liquefied discs
    way : (2, n) Displacement since the last neighbour list (m)
    pairs : numbers of the discs of each pair
    memory : (pairs, MEMORY) History variables of the bonds
    reach, period : reach of the kernels (m), and period of the ground

    Returns
    -------
    (3, n)
        Measured shear stress (Pa), shear strain since the last neighbour list, and mobilised share of the strength of
        the bonds; zero for discs that have not liquefied.
    """
    n = len(discs)
    sums, width = _sums(discs, way, pairs, memory, reach, period)
    mean = _means(discs, pairs, width, reach, sums[:, : G_ZZ + 1])
    out = np.zeros((3, n))
    for i in range(n):
        if discs[i, bond.SHARE] > 0.0:
            out[0, i], out[1, i] = _shear_of(mean[i])
            out[2, i] = sums[i, MOBILISED] / sums[i, WEIGHT] if sums[i, WEIGHT] > 0.0 else 0.0
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _sums(
    discs: np.ndarray, way: np.ndarray, pairs: np.ndarray, memory: np.ndarray, reach: float, period: Period
) -> tuple[np.ndarray, np.ndarray]:
    """Return the stress and displacement gradient of every disc (n, 12), and the kernel W (pairs,) of every pair
    (1/m2)."""
    n = len(discs)
    sums = np.zeros((n, 12))
    width = np.zeros(pairs.shape[1])
    for c in range(pairs.shape[1]):
        i, j = pairs[0, c], pairs[1, c]
        dx, dz = image(discs[j, bond.AT_X] - discs[i, bond.AT_X], discs[j, bond.AT_Z] - discs[i, bond.AT_Z], period)
        apart = math.sqrt(dx * dx + dz * dz)
        if not 0.0 < apart < reach:
            continue
        width[c], slope = density_kernel(apart, reach)
        nx, nz = dx / apart, dz / apart
        more_i, more_j = stand_in_shares(discs[i, bond.SHARE], discs[j, bond.SHARE])
        pressure = (1.0 + more_i) * discs[i, bond.PRESSURE_TERM] + (1.0 + more_j) * discs[j, bond.PRESSURE_TERM]
        pressure_force = -pressure * discs[i, bond.AREA] * discs[j, bond.AREA] * slope
        a, b = bond.strength_weights(discs, i, j)
        limit = BOND_LIMIT * (a * discs[i, bond.BOND] + b * discs[j, bond.BOND])
        limit *= bond_kernel(apart, reach)
        limit *= 1.0 + EXTRA_STRENGTH * memory[c, bond.EXTRA_SHARE_AT]
        along, across = memory[c, bond.ALONG_AT], memory[c, bond.ACROSS_AT]
        soft, steep, _ = bond_lines(discs, i, j)
        share = force_share(along, across, soft, steep)
        along, across = share * along, share * across
        normal = pressure_force - limit * along - memory[c, bond.DASH_ALONG_AT] - memory[c, bond.COUNTER_ALONG_AT]
        drag = limit * across + memory[c, bond.DASH_ACROSS_AT] + memory[c, bond.COUNTER_ACROSS_AT]
        fx, fz = normal * nx + drag * nz, normal * nz - drag * nx
        near = width[c] / (apart * apart)
        ux, uz = near * (way[0, j] - way[0, i]), near * (way[1, j] - way[1, i])
        used = width[c] * math.sqrt(along * along + across * across)
        for k in (i, j):
            sums[k, S_XX] -= 0.5 * fx * dx
            sums[k, S_XZ] -= 0.25 * (fx * dz + fz * dx)
            sums[k, S_ZZ] -= 0.5 * fz * dz
            sums[k, G_XX] += ux * dx
            sums[k, G_XZ] += ux * dz
            sums[k, G_ZX] += uz * dx
            sums[k, G_ZZ] += uz * dz
            sums[k, M_XX] += near * dx * dx
            sums[k, M_XZ] += near * dx * dz
            sums[k, M_ZZ] += near * dz * dz
            sums[k, MOBILISED] += used
            sums[k, WEIGHT] += width[c]
    for i in range(n):
        if discs[i, bond.SHARE] > 0.0:
            for k in range(S_XX, S_ZZ + 1):
                sums[i, k] /= discs[i, bond.AREA]
        _solve(sums[i])
    return sums, width


@njit(cache=True, nogil=True, error_model="numpy")
def _shear_of(mean: np.ndarray) -> tuple[float, float]:
    """Return the measured shear stress (Pa) and shear strain, from a stress and a displacement gradient.

    The shear stress is the mean of both shear stresses, since the forces that balance the moments of bonds are not
    summed: in a sheared box they change the mean stress of a row of discs by 1 % at the most.
    """
    xx, xz, zx, zz = mean[G_XX], mean[G_XZ], mean[G_ZX], mean[G_ZZ]
    strain = math.sqrt((xx - zz) * (xx - zz) + (xz + zx) * (xz + zx))
    if strain == 0.0:
        return 0.0, 0.0
    half = 0.5 * (mean[S_XX] - mean[S_ZZ]) * (xx - zz)
    return (half + mean[S_XZ] * (xz + zx)) / strain, strain


@njit(cache=True, nogil=True, error_model="numpy")
def _means(discs: np.ndarray, pairs: np.ndarray, width: np.ndarray, reach: float, values: np.ndarray) -> np.ndarray:
    """Return the means of values (n, k) over the liquefied discs of the same stratum within reach, weighted by the
    kernel (width) and the areas of the discs.

    Means are computed one value after the other, since loops over rows would take seconds more to compile.
    """
    n, count = values.shape
    out, weight = np.zeros((n, count)), np.zeros(n)
    at_zero = 7.0 / (math.pi * reach * reach)
    for i in range(n):
        if discs[i, bond.SHARE] > 0.0:
            weight[i] = at_zero * discs[i, bond.AREA]
            for q in range(count):
                out[i, q] = weight[i] * values[i, q]
    for c in range(pairs.shape[1]):
        i, j = pairs[0, c], pairs[1, c]
        both_liquefied = discs[i, bond.SHARE] > 0.0 and discs[j, bond.SHARE] > 0.0
        if both_liquefied and discs[i, bond.STRATUM] == discs[j, bond.STRATUM]:
            for k, other in ((i, j), (j, i)):
                part = width[c] * discs[other, bond.AREA]
                weight[k] += part
                for q in range(count):
                    out[k, q] += part * values[other, q]
    for i in range(n):
        if weight[i] > 0.0:
            for q in range(count):
                out[i, q] /= weight[i]
    return out


@njit(cache=True, nogil=True, error_model="numpy")
def _solve(sums: np.ndarray) -> None:
    """Compute displacement gradients from sums over neighbours. The gradient is zero if the neighbours lie on a
    line."""
    xx, xz, zz = sums[M_XX], sums[M_XZ], sums[M_ZZ]
    scale = xx * zz - xz * xz
    inverse = 1.0 / scale if scale > SMALLEST_MOMENT_RATIO * (xx + zz) * (xx + zz) else 0.0
    for x, z in ((G_XX, G_XZ), (G_ZX, G_ZZ)):
        gx, gz = sums[x], sums[z]
        sums[x], sums[z] = (gx * zz - gz * xz) * inverse, (gz * xx - gx * xz) * inverse
