"""Computes the energy that liquefied ground stores, in J per metre out of plane (kernel)."""

import numpy as np

from dem.kernels import liquefied_pairs as bond
from dem.kernels.bond_law import energy_share
from dem.kernels.device_function import device_function
from dem.kernels.liquefied_bonds import bond_lines
from dem.kernels.liquefied_laws import water_energy


@device_function(nogil=True)
def liquefied_energy(wet: bond.Liquefied, shared: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    """Return the energy (J) stored in pore water and in bonds. Also add the last forces to `force` (3, slots).

    The work of the last forces on the displacements since their evaluation counts as stored energy.
    """
    discs = wet.discs
    water, bonds = 0.0, 0.0
    for k in range(len(wet.paired)):
        i = np.int64(wet.paired[k])
        fx, fz = discs[i, bond.FORCE_X], discs[i, bond.FORCE_Z]
        force[0, i] += fx
        force[1, i] += fz
        water -= fx * (shared[8 * i] - discs[i, bond.AT_X]) + fz * (shared[8 * i + 1] - discs[i, bond.AT_Z])
        if discs[i, bond.SHARE] > 0.0:
            water += water_energy(
                discs[i, bond.SHARE], discs[i, bond.AREA], discs[i, bond.PRESSURE], discs[i, bond.STIFFNESS],
                discs[i, bond.DENSITY], discs[i, bond.PRESENT_DENSITY],
            )  # fmt: skip
    for block in range(wet.start[-1]):
        for lane in range(bond.LANES):
            r = np.uint64(block) * bond.MEMORY_BLOCK + np.uint64(lane)
            i, j = np.int64(wet.disc_i[block * bond.LANES + lane]), np.int64(wet.disc_j[block * bond.LANES + lane])
            soft, steep, soft_to = bond_lines(discs, i, j)
            stored = energy_share(wet.memory[r + bond.ALONG], wet.memory[r + bond.ACROSS], soft, steep, soft_to)
            bonds += 0.5 * wet.memory[r + bond.LIMIT_ENERGY] * stored
    return water, bonds
