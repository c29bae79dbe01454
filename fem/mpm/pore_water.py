"""Computes the forces of the pore water, and of free water, on the material points of a section.

Pressures in Pa, compression positive; lengths in m, z upwards.
"""

import numpy as np

from meshes.section.section import Section

ROUNDING = 1e-6  # of a cell or a point: a difference that the place of the section on its axes may make


def uplift(section: Section, cell: float, x: np.ndarray, z: np.ndarray, periodic: bool) -> np.ndarray:
    """Return the force of the water pressure per volume at the nodes of the grid.

    The force is minus the gradient of the water pressure, by central differences between half a cell before and half a
    cell behind the node. Above the ground the gradient is that of free water, so that ground that has slid into the
    water is buoyant.

    Parameters
    ----------
    section : the ground with its water
    cell : width of a cell (m)
    x (nx,), z (nx, nz) : coordinates of the nodes (m)
    periodic : whether the water continues across the sides, as the ground does

    Returns
    -------
    Forces (nx, nz, 2) in N/m³.
    """
    shape = z.shape
    if not section.water_pressure.present:
        return np.zeros((*shape, 2))
    grid = np.column_stack([np.repeat(x, shape[1]), z.ravel()]) + ROUNDING * cell  # not on the lines of the section
    out = np.zeros((*shape, 2))
    for axis in (0, 1):
        step = np.zeros(2)
        step[axis] = 0.5 * cell
        before, behind = (_across_sides(section, grid + way) if periodic else grid + way for way in (-step, step))
        drop = _pressure(section, before) - _pressure(section, behind)
        out[..., axis] = (drop / cell).reshape(shape)
    return out


def _across_sides(section: Section, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) in m; those beyond a periodic side are moved by a period to the other side."""
    (left, right), layering = section.extent, section.layering
    periods = np.floor((points[:, 0] - left) / (right - left))
    return np.asarray(points - np.outer(periods, [right - left, layering.right[-1, -1] - layering.left[0, -1]]))


def between_sides(section: Section, points: np.ndarray) -> np.ndarray:
    """Return points (n, 2) in m; those beyond a side are moved to it, at their height."""
    left, right = section.extent
    tiny = 1e-9 * (right - left)
    return np.column_stack([np.clip(points[:, 0], left + tiny, right - tiny), points[:, 1]])


def _pressure(section: Section, points: np.ndarray) -> np.ndarray:
    """Return the water pressure (n,) in the ground and above it (Pa). Beyond the sides and the base, the pressure is
    that at the side or the base."""
    water, points_inside = section.water_pressure, between_sides(section, points)
    levels = section.layering.interfaces(points_inside[:, 0])
    drop = np.maximum(levels[:, -1] - points_inside[:, 1], 0.0)  # hydrostatic below the base
    points_inside[:, 1] += drop
    stratum = section.layering.stratum_at(points_inside[:, 0], np.minimum(points_inside[:, 1], levels[:, 0]))
    inside = (points_inside[:, 1] <= levels[:, 0]) & (stratum >= 0)
    pressure = water.on_ground(points_inside, points_inside)
    if inside.any():
        places_inside = points_inside[inside]
        pressure[inside] = water.at_rest(places_inside, places_inside, stratum[inside]) + water.excess(
            places_inside, places_inside, stratum[inside]
        )
    return pressure + np.where(pressure > 0.0, drop * water.unit_weight, 0.0)
