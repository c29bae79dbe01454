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
from dem.kernels.inner import inner
from dem.kernels.layout import INVMASS, LANES, LENGTH, LINK, RADII, RIM, ROLL_LINK, SHARE, Layout, X, Z, entry, place
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


@inner(nogil=True)
def add_block(block: np.ndarray, nx: float, nz: float, lever: float, normal: float, tangential: float) -> None:
    """Adds a spring along (nx, nz) and one across it, at a lever, to the six entries of a disc's block."""
    block[0] += normal * nx * nx + tangential * nz * nz
    block[1] += normal * nz * nz + tangential * nx * nx
    block[2] += (normal - tangential) * nx * nz
    block[3] += tangential * lever * nz
    block[4] -= tangential * lever * nx
    block[5] += tangential * lever * lever


@inner(nogil=True)
def bound(block: np.ndarray, invmass: float, rim: float) -> float:
    """Gershgorin's bound of the block's largest eigenvalue over mass; rim: r^2/I with levers in radii."""
    cross = np.sqrt(invmass * rim)
    first = (block[0] + abs(block[2])) * invmass + abs(block[3]) * cross
    second = (block[1] + abs(block[2])) * invmass + abs(block[4]) * cross
    third = block[5] * rim + (abs(block[3]) + abs(block[4])) * cross
    return max(first, second, third)


@njit(cache=True, nogil=True, error_model="numpy")
def add_pair(
    stiffness: np.ndarray,
    dashpots: np.ndarray,
    a: int,
    b: int,
    way: tuple[float, float],
    radii: float,
    parts: tuple[float, float],
    length: float,
    kind: int,
    skin: float,
    table: np.ndarray,
) -> None:
    """Adds a pair to the blocks of its discs a and b.

    way: from a to b (m); radii: their sum (m), parts: the share of each in it; length: of the pore spring (m).
    """
    dx, dz = way
    d = max(np.sqrt(dx * dx + dz * dz), 1e-300)
    if length <= 0.0 and d > max(radii, -length) + skin:
        return
    nx, nz = dx / d, dz / d
    # overlap only shortens the lever
    lever = max(d / radii, 1.0)
    kn, ks = table[KN, kind] + table[STOP, kind], table[KS, kind]
    if length != 0.0:
        kn, ks = kn + table[KPN, kind], ks + table[KPS, kind]
    add_block(stiffness[a], nx, nz, lever, kn, ks)
    add_block(stiffness[b], -nx, -nz, lever, kn, ks)
    add_block(dashpots[a], nx, nz, lever, table[CN, kind], table[CT, kind])
    add_block(dashpots[b], -nx, -nz, lever, table[CN, kind], table[CT, kind])
    if table[MU_ROLLING, kind] > 0.0:
        stiffness[a, 5] += table[KS, kind] * parts[1] ** 2
        dashpots[a, 5] += table[CT, kind] * parts[1] ** 2
        stiffness[b, 5] += table[KS, kind] * parts[0] ** 2
        dashpots[b, 5] += table[CT, kind] * parts[0] ** 2


@njit(cache=True, nogil=True, error_model="numpy")
def add_line(stiffness: np.ndarray, dashpots: np.ndarray, line: int, kind: int, springs: Springs) -> None:
    """Adds a rigid line to the block of a disc."""
    nx, nz = springs.walls[line, 2], springs.walls[line, 3]
    table = springs.lines
    add_block(stiffness, -nx, -nz, 1.0, table[KN, kind], table[KS, kind])
    add_block(dashpots, -nx, -nz, 1.0, table[CN, kind], table[CT, kind])
    if table[MU_ROLLING, kind] > 0.0:
        stiffness[5] += table[KS, kind]
        dashpots[5] += table[CT, kind]


@njit(cache=True, nogil=True, error_model="numpy")
def step_of(stiffness: np.ndarray, dashpots: np.ndarray, invmass: float, rim: float) -> float:
    """Largest stable time step (s) of a disc with these blocks; inf if it moves nothing."""
    k2 = 2.0 * bound(stiffness, invmass, rim)
    c2 = 2.0 * bound(dashpots, invmass, rim)
    return 2.0 / (c2 + np.sqrt(c2 * c2 + k2)) if k2 > 0.0 else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step(
    bodies: Bodies, pairs: Pairs, skin: float, at_lines: LineContacts, springs: Springs, period: Period
) -> tuple[float, int]:
    """Largest stable time step (s) and the disc that sets it; (inf, -1) without contacts.

    skin (m): how much nearer a pair may come before the list is made anew.
    """
    x, z, radius = bodies.x, bodies.z, bodies.radius
    stiffness = np.zeros((len(x), 6))
    dashpots = np.zeros((len(x), 6))
    for c in range(len(pairs.i)):
        a, b = pairs.i[c], pairs.j[c]
        radii = radius[a] + radius[b]
        add_pair(
            stiffness, dashpots, a, b, image(x[b] - x[a], z[b] - z[a], period), radii,
            (radius[a] / radii, radius[b] / radii), pairs.length[c], pairs.kind[c], skin, springs.pairs,
        )  # fmt: skip
    for e in range(len(at_lines.disc)):
        a = at_lines.disc[e]
        add_line(stiffness[a], dashpots[a], at_lines.line[e], at_lines.kind[e], springs)
    least = np.inf
    which = -1
    for a in range(len(x)):
        step = step_of(stiffness[a], dashpots[a], bodies.invmass[a], bodies.rim[a])
        if step < least:
            least, which = step, a
    return least, which


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step_of_layout(layout: Layout, discs: int, skin: float, springs: Springs, period: Period) -> float:
    """The same step (s), to rounding, from where the kernels keep the contacts; discs: how many there are."""
    stiffness = np.zeros((discs, 6))
    dashpots = np.zeros((discs, 6))
    shared, links = layout.shared, layout.links
    for p in range(len(layout.chunk_start) - 1):
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            for lane in range(LANES):
                a, b = p * LANES + lane, np.int64(layout.partner[chunk * LANES + lane])
                if a >= discs or b >= discs:
                    continue
                at = np.uint64(chunk) * LINK + np.uint64(lane)
                part = 0.5
                if len(layout.rolling) > 0:
                    part = layout.rolling[np.uint64(chunk) * ROLL_LINK + SHARE + np.uint64(lane)]
                dx = shared[entry(b, X)] - shared[entry(a, X)]
                dz = shared[entry(b, Z)] - shared[entry(a, Z)]
                add_pair(
                    stiffness, dashpots, a, b, image(dx, dz, period), links[at + RADII], (part, 1.0 - part),
                    links[at + LENGTH], np.int64(layout.kinds[chunk * LANES + lane]), skin, springs.pairs,
                )  # fmt: skip
    for e in range(len(layout.line_disc)):
        a = layout.line_disc[e]
        add_line(stiffness[a], dashpots[a], layout.line_id[e], layout.line_kind[e], springs)
    least = np.inf
    for a in range(discs):
        invmass, rim = layout.discs[place(a, INVMASS)], layout.discs[place(a, RIM)]
        least = min(least, step_of(stiffness[a], dashpots[a], invmass, rim))
    return least
