"""Forces of the contacts as they are now, what they add up to on each disc, and the stress they carry."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from dem.engine.packer import pack, unpack
from dem.kernels.chunks import SCRATCH
from dem.kernels.layout import LANES, LINK_FIELDS, Layout, count_slots
from dem.kernels.stepping import LEDGER, contacts_of_slice
from dem.model import DiscModel


@dataclass(frozen=True)
class ContactForces:
    """Forces (N per metre) at one instant, element and pore spring together.

    Per listed pair: fx, fz on pair_j (on pair_i the opposite), normal (positive: push) and tangential, and the
    tangential force times the ratio of distance and sum of radii, rim. Per disc at a rigid line: the same on the disc.
    """

    fx: np.ndarray
    fz: np.ndarray
    rim: np.ndarray
    normal: np.ndarray
    tangential: np.ndarray
    line_fx: np.ndarray
    line_fz: np.ndarray
    line_rim: np.ndarray


def contact_forces(
    model: DiscModel, *, pulls: bool = False, crack_by: Literal["contact", "pore"] = "contact"
) -> ContactForces:
    """The forces of all contacts, taken by the stepping kernel itself from a copy of the model's state."""
    layout = _evaluated(model, pulls, crack_by)
    slices = len(layout.chunk_start) - 1
    number = np.empty(len(model), np.int32)
    number[model.order] = np.arange(len(model), dtype=np.int32)
    owner = number[model.pair_i]
    turn, start = count_slots(owner, slices)
    links = layout.links.reshape(-1, LINK_FIELDS, LANES)
    fx, fz, rim = links[start[owner // LANES] + turn, 4:7, owner % LANES].T
    e = np.arange(len(model.line_disc))
    line_fx, line_fz, line_rim = links[start[-1] + 1 + e // LANES, 4:7, e % LANES].T
    distance = model.distance()
    nx = (model.x[model.pair_j] - model.x[model.pair_i]) / distance
    nz = (model.z[model.pair_j] - model.z[model.pair_i]) / distance
    return ContactForces(fx, fz, rim, fx * nx + fz * nz, fx * nz - fz * nx, line_fx, line_fz, line_rim)


def keep_slip(model: DiscModel, *, crack_by: Literal["contact", "pore"] = "contact") -> None:
    """Lets the springs remember the slip of the step just taken, as the next step would: to be called before velocities
    are set by hand, since that slip is known by them alone."""
    unpack(_evaluated(model, False, crack_by), model)


def _evaluated(model: DiscModel, pulls: bool, crack_by: str) -> Layout:
    layout = pack(model)
    scratch = np.zeros(SCRATCH)
    slices = len(layout.chunk_start) - 1
    for p in range(slices):
        contacts_of_slice(
            p, layout, model.springs.pairs, model.lines, model.springs.lines, scratch, -1, model.last_dt,
            -np.inf if pulls else 0.0, 1.0 if crack_by == "contact" else 0.0, False, np.zeros((slices, LEDGER)),
        )  # fmt: skip
    return layout


def resultants(model: DiscModel, forces: ContactForces) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Force (x, z) and moment on each disc from contacts, weight and external acceleration (N, N m per metre)."""
    n = len(model)

    def total(pairs: np.ndarray, lines: np.ndarray, sign: float) -> np.ndarray:
        on_j = np.bincount(model.pair_j, pairs, n)
        on_i = np.bincount(model.pair_i, pairs, n)
        return on_j + sign * on_i + np.bincount(model.line_disc, lines, n)

    series = model.acceleration
    ax = np.interp(model.time, series.times, series.x)
    az = np.interp(model.time, series.times, series.z)
    fx = total(forces.fx, forces.line_fx, -1.0) + model.mass * (model.weight * model.gravity[0] + ax)
    fz = total(forces.fz, forces.line_fz, -1.0) + model.mass * (model.weight * model.gravity[1] + az)
    return fx, fz, model.radius * total(forces.rim, forces.line_rim, 1.0)


def stress(model: DiscModel, forces: ContactForces, area: float, where: np.ndarray | None = None) -> np.ndarray:
    """Mean stress (2, 2) of the discs in the mask `where` on their share of the plane `area` (Pa, tension positive).

    Sum over pairs of force times branch, half of it for each of the two discs: pair forces, not what they add up to
    on a disc, which would be nothing at rest.
    """
    chosen = np.ones(len(model), bool) if where is None else where
    i, j = model.pair_i, model.pair_j
    share = 0.5 * (chosen[i].astype(float) + chosen[j])
    branch = np.array([model.x[j] - model.x[i], model.z[j] - model.z[i]])
    return -np.einsum("c,ac,bc->ab", share, np.array([forces.fx, forces.fz]), branch) / area
