"""Computes the motion of the background grid of material points in a time step, and of the base that supports its
lowest nodes (kernels).

Velocities are relative to the ground far below the section. Kh or a record acts in this moving frame as an acceleration
of the whole mass. Vectors are positive to the right and upwards; masses (kg) and forces (N) are per metre out of plane.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Of a column of nodes (J/m): kinetic energy that forces gave it, work of pore water.
KINETIC_GAIN, WATER_WORK = range(2)
FREE, FIXED, WALL = range(3)  # of a node: free; at rest relative to the base; horizontally at rest relative to it
# Of a compliant base: ρ V_s L (kg/s per metre), 0 if rigid; its velocity before and after a step (m/s); energy (J/m)
# that left through it.
IMPEDANCE, OLD_VELOCITY, NEW_VELOCITY, RADIATED = range(4)
BASE_FIELDS = 4


@njit(cache=True, nogil=True, error_model="numpy")
def move_base(grid: Floats, uplift: Floats, support: NDArray[np.int8], dt: float, shaking: float, base: Floats) -> None:
    """Advance the velocity of a compliant base by a step; a rigid base stays at rest.

    The nodes that are held have the velocity v of the base, and waves leave the ground through dashpots below it
    (Lysmer & Kuhlemeyer 1969, J. Eng. Mech. Div. ASCE 95, 859-877):

        M dv/dt = F - F_0 - ρ V_s L v,

    M their mass, F the force on them, and F_0 the sum of all forces on the ground but those of shaking: the base
    carries F_0 while the ground is at rest. The dashpots are implicit, so that no time step is too long for them.

    Parameters
    ----------
    grid, uplift, support, dt : as in `move_grid`
    shaking : horizontal acceleration of the whole mass by shaking (m/s²)
    base (BASE_FIELDS,) : impedance, velocities and radiated energy of the base, which are changed
    """
    if base[IMPEDANCE] == 0.0:
        return
    at_rest = base_mass = base_force = 0.0
    for i in range(grid.shape[0]):
        for j in range(grid.shape[1]):
            mass = grid[i, j, 0]
            if mass > 0.0:
                force = grid[i, j, 3] + grid[i, j, 5] * uplift[i, j, 0]
                at_rest += force - shaking * mass
                if support[i, j] != FREE:
                    base_mass += mass
                    base_force += force
    old = base[NEW_VELOCITY]
    new = (base_mass * old + dt * (base_force - at_rest)) / (base_mass + dt * base[IMPEDANCE])
    base[OLD_VELOCITY], base[NEW_VELOCITY] = old, new
    base[RADIATED] += 0.5 * dt * (old + new) * (base[IMPEDANCE] * new + at_rest)


@njit(cache=True, nogil=True, error_model="numpy")
def move_grid(
    first: int, last: int, grid: Floats, uplift: Floats, support: NDArray[np.int8], dt: float, damping: float,
    base: Floats, velocity: Floats, gained: Floats,
) -> None:  # fmt: skip
    """Compute the velocities of the nodes in some columns before and after a step.

    Parameters
    ----------
    first, last : the first column, and the one behind the last
    grid (nx, nz, NODE) : mass, momentum, force and volume of the nodes, as of `material_points.scatter`
    uplift (nx, nz, 2) : force of pore water on a volume of ground, minus the gradient of its pressure (N/m³)
    support (nx, nz) : FREE, FIXED or WALL
    dt : time step (s)
    damping : local non-viscous damping of the forces (Cundall 1987), 0 for none (-)
    base (BASE_FIELDS,) : motion of the base and of the nodes fixed to it
    velocity (nx, nz, 4) : set to the velocities [x, z] before and [x, z] after the step (m/s)
    gained (nx, 2) : increased by the kinetic energy that all forces gave to the nodes of each column, and by the part
        of this energy by pore water (J/m)
    """
    base_old, base_new = base[OLD_VELOCITY], base[NEW_VELOCITY]
    for i in range(first, last):
        energy = buoyed = 0.0
        for j in range(grid.shape[1]):
            mass = grid[i, j, 0]
            if mass <= 0.0 or support[i, j] == FIXED:
                velocity[i, j, 0], velocity[i, j, 2] = base_old, base_new
                velocity[i, j, 1] = velocity[i, j, 3] = 0.0
                if mass > 0.0:
                    energy += 0.5 * mass * (base_new * base_new - base_old * base_old)
                    buoyed += 0.5 * dt * grid[i, j, 5] * uplift[i, j, 0] * (base_old + base_new)
                continue
            old_x, old_z = grid[i, j, 1] / mass, grid[i, j, 2] / mass
            if support[i, j] == WALL:
                old_x = base_old
            water_x, water_z = grid[i, j, 5] * uplift[i, j, 0], grid[i, j, 5] * uplift[i, j, 1]
            ax, az = (grid[i, j, 3] + water_x) / mass, (grid[i, j, 4] + water_z) / mass
            if damping > 0.0:
                ax *= 1.0 - damping if ax * old_x > 0.0 else 1.0 + damping
                az *= 1.0 - damping if az * old_z > 0.0 else 1.0 + damping
            new_x, new_z = old_x + dt * ax, old_z + dt * az
            if support[i, j] == WALL:
                new_x = base_new
            if grid[i, j, 6] > 0.0:
                old_z = new_z = 0.0
            velocity[i, j, 0], velocity[i, j, 1], velocity[i, j, 2], velocity[i, j, 3] = old_x, old_z, new_x, new_z
            energy += 0.5 * mass * (new_x * new_x + new_z * new_z - old_x * old_x - old_z * old_z)
            buoyed += 0.5 * dt * (water_x * (old_x + new_x) + water_z * (old_z + new_z))
        gained[i, KINETIC_GAIN] += energy
        gained[i, WATER_WORK] += buoyed
