"""Vertical stresses in a section before the earthquake, at a point (x, depth)."""

from dataclasses import dataclass

import numpy as np

from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

WATER = 1000.0  # kg/m³


@dataclass(frozen=True)
class Overburden:
    """Stresses at a point.

    Attributes
    ----------
    stratum : index of the stratum
    total, effective : vertical stresses (Pa)
    below_water : whether the point lies below the water table
    """

    stratum: int
    total: float
    effective: float
    below_water: bool


def overburden(section: Section, x: float, depth: float) -> Overburden:
    """Weight of the strata above a point, and the water pressure below the water table, which is hydrostatic.

    The seismic density of a stratum is its density with all its water, and so makes the total stress. ``x`` in the
    section and ``depth`` (m) within it: see `outside`.
    """
    levels = section.layering.interfaces(np.array([x]))[0]
    here = float(levels[0]) - depth
    inside = np.clip(levels[:-1], here, None) - np.clip(levels[1:], here, None)
    densities = np.array([stratum.density_seismic for stratum in section.strata])
    total = GRAVITY * float(inside @ densities)
    water = water_level(section, x)
    pressure = 0.0 if water is None else WATER * GRAVITY * max(0.0, water - here)
    stratum = int(section.stratum_at(np.array([x]), np.array([here]))[0])
    return Overburden(stratum, total, total - pressure, pressure > 0.0)


def water_level(section: Section, x: float) -> float | None:
    """Elevation of the water table at x (m); None without any."""
    points = section.water_points()
    return None if points is None else float(np.interp(x, points[:, 0], points[:, 1]))


def outside(section: Section, x: float, depth: float) -> str:
    """Why a point is not in the section; empty where it is."""
    left, right = section.given_extent
    if not left <= x <= right:
        return f"x = {x:g} m is off the section, which reaches from {left:g} to {right:g} m"
    levels = section.layering.interfaces(np.array([x]))[0]
    deepest = float(levels[0] - levels[-1])
    return f"depth = {depth:g} m is below the base, {deepest:.2f} m down at x = {x:g} m" if depth >= deepest else ""
