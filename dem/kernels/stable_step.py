"""Computes the largest stable time step of any assembly of discs (kernel).

For springs between pairs, K <= diag(sum over pairs of (1 + w_j / w_i) K_ii) with any positive weights w of the discs:
(a + b)^2 <= (1 + w_j / w_i) a^2 + (1 + w_i / w_j) b^2 for what the motions a of disc i and b of disc j do to a spring.
Therefore omega_max^2 is at most the largest eigenvalue of these 3 x 3 blocks of translation and rotation over mass:
with equal weights twice that of K_ii, and only that of K_ii beside fixed discs. Weights that are multiplied by the
eigenvalues of their discs, as in a power iteration, may give a smaller bound; the smallest of `WEIGHT_ROUNDS` bounds
counts. The dashpots have the same weights. The stepping scheme is stable for a mode of frequency omega and damping c =
2 zeta omega as long as h^2 omega^2 + 4 h c <= 4 (its characteristic polynomial leaves the unit circle at -1), and a
step that is stable at the bound is stable for every mode.

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
from dem.kernels.contact import CN, CT, KN, KPN, KPS, KS, MU_ROLLING, STOP_STIFFNESS
from dem.kernels.device_function import device_function
from dem.kernels.layout import INVMASS, LANES, LENGTH, LINK, RADII, RIM, ROLL_LINK, SHARE, Layout, X, Z, entry, place
from dem.kernels.period import Period, image
from dem.kernels.transpose import CONSTANT_RECORD

ONE, TWO, THREE, FOUR, FIVE = (np.uint64(k) for k in range(1, 6))
DASHPOT_BLOCK = np.uint64(8)  # behind the block of stiffness
BLOCK_DOUBLES = 16  # doubles of a disc: its two blocks, each in a cache line
WEIGHT_ROUNDS = 3  # sets of weights, each of which gives a bound
ROUNDING_FACTOR = 1.0 + 1e-9  # on the eigenvalue, whose rounding error is smaller


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
def share_of(weights: np.ndarray, a: int, b: int) -> float:
    """Return the factor on the springs between discs a and b in the block of disc a; 0 if this disc cannot move."""
    return 1.0 + weights[b] / weights[a] if weights[a] > 0.0 else 0.0


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


@device_function(nogil=True)
def largest_eigenvalue(blocks: np.ndarray, at: np.uint64, invmass: float, rim: float) -> float:
    """Return the largest eigenvalue (1/s2) of the block that begins at `at`, over mass, in closed form (Smith 1961,
    Commun. ACM 4, 168); blocks, invmass, rim: as in `bound`."""
    cross = np.sqrt(invmass * rim)
    xx, zz, rr = blocks[at] * invmass, blocks[at + ONE] * invmass, blocks[at + FIVE] * rim
    xz, xr, zr = blocks[at + TWO] * invmass, blocks[at + THREE] * cross, blocks[at + FOUR] * cross
    mean = (xx + zz + rr) / 3.0
    xx, zz, rr = xx - mean, zz - mean, rr - mean
    spread = np.sqrt((xx * xx + zz * zz + rr * rr + 2.0 * (xz * xz + xr * xr + zr * zr)) / 6.0)
    if not spread > 1e-12 * mean:
        return mean * ROUNDING_FACTOR
    determinant = xx * (zz * rr - zr * zr) - xz * (xz * rr - zr * xr) + xr * (xz * zr - zz * xr)
    cosine = min(1.0, max(-1.0, 0.5 * determinant / spread**3))
    return (mean + 2.0 * spread * np.cos(np.arccos(cosine) / 3.0)) * ROUNDING_FACTOR


@device_function(nogil=True, forceinline=True)
def blocks_of(disc: int) -> np.uint64:
    """Return the places of the two blocks of a disc: of stiffness, then of dashpots."""
    return np.uint64(disc) * np.uint64(BLOCK_DOUBLES)


@device_function(nogil=True, forceinline=True)
def add_pair(
    blocks: np.ndarray,
    weights: np.ndarray,
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

    weights: weights of all discs; way: vector from a to b (m); radii: sum of their radii (m); parts: share of each
    radius in the sum; length: length of the pore spring (m); kind: column of the constants; skin: decrease of the
    distance that is allowed for (m); records: see `Springs`.
    """
    dx, dz = way
    d = max(np.sqrt(dx * dx + dz * dz), 1e-300)
    if length <= 0.0 and d > max(radii, -length) + skin:
        return
    # overlap only shortens the lever
    along = (dx / d, dz / d, max(d / radii, 1.0))
    constant = np.uint64(kind) * np.uint64(CONSTANT_RECORD)
    kn = records[constant + np.uint64(KN)] + records[constant + np.uint64(STOP_STIFFNESS)]
    ks = records[constant + np.uint64(KS)]
    rolls = ks if records[constant + np.uint64(MU_ROLLING)] > 0.0 else 0.0
    if length != 0.0:
        kn += records[constant + np.uint64(KPN)]
        ks += records[constant + np.uint64(KPS)]
    cn, ct = records[constant + np.uint64(CN)], records[constant + np.uint64(CT)]
    turns = ct if rolls > 0.0 else 0.0
    block, share = blocks_of(a), share_of(weights, a, b)
    add_block(blocks, block, 1.0, along, share * kn, share * ks)
    add_block(blocks, block + DASHPOT_BLOCK, 1.0, along, share * cn, share * ct)
    blocks[block + FIVE] += share * rolls * parts[1] ** 2
    blocks[block + DASHPOT_BLOCK + FIVE] += share * turns * parts[1] ** 2
    block, share = blocks_of(b), share_of(weights, b, a)
    add_block(blocks, block, -1.0, along, share * kn, share * ks)
    add_block(blocks, block + DASHPOT_BLOCK, -1.0, along, share * cn, share * ct)
    blocks[block + FIVE] += share * rolls * parts[0] ** 2
    blocks[block + DASHPOT_BLOCK + FIVE] += share * turns * parts[0] ** 2


@device_function(nogil=True)
def add_line(blocks: np.ndarray, disc: int, line: int, kind: int, springs: Springs) -> None:
    """Add a rigid line to the blocks of a disc; kind: column of the constants in `springs.lines`."""
    table, at = springs.lines, blocks_of(disc)
    against = (springs.walls[line, 2], springs.walls[line, 3], 1.0)
    add_block(blocks, at, -1.0, against, table[KN, kind], table[KS, kind])
    add_block(blocks, at + DASHPOT_BLOCK, -1.0, against, table[CN, kind], table[CT, kind])
    if table[MU_ROLLING, kind] > 0.0:
        blocks[at + FIVE] += table[KS, kind]
        blocks[at + DASHPOT_BLOCK + FIVE] += table[CT, kind]


@device_function(nogil=True)
def step_of(blocks: np.ndarray, disc: int, invmass: float, rim: float, least: float) -> float:
    """Return the largest stable time step (s) of a disc from its blocks, or any time above `least` (s) if the step is
    above it; inf for a disc that cannot move; invmass, rim: see `bound`.
    """
    at = blocks_of(disc)
    step = _stable(bound(blocks, at, invmass, rim), bound(blocks, at + DASHPOT_BLOCK, invmass, rim))
    if step >= least:
        return step
    return _stable(
        largest_eigenvalue(blocks, at, invmass, rim), largest_eigenvalue(blocks, at + DASHPOT_BLOCK, invmass, rim)
    )


@device_function(nogil=True, forceinline=True)
def _stable(square: float, rate: float) -> float:
    """Return the largest stable time step (s) at a squared frequency (1/s2) and a rate of damping (1/s)."""
    return 2.0 / (rate + np.sqrt(rate * rate + square)) if square > 0.0 else np.inf


@device_function(nogil=True)
def weigh(blocks: np.ndarray, weights: np.ndarray, disc: int, invmass: float, rim: float) -> None:
    """Multiply the weight of a disc in `weights` by the bound from its block of stiffness, and empty its blocks;
    invmass, rim: see `bound`."""
    at = blocks_of(disc)
    weights[disc] *= bound(blocks, at, invmass, rim)
    for k in range(BLOCK_DOUBLES):
        blocks[at + np.uint64(k)] = 0.0


@device_function(nogil=True)
def _add_all(
    blocks: np.ndarray,
    weights: np.ndarray,
    bodies: Bodies,
    pairs: Pairs,
    skin: float,
    at_lines: LineContacts,
    springs: Springs,
    period: Period,
) -> None:
    """Add stiffness and damping of all pairs and lines to the blocks of the discs; arguments as in `stable_step`."""
    x, z, radius = bodies.x, bodies.z, bodies.radius
    for c in range(len(pairs.i)):
        a, b = pairs.i[c], pairs.j[c]
        radii = radius[a] + radius[b]
        add_pair(
            blocks, weights, a, b, image(x[b] - x[a], z[b] - z[a], period), radii,
            (radius[a] / radii, radius[b] / radii), pairs.length[c], pairs.kind[c], skin, springs.records,
        )  # fmt: skip
    for e in range(len(at_lines.disc)):
        add_line(blocks, at_lines.disc[e], at_lines.line[e], at_lines.kind[e], springs)


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step(
    bodies: Bodies, pairs: Pairs, skin: float, at_lines: LineContacts, springs: Springs, period: Period, enough: float
) -> tuple[float, int]:
    """Return the largest stable time step of discs in contact, by the bound in the docstring of this module.

    Parameters
    ----------
    bodies : the discs
    pairs : pairs of the neighbour list
    skin : decrease of the distance of a pair before the list is renewed (m)
    at_lines : contacts with rigid lines
    springs : constants of the contacts
    period : length along x and rise along z of a period (m)
    enough : step (s) beyond which the bound is not improved by further weights; inf for the best bound

    Returns
    -------
    The step (s), and the disc that limits it if all discs have equal weights; (inf, -1) without contacts.
    """
    discs = len(bodies.x)
    blocks = np.zeros(discs * BLOCK_DOUBLES)
    weights = np.where(bodies.invmass > 0.0, 1.0, 0.0)
    largest, which = 0.0, -1
    for weighing in range(WEIGHT_ROUNDS):
        _add_all(blocks, weights, bodies, pairs, skin, at_lines, springs, period)
        least, slowest = np.inf, -1
        for a in range(discs):
            step = step_of(blocks, a, bodies.invmass[a], bodies.rim[a], least)
            if step < least:
                least, slowest = step, a
            weigh(blocks, weights, a, bodies.invmass[a], bodies.rim[a])
        largest = max(largest, least)
        if weighing == 0:
            which = slowest
        if largest >= enough:
            break
    return largest, which


@device_function(nogil=True)
def _add_layout(
    blocks: np.ndarray,
    weights: np.ndarray,
    layout: Layout,
    discs: int,
    skin: float,
    springs: Springs,
    period: Period,
) -> None:
    """Add all pairs and lines of a layout to the blocks; arguments as in `stable_step_of_layout`."""
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
                    blocks, weights, a, b, image(dx, dz, period), links[at + RADII], (part, 1.0 - part),
                    links[at + LENGTH], np.int64(layout.kinds[chunk * LANES + lane]), skin, springs.records,
                )  # fmt: skip
    for e in range(len(layout.line_disc)):
        add_line(blocks, layout.line_disc[e], layout.line_id[e], layout.line_kind[e], springs)


@njit(cache=True, nogil=True, error_model="numpy")
def stable_step_of_layout(layout: Layout, discs: int, skin: float, springs: Springs, period: Period) -> float:
    """Return the largest stable time step from the arrays of the kernels; equal to `stable_step` to rounding.

    Parameters
    ----------
    layout : discs and contacts
    discs : number of discs
    skin, springs, period : as in `stable_step`

    Returns
    -------
    The step (s), inf without contacts.
    """
    blocks, weights, largest = np.zeros(discs * BLOCK_DOUBLES), np.zeros(discs), 0.0
    for a in range(discs):
        weights[a] = 1.0 if layout.discs[place(a, INVMASS)] > 0.0 else 0.0
    for _ in range(WEIGHT_ROUNDS):
        _add_layout(blocks, weights, layout, discs, skin, springs, period)
        least = np.inf
        for a in range(discs):
            invmass, rim = layout.discs[place(a, INVMASS)], layout.discs[place(a, RIM)]
            least = min(least, step_of(blocks, a, invmass, rim, least))
            weigh(blocks, weights, a, invmass, rim)
        largest = max(largest, least)
    return largest
