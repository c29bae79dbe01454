"""Arranges pairs of liquefied ground in lanes, lists the pairs of every disc, and computes the density of areas
(kernel)."""

import math

import numpy as np
from numba import njit

from dem.kernels.liquefied_laws import density_kernel
from dem.kernels.liquefied_pairs import LANES, MEMORY, WIDTH_1, WIDTH_2, WORKING
from dem.kernels.period import Period, image

FIRST_DENSITY, SECOND_DENSITY = int(WIDTH_1), int(WIDTH_2)  # contribution to the density of either disc


@njit(cache=True, nogil=True, error_model="numpy")
def place_pairs(first: np.ndarray, slices: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the lane of every pair of liquefied ground. Each slice begins with a new block of lanes.

    Parameters
    ----------
    first (pairs,) : first disc of each pair, in spatial order; the pairs are sorted by it
    slices : number of slices

    Returns
    -------
    Lanes (pairs,), and the first block (slices + 1,) of each slice.
    """
    start = np.zeros(slices + 1, np.int64)
    for c in range(len(first)):
        start[first[c] // LANES + 1] += 1
    lane = np.empty(len(first), np.int64)
    c = 0
    for p in range(slices):
        count = start[p + 1]
        for k in range(count):
            lane[c] = start[p] * LANES + k
            c += 1
        start[p + 1] = start[p] + (count + LANES - 1) // LANES
    return lane, start


@njit(cache=True, nogil=True, error_model="numpy")
def place_bonds(lane: np.ndarray, bonds: np.ndarray, memory: np.ndarray) -> None:
    """Write the history variables of the bonds into their lanes.

    Parameters
    ----------
    lane (pairs,) : lane of every pair, by `place_pairs`
    bonds (pairs, MEMORY) : history variables
    memory (blocks * MEMORY * LANES,) : the same by lanes, filled here
    """
    for c in range(len(lane)):
        at = lane[c] // LANES * MEMORY * LANES + lane[c] % LANES
        for field in range(MEMORY):
            memory[at + field * LANES] = bonds[c, field]


@njit(cache=True, nogil=True, error_model="numpy")
def list_bonds(lane: np.ndarray, memory: np.ndarray, bonds: np.ndarray) -> None:
    """Read the history variables of the bonds from their lanes.

    Parameters
    ----------
    lane (pairs,) : lane of every pair, by `place_pairs`
    memory (blocks * MEMORY * LANES,) : history variables by lanes
    bonds (pairs, MEMORY) : the same by pairs, filled here
    """
    for c in range(len(lane)):
        at = lane[c] // LANES * MEMORY * LANES + lane[c] % LANES
        for field in range(MEMORY):
            bonds[c, field] = memory[at + field * LANES]


@njit(cache=True, nogil=True, error_model="numpy")
def members_of(first: np.ndarray, second: np.ndarray, lane: np.ndarray, slots: int) -> tuple[np.ndarray, np.ndarray]:
    """List for every disc where its pairs contribute to its density, in the order of the pairs.

    Parameters
    ----------
    first, second (pairs,) : discs of each pair, in spatial order
    lane (pairs,) : lane of each pair, by `place_pairs`
    slots : number of discs, filled up to whole slices

    Returns
    -------
    `member` and `members` of `Liquefied`.
    """
    members = np.zeros(slots + 1, np.int64)
    for c in range(len(first)):
        members[first[c] + 1] += 1
        members[second[c] + 1] += 1
    for i in range(slots):
        members[i + 1] += members[i]
    free = members[:-1].copy()
    member = np.empty(2 * len(first), np.int64)
    for c in range(len(first)):
        at = lane[c] // LANES * WORKING * LANES + lane[c] % LANES
        member[free[first[c]]] = at + FIRST_DENSITY
        member[free[second[c]]] = at + SECOND_DENSITY
        free[first[c]] += 1
        free[second[c]] += 1
    return member, members


@njit(cache=True, nogil=True, error_model="numpy")
def densities(
    x: np.ndarray, z: np.ndarray, area: np.ndarray, first: np.ndarray, second: np.ndarray, reach: float, period: Period
) -> np.ndarray:
    """Return the density of the areas of discs, rho_i = sum_j V_j W(r_ij), the disc itself included.

    W is the kernel C2 of Wendland (1995), see `liquefied_pairs`.

    Parameters
    ----------
    x, z (n,) : places (m)
    area (n,) : areas V of the discs with their voids (m2)
    first, second (pairs,) : discs of each pair
    reach : reach of the kernel (m); pairs further apart count nothing
    period : length along x and rise along z of a period (m)

    Returns
    -------
    Densities (n,), without dimension.
    """
    out = area * (7.0 / (math.pi * reach * reach))
    for c in range(len(first)):
        i, j = first[c], second[c]
        dx, dz = image(x[j] - x[i], z[j] - z[i], period)
        apart = math.sqrt(dx * dx + dz * dz)
        if apart < reach:
            width = density_kernel(apart, reach)[0]
            out[i] += area[j] * width
            out[j] += area[i] * width
    return out
