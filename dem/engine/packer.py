"""Converts a DiscModel to a Layout and back, and its law and springs to arguments of the kernels."""

from functools import partial

import numpy as np

from dem.chunked_map import Ranges, serial
from dem.engine.memory import ReusedMemory, large_zeros
from dem.kernels.arguments import Law, Springs
from dem.kernels.layout import (
    DISC_FIELDS,
    LANES,
    LINK_FIELDS,
    ROLL_FIELDS,
    X0,
    Z0,
    Layout,
    count_links,
    count_slots,
    find_changed,
    list_links,
    place_incoming,
    place_links,
    places_of_lines,
)
from dem.kernels.liquefied_lists import list_bonds, members_of, place_bonds, place_pairs
from dem.kernels.liquefied_pairs import EXTRA_SHARE_AT, FIELDS, KNEE_STRAIN, KNEE_STRENGTH, WORKING, Liquefied
from dem.kernels.liquefied_pairs import MEMORY as BOND_MEMORY
from dem.kernels.motion import list_half_velocities, list_motion, place_fields, place_motion
from dem.kernels.transpose import CONSTANT_RECORD, SHARED
from dem.model import DiscModel
from dem.state import MEMORY, ROLLING_MEMORY

FAR_AWAY = 1e15  # m: position of lanes without a disc
# what a run changes, beside `roll`: arrays of the model in the order of the record of a disc
_STATE = ("x", "z", "vx_half", "vz_half", "vr_half", "vx", "vz", "vr")

_LINE_MEMORY = {2: "line_shear", 4: "line_force_x", 5: "line_force_z"}
_LINE_ROLLING = {1: "line_rolled", 2: "line_torque"}


def pack(
    model: DiscModel, *, keep_pairs: bool = True, in_ranges: Ranges = serial, room: ReusedMemory | None = None
) -> Layout:
    """Return the layout of a model for the stepping kernel; the same model always gives the same layout.

    Parameters
    ----------
    model : discs with their neighbour list
    keep_pairs : False removes the pairs from the model until `unpack` restores them, so that they are not stored twice
    in_ranges : runs loops over contacts, in this thread or in several
    room : reusable memory for the largest arrays; an earlier layout in it becomes invalid. New memory if None.

    Returns
    -------
    The layout, with the discs in their spatial order.
    """
    room = ReusedMemory() if room is None else room
    n = len(model)
    slices = n // LANES + 1
    order = model.order
    number = model.places
    owner, partner = number[model.pair_i], number[model.pair_j]
    turn, chunk_start = count_slots(owner, slices)
    chunks = int(chunk_start[-1])
    tail = -(-len(model.line_disc) // LANES)
    line_disc = number[model.line_disc]

    links = room.zeros("links", chunks + 1 + tail, LINK_FIELDS, LANES)
    links[:, 0] = 1.0
    rolling = room.zeros("rolling", chunks + 1 + tail if model.law == "soil" else 0, ROLL_FIELDS, LANES)
    partners = np.full((chunks, LANES), n, np.uint32)
    # an empty lane cannot be its own partner, since their distance would be zero
    partners[chunk_start[-2] :, n % LANES] = n + 1 if (n + 1) % LANES else 0
    kinds = np.zeros(chunks * LANES, np.uint16)
    placed = partial(
        place_links, owner, partner, turn, chunk_start, model.radius[order], model.pair_kind,
        tuple(getattr(model, name) for name in MEMORY + ROLLING_MEMORY), links.reshape(-1), rolling.reshape(-1),
        partners.reshape(-1), kinds,
    )  # fmt: skip
    in_ranges(placed, len(owner))
    del placed, owner, partner, turn
    changed, changed_start = find_changed(partners.reshape(-1), n, kinds)
    if not keep_pairs:
        model.pair_i = model.pair_j = np.zeros(0, np.int32)
        for name in model.memory:
            setattr(model, name, np.zeros(0))
    chunk, lane = places_of_lines(chunk_start, len(line_disc))
    for field, name in _LINE_MEMORY.items():
        links[chunk, field, lane] = getattr(model, name)
    if model.law == "soil":
        for field, name in _LINE_ROLLING.items():
            rolling[chunk, field, lane] = getattr(model, name)
    incoming, incoming_start, lowest, highest = place_incoming(partners.reshape(-1), chunk_start, line_disc, n)
    return Layout(
        discs=_discs(model, slices), shared=_shared_fields(model, slices), links=links.reshape(-1),
        rolling=rolling.reshape(-1), partner=partners.reshape(-1), kinds=kinds, changed=changed,
        changed_start=changed_start, chunk_start=chunk_start, incoming=incoming, incoming_start=incoming_start,
        lowest_owner=lowest, highest_owner=highest, line_disc=line_disc.astype(np.int64),
        line_id=model.line_id.astype(np.int64), line_kind=model.line_kind.astype(np.int64),
        line_radius=model.radius[model.line_disc],
        line_start=np.searchsorted(line_disc, np.arange(slices + 1) * LANES).astype(np.int64),
        **_added_mass(model, slices), liquefied=_liquefied(model, number, slices),
    )  # fmt: skip


def _discs(model: DiscModel, slices: int) -> np.ndarray:
    n, order = len(model), model.order
    free = ~model.fixed
    pull_x, pull_z = model.pull
    discs = large_zeros(slices, DISC_FIELDS, LANES)
    fields = (
        np.where(free, 1.0 / model.mass, 0.0), np.where(free, model.inertia_ratio / model.mass, 0.0),
        pull_x, pull_z, model.x_list, model.z_list, model.roll, np.where(free, model.mass, 0.0),
    )  # fmt: skip
    place_fields(order, fields, discs.reshape(-1))
    empty = np.arange(n % LANES, LANES)
    for row in (X0, Z0):
        discs[-1, int(row) // LANES, empty] = _far_fields(empty)
    return discs.reshape(-1)


def _shared_fields(model: DiscModel, slices: int) -> np.ndarray:
    n, order = len(model), model.order
    shared = large_zeros(slices * LANES, SHARED)
    place_motion(order, tuple(getattr(model, name) for name in _STATE), shared.reshape(-1))
    shared[n:, :2] = _far_fields(np.arange(n, slices * LANES) % LANES)[:, np.newaxis]
    return shared.reshape(-1)


def _far_fields(lanes: np.ndarray) -> np.ndarray:
    return FAR_AWAY * (1.0 + lanes)


def _added_mass(model: DiscModel, slices: int) -> dict[str, np.ndarray]:
    """Return the fields of the layout for discs with added mass."""
    order = model.order
    carries = (model.added_mass_x != 0.0) | (model.added_mass_z != 0.0)
    discs_with_mass = np.flatnonzero(carries[order]) if carries.any() else np.zeros(0, np.int64)
    fields = (*model.pull, model.added_mass_x, model.added_mass_z)
    return {
        "added_mass_disc": discs_with_mass,
        "added_mass": np.column_stack([values[order[discs_with_mass]] for values in fields]),
        "added_mass_start": np.searchsorted(discs_with_mass, np.arange(slices + 1) * LANES),
    }


def _liquefied(model: DiscModel, number: np.ndarray, slices: int) -> Liquefied:
    """Return the liquefied discs and their pairs as arguments of the kernels; number: number of each disc in spatial
    order."""
    slots = slices * LANES
    first, second = number[model.liquefied_i], number[model.liquefied_j]
    lane, start = place_pairs(first, slices)
    lanes = int(start[-1]) * LANES
    discs = np.zeros((slots if len(first) else 0, FIELDS))
    if len(first):
        discs[: len(model)] = model.liquefied[model.order]
    numbers = np.zeros((2, lanes), np.int32)
    numbers[:, lane] = first, second
    memory = large_zeros(int(start[-1]) * BOND_MEMORY * LANES)
    place_bonds(lane, model.bonds, memory)
    member, members = members_of(first, second, lane, slots)
    near, linear = np.flatnonzero(np.diff(members)), _linear_blocks(model, lane, int(start[-1]))
    return Liquefied(
        discs, numbers[0], numbers[1], linear, memory, large_zeros(lanes * WORKING), start, member, members, near,
        np.searchsorted(near, np.arange(slices + 1) * LANES), model.reach, model.steps_between_looks,
    )  # fmt: skip


def _linear_blocks(model: DiscModel, lane: np.ndarray, blocks: int) -> np.ndarray:
    """Return whether all bonds of each block are linear; lane: lane of every pair. They stay linear while a layout is
    used: strain potentials are constant, and extra strength is only lost."""
    bent = model.bonds[:, EXTRA_SHARE_AT] != 0.0
    for knee in (KNEE_STRENGTH, KNEE_STRAIN):
        bent |= (model.liquefied[:, knee] != 0.0)[np.column_stack([model.liquefied_i, model.liquefied_j])].any(axis=1)
    linear = np.ones(blocks, bool)
    linear[lane[bent] // LANES] = False
    return linear


def _bonds(layout: Layout, model: DiscModel) -> np.ndarray:
    """Return the history variables of the bonds (pairs, MEMORY), read back from their lanes."""
    lane, _ = place_pairs(model.places[model.liquefied_i], len(layout.chunk_start) - 1)
    bonds = np.empty((len(lane), BOND_MEMORY))
    list_bonds(lane, layout.liquefied.memory, bonds)
    return bonds


def pack_motion(layout: Layout, model: DiscModel) -> None:
    """Write positions and velocities of the model into the layout, which `unpack_motion` reads."""
    place_motion(model.order, tuple(getattr(model, name) for name in _STATE), layout.shared)


def unpack_motion(layout: Layout, model: DiscModel) -> None:
    """Write positions and velocities of the discs into the model; the history of contacts stays in the layout."""
    list_motion(layout, model.order, tuple(getattr(model, name) for name in _STATE), model.roll)


def unpack_velocities(layout: Layout, model: DiscModel) -> None:
    """Write the velocities of the discs in the middle of the last step into the model, and nothing else."""
    list_half_velocities(layout.shared, model.order, model.vx_half, model.vz_half)


def unpack(layout: Layout, model: DiscModel, in_ranges: Ranges = serial) -> None:
    """Write everything that a run has changed back into the model.

    Parameters
    ----------
    layout : layout of the model, by `pack`
    model : discs; their motion, pairs, history variables of contacts and liquefied ground are replaced
    in_ranges : runs loops over contacts, in this thread or in several
    """
    unpack_motion(layout, model)
    start = count_links(layout, len(model))
    count = int(start[-1])
    owner, other, kind = np.empty(count, np.int32), np.empty(count, np.int32), np.empty(count, np.uint16)
    memory = tuple(np.empty(count if name in model.memory else 0) for name in MEMORY + ROLLING_MEMORY)

    def listed(begin: int, end: int) -> None:
        slices = -(-begin // LANES), min(-(-end // LANES), len(start) - 1)
        list_links(*slices, start, layout, model.order, owner, other, kind, memory)

    in_ranges(listed, len(model))
    model.pair_i, model.pair_j = owner, other
    if len(model.undisturbed):
        model.undisturbed = kind >= model.springs.size**2
    if len(layout.liquefied.disc_i):
        model.liquefied[model.order] = layout.liquefied.discs[: len(model)]
        model.bonds = _bonds(layout, model)
    for name, values in zip(MEMORY + ROLLING_MEMORY, memory, strict=True):
        setattr(model, name, values)
    chunk, lane = places_of_lines(layout.chunk_start, len(model.line_disc))
    links = layout.links.reshape(-1, LINK_FIELDS, LANES)
    for field, name in _LINE_MEMORY.items():
        setattr(model, name, links[chunk, field, lane])
    if model.law == "soil":
        rolling = layout.rolling.reshape(-1, ROLL_FIELDS, LANES)
        for field, name in _LINE_ROLLING.items():
            setattr(model, name, rolling[chunk, field, lane])


def law_of(model: DiscModel) -> Law:
    """Return the contact law of a model as an argument of the kernels. The model must have its contacts: without any
    pore spring the kernels leave out the law of pore springs."""
    return Law(model.law == "soil", bool(model.pore_length.any()), model.repeats)


def springs_of(model: DiscModel) -> Springs:
    """Return all constants of the contacts of a model as an argument of the kernels."""
    pairs = model.springs.pairs
    records = large_zeros(pairs.shape[1], CONSTANT_RECORD)
    records[:, : len(pairs)] = pairs.T
    return Springs(pairs, records.reshape(-1), model.springs.lines, model.lines)
