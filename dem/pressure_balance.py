"""Moves the discs of ground that is to liquefy until their pore pressures nearly balance.

Discs that have settled by their contacts do not lie where the pressures of `kernels.liquefied_pairs` balance: those of
its neighbours press a disc with three times its weight. Where pressures replace contacts, discs rearrange by 3 to 5 %
of a diameter. All bonds would then slip, each in a direction of its own, and the ground would have only 0.7 to 0.9 of
its strength in the first 5 % of shear strain. Discs are therefore moved before, without time or inertia, as in the
particle packing algorithm of Colagrossi, Bouscasse, Antuono & Marrone (2012), Comput. Phys. Commun. 183, 1641-1653:
each disc follows the force of its pressures, less the mean of this force over its neighbours, since the mean carries
the weight of the ground. Discs of a free surface do not move: they have neighbours on one side only, whose force their
weight carries, and which would lift them by up to a diameter.
"""

import numpy as np

from dem.kernels import liquefied_pairs as bond
from dem.liquefied_ground import LOOSEST_DENSITY, list_liquefied
from dem.neighbourhood import Neighbourhood
from dem.state import DiscState

ITERATIONS = 60
MOBILITY = 0.03  # displacement over the reach for a force u V/H, with the pressure u, the area V and the reach H
LARGEST_MOVE = 0.01  # over the reach
# Of the mean pressure: discs near a free surface do not follow the larger pressures of their neighbours further.
LEAST_PRESSURE = 0.1
# Slope of the density, times the reach, from which a loose disc is at a free surface and not beside a void: half of the
# slope 14/(3 pi) at the edge of a half-plane of ground.
SURFACE_SLOPE = 7.0 / (3.0 * np.pi)


def balance_pressures(state: DiscState, discs: np.ndarray) -> None:
    """Move discs until the pressures of their neighbours nearly balance; other discs stay.

    Parameters
    ----------
    state : discs with the areas (m2) and pressures (Pa) of liquefied ground; positions (m) and the list of liquefied
        pairs are changed, the list of contacts is not
    discs (n,) : mask of the discs that have these pressures. Discs on rigid lines stay, too, since the line carries
        them.
    """
    wet = state.liquefied
    moves = discs & ~np.isin(np.arange(len(state)), state.line_disc)
    if not moves.any():
        return
    pressure = np.where(
        discs, np.maximum(wet[:, bond.PRESSURE], LEAST_PRESSURE * wet[discs, bond.PRESSURE].mean()), 0.0
    )
    for _ in range(ITERATIONS):
        step_x, step_z = _steps(state, discs, pressure)
        state.x[moves] += step_x[moves]
        state.z[moves] += step_z[moves]
        far = np.hypot(state.x - wet[:, bond.AT_X], state.z - wet[:, bond.AT_Z])[moves].max()
        if far > 0.5 * state.skin:
            wet[:, bond.AT_X], wet[:, bond.AT_Z] = state.x, state.z
            list_liquefied(state)
    wet[:, bond.AT_X], wet[:, bond.AT_Z] = state.x, state.z
    list_liquefied(state)


def _steps(state: DiscState, discs: np.ndarray, pressure: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the displacements (n,) in m of all discs in one move, along x and z; discs, pressure (n,): discs with a
    pressure, and the pressure (Pa)."""
    area, reach = state.liquefied[:, bond.AREA], state.reach
    near = Neighbourhood.of(state, state.x, state.z)
    i, j = near.i, near.j
    density = near.density(area)
    term = np.where(discs, pressure / np.where(discs, density, 1.0) ** 2, 0.0)
    both = np.where(discs[i] & discs[j], 1.0, 2.0)  # a disc without pressure reflects that of the other
    force = -both * (term[i] + term[j]) * area[i] * area[j] * near.slope
    wet_area = np.where(discs, area, 0.0)
    per_force = MOBILITY * reach**2 / np.where(discs, area * near.mean(pressure, wet_area), 1.0)
    steps = [per_force * near.sums(-force * n, force * n) for n in (near.nx, near.nz)]
    steps = [step - near.mean(step, wet_area) for step in steps]
    loose = density < LOOSEST_DENSITY * np.median(density[discs])
    length = np.where(loose & _has_one_sided_neighbours(near, area, reach), np.inf, np.hypot(*steps))
    shorter = np.minimum(1.0, LARGEST_MOVE * reach / np.where(length > 0.0, length, 1.0))
    return shorter * steps[0], shorter * steps[1]


def _has_one_sided_neighbours(near: Neighbourhood, area: np.ndarray, reach: float) -> np.ndarray:
    """Return the mask (n,) of discs whose neighbours, with areas (n,) in m2, lie on one side; reach in m."""
    i, j = near.i, near.j
    slope = [near.sums(near.slope * area[j] * n, -near.slope * area[i] * n) for n in (near.nx, near.nz)]
    return np.asarray(np.hypot(*slope) * reach > SURFACE_SLOPE)
