"""Copies the state of discs from the model to the layout and back, and checks their positions (kernel)."""

import numpy as np
from numba import njit

from dem.kernels.layout import DISC_FIELDS, LANES, ROLL, VX, VZ, Layout, entry, place
from dem.kernels.transpose import SHARED

IGNORED_DISTANCE = 1e3  # radii behind a rigid line beyond which the line does not act on a disc


@njit(cache=True, nogil=True, error_model="numpy")
def place_motion(order: np.ndarray, state: tuple[np.ndarray, ...], shared: np.ndarray) -> None:
    """Write positions and velocities of the discs into their shared fields.

    Parameters
    ----------
    order (n,) : original number of every disc
    state : the SHARED arrays (n,) of the model in the order of the fields X to VRS of `layout`
    shared (slices * 64 * SHARED,) : as in `Layout`, filled here
    """
    for i in range(len(order)):
        disc = order[i]
        for field in range(SHARED):
            shared[i * SHARED + field] = state[field][disc]


@njit(cache=True, nogil=True, error_model="numpy")
def place_fields(order: np.ndarray, fields: tuple[np.ndarray, ...], discs: np.ndarray) -> None:
    """Write the fields of the discs that only their own slice reads, a row of the slice for each field.

    Parameters
    ----------
    order (n,) : original number of every disc
    fields : arrays (n,) in the order of the fields INVMASS to MASS of `layout`
    discs (slices * DISC,) : as in `Layout`, filled here
    """
    for i in range(len(order)):
        disc = order[i]
        for field in range(DISC_FIELDS):
            discs[place(i, np.uint64(field * LANES))] = fields[field][disc]


@njit(cache=True, nogil=True, error_model="numpy")
def list_motion(layout: Layout, order: np.ndarray, state: tuple[np.ndarray, ...], roll: np.ndarray) -> None:
    """Write positions, velocities and rolled distances of the layout into arrays of the model.

    Parameters
    ----------
    layout : discs and contacts
    order (n,) : original number of every disc
    state : arrays (n,) as of `place_motion`, filled here
    roll (n,) : radius times angle of rotation (m), filled here
    """
    for i in range(len(order)):
        disc = order[i]
        for field in range(SHARED):
            state[field][disc] = layout.shared[i * SHARED + field]
        roll[disc] = layout.discs[place(i, ROLL)]


@njit(cache=True, nogil=True, error_model="numpy")
def list_half_velocities(shared: np.ndarray, order: np.ndarray, vx: np.ndarray, vz: np.ndarray) -> None:
    """Write the velocities of the discs in the middle of the last step into arrays of the model.

    Parameters
    ----------
    shared (slices * 64 * SHARED,) : as in `Layout`
    order (n,) : original number of every disc
    vx, vz (n,) : velocities (m/s), filled here
    """
    for i in range(len(order)):
        disc = order[i]
        vx[disc] = shared[entry(i, VX)]
        vz[disc] = shared[entry(i, VZ)]


@njit(cache=True, nogil=True, error_model="numpy")
def all_finite(x: np.ndarray, z: np.ndarray, vx: np.ndarray, vz: np.ndarray, vr: np.ndarray) -> bool:
    """Return whether all positions and velocities are finite numbers.

    Parameters
    ----------
    x, z (n,) : positions (m)
    vx, vz, vr (n,) : velocities, and radius times angular velocity (m/s)

    Returns
    -------
    False if there is any NaN or infinity.
    """
    fine = True
    for i in range(len(x)):
        fine &= np.isfinite(x[i]) & np.isfinite(z[i]) & np.isfinite(vx[i]) & np.isfinite(vz[i]) & np.isfinite(vr[i])
    return fine


@njit(cache=True, nogil=True, error_model="numpy")
def first_behind(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, fixed: np.ndarray, lines: np.ndarray
) -> tuple[int, int]:
    """Return a rigid line, and a free disc whose centre has passed the line by a radius or more.

    Parameters
    ----------
    x, z (n,) : positions (m)
    radius (n,) : radii (m)
    fixed (n,) : whether the disc is fixed
    lines (k, 6) : point, inward normal, begin and end along the line (m), see `DiscState`

    Returns
    -------
    Numbers of the line and the disc; (-1, -1) without one. A disc further behind a line than `IGNORED_DISTANCE` radii
    does not count.
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
