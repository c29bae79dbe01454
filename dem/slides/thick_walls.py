"""Makes the walls of a box of discs thicker, so that they can move with the ground.

Walls of free-field sides are strips of fixed discs that move past each other (`dem.slides.free_sides`). Beyond the
walls of a deposit there is nothing: ground that moves out over a strip would fall down behind it.
"""

import numpy as np

from dem.kernels.layout import LANES
from dem.kernels.liquefied_pairs import FORCE_X, FORCE_Z
from dem.model import DiscModel

OF_DISCS = (
    "x", "z", "roll", "vx", "vz", "vr", "vx_half", "vz_half", "vr_half", "radius", "mass", "weight",
    "pore_acceleration_x", "pore_acceleration_z", "added_mass_x", "added_mass_z", "inertia_ratio", "layer", "fixed",
    "x_list", "z_list", "liquefied", "strength_factor", "undisturbed_x", "undisturbed_z",
)  # fmt: skip


def with_copies(model: DiscModel, which: np.ndarray, shift: float, copies: int) -> tuple[DiscModel, np.ndarray]:
    """Return discs with copies of some fixed discs, side by side.

    Parameters
    ----------
    model : the discs
    which (k,) : numbers of fixed discs
    shift : distance along x from a disc to its first copy, and from there to the next one (m)
    copies : number of copies of each disc

    Returns
    -------
    The discs, with the copies at the end, and the number (copies k,) of the disc that each copy is of.
    """
    source = np.tile(which, copies)
    along = shift * np.repeat(np.arange(1, copies + 1), len(which))
    out = model.copy()
    for name in OF_DISCS:
        values = getattr(model, name)
        if len(values) == len(model):
            setattr(out, name, np.concatenate([values, values[source]]))
    out.x[len(model) :] += along
    out.x_list[len(model) :] += along
    if len(out.liquefied):
        out.liquefied[len(model) :, [FORCE_X, FORCE_Z]] = 0.0
    out.order = np.concatenate([model.order, np.arange(len(model), len(out), dtype=np.int32)])
    sums = np.zeros((len(out) // LANES + 1, model.energy_sums.shape[1]))
    sums[: len(model.energy_sums)] = model.energy_sums
    out.energy_sums = sums
    out.make_list()
    return out, source
