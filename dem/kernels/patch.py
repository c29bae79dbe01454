"""Computes the stress of a patch of discs in a frame, and imposes strain on it, in the layout of the stepping kernel
(kernel).

Writing a patch back into the model between two short runs would take longer than computing its stress in the layout.
"""

import numpy as np
from numba import njit

from dem.kernels import layout as field
from dem.kernels.layout import Layout, entry, place


@njit(cache=True, nogil=True, error_model="numpy")
def share_inside(x: float, z: float, along_x: float, along_z: float, region: np.ndarray) -> float:
    """Return the share of the way from (x, z) along (along_x, along_z) that lies in a rectangle (Liang-Barsky).

    region: (2, 2), its low and high corner.
    """
    start, end = 0.0, 1.0
    for axis in range(2):
        first, along = (x, along_x) if axis == 0 else (z, along_z)
        if along == 0.0:
            if first < region[0, axis] or first > region[1, axis]:
                return 0.0
            continue
        a, b = (region[0, axis] - first) / along, (region[1, axis] - first) / along
        start, end = max(start, min(a, b)), min(end, max(a, b))
    return max(end - start, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def pair_forces(layout: Layout, discs: int, back: np.ndarray, region: np.ndarray) -> tuple[np.ndarray, float, int]:
    """Compute the sums for the mean stress in a patch from the contact forces of the last step, dashpots included.

    The mean stress is the sum over pairs of force times branch vector, over the area (virial of Love 1927).

    Parameters
    ----------
    layout : discs and contacts
    discs : number of discs
    back (2, 2) : inverse of the deformation gradient, since ``region`` is given in undeformed coordinates
    region (2, 2) : low and high corner of a rectangle (m)

    Returns
    -------
    Sum (2, 2) of pair force times the part of the branch vector inside the region (N m per metre, tension positive);
    mean unbalanced force on a free disc over the mean pair force, 0 without contact forces; number of cracked pore
    springs.
    """
    shared, links = layout.shared, layout.links
    stress = np.zeros((2, 2))
    total = np.zeros((discs, 2))
    sum_of_forces, carrying, cracked = 0.0, 0, 0
    for p in range(len(layout.chunk_start) - 1):
        for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
            for lane in range(field.LANES):
                i, j = p * field.LANES + lane, np.int64(layout.partner[chunk * field.LANES + lane])
                if i >= discs or j >= discs:
                    continue
                at = np.uint64(chunk) * field.LINK + np.uint64(lane)
                cracked += links[at + field.LENGTH] < 0.0
                fx, fz = links[at + field.FX], links[at + field.FZ]
                if fx == 0.0 and fz == 0.0:
                    continue
                sum_of_forces += np.hypot(fx, fz)
                carrying += 1
                total[i, 0] -= fx
                total[i, 1] -= fz
                total[j, 0] += fx
                total[j, 1] += fz
                x, z = shared[entry(i, field.X)], shared[entry(i, field.Z)]
                dx, dz = shared[entry(j, field.X)] - x, shared[entry(j, field.Z)] - z
                share = share_inside(
                    back[0, 0] * x + back[0, 1] * z, back[1, 0] * x + back[1, 1] * z,
                    back[0, 0] * dx + back[0, 1] * dz, back[1, 0] * dx + back[1, 1] * dz, region,
                )  # fmt: skip
                stress[0, 0] -= share * fx * dx
                stress[0, 1] -= share * fx * dz
                stress[1, 0] -= share * fz * dx
                stress[1, 1] -= share * fz * dz
    if carrying == 0:
        return stress, 0.0, cracked
    left, free = 0.0, 0
    for i in range(discs):
        if layout.discs[place(i, field.INVMASS)] > 0.0:
            left += np.hypot(total[i, 0], total[i, 1])
            free += 1
    return stress, (left / free) / (sum_of_forces / carrying), cracked


@njit(cache=True, nogil=True, error_model="numpy")
def outside(layout: Layout, discs: int, back: np.ndarray) -> int:
    """Return a free disc that is not within the frame, the rectangle of the fixed discs.

    Parameters
    ----------
    layout : discs and contacts
    discs : number of discs
    back (2, 2) : inverse of the deformation gradient, with which the frame is a rectangle about the origin

    Returns
    -------
    Number of the disc in spatial order; -1 if all free discs are within the frame. A disc whose position is NaN counts
    as outside.
    """
    shared = layout.shared
    most_x, most_z = 0.0, 0.0
    for i in range(discs):
        if layout.discs[place(i, field.INVMASS)] == 0.0:
            x, z = shared[entry(i, field.X)], shared[entry(i, field.Z)]
            most_x = max(most_x, abs(back[0, 0] * x + back[0, 1] * z))
            most_z = max(most_z, abs(back[1, 0] * x + back[1, 1] * z))
    for i in range(discs):
        x, z = shared[entry(i, field.X)], shared[entry(i, field.Z)]
        across, up = abs(back[0, 0] * x + back[0, 1] * z), abs(back[1, 0] * x + back[1, 1] * z)
        if layout.discs[place(i, field.INVMASS)] > 0.0 and not (across <= most_x and up <= most_z):
            return i
    return -1


@njit(cache=True, nogil=True, error_model="numpy")
def turn(layout: Layout, radius: np.ndarray, change: np.ndarray, rates: np.ndarray) -> None:
    """Add a change of the velocity gradient to all free discs, and move the discs of the frame with the new gradient.

    Parameters
    ----------
    layout : discs and contacts; the velocities are changed here
    radius (n,) : radius of every disc (m), in spatial order
    change (2, 2) : change of the velocity gradient (1/s), whose antisymmetric part is added to the spin of all discs
    rates (2, 2) : new velocity gradient (1/s)
    """
    shared = layout.shared
    spin = 0.5 * (change[1, 0] - change[0, 1])
    for i in range(len(radius)):
        x, z = shared[entry(i, field.X)], shared[entry(i, field.Z)]
        vx, vz = change[0, 0] * x + change[0, 1] * z, change[1, 0] * x + change[1, 1] * z
        shared[entry(i, field.VR)] += spin * radius[i]
        shared[entry(i, field.VRS)] += spin * radius[i]
        if layout.discs[place(i, field.INVMASS)] > 0.0:
            shared[entry(i, field.VX)] += vx
            shared[entry(i, field.VXS)] += vx
            shared[entry(i, field.VZ)] += vz
            shared[entry(i, field.VZS)] += vz
        else:
            vx, vz = rates[0, 0] * x + rates[0, 1] * z, rates[1, 0] * x + rates[1, 1] * z
            shared[entry(i, field.VX)] = vx
            shared[entry(i, field.VXS)] = vx
            shared[entry(i, field.VZ)] = vz
            shared[entry(i, field.VZS)] = vz
