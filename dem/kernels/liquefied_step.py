"""Computes the forces of liquefied ground in a step by all threads, slice by slice (kernel). The laws are in
`liquefied_pairs` and `liquefied_bonds`."""

import math

import numpy as np

from dem.kernels.arguments import BONDS, STAND_IN, VISCOSITY, Entries, Law, Team
from dem.kernels.barrier import slices_of, wait
from dem.kernels.device_function import device_function
from dem.kernels.layout import LANES, Layout
from dem.kernels.liquefied_bonds import MAXWELL_TIME, fetch_strength, press_pairs, press_pairs_with_losses, sum_pairs
from dem.kernels.liquefied_pairs import FORCE_X, FORCE_Z, Liquefied, fetch_motion, look_at_discs, look_at_pairs
from dem.kernels.work_buffers import SUM_X, SUM_Z


@device_function(nogil=True, _nrt=False)
def look_at_slice(p: int, layout: Layout, law: Law, entries: Entries, later: float) -> None:
    """Compute densities, levers and speeds of the pairs of slice p at the positions of discs in `later` seconds.

    layout: discs and contacts; law: contact law with the period of the ground; entries: entries of the energy balance.
    """
    wet = layout.liquefied
    for block in range(wet.start[p], wet.start[p + 1]):
        fetch_motion(block, wet, layout.shared, later, entries.summed)
        work = look_at_pairs(block, wet, law.period, entries.summed)
        if entries.summed:
            entries.sums[p, STAND_IN] += work


@device_function(nogil=True, _nrt=False)
def press_slice(p: int, wet: Liquefied, entries: Entries, damping_time: float, relaxation: float) -> None:
    """Compute the forces of the pairs of slice p; damping_time, relaxation: see `press_lanes`.

    wet: liquefied pairs; entries: entries of the energy balance.
    """
    for block in range(wet.start[p], wet.start[p + 1]):
        fetch_strength(block, wet)
        if not entries.summed:
            press_pairs(block, wet, damping_time, relaxation, wet.linear[block])
        else:
            slid, damped, work = press_pairs_with_losses(block, wet, damping_time, relaxation, wet.linear[block])
            entries.sums[p, BONDS] += slid
            entries.sums[p, VISCOSITY] += damped
            entries.sums[p, STAND_IN] += work


@device_function(nogil=True, _nrt=False)
def press(team: Team, layout: Layout, law: Law, entries: Entries, dt: float) -> None:
    """Compute the forces of all pairs of liquefied ground, which then stay constant until the next call.

    Threads of the `team` wait for each other three times. layout: discs and contacts; law: contact law with the period
    of the ground; entries: entries of the energy balance; dt: time step (s).
    """
    wet = layout.liquefied
    begin, end = slices_of(team.thread, team.threads, len(layout.chunk_start) - 1)
    later, interval = 0.5 * (wet.steps_between_looks - 1) * dt, wet.steps_between_looks * dt
    relaxation = math.exp(-interval / MAXWELL_TIME)
    for p in range(begin, end):
        look_at_slice(p, layout, law, entries, later)
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        lost = look_at_discs(wet.paired_start[p], wet.paired_start[p + 1], wet, layout.shared, later, entries.summed)
        if entries.summed:
            entries.sums[p, VISCOSITY] += lost
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        press_slice(p, wet, entries, 0.5 * interval, relaxation)
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        sum_pairs(wet.paired_start[p], wet.paired_start[p + 1], wet)


@device_function(nogil=True, _nrt=False)
def add_pressed(p: int, layout: Layout, buffer: np.ndarray) -> None:
    """Add the stored forces of liquefied ground to the forces on the discs of slice p."""
    wet = layout.liquefied
    for k in range(wet.paired_start[p], wet.paired_start[p + 1]):
        i = np.int64(wet.paired[k])
        q = np.uint64(i % LANES)
        buffer[SUM_X + q] += wet.discs[i, FORCE_X]
        buffer[SUM_Z + q] += wet.discs[i, FORCE_Z]
