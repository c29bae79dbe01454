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
    """Return the lane (pairs,) of every pair, and the first block (slices + 1,) of every slice. Each slice begins with
    a new block of lanes.
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
    """Write the history variables of the bonds (pairs, MEMORY) into their lanes; lane: see `place_pairs`."""
    for c in range(len(lane)):
        at = lane[c] // LANES * MEMORY * LANES + lane[c] % LANES
        for field in range(MEMORY):
            memory[at + field * LANES] = bonds[c, field]


@njit(cache=True, nogil=True, error_model="numpy")
def list_bonds(lane: np.ndarray, memory: np.ndarray, bonds: np.ndarray) -> None:
    """Read the history variables of the bonds (pairs, MEMORY) from their lanes; lane: see `place_pairs`."""
    for c in range(len(lane)):
        at = lane[c] // LANES * MEMORY * LANES + lane[c] % LANES
        for field in range(MEMORY):
            bonds[c, field] = memory[at + field * LANES]


@njit(cache=True, nogil=True, error_model="numpy")
def members_of(first: np.ndarray, second: np.ndarray, lane: np.ndarray, slots: int) -> tuple[np.ndarray, np.ndarray]:
    """Return `member` and `members` of pairs, which list for every disc its pairs in the order of the list.

    first, second: discs of each pair; lane: lane of each pair; slots: number of discs including padding.
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
    """Return the density of areas (m2) at all discs (n,), summed over the listed pairs.

    x, z: places (m); area: area of each disc (m2); first, second: discs of each pair; reach: reach of the kernel (m);
    period: length after which periodic ground repeats itself.
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
