"""Computes the largest stable time step of any assembly of discs (kernel).

For springs between pairs, K <= 2 diag(K_ii): the energy of a spring between i and j is at most twice the sum of the
energies that it would have if only i or only j moved. Therefore omega_max^2 <= 2 max_i lambda(K_ii / M_ii), with the 3
x 3 blocks of translation and rotation of one disc, and likewise for the dashpots. The stepping scheme is stable for a
mode of frequency omega and damping c = 2 zeta omega as long as h^2 omega^2 + 4 h c <= 4 (its characteristic polynomial
leaves the unit circle at -1), and a step that is stable at the bound is stable for every mode.

Every listed pair counts as touching, and every pore spring as compressed, so that the bound holds until the list is
renewed, when it is computed again. Only cracked pairs that are too far apart to touch before the list is renewed are
left out; the list contains such pairs only for their history variables. Equal discs on a triangular lattice give max(6
kn + 6 ks, 24 ks)/m for omega_max^2, where max(6 kn + 2 ks, 24 ks)/m is exact. A spring of rolling resistance adds ks
(r_j/(r_i + r_j))^2 to the rotational stiffness, and where soil discs stiffen with the overlap, the stiffer branch
counts.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from dem.kernels.arguments import Springs
from dem.kernels.contact import CN, CT, KN, KPN, KPS, KS, MU_ROLLING, STOP
from dem.kernels.device_function import device_function
from dem.kernels.layout import INVMASS, LANES, LENGTH, LINK, RADII, RIM, ROLL_LINK, SHARE, Layout, X, Z, entry, place
from dem.kernels.period import Period, image
from dem.kernels.transpose import CONSTANT_RECORD

ONE, TWO, THREE, FOUR, FIVE = (np.uint64(k) for k in range(1, 6))
DASHPOTS = np.uint64(8)  # behind the block of stiffness
BLOCKS = 16  # doubles of a disc: its two blocks, each in a cache line


class Bodies(NamedTuple):
    """Holds the n discs for which the stable time step is computed.

    Attributes
    ----------
    x, z, radius (n,) : places and radii (m)
    invmass (n,) : 1/m (m/kg), 0 for fixed discs
    rim (n,) : r^2/I (m/kg), 0 for discs that do not turn
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    invmass: np.ndarray
    rim: np.ndarray


class Pairs(NamedTuple):
    """Holds the m pairs of the neighbour list.

    Attributes
    ----------
    i, j, kind (m,) : numbers of the discs, column of the table of constants
    length (m,) : length of the pore spring (m), see `contact.pore`
    """

    i: np.ndarray
    j: np.ndarray
    kind: np.ndarray
    length: np.ndarray


class LineContacts(NamedTuple):
    """Holds k discs near rigid lines.

    Attributes
    ----------
    disc, line, kind (k,) : number of the disc, of the line, column of the table of lines
    """

    disc: np.ndarray
    line: np.ndarray
    kind: np.ndarray


@device_function(nogil=True, forceinline=True)
def add_block(
    blocks: np.ndarray, at: np.uint64, sign: float, way: tuple[float, float, float], normal: float, tangential: float
) -> None:
    """Add a spring along a direction and a spring across it to the six entries of a block of the stiffness matrix.

    blocks: blocks of all discs; at: place at which the block begins; sign: -1 at the other end of the spring; way: unit
    direction, and the lever of the transverse spring, in radii; normal, tangential: stiffnesses (N/m).
    """
    nx, nz, lever = way
    blocks[at] += normal * nx * nx + tangential * nz * nz
    blocks[at + ONE] += normal * nz * nz + tangential * nx * nx
    blocks[at + TWO] += (normal - tangential) * nx * nz
    blocks[at + THREE] += sign * (tangential * lever * nz)
    blocks[at + FOUR] -= sign * (tangential * lever * nx)
    blocks[at + FIVE] += tangential * lever * lever


@device_function(nogil=True, forceinline=True)
def bound(blocks: np.ndarray, at: np.uint64, invmass: float, rim: float) -> float:
    """Return Gershgorin's bound of the largest eigenvalue (1/s2) of the block that begins at `at`, over mass.

    blocks: blocks of all discs; invmass: 1/m (1/kg); rim: r^2/I (1/kg), where the lever arms are in units of the
    radius.
    """
    cross = np.sqrt(invmass * rim)
    across, moment_x, moment_z = abs(blocks[at + TWO]), abs(blocks[at + THREE]), abs(blocks[at + FOUR])
    first = (blocks[at] + across) * invmass + moment_x * cross
    second = (blocks[at + ONE] + across) * invmass + moment_z * cross
    third = blocks[at + FIVE] * rim + (moment_x + moment_z) * cross
    return max(first, second, third)


@device_function(nogil=True, forceinline=True)
def blocks_of(disc: int) -> np.uint64:
    """Return the places of the two blocks of a disc: of stiffness, then of dashpots."""
    return np.uint64(disc) * np.uint64(BLOCKS)


@device_function(nogil=True, forceinline=True)
def add_pair(
    blocks: np.ndarray,
    a: int,
    b: int,
    way: tuple[float, float],
    radii: float,
    parts: tuple[float, float],
    length: float,
    kind: int,
    skin: float,
    records: np.ndarray,
) -> None:
    """Add a pair to the blocks of its discs a and b.

    way: vector from a to b (m); radii: sum of their radii (m); parts: share of each radius in the sum; length: length
    of the pore spring (m); kind: column of the constants; skin: decrease of the distance that is allowed for (m);
    records: see `Springs`.
    """
    dx, dz = way
    d = max(np.sqrt(dx * dx + dz * dz), 1e-300)
    if length <= 0.0 and d > max(radii, -length) + skin:
        return
    # overlap only shortens the lever
    along = (dx / d, dz / d, max(d / radii, 1.0))
    constant = np.uint64(kind) * np.uint64(CONSTANT_RECORD)
    kn = records[constant + np.uint64(KN)] + records[constant + np.uint64(STOP)]
    ks = records[constant + np.uint64(KS)]
    rolls = ks if records[constant + np.uint64(MU_ROLLING)] > 0.0 else 0.0
    if length != 0.0:
        kn += records[constant + np.uint64(KPN)]
        ks += records[constant + np.uint64(KPS)]
    cn, ct = records[constant + np.uint64(CN)], records[constant + np.uint64(CT)]
    turns = ct if rolls > 0.0 else 0.0
    block_a, block_b = blocks_of(a), blocks_of(b)
    add_block(blocks, block_a, 1.0, along, kn, ks)
    add_block(blocks, block_a + DASHPOTS, 1.0, along, cn, ct)
    add_block(blocks, block_b, -1.0, along, kn, ks)
    add_block(blocks, block_b + DASHPOTS, -1.0, along, cn, ct)
    if rolls > 0.0:
        blocks[block_a + FIVE] += rolls * parts[1] ** 2
        blocks[block_a + DASHPOTS + FIVE] += turns * parts[1] ** 2
        blocks[block_b + FIVE] += rolls * parts[0] ** 2
        blocks[block_b + DASHPOTS + FIVE] += turns * parts[0] ** 2


@device_function(nogil=True)
def add_line(blocks: np.ndarray, disc: int, line: int, kind: int, springs: Springs) -> None:
    """Add a rigid line to the blocks of a disc; kind: column of the constants in `springs.lines`."""
    table, at = springs.lines, blocks_of(disc)
    against = (springs.walls[line, 2], springs.walls[line, 3], 1.0)
    add_block(blocks, at, -1.0, against, table[KN, kind], table[KS, kind])
    add_block(blocks, at + DASHPOTS, -1.0, against, table[CN, kind], table[CT, kind])
    if table[MU_ROLLING, kind] > 0.0:
        blocks[at + FIVE] += table[KS, kind]
        blocks[at + DASHPOTS + FIVE] += table[CT, kind]


@device_function(nogil=True)
def step_of(blocks: np.ndarray, disc: int, invmass: float, rim: float) -> float:
    """Return the largest stable time step (s) of a disc from its blocks; inf for a disc that cannot move; invmass, rim:
    see `bound`.
    """
    k2 = 2.0 * bound(blocks, blocks_of(disc), invmass, rim)
    c2 = 2.0 * bound(blocks, blocks_of(disc) + DASHPOTS, invmass, rim)
    return 2.0 / (c2 + np.sqrt(c2 * c2 + k2)) if k2 > 0.0 else np.inf


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step(
    bodies: Bodies, pairs: Pairs, skin: float, at_lines: LineContacts, springs: Springs, period: Period
) -> tuple[float, int]:
    """Return the largest stable time step (s) and the disc that limits it; (inf, -1) without contacts.

    bodies: the discs; pairs: listed pairs; skin: decrease of the distance of a pair before the list is renewed (m);
    at_lines: contacts with rigid lines; springs: constants; period: period of the ground.
    """
    x, z, radius = bodies.x, bodies.z, bodies.radius
    blocks = np.zeros(len(x) * BLOCKS)
    for c in range(len(pairs.i)):
        a, b = pairs.i[c], pairs.j[c]
        radii = radius[a] + radius[b]
        add_pair(
            blocks, a, b, image(x[b] - x[a], z[b] - z[a], period), radii, (radius[a] / radii, radius[b] / radii),
            pairs.length[c], pairs.kind[c], skin, springs.records,
        )  # fmt: skip
    for e in range(len(at_lines.disc)):
        add_line(blocks, at_lines.disc[e], at_lines.line[e], at_lines.kind[e], springs)
    least = np.inf
    which = -1
    for a in range(len(x)):
        step = step_of(blocks, a, bodies.invmass[a], bodies.rim[a])
        if step < least:
            least, which = step, a
    return least, which


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step_of_layout(layout: Layout, discs: int, skin: float, springs: Springs, period: Period) -> float:
    """Return the stable time step (s) from the arrays of the kernels; equal to `stable_step` to rounding.

    layout: discs and contacts; discs: number of discs; skin, springs, period: as in `stable_step`.
    """
    blocks = np.zeros(discs * BLOCKS)
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
                    blocks, a, b, image(dx, dz, period), links[at + RADII], (part, 1.0 - part), links[at + LENGTH],
                    np.int64(layout.kinds[chunk * LANES + lane]), skin, springs.records,
                )  # fmt: skip
    for e in range(len(layout.line_disc)):
        add_line(blocks, layout.line_disc[e], layout.line_id[e], layout.line_kind[e], springs)
    least = np.inf
    for a in range(discs):
        least = min(least, step_of(blocks, a, layout.discs[place(a, INVMASS)], layout.discs[place(a, RIM)]))
    return least
