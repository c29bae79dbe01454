"""Kernel: many time steps of all discs, by any number of threads, with the same bits for any number.

Scheme: velocity Verlet, which is the trapezoidal rule for the displacement (Sec. 2(2) of the paper). With the forces
F at t_n,
    v(n+1/2) = v(n-1/2) + dt F(n)/m,   x(n+1) = x(n) + dt v(n+1/2),   v*(n+1) = v(n+1/2) + dt/2 F(n)/m.
Dashpots need a velocity at t_(n+1) before its force is known: v* is that one, to second order. Slip, and so the
springs' memory, follows from v(n+1/2), that is from displacements.

A step goes through the slices in order: the contacts a slice owns, then all slices whose last contact is known, while
they are still in the cache. A slice that shares contacts with another thread's is moved at the end of the step, once
that thread has been through the last of them: all threads meet only once a step.
"""

import numpy as np
from numba import njit

from dem.kernels.arguments import Clock, Entries, Law, Loads, Springs, State, Step, Team
from dem.kernels.barrier import report, wait, wait_for
from dem.kernels.chunks import add, contacts, contacts_with_losses, line_contact
from dem.kernels.layout import (
    DISC,
    DISC_FIELDS,
    FR,
    FX,
    FZ,
    INVMASS,
    LANES,
    LINK,
    LINK_FIELDS,
    PULL_X,
    PULL_Z,
    RIM,
    ROLL,
    ROLL_LINK,
    TORQUE,
    VR,
    VRS,
    VX,
    VXS,
    VZ,
    VZS,
    X0,
    Z0,
    Layout,
    X,
    Z,
)
from dem.kernels.prefetch import LINE, fetch, wide_vectors
from dem.kernels.records import EIGHT, add_gathered, spread
from dem.kernels.scratch import OWN, ROW, SUM_R, SUM_X, SUM_Z, load_all_constants, load_constants, load_own, new_scratch
from dem.kernels.swing import momentum_of_swings, swing_slice

# Why a run of the kernel came to its end.
DONE, MOVED, OVERLAP = 0, 1, 2

# Columns of the ledger kept per slice: work of weight, of external acceleration and of moving boundaries; energy
# dissipated by dashpots, by sliding, by cracks, by rolling. All in J per metre out of plane.
WORK_WEIGHT, WORK_EXTERNAL, WORK_BOUNDARY, DASHPOT, SLIDING, CRACKS, ROLLING = range(7)
LEDGER = 7

OWN_LINES = DISC_FIELDS * LANES // 8  # cache lines of a slice that its neighbours do not read


@njit(cache=True, nogil=True, _nrt=False, forceinline=True, error_model="numpy")
def sum_forces(p: int, layout: Layout, scratch: np.ndarray) -> None:
    """Forces and rim force on the 64 discs of slice p, from the contacts they own, then from the others."""
    wide_vectors()
    links = layout.links
    own = np.uint64(layout.chunk_start[p])
    owned = layout.chunk_start[p + 1] - layout.chunk_start[p]
    others = np.uint64(layout.incoming_start[p])
    count = layout.incoming_start[p + 1] - layout.incoming_start[p]
    for lane in range(LANES):
        q = np.uint64(lane)
        scratch[SUM_X + q] = 0.0
        scratch[SUM_Z + q] = 0.0
        scratch[SUM_R + q] = 0.0
    for k in range(owned):
        at = (own + np.uint64(k)) * LINK
        for lane in range(LANES):
            q = np.uint64(lane)
            scratch[SUM_X + q] -= links[at + FX + q]
            scratch[SUM_Z + q] -= links[at + FZ + q]
            scratch[SUM_R + q] += links[at + FR + q]
        if len(layout.rolling) > 0:
            at = (own + np.uint64(k)) * ROLL_LINK
            for lane in range(LANES):
                q = np.uint64(lane)
                scratch[SUM_R + q] += layout.rolling[at + TORQUE + q]
    for k in range(count):
        slot = (others + np.uint64(k)) * ROW
        for lane in range(0, LANES, EIGHT):
            q = np.uint64(lane)
            add_gathered(links, layout.incoming, slot + q, scratch, SUM_X + q)


@njit(cache=True, nogil=True, _nrt=False, error_model="numpy")
def move(p: int, discs: np.ndarray, shared: np.ndarray, scratch: np.ndarray, step: Step) -> bool:
    """One step of the 64 discs of slice p; True if one has left the reach of the neighbour list."""
    wide_vectors()
    b = np.uint64(p) * DISC
    half = 0.5 * step.dt
    moved = False
    for lane in range(LANES):
        q = np.uint64(lane)
        invmass = discs[b + INVMASS + q]
        free = 1.0 if invmass > 0.0 else 0.0
        accel_x = scratch[SUM_X + q] * invmass + free * (discs[b + PULL_X + q] + step.ax)
        accel_z = scratch[SUM_Z + q] * invmass + free * (discs[b + PULL_Z + q] + step.az)
        accel_r = scratch[SUM_R + q] * discs[b + RIM + q]
        vx = scratch[OWN + VX + q] + step.kick * accel_x
        vz = scratch[OWN + VZ + q] + step.kick * accel_z
        vr = scratch[OWN + VR + q] + step.kick * accel_r
        x = scratch[OWN + X + q] + step.dt * vx
        z = scratch[OWN + Z + q] + step.dt * vz
        scratch[OWN + VX + q] = vx
        scratch[OWN + VZ + q] = vz
        scratch[OWN + VR + q] = vr
        scratch[OWN + VXS + q] = vx + half * accel_x
        scratch[OWN + VZS + q] = vz + half * accel_z
        scratch[OWN + VRS + q] = vr + half * accel_r
        scratch[OWN + X + q] = x
        scratch[OWN + Z + q] = z
        discs[b + ROLL + q] += step.dt * vr
        dx = x - discs[b + X0 + q]
        dz = z - discs[b + Z0 + q]
        moved |= not (dx * dx + dz * dz <= step.reach)
    for lane in range(0, LANES, EIGHT):
        q = np.uint64(lane)
        spread(scratch, OWN + q, shared, (np.uint64(p) * ROW + q) * LINE)
    return moved


@njit(cache=True, nogil=True, _nrt=False, error_model="numpy")
def work(p: int, discs: np.ndarray, scratch: np.ndarray, step: Step) -> tuple[float, float, float]:
    """Work of weight, external acceleration and moving boundaries on slice p, once `move` has moved it (J)."""
    wide_vectors()
    b = np.uint64(p) * DISC
    by_weight = 0.0
    by_external = 0.0
    by_boundary = 0.0
    for lane in range(LANES):
        q = np.uint64(lane)
        invmass = discs[b + INVMASS + q]
        mass = 1.0 / invmass if invmass > 0.0 else 0.0
        vx = scratch[OWN + VX + q]
        vz = scratch[OWN + VZ + q]
        by_weight = add(by_weight, mass * (discs[b + PULL_X + q] * vx + discs[b + PULL_Z + q] * vz))
        by_external = add(by_external, mass * (step.mean_x * vx + step.mean_z * vz))
        driven = scratch[SUM_X + q] * vx + scratch[SUM_Z + q] * vz + scratch[SUM_R + q] * scratch[OWN + VR + q]
        by_boundary = add(by_boundary, 0.0 if invmass > 0.0 else -driven)
    return by_weight * step.dt, by_external * step.dt, by_boundary * step.kick


@njit(cache=True, nogil=True, _nrt=False, forceinline=True, error_model="numpy")
def contacts_of_slice(
    p: int,
    layout: Layout,
    springs: Springs,
    scratch: np.ndarray,
    unknown: int,
    slip_time: float,
    law: Law,
    entries: Entries,
) -> bool:
    """All contacts that slice p owns; True if one is too deep.

    unknown: a chunk that finds in the scratch rows something else than the constants of the chunk before.
    """
    too_deep = False
    load_own(p, layout.shared, scratch)
    state = State(layout.discs, layout.links, layout.rolling, layout.shared, layout.partner)
    pores = law.pores or not law.soil
    for line in range(OWN_LINES):
        fetch(layout.discs, np.uint64(p) * DISC + np.uint64(line) * LINE)
    for chunk in range(layout.chunk_start[p], layout.chunk_start[p + 1]):
        if chunk == unknown:
            load_all_constants(np.uint64(chunk) * ROW, layout.kinds, springs.records, law.soil, pores, scratch)
        else:
            for k in range(layout.fresh_start[chunk], layout.fresh_start[chunk + 1]):
                load_constants(np.uint64(layout.fresh[k]), layout.kinds, springs.records, law.soil, pores, scratch)
        if entries.kept:
            deep, damping, slid, cracked, rolled = contacts_with_losses(chunk, state, scratch, slip_time, law)
            entries.sums[p, DASHPOT] += damping
            entries.sums[p, SLIDING] += slid
            entries.sums[p, CRACKS] += cracked
            entries.sums[p, ROLLING] += rolled
        else:
            deep = contacts(chunk, state, scratch, slip_time, law)
        too_deep |= deep
    for e in range(layout.line_start[p], layout.line_start[p + 1]):
        deep, damping, slid, rolled = line_contact(e, layout, springs, slip_time, law)
        too_deep |= deep
        if entries.kept:
            entries.sums[p, DASHPOT] += damping
            entries.sums[p, SLIDING] += slid
            entries.sums[p, ROLLING] += rolled
    return too_deep


@njit(cache=True, nogil=True, _nrt=False, forceinline=True, error_model="numpy")
def move_slice(p: int, layout: Layout, scratch: np.ndarray, step: Step, entries: Entries, at_hand: bool) -> bool:
    """Sums the forces on slice p and moves it; True if a disc has left the reach of the neighbour list.

    at_hand: whether the scratch rows still hold the slice's own discs.
    """
    sum_forces(p, layout, scratch)
    swing_slice(p, layout, step.level)
    if not at_hand:
        load_own(p, layout.shared, scratch)
    moved = move(p, layout.discs, layout.shared, scratch, step)
    if entries.kept:
        by_weight, by_external, by_boundary = work(p, layout.discs, scratch, step)
        swings = momentum_of_swings(p, layout) * step.dt
        entries.sums[p, WORK_WEIGHT] += by_weight - swings * step.level
        entries.sums[p, WORK_EXTERNAL] += by_external + swings * step.mean_level
        entries.sums[p, WORK_BOUNDARY] += by_boundary
    return moved


@njit(cache=True, nogil=True, _nrt=False, error_model="numpy")
def interpolate(time: float, times: np.ndarray, values: np.ndarray, place: int) -> float:
    """Linear interpolation of a series, constant outside it; `place`: an interval at or before that of `time`."""
    if time <= times[0]:
        return values[0]
    if time >= times[-1]:
        return values[-1]
    while times[place + 1] < time:
        place += 1
    span = times[place + 1] - times[place]
    return values[place] + (values[place + 1] - values[place]) * ((time - times[place]) / span)


@njit(cache=True, nogil=True, _nrt=False, error_model="numpy")
def slices_of(thread: int, threads: int, slices: int) -> tuple[int, int]:
    """First slice of a thread, and the one after its last."""
    return slices * thread // threads, slices * (thread + 1) // threads


@njit(cache=True, nogil=True, error_model="numpy")
def needs(team: Team, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Slices of a thread that share contacts with other threads, and how many slices each thread must be through.

    Returns (slices (shared,), counts (shared, threads)).
    """
    threads, slices = team.threads, len(layout.chunk_start) - 1
    begin, end = slices_of(team.thread, threads, slices)
    shared = np.zeros(end - begin, np.int64)
    count = np.zeros((end - begin, threads), np.int64)
    found = 0
    for p in range(begin, end):
        if layout.first[p] >= begin and layout.last[p] < end:
            continue
        shared[found] = p
        for k in range(layout.incoming_start[p] * LANES, layout.incoming_start[p + 1] * LANES):
            chunk = np.int64(layout.incoming[k]) // (LINK_FIELDS * LANES)
            if chunk >= layout.chunk_start[-1]:
                continue  # nothing, or a rigid line, which is the slice's own
            owner = np.searchsorted(layout.chunk_start, chunk, side="right") - 1
            if begin <= owner < end:
                continue
            for t in range(threads):
                start, stop = slices_of(t, threads, slices)
                if start <= owner < stop:
                    count[found, t] = max(count[found, t], owner - start + 1)
        found += 1
    # What needs least of the others comes first, so that no slice waits behind one that needs their last.
    order = np.argsort(count[:found].sum(axis=1), kind="mergesort")
    return shared[:found][order], count[:found][order]


@njit(cache=True, nogil=True, _nrt=False, forceinline=True, error_model="numpy")
def step_at(time: float, last_dt: float, dt: float, loads: Loads, place: int, reach: float) -> Step:
    """The step that begins at `time`; a new length follows the old one without a jump of the velocities."""
    ax = interpolate(time, loads.times, loads.acceleration[0], place)
    az = interpolate(time, loads.times, loads.acceleration[1], place)
    level = interpolate(time, loads.times, loads.acceleration[2], place)
    mean_x = 0.5 * (ax + interpolate(time + dt, loads.times, loads.acceleration[0], place))
    mean_z = 0.5 * (az + interpolate(time + dt, loads.times, loads.acceleration[1], place))
    mean_level = 0.5 * (level + interpolate(time + dt, loads.times, loads.acceleration[2], place))
    return Step(0.5 * (last_dt + dt), dt, last_dt, ax, az, level, mean_x, mean_z, mean_level, reach)


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
    scratch: np.ndarray,
) -> tuple[int, float, int]:
    """What `advance` does once it has memory to work in; shared, need: see `needs`."""
    thread, threads, barrier = team.thread, team.threads, team.barrier
    slices = len(layout.chunk_start) - 1
    begin, end = slices_of(thread, threads, slices)
    unknown = layout.chunk_start[begin]
    last_dt = clock.last_dt
    time = clock.time
    place = 0
    reason = DONE
    taken = 0
    while taken < clock.steps and reason == DONE:
        while place + 2 < len(loads.times) and loads.times[place + 1] < time:
            place += 1
        step = step_at(time, last_dt, clock.dt, loads, place, reach)
        too_deep = False
        moved = False
        ready = begin
        for p in range(begin, end):
            too_deep |= contacts_of_slice(p, layout, springs, scratch, unknown, last_dt, law, entries)
            at_hand = p
            if threads > 1:
                report(barrier, thread)
            while ready < end and (layout.last[ready] <= p or layout.last[ready] >= end):
                if layout.first[ready] >= begin and layout.last[ready] < end:
                    moved |= move_slice(ready, layout, scratch, step, entries, ready == at_hand)
                    at_hand = ready
                ready += 1
        for k in range(len(shared)):
            for t in range(threads):
                if need[k, t] > 0:
                    start, stop = slices_of(t, threads, slices)
                    wait_for(barrier, t, taken * (stop - start) + need[k, t])
            moved |= move_slice(shared[k], layout, scratch, step, entries, False)
        team.stops[taken % 2, thread] = OVERLAP if too_deep else (MOVED if moved else DONE)
        if threads > 1:
            wait(barrier, threads)
        for k in range(threads):
            reason = max(reason, team.stops[taken % 2, k])
        last_dt = clock.dt
        time += clock.dt
        taken += 1
    return taken, time, reason


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    team: Team,
    clock: Clock,
    layout: Layout,
    springs: Springs,
    law: Law,
    loads: Loads,
    entries: Entries,
    reach: float,
) -> tuple[int, float, int]:
    """Takes the clock's steps or fewer; each thread of the team calls it with its own number.

    reach: square of the way (m2) after which a disc wants a new neighbour list.
    Returns (steps taken, time, reason): MOVED if the neighbour list must be made anew before the next step,
    OVERLAP if two discs are deeper in each other than allowed, DONE otherwise.
    """
    shared, need = needs(team, layout)
    return take_steps(team, clock, layout, springs, law, loads, entries, reach, shared, need, new_scratch())
