"""The largest stable time step of any assembly of discs.

For springs between pairs, K <= 2 diag(K_ii): the energy of a spring between i and j is at most twice the sum of what
each end would store alone. So omega_max^2 <= 2 max_i lambda(K_ii / M_ii), with the 3 x 3 blocks of translation and
**rotation** of one disc, and likewise for the dashpots. The stepping scheme is stable for a mode of frequency omega and
damping c = 2 zeta omega as long as h^2 omega^2 + 4 h c <= 4 (its characteristic polynomial leaves the unit circle at
-1), and what holds for the bound holds for the mode.

Every listed pair counts as touching, whether it does or not, and every pore spring as compressed: the bound stays true
until the list is made anew, when it is taken again. Only cracked pairs too far apart to meet by then are left out; they
stay listed for their memory alone. Equal discs on a triangular lattice give
max(6 kn + 6 ks, 24 ks)/m for omega_max^2, where max(6 kn + 2 ks, 24 ks)/m is exact. A spring of rolling resistance
adds ks (r_j/(r_i + r_j))^2 to what a rim feels of its neighbours, and where soil discs stiffen with the overlap, the
stiffer branch counts.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.arguments import Springs
from dem.kernels.contact import CN, CT, KN, KPN, KPS, KS, MU_ROLLING, STOP
from dem.kernels.period import Period, image


class Bodies(NamedTuple):
    """Discs, n of them.

    Attributes
    ----------
    x, z, radius : (n,)
        Places and radii (m).
    invmass : (n,)
        1/m (m/kg), 0 for fixed discs.
    rim : (n,)
        r^2/I (m/kg), 0 for discs that do not turn.
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    invmass: np.ndarray
    rim: np.ndarray


class Pairs(NamedTuple):
    """Listed pairs, m of them.

    Attributes
    ----------
    i, j, kind : (m,)
        Numbers of the discs, column of the table of constants.
    length : (m,)
        Of the pore spring (m), see `contact.pore`.
    """

    i: np.ndarray
    j: np.ndarray
    kind: np.ndarray
    length: np.ndarray


class LineContacts(NamedTuple):
    """Discs near rigid lines, k of them.

    Attributes
    ----------
    disc, line, kind : (k,)
        Number of the disc, of the line, column of the table of lines.
    """

    disc: np.ndarray
    line: np.ndarray
    kind: np.ndarray


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
    bodies: Bodies, pairs: Pairs, skin: float, at_lines: LineContacts, springs: Springs, period: Period
) -> tuple[float, int]:
    """Largest stable time step (s) and the disc that sets it; (inf, -1) without contacts.

    skin (m): how much nearer a pair may come before the list is made anew.
    """
    x, z, radius = bodies.x, bodies.z, bodies.radius
    table, line_table = springs.pairs, springs.lines
    stiffness = np.zeros((len(x), 6))
    dashpots = np.zeros((len(x), 6))
    for c in range(len(pairs.i)):
        a, b, k, length = pairs.i[c], pairs.j[c], pairs.kind[c], pairs.length[c]
        dx, dz = image(x[b] - x[a], z[b] - z[a], period)
        d = max(np.sqrt(dx * dx + dz * dz), 1e-300)
        radii = radius[a] + radius[b]
        if length <= 0.0 and d > max(radii, -length) + skin:
            continue
        nx, nz = dx / d, dz / d
        # overlap only shortens the lever
        lever = max(d / radii, 1.0)
        kn, ks = table[KN, k] + table[STOP, k], table[KS, k]
        if length != 0.0:
            kn, ks = kn + table[KPN, k], ks + table[KPS, k]
        add_block(stiffness[a], nx, nz, lever, kn, ks)
        add_block(stiffness[b], -nx, -nz, lever, kn, ks)
        add_block(dashpots[a], nx, nz, lever, table[CN, k], table[CT, k])
        add_block(dashpots[b], -nx, -nz, lever, table[CN, k], table[CT, k])
        if table[MU_ROLLING, k] > 0.0:
            for disc, other in ((a, b), (b, a)):
                share = (radius[other] / radii) ** 2
                stiffness[disc, 5] += table[KS, k] * share
                dashpots[disc, 5] += table[CT, k] * share
    for e in range(len(at_lines.disc)):
        a, k, line = at_lines.disc[e], at_lines.kind[e], at_lines.line[e]
        nx, nz = springs.walls[line, 2], springs.walls[line, 3]
        add_block(stiffness[a], -nx, -nz, 1.0, line_table[KN, k], line_table[KS, k])
        add_block(dashpots[a], -nx, -nz, 1.0, line_table[CN, k], line_table[CT, k])
        if line_table[MU_ROLLING, k] > 0.0:
            stiffness[a, 5] += line_table[KS, k]
            dashpots[a, 5] += line_table[CT, k]
    least = np.inf
    which = -1
    for a in range(len(x)):
        k2 = 2.0 * bound(stiffness[a], bodies.invmass[a], bodies.rim[a])
        c2 = 2.0 * bound(dashpots[a], bodies.invmass[a], bodies.rim[a])
        if k2 > 0.0:
            step = 2.0 / (c2 + np.sqrt(c2 * c2 + k2))
            if step < least:
                least, which = step, a
    return least, which
