"""How a step would be shared out to more threads: python -m tests.benchmarks.threads [--threads N ...] [--json FILE].

The rules of `take_steps` are played through on a real layout: every thread goes through the contacts of its slices,
moves each slice once its last contact is known, then those that it shares with others, each once they have reported
what it needs, and all meet at the barrier. What a slice costs and what a meeting of two threads takes is measured here;
that memory gets no faster with more threads, as a machine of one socket would feel, is left out.
"""

import argparse
import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from dem.engine.engine import Engine, EngineRun
from dem.engine.packer import pack
from dem.engine.sharing import needs
from dem.kernels.barrier import new_barrier, wait
from dem.kernels.layout import LANES, Layout
from dem.model import DiscModel
from tests.benchmarks.dem_throughput import DT, model_of

SIZES, THREADS = (31800, 318000), (1, 2, 8, 32)
# Of a step the share of summing forces and moving discs; the rest are contacts.
MOVING = 0.25
MEETINGS, REPEATS = 200_000, 5


@dataclass(frozen=True)
class Costs:
    """Seconds: of the contacts and of the moving of every slice (slices,), and of each thread at a meeting."""

    contacts: np.ndarray
    moving: np.ndarray
    meeting: float


@njit(nogil=True)
def meet(barrier: np.ndarray, threads: int, times: int) -> None:
    """Nothing but meetings."""
    for _ in range(times):
        wait(barrier, threads)


def meeting() -> float:
    """Seconds that a meeting of two threads takes, for each of them."""
    meet(new_barrier(1), 1, 1)
    with ThreadPoolExecutor(2) as pool:
        barrier, begin = new_barrier(2), time.perf_counter()
        for one in [pool.submit(meet, barrier, 2, MEETINGS) for _ in range(2)]:
            one.result()
    return (time.perf_counter() - begin) / MEETINGS / 2


def seconds_of_a_step(model: DiscModel, threads: int) -> float:
    """On the clock, the kernel alone, the best of some calls."""
    run = EngineRun(Engine(dt=DT, balance=np.inf, threads=threads), model, DT)
    run.advance(5)
    steps, times = max(20, int(4e6 / len(model))), []
    for _ in range(REPEATS):
        begin, before = time.perf_counter(), model.steps
        run.call_kernel(steps)
        times.append((time.perf_counter() - begin) / max(model.steps - before, 1))
        run.update()
        model.make_list()
        run.pack()
    run.close()
    return min(times)


def costs_of(layout: Layout, step: float, meeting: float) -> Costs:
    """Contacts go with the chunks of a slice, moving it with what it gathers from others and with itself."""
    chunks = np.diff(layout.chunk_start).astype(float)
    gathered = np.diff(layout.incoming_start) + 3.0
    return Costs((1.0 - MOVING) * step * chunks / chunks.sum(), MOVING * step * gathered / gathered.sum(), meeting)


def played(layout: Layout, threads: int, costs: Costs) -> dict[str, float]:
    """Seconds of a step, and the shares of it in which threads wait for slices, wait for the last one, and meet."""
    slices = len(layout.chunk_start) - 1
    ends = slices * np.arange(threads + 1) // threads
    through, free = np.zeros(slices), np.zeros(threads)
    for t in range(threads):
        begin, end = ends[t], ends[t + 1]
        now, ready = 0.0, begin
        for p in range(begin, end):
            now += costs.contacts[p]
            through[p] = now
            while ready < end and (layout.last[ready] <= p or layout.last[ready] >= end):
                if layout.first[ready] >= begin and layout.last[ready] < end:
                    now += costs.moving[ready]
                ready += 1
        free[t] = now
    waited, done = np.zeros(threads), free.copy()
    for t in range(threads):
        for p, need in zip(*needs(t, threads, layout), strict=True):
            known = max((through[ends[o] + need[o] - 1] for o in range(threads) if need[o] > 0), default=0.0)
            waited[t] += max(known - done[t], 0.0)
            done[t] = max(known, done[t]) + costs.moving[p]
    meets = costs.meeting * threads if threads > 1 else 0.0
    whole = float(done.max()) + meets
    return {
        "seconds": whole,
        "waiting_for_slices": float(waited.mean()) / whole,
        "waiting_for_the_last": float((done.max() - done).mean()) / whole,
        "meeting": meets / whole,
    }


def rows_of(size: int, counts: list[int], meets: float) -> list[dict[str, Any]]:
    """One row for each number of threads; those that were measured beside those played."""
    model = model_of(size, False, "soil")
    step = seconds_of_a_step(model, 1)
    layout = pack(model)
    costs = costs_of(layout, step, meets)
    rows = []
    for threads in counts:
        found = played(layout, threads, costs)
        row: dict[str, Any] = {"discs": len(model), "slices": len(layout.chunk_start) - 1, "threads": threads}
        row |= {"times_one": round(step / found.pop("seconds"), 2), **{k: round(v, 3) for k, v in found.items()}}
        if threads == 2:
            row["times_one_measured"] = round(step / seconds_of_a_step(model_of(size, False, "soil"), 2), 2)
        rows.append(row)
        print(row, flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, nargs="+", default=list(SIZES))
    parser.add_argument("--threads", type=int, nargs="+", default=list(THREADS))
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    meets = meeting()
    print(f"a meeting takes {1e9 * meets:.0f} ns a thread; slices of {LANES} discs", flush=True)
    rows = [row for size in arguments.elements for row in rows_of(size, arguments.threads, meets)]
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
