"""Adds the inertia of surcharges and free water, which move with the ground, to discs (`Layout.added_mass`; kernel)."""

from dem.kernels.device_function import device_function
from dem.kernels.layout import INVMASS, PULL_X, PULL_Z, VX, VZ, Layout, entry, place


@device_function(nogil=True)
def pull_added_mass(p: int, layout: Layout, level: float) -> None:
    """Add the inertia force of added mass to the 64 discs of slice p, at a horizontal acceleration (m/s2)."""
    for k in range(layout.added_mass_start[p], layout.added_mass_start[p + 1]):
        disc = layout.added_mass_disc[k]
        layout.discs[place(disc, PULL_X)] = layout.added_mass[k, 0] + layout.added_mass[k, 2] * level
        layout.discs[place(disc, PULL_Z)] = layout.added_mass[k, 1] + layout.added_mass[k, 3] * level


@device_function(nogil=True)
def added_momentum(p: int, layout: Layout) -> float:
    """Return the momentum (kg m/s per metre) that the added mass in slice p has in the direction of its inertia force,
    which is the power of this force over the horizontal acceleration."""
    momentum = 0.0
    for k in range(layout.added_mass_start[p], layout.added_mass_start[p + 1]):
        disc = layout.added_mass_disc[k]
        vx, vz = layout.shared[entry(disc, VX)], layout.shared[entry(disc, VZ)]
        speed = layout.added_mass[k, 2] * vx + layout.added_mass[k, 3] * vz
        momentum += speed / layout.discs[place(disc, INVMASS)]
    return momentum
