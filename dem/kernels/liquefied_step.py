"""Kernel: liquefied ground in a step of all threads, slice by slice; the laws are in `liquefied_pairs`."""

import math

import numpy as np

from dem.kernels.arguments import BONDS, STAND_IN, VISCOSITY, Entries, Law, Team
from dem.kernels.barrier import slices_of, wait
from dem.kernels.inner import inner
from dem.kernels.layout import LANES, Layout
from dem.kernels.liquefied_pairs import (
    FORCE_X,
    FORCE_Z,
    RELAXES,
    look_at_discs,
    look_at_pairs,
    press_pairs,
    sum_pairs,
)
from dem.kernels.scratch import SUM_X, SUM_Z


@inner(nogil=True, _nrt=False)
def press(team: Team, layout: Layout, law: Law, entries: Entries, dt: float) -> None:
    """Looks at the pairs of liquefied ground: their forces are held from now on; threads meet three times."""
    wet = layout.liquefied
    slices = len(layout.chunk_start) - 1
    begin, end = slices_of(team.thread, team.threads, slices)
    ahead, damping_time = 0.5 * (wet.every - 1) * dt, wet.every * dt
    kept = math.exp(-damping_time / RELAXES)
    for p in range(begin, end):
        work = look_at_pairs(wet.start[p], wet.start[p + 1], wet, layout.shared, ahead, law.period, entries.kept)
        if entries.kept:
            entries.sums[p, STAND_IN] += work
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        lost = look_at_discs(wet.near_start[p], wet.near_start[p + 1], wet, layout.shared, ahead, entries.kept)
        if entries.kept:
            entries.sums[p, VISCOSITY] += lost
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        slid, damped, work = press_pairs(wet.start[p], wet.start[p + 1], wet, damping_time, kept, entries.kept)
        if entries.kept:
            entries.sums[p, BONDS] += slid
            entries.sums[p, VISCOSITY] += damped
            entries.sums[p, STAND_IN] += work
    if team.threads > 1:
        wait(team.barrier, team.threads)
    for p in range(begin, end):
        sum_pairs(wet.near_start[p], wet.near_start[p + 1], wet)


@inner(nogil=True, _nrt=False)
def add_pressed(p: int, layout: Layout, scratch: np.ndarray) -> None:
    """Adds the forces that liquefied ground holds to those on the discs of slice p."""
    wet = layout.liquefied
    for k in range(wet.near_start[p], wet.near_start[p + 1]):
        i = np.int64(wet.near[k])
        q = np.uint64(i % LANES)
        scratch[SUM_X + q] += wet.discs[i, FORCE_X]
        scratch[SUM_Z + q] += wet.discs[i, FORCE_Z]
