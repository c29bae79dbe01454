"""Takes many time steps of all discs, by any number of threads, with the same bits for any number (kernel).

Scheme: velocity Verlet, which is the trapezoidal rule for the displacement (Sec. 2(2) of the paper). With the forces
F at t_n,
    v(n+1/2) = v(n-1/2) + dt F(n)/m,   x(n+1) = x(n) + dt v(n+1/2),   v*(n+1) = v(n+1/2) + dt/2 F(n)/m.
Dashpots need a velocity at t_(n+1) before the force at this time is known: they use v*, which is accurate to second
order. Slip, and so the history of springs, follows from v(n+1/2), that is from displacements.

A step handles the slices in order: first the contacts that a slice owns; then all slices whose contacts are complete
are moved, while they are still in the cache. A slice that shares contacts with slices of another thread is moved at the
end of the step, after that thread has computed the last of these contacts: all threads wait for each other only once in
a step.
"""

import numpy as np
from numba import njit

from dem.kernels import layout as field
from dem.kernels.added_mass import added_momentum, pull_added_mass
from dem.kernels.arguments import (
    CRACKS,
    DASHPOT,
    ROLLING,
    SLIDING,
    WORK_BOUNDARY,
    WORK_EXTERNAL,
    WORK_WEIGHT,
    Clock,
    Entries,
    Law,
    Loads,
    Springs,
    State,
    Step,
    Team,
)
from dem.kernels.barrier import report, slices_of, wait, wait_for
from dem.kernels.chunks import add, contacts, contacts_with_losses, line_contact
from dem.kernels.device_function import device_function
from dem.kernels.layout import Layout
from dem.kernels.liquefied_step import add_pressed, press
from dem.kernels.losses import along
from dem.kernels.prefetch import CACHE_LINE, fetch, wide_vectors
from dem.kernels.transpose import LANE_GROUP, add_gathered, spread
from dem.kernels.work_buffers import OWNED_DISCS, ROW, SUM_R, SUM_X, SUM_Z, load_all_constants, load_constants, load_own

# Why a run of the kernel came to its end.
DONE, MOVED, OVERLAP = 0, 1, 2

OWN_LINES = (
    (field.DISC_FIELDS - 1) * field.LANES // 8
)  # cache lines of a slice that its neighbours do not read, MASS left out


@device_function(nogil=True, _nrt=False, forceinline=True)
def sum_forces(p: int, layout: Layout, buffer: np.ndarray) -> None:
    """Sum the forces and moments (over the radius) on the 64 discs of slice p, first from contacts that these discs
    own, then from all other contacts."""
    wide_vectors()
    links = layout.links
    first = np.uint64(layout.chunk_start[p])
    owned = layout.chunk_start[p + 1] - layout.chunk_start[p]
    others = np.uint64(layout.incoming_start[p])
    count = layout.incoming_start[p + 1] - layout.incoming_start[p]
    for lane in range(field.LANES):
        q = np.uint64(lane)
        buffer[SUM_X + q] = 0.0
        buffer[SUM_Z + q] = 0.0
        buffer[SUM_R + q] = 0.0
    for k in range(owned):
        at = (first + np.uint64(k)) * field.LINK
        for lane in range(field.LANES):
            q = np.uint64(lane)
            buffer[SUM_X + q] -= links[at + field.FX + q]
            buffer[SUM_Z + q] -= links[at + field.FZ + q]
            buffer[SUM_R + q] += links[at + field.FR + q]
        if len(layout.rolling) > 0:
            at = (first + np.uint64(k)) * field.ROLL_LINK
            for lane in range(field.LANES):
                q = np.uint64(lane)
                buffer[SUM_R + q] += layout.rolling[at + field.TORQUE + q]
    for k in range(count):
        slot = (others + np.uint64(k)) * ROW
        for lane in range(0, field.LANES, LANE_GROUP):
            q = np.uint64(lane)
            add_gathered(links, layout.incoming, slot + q, buffer, SUM_X + q)


@device_function(nogil=True, _nrt=False, forceinline=True)
def move_lanes(
    p: int, discs: np.ndarray, shared: np.ndarray, buffer: np.ndarray, step: Step, with_losses: bool
) -> tuple[bool, float, float, float]:
    """Move the 64 discs of slice p by one step.

    discs, shared: see `Layout`; buffer: rows with the sums of forces; step: the time step and its accelerations.
    Returns whether a disc has moved beyond the reach of the neighbour list and, if `with_losses`, the work of weight,
    external acceleration and moving boundaries on the discs (J).
    """
    wide_vectors()
    b = np.uint64(p) * field.DISC
    half = 0.5 * step.dt
    moved = False
    by_weight, by_external, by_boundary = 0.0, 0.0, 0.0
    for lane in range(field.LANES):
        q = np.uint64(lane)
        invmass = discs[b + field.INVMASS + q]
        free = 1.0 if invmass > 0.0 else 0.0
        pull_x, pull_z = discs[b + field.PULL_X + q], discs[b + field.PULL_Z + q]
        accel_x = buffer[SUM_X + q] * invmass + free * (pull_x + step.ax)
        accel_z = buffer[SUM_Z + q] * invmass + free * (pull_z + step.az)
        accel_r = buffer[SUM_R + q] * discs[b + field.RIM + q]
        vx = buffer[OWNED_DISCS + field.VX + q] + step.kick * accel_x
        vz = buffer[OWNED_DISCS + field.VZ + q] + step.kick * accel_z
        vr = buffer[OWNED_DISCS + field.VR + q] + step.kick * accel_r
        x = buffer[OWNED_DISCS + field.X + q] + step.dt * vx
        z = buffer[OWNED_DISCS + field.Z + q] + step.dt * vz
        buffer[OWNED_DISCS + field.VX + q] = vx
        buffer[OWNED_DISCS + field.VZ + q] = vz
        buffer[OWNED_DISCS + field.VR + q] = vr
        buffer[OWNED_DISCS + field.VXS + q] = vx + half * accel_x
        buffer[OWNED_DISCS + field.VZS + q] = vz + half * accel_z
        buffer[OWNED_DISCS + field.VRS + q] = vr + half * accel_r
        buffer[OWNED_DISCS + field.X + q] = x
        buffer[OWNED_DISCS + field.Z + q] = z
        discs[b + field.ROLL + q] += step.dt * vr
        dx = x - discs[b + field.X0 + q]
        dz = z - discs[b + field.Z0 + q]
        moved |= not (dx * dx + dz * dz <= step.reach)
        if with_losses:
            mass = discs[b + field.MASS + q]
            by_weight = add(by_weight, along(mass * pull_x, mass * pull_z, vx, vz))
            by_external = add(by_external, along(mass * step.mean_x, mass * step.mean_z, vx, vz))
            driven = along(buffer[SUM_X + q], buffer[SUM_Z + q], vx, vz) + buffer[SUM_R + q] * vr
            by_boundary = add(by_boundary, 0.0 if invmass > 0.0 else -driven)
    for lane in range(0, field.LANES, LANE_GROUP):
        q = np.uint64(lane)
        spread(buffer, OWNED_DISCS + q, shared, (np.uint64(p) * ROW + q) * CACHE_LINE)
    return moved, by_weight * step.dt, by_external * step.dt, by_boundary * step.kick


@device_function(nogil=True, _nrt=False)
def move(p: int, discs: np.ndarray, shared: np.ndarray, buffer: np.ndarray, step: Step) -> bool:
    """Move the 64 discs of slice p; return True if one has left the reach of the list; discs, shared, buffer, step: see
    `move_lanes`.
    """
    return move_lanes(p, discs, shared, buffer, step, False)[0]


@device_function(nogil=True, _nrt=False)
def move_with_work(
    p: int, discs: np.ndarray, shared: np.ndarray, buffer: np.ndarray, step: Step
) -> tuple[bool, float, float, float]:
    """Move the discs of slice p. Also return the work of weight, external acceleration and moving boundaries (J).

    discs, shared, buffer, step: as in `move_lanes`.
    """
    return move_lanes(p, discs, shared, buffer, step, True)


@device_function(nogil=True, _nrt=False)
def contacts_of_slice(
    p: int,
    layout: Layout,
    springs: Springs,
    buffer: np.ndarray,
    unknown: int,
    slip_time: float,
    law: Law,
    entries: Entries,
) -> bool:
    """Compute all contacts that slice p owns; return True if an overlap is too large.

    layout: discs and contacts; springs: constants; buffer: rows to work in; slip_time: length of the last step (s);
    law: law of the contacts; entries: entries of the energy balance. unknown: the first chunk of the thread, for which
    all constants have to be loaded into the buffer; later chunks only load constants that differ from the chunk before.
    """
    too_deep = False
    load_own(p, layout.shared, buffer)
    state = State(layout.discs, layout.links, layout.rolling, layout.shared, layout.partner)
    damping, sliding, cracks, rolling = 0.0, 0.0, 0.0, 0.0
    for line in range(OWN_LINES):
        fetch(layout.discs, np.uint64(p) * field.DISC + np.uint64(line) * CACHE_LINE)
    for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
        if chunk == unknown:
            load_all_constants(np.uint64(chunk) * ROW, layout.kinds, springs.records, law.soil, law.pores, buffer)
        else:
            for k in range(layout.changed_start[chunk], layout.changed_start[chunk + 1]):
                load_constants(np.uint64(layout.changed[k]), layout.kinds, springs.records, law.soil, law.pores, buffer)
        if entries.summed:
            deep, damped, slid, cracked, rolled = contacts_with_losses(chunk, state, buffer, slip_time, law)
            damping += damped
            sliding += slid
            cracks += cracked
            rolling += rolled
        else:
            deep = contacts(chunk, state, buffer, slip_time, law)
        too_deep |= deep
    for e in range(layout.line_start[p], layout.line_start[p + 1]):
        deep, damped, slid, rolled = line_contact(e, layout, springs, slip_time, law)
        too_deep |= deep
        damping += damped
        sliding += slid
        rolling += rolled
    if entries.summed:
        entries.sums[p, DASHPOT] += damping
        entries.sums[p, SLIDING] += sliding
        entries.sums[p, CRACKS] += cracks
        entries.sums[p, ROLLING] += rolling
    return too_deep


@device_function(nogil=True, _nrt=False)
def move_slice(p: int, layout: Layout, buffer: np.ndarray, step: Step, entries: Entries, at_hand: int) -> bool:
    """Sum the forces on slice p and move its discs. Return True if a disc has left the reach of the neighbour list.

    layout: discs and contacts; buffer: rows to work in; step: the time step; entries: entries of the energy balance;
    at_hand: the slice whose discs are in the buffer.
    """
    sum_forces(p, layout, buffer)
    if len(layout.liquefied.paired) > 0:
        add_pressed(p, layout, buffer)
    pull_added_mass(p, layout, step.level)
    if p != at_hand:
        load_own(p, layout.shared, buffer)
    if not entries.summed:
        return move(p, layout.discs, layout.shared, buffer, step)
    moved, by_weight, by_external, by_boundary = move_with_work(p, layout.discs, layout.shared, buffer, step)
    added = added_momentum(p, layout) * step.dt
    entries.sums[p, WORK_WEIGHT] += by_weight - added * step.level
    entries.sums[p, WORK_EXTERNAL] += by_external + added * step.mean_level
    entries.sums[p, WORK_BOUNDARY] += by_boundary
    return moved


@device_function(nogil=True, _nrt=False)
def interpolate(time: float, times: np.ndarray, values: np.ndarray, place: int) -> float:
    """Interpolate `values`, given at `times` (s), linearly at `time`. Outside the times the value is constant.

    place: number of an interval between two `times` that contains `time` or lies before it.
    """
    if time <= times[0]:
        return values[0]
    if time >= times[-1]:
        return values[-1]
    while times[place + 1] < time:
        place += 1
    span = times[place + 1] - times[place]
    return values[place] + (values[place + 1] - values[place]) * ((time - times[place]) / span)


@device_function(nogil=True, _nrt=False, forceinline=True)
def step_at(time: float, last_dt: float, dt: float, loads: Loads, place: int, reach: float) -> Step:
    """Return the step that begins at `time`; its length may change without a jump of the velocities.

    last_dt, dt: length of the last step and of this one (s); loads: acceleration; place: see `interpolate`; reach:
    square of the displacement after which a disc needs a new neighbour list (m2).
    """
    ax = interpolate(time, loads.times, loads.acceleration[0], place)
    az = interpolate(time, loads.times, loads.acceleration[1], place)
    level = interpolate(time, loads.times, loads.acceleration[2], place)
    mean_x = 0.5 * (ax + interpolate(time + dt, loads.times, loads.acceleration[0], place))
    mean_z = 0.5 * (az + interpolate(time + dt, loads.times, loads.acceleration[1], place))
    mean_level = 0.5 * (level + interpolate(time + dt, loads.times, loads.acceleration[2], place))
    return Step(0.5 * (last_dt + dt), dt, last_dt, ax, az, level, mean_x, mean_z, mean_level, reach)


@device_function(nogil=True, _nrt=False)
def move_shared(
    team: Team,
    taken: int,
    layout: Layout,
    buffer: np.ndarray,
    step: Step,
    entries: Entries,
    shared: np.ndarray,
    need: np.ndarray,
) -> bool:
    """Move the slices that share contacts with other threads, each after these threads have computed them; see
    `move_slice`.

    team: the threads; taken: steps taken; layout, buffer, step, entries: as in `move_slice`; shared, need: see
    `sharing.neighbour_slices`.
    """
    slices = len(layout.chunk_start) - 1
    nobody = np.int64(-1)
    moved = False
    for k in range(len(shared)):
        for t in range(team.threads):
            if need[k, t] > 0:
                start, stop = slices_of(t, team.threads, slices)
                wait_for(team.barrier, t, taken * (stop - start) + need[k, t])
        moved |= move_slice(shared[k], layout, buffer, step, entries, nobody)
    return moved


@njit(cache=True, nogil=True, _nrt=False, error_model="numpy")
def take_steps(
    team: Team,
    clock: Clock,
    layout: Layout,
    springs: Springs,
    law: Law,
    loads: Loads,
    entries: Entries,
    reach: float,
    shared: np.ndarray,
    need: np.ndarray,
    buffer: np.ndarray,
) -> tuple[int, float, int]:
    """Advance the discs by a number of time steps, or by fewer if the neighbour list ends or an overlap is too large.

    Each thread calls this function with its number in the ``team``. If there are no steps to take, the function
    computes the contacts in the present state and moves no disc.

    Parameters
    ----------
    team : the threads
    clock : steps to take, and the time
    layout : discs and contacts, changed here
    springs : constants of the contacts
    law : law of the contacts
    loads : external acceleration
    entries : entries of the energy balance, changed here
    reach : square of the displacement after which a disc needs a new neighbour list (m2)
    shared, need : see `sharing.neighbour_slices`
    buffer (BUFFER_SIZE,) : rows of the thread, by `new_buffer`

    Returns
    -------
    Number of steps taken, time (s), and reason of the end: MOVED if the neighbour list must be made anew before the
    next step, OVERLAP if two discs overlap by more than allowed, DONE otherwise.
    """
    thread, threads, barrier = team.thread, team.threads, team.barrier
    slices = len(layout.chunk_start) - 1
    begin, end = slices_of(thread, threads, slices)
    unknown = layout.chunk_start[begin]
    last_dt = clock.last_dt
    time = clock.time
    place = 0
    reason = DONE
    taken = 0
    if clock.steps == 0:
        for p in range(begin, end):
            contacts_of_slice(p, layout, springs, buffer, unknown, last_dt, law, entries)
    while taken < clock.steps and reason == DONE:
        while place + 2 < len(loads.times) and loads.times[place + 1] < time:
            place += 1
        step = step_at(time, last_dt, clock.dt, loads, place, reach)
        wet = layout.liquefied
        if len(wet.disc_i) > 0 and (clock.steps_before + taken) % wet.steps_between_looks == 0:
            press(team, layout, law, entries, clock.dt)
        too_deep = False
        moved = False
        ready = begin
        for p in range(begin, end):
            too_deep |= contacts_of_slice(p, layout, springs, buffer, unknown, last_dt, law, entries)
            at_hand = p
            if threads > 1:
                report(barrier, thread)
            while ready < end and (layout.highest_owner[ready] <= p or layout.highest_owner[ready] >= end):
                if layout.lowest_owner[ready] >= begin and layout.highest_owner[ready] < end:
                    moved |= move_slice(ready, layout, buffer, step, entries, at_hand)
                    at_hand = ready
                ready += 1
        moved |= move_shared(team, taken, layout, buffer, step, entries, shared, need)
        team.stops[taken % 2, thread] = OVERLAP if too_deep else (MOVED if moved else DONE)
        if threads > 1:
            wait(barrier, threads)
        for k in range(threads):
            reason = max(reason, team.stops[taken % 2, k])
        last_dt = clock.dt
        time += clock.dt
        taken += 1
    return taken, time, reason
