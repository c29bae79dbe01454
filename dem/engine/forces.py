"""Computes current contact forces, and their resultant on each disc."""

from dataclasses import dataclass

import numpy as np

from dem.engine.compliant_base import acceleration_on_discs
from dem.engine.packer import law_of, pack, springs_of, unpack
from dem.engine.sharing import neighbour_slices
from dem.kernels.arguments import ENERGY_COLUMNS, Clock, Entries, Law, Loads, Springs, Team
from dem.kernels.barrier import new_barrier
from dem.kernels.layout import LANES, LINK_FIELDS, ROLL_FIELDS, Layout, count_slots, places_of_lines
from dem.kernels.liquefied_pairs import FORCE_X
from dem.kernels.stepping import take_steps
from dem.kernels.work_buffers import new_buffer
from dem.model import DiscModel


@dataclass(frozen=True)
class ContactForces:
    """Holds the contact forces at one instant, contact and pore spring together (N per metre).

    Attributes
    ----------
    fx, fz (pairs,) : force on the disc pair_j; the force on pair_i is opposite
    rim, rim_i (pairs,) : moment over radius on pair_j and on pair_i: the tangential force times the distance over the
        sum of radii, plus the contribution of rolling resistance
    normal, tangential (pairs,) : the force along (positive: push) and across the line of centres
    line_fx, line_fz, line_rim (contacts with lines,) : force of rigid lines on discs, and moment of this force over the
        radius
    """

    fx: np.ndarray
    fz: np.ndarray
    rim: np.ndarray
    rim_i: np.ndarray
    normal: np.ndarray
    tangential: np.ndarray
    line_fx: np.ndarray
    line_fz: np.ndarray
    line_rim: np.ndarray


def contact_forces(model: DiscModel) -> ContactForces:
    """Compute the forces of all contacts at the present time, by the stepping kernel from a copy of the state.

    Parameters
    ----------
    model : discs with a neighbour list for their present positions; not changed

    Returns
    -------
    Forces of the listed pairs, and of the contacts with rigid lines, in the order of the model.
    """
    layout = _evaluated_layout(model)
    slices = len(layout.chunk_start) - 1
    owner = model.places[model.pair_i]
    turn, start = count_slots(owner, slices)
    links = layout.links.reshape(-1, LINK_FIELDS, LANES)
    chunk = start[owner // LANES] + turn
    fx, fz, rim = links[chunk, 4:7, owner % LANES].T
    rim_i = rim
    if model.law == "soil":
        rim_i = rim + layout.rolling.reshape(-1, ROLL_FIELDS, LANES)[chunk, 2, owner % LANES]
    at_chunk, at_lane = places_of_lines(layout.chunk_start, len(model.line_disc))
    line_fx, line_fz, line_rim = links[at_chunk, 4:7, at_lane].T
    nx, nz = model.branch() / model.distance()
    return ContactForces(fx, fz, rim, rim_i, fx * nx + fz * nz, fx * nz - fz * nx, line_fx, line_fz, line_rim)


def keep_slip(model: DiscModel) -> None:
    """Store the slip of the last step in the springs, as the next step would do.

    Call this function before velocities are set, since the slip follows from the velocities of the last step.

    Parameters
    ----------
    model : discs; the history variables of their contacts are changed
    """
    unpack(_evaluated_layout(model), model)


def forces_along_x(model: DiscModel, layout: Layout, springs: Springs, law: Law) -> np.ndarray:
    """Return the horizontal force on every disc from contacts, rigid lines and liquefied ground, while a run has the
    contacts of the model in a layout.

    Parameters
    ----------
    model : DiscModel
        The discs, at the positions and velocities of the layout.
    layout : Layout
        Discs and contacts, which stay as they are.
    springs, law : Springs, Law
        Constants of the contacts and their law.

    Returns
    -------
    (n,) array
        Force along x (N per metre), equal to that of `neighbour_forces`.
    """
    now = _evaluated(layout._replace(links=layout.links.copy(), rolling=layout.rolling.copy()), model, springs, law)
    force = now.links.reshape(-1, LINK_FIELDS, LANES)[:, 4]
    slices, discs = len(layout.chunk_start) - 1, model.places
    partner = layout.partner.reshape(-1, LANES)
    chunk, lane = np.nonzero(partner < len(model))
    owner = LANES * np.repeat(np.arange(slices), np.diff(layout.chunk_start))[chunk] + lane
    pairs = np.bincount(partner[chunk, lane], force[chunk, lane], slices * LANES)
    pairs += np.bincount(owner, -force[chunk, lane], slices * LANES)
    on_lines = force[places_of_lines(layout.chunk_start, len(layout.line_disc))]
    lines = np.bincount(layout.line_disc, on_lines, slices * LANES)
    wet = layout.liquefied.discs[discs, FORCE_X] if len(layout.liquefied.discs) else 0.0
    return np.asarray(wet + (pairs + lines)[discs])


def _evaluated_layout(model: DiscModel) -> Layout:
    return _evaluated(pack(model), model, springs_of(model), law_of(model))


def _evaluated(layout: Layout, model: DiscModel, springs: Springs, law: Law) -> Layout:
    """Compute the forces of the contacts in a layout, and store them there."""
    entries = Entries(False, np.zeros((len(layout.chunk_start) - 1, ENERGY_COLUMNS)))
    now = acceleration_on_discs(model)
    loads = Loads(now.times, now.with_level(model.gravity))
    take_steps(
        Team(0, 1, new_barrier(1), np.zeros((2, 1), np.int64)), Clock(0, 0.0, model.last_dt, model.time, model.steps),
        layout, springs, law, loads, entries, 0.0, *neighbour_slices(0, 1, layout), new_buffer(),
    )  # fmt: skip
    return layout


def neighbour_forces(model: DiscModel, forces: ContactForces) -> tuple[np.ndarray, np.ndarray]:
    """Return the force on each disc from contacts, rigid lines and liquefied ground.

    Parameters
    ----------
    model : the discs
    forces : contact forces by `contact_forces`

    Returns
    -------
    Components (n,) along x and z, in N per metre.
    """
    wet_x, wet_z = model.liquefied_forces
    return (
        wet_x + _on_discs(model, forces.fx, -forces.fx, forces.line_fx),
        wet_z + _on_discs(model, forces.fz, -forces.fz, forces.line_fz),
    )


def resultants(model: DiscModel, forces: ContactForces) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return force and moment on each disc from contacts, weight, water, loads and external acceleration.

    Parameters
    ----------
    model : the discs; the external acceleration is that of their time
    forces : contact forces by `contact_forces`

    Returns
    -------
    Components (n,) of the force along x and z (N per metre), and moment (n,) about the centre, positive
    counter-clockwise (N m per metre).
    """
    ax, az, level = acceleration_on_discs(model).with_level(model.gravity)[:, 0]
    pull_x, pull_z = model.pull
    fx, fz = neighbour_forces(model, forces)
    fx = fx + model.mass * (pull_x + model.added_mass_x * level + ax)
    fz = fz + model.mass * (pull_z + model.added_mass_z * level + az)
    return fx, fz, model.radius * _on_discs(model, forces.rim, forces.rim_i, forces.line_rim)


def _on_discs(model: DiscModel, on_j: np.ndarray, on_i: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return the sum (n,) on each disc of what acts on the second and on the first disc of each pair, and of what lines
    contribute."""
    n = len(model)
    pairs = np.bincount(model.pair_j, on_j, n) + np.bincount(model.pair_i, on_i, n)
    return pairs + np.bincount(model.line_disc, lines, n)
