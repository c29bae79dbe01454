"""The largest stable time step of any assembly of discs.

For springs between pairs, K <= 2 diag(K_ii): the energy of a spring between i and j is at most twice the sum of what
each end would store alone. So omega_max^2 <= 2 max_i lambda(K_ii / M_ii), with the 3 x 3 blocks of translation and
**rotation** of one disc, and likewise for the dashpots. The stepping scheme is stable for a mode of frequency omega and
damping c = 2 zeta omega as long as h^2 omega^2 + 4 h c <= 4 (its characteristic polynomial leaves the unit circle at
-1), and what holds for the bound holds for the mode.

Every listed pair counts as touching, whether it does or not, and every pore spring as compressed: the bound stays true
until the list is made anew, when it is taken again. Only cracked pairs too far apart to meet by then are left out; they
stay listed for their memory alone. Equal discs on a triangular lattice give
max(6 kn + 6 ks, 24 ks)/m for omega_max^2, where max(6 kn + 2 ks, 24 ks)/m is exact.
"""

import numpy as np
from numba import njit

from dem.kernels.contact import CN, CT, KN, KPN, KPS, KS


@njit(cache=True, nogil=True, error_model="numpy")
def add_block(block: np.ndarray, nx: float, nz: float, lever: float, normal: float, tangential: float) -> None:
    """Adds a spring along (nx, nz) and one across it, at a lever, to the six entries of a disc's block."""
    block[0] += normal * nx * nx + tangential * nz * nz
    block[1] += normal * nz * nz + tangential * nx * nx
    block[2] += (normal - tangential) * nx * nz
    block[3] += tangential * lever * nz
    block[4] -= tangential * lever * nx
    block[5] += tangential * lever * lever


@njit(cache=True, nogil=True, error_model="numpy")
def bound(block: np.ndarray, invmass: float, rim: float) -> float:
    """Gershgorin's bound of the block's largest eigenvalue over mass; rim: r^2/I with levers in radii."""
    cross = np.sqrt(invmass * rim)
    first = (block[0] + abs(block[2])) * invmass + abs(block[3]) * cross
    second = (block[1] + abs(block[2])) * invmass + abs(block[4]) * cross
    third = block[5] * rim + (abs(block[3]) + abs(block[4])) * cross
    return max(first, second, third)


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step(
    x: np.ndarray,
    z: np.ndarray,
    radius: np.ndarray,
    invmass: np.ndarray,
    rim: np.ndarray,
    i: np.ndarray,
    j: np.ndarray,
    kind: np.ndarray,
    length: np.ndarray,
    skin: float,
    table: np.ndarray,
    line_disc: np.ndarray,
    line_id: np.ndarray,
    line_kind: np.ndarray,
    lines: np.ndarray,
    line_table: np.ndarray,
) -> tuple[float, int]:
    """Largest stable time step (s) and the disc that sets it; (inf, -1) without contacts.

    invmass: 1/m or 0 for fixed discs; rim: r^2/I; pairs i, j with column `kind` of `table` and pore length `length`;
    skin (m): how much nearer a pair may come before the list is made anew.
    """
    n = len(x)
    springs = np.zeros((n, 6))
    dashpots = np.zeros((n, 6))
    for c in range(len(i)):
        a, b, k = i[c], j[c], kind[c]
        dx, dz = x[b] - x[a], z[b] - z[a]
        d = max(np.sqrt(dx * dx + dz * dz), 1e-300)
        if length[c] <= 0.0 and d > max(radius[a] + radius[b], -length[c]) + skin:
            continue
        nx, nz = dx / d, dz / d
        # overlap only shortens the lever
        lever = max(d / (radius[a] + radius[b]), 1.0)
        kn, ks = table[KN, k], table[KS, k]
        if length[c] != 0.0:
            kn, ks = kn + table[KPN, k], ks + table[KPS, k]
        add_block(springs[a], nx, nz, lever, kn, ks)
        add_block(springs[b], -nx, -nz, lever, kn, ks)
        add_block(dashpots[a], nx, nz, lever, table[CN, k], table[CT, k])
        add_block(dashpots[b], -nx, -nz, lever, table[CN, k], table[CT, k])
    for e in range(len(line_disc)):
        a, k = line_disc[e], line_kind[e]
        nx, nz = lines[line_id[e], 2], lines[line_id[e], 3]
        add_block(springs[a], -nx, -nz, 1.0, line_table[KN, k], line_table[KS, k])
        add_block(dashpots[a], -nx, -nz, 1.0, line_table[CN, k], line_table[CT, k])
    least = np.inf
    which = -1
    for a in range(n):
        k2 = 2.0 * bound(springs[a], invmass[a], rim[a])
        c2 = 2.0 * bound(dashpots[a], invmass[a], rim[a])
        if k2 > 0.0:
            step = 2.0 / (c2 + np.sqrt(c2 * c2 + k2))
            if step < least:
                least, which = step, a
    return least, which
