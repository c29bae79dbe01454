"""Copies the state of discs from the model to the layout and back, and checks their positions (kernel)."""

import numpy as np
from numba import njit

from dem.kernels.layout import DISC_FIELDS, LANES, ROLL, VX, VZ, Layout, entry, place
from dem.kernels.transpose import SHARED

IGNORED_DISTANCE = 1e3  # radii behind a rigid line beyond which the line does not act on a disc


@njit(cache=True, nogil=True, error_model="numpy")
def place_motion(order: np.ndarray, state: tuple[np.ndarray, ...], shared: np.ndarray) -> None:
    """Write the arrays of `state` into the shared fields of every disc, in their order."""
    for i in range(len(order)):
        disc = order[i]
        for field in range(SHARED):
            shared[i * SHARED + field] = state[field][disc]


@njit(cache=True, nogil=True, error_model="numpy")
def place_fields(order: np.ndarray, fields: tuple[np.ndarray, ...], discs: np.ndarray) -> None:
    """Write the other fields of every disc into its slice, a row of the slice for each field."""
    for i in range(len(order)):
        disc = order[i]
        for field in range(DISC_FIELDS):
            discs[place(i, np.uint64(field * LANES))] = fields[field][disc]


@njit(cache=True, nogil=True, error_model="numpy")
def list_motion(layout: Layout, order: np.ndarray, state: tuple[np.ndarray, ...], roll: np.ndarray) -> None:
    """Write the shared fields of every disc, and the distance that it has rolled, into the arrays of `state`, in their
    order.

    layout: discs and contacts; order: original number of every disc; roll: (n,) rolled distance (m), filled here.
    """
    for i in range(len(order)):
        disc = order[i]
        for field in range(SHARED):
            state[field][disc] = layout.shared[i * SHARED + field]
        roll[disc] = layout.discs[place(i, ROLL)]


@njit(cache=True, nogil=True, error_model="numpy")
def list_half_velocities(shared: np.ndarray, order: np.ndarray, vx: np.ndarray, vz: np.ndarray) -> None:
    """Write the velocities of every disc in the middle of a step into the arrays `vx` and `vz` (m/s).

    shared: shared fields of the layout; order: original number of every disc.
    """
    for i in range(len(order)):
        disc = order[i]
        vx[disc] = shared[entry(i, VX)]
        vz[disc] = shared[entry(i, VZ)]


@njit(cache=True, nogil=True, error_model="numpy")
def all_finite(x: np.ndarray, z: np.ndarray, vx: np.ndarray, vz: np.ndarray, vr: np.ndarray) -> bool:
    """Return whether all places x, z and velocities vx, vz, vr are finite numbers."""
    fine = True
    for i in range(len(x)):
        fine &= np.isfinite(x[i]) & np.isfinite(z[i]) & np.isfinite(vx[i]) & np.isfinite(vz[i]) & np.isfinite(vr[i])
    return fine


@njit(cache=True, nogil=True, error_model="numpy")
def first_behind(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, lines: np.ndarray
) -> tuple[int, int]:
    """Return (line, disc) of a free disc whose centre has passed a rigid line by a radius or more, (-1, -1) without
    one.

    x, z: places (m); radius: radii (m); fixed: whether the disc is held; lines: (k, 6) point, inward normal, begin and
    end (m).
    """
    for k in range(len(lines)):
        px, pz, nx, nz, begin, end = lines[k]
        for i in range(len(x)):
            before = (x[i] - px) * nx + (z[i] - pz) * nz
            along = (z[i] - pz) * nx - (x[i] - px) * nz
            # the mouth of a corner belongs to both lines; far beyond the ends nobody is held
            if not fixed[i] and -IGNORED_DISTANCE * radius[i] < before < -radius[i] and begin < along < end:
                return k, i
    return -1, -1
