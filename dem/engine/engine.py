"""Integrates the motion of a DiscModel, renews its neighbour list, keeps the energy balance, and reports errors.

Between two calls of `run` the model may be changed in any way; the engine itself holds only settings.
"""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from threading import current_thread, main_thread
from typing import Any, Literal

import numpy as np
from numba import config

from dem.chunked_map import threaded
from dem.engine.checks import (
    BALANCE,
    check_balance,
    check_escape,
    check_finite,
    check_overlap,
    check_speed,
    step_at_speed,
)
from dem.engine.compliant_base import FreeDiscs, MeasurementInterval, acceleration_on_discs, felt_until
from dem.engine.energy_balance import EnergyBalance
from dem.engine.forces import forces_along_x
from dem.engine.memory import ReusedMemory, keep_freed_arrays
from dem.engine.packer import law_of, pack, pack_motion, springs_of, unpack, unpack_motion, unpack_velocities
from dem.engine.sharing import neighbour_slices
from dem.engine.time_step import StableStep, largest_step, step_finder
from dem.errors import DemError, StepTooLargeError
from dem.kernels import energy
from dem.kernels.arguments import Clock, Entries, Loads, Team
from dem.kernels.barrier import new_barrier
from dem.kernels.layout import Layout
from dem.kernels.stepping import DONE, MOVED, OVERLAP, take_steps
from dem.kernels.work_buffers import new_buffer
from dem.liquefied_ground import steps_between_looks
from dem.model import DiscModel
from meshes.executor import deferred_interruption

AUTO_SHARE = 0.2  # of the stable step
LIQUEFIED_BALANCE_RATIO = 10.0  # factor on the tolerance where forces of liquefied ground are constant over steps
CALL_WORK = 2.0e7  # disc-steps in one call of the kernel, about half a second
CALL_STEPS = 100  # at least: what is done between two calls takes as long as a step or two

OnOutput = Callable[[DiscModel], None]
OnInterval = Callable[[DiscModel, np.ndarray], None]


@dataclass(frozen=True)
class Engine:
    """Integrates the motion of discs; holds the settings of a run.

    Attributes
    ----------
    dt : float or "auto"
        Time step (s); "auto" is the share `AUTO_SHARE` of the stable time step at the beginning of a run.
    threads : int
        Number of threads; the result does not depend on it.
    energies : bool
        Whether the energy balance is computed; then a run stops with an error if it does not close.
    balance : float
        Largest unaccounted energy over the total energy exchanged; after liquefaction ten times this value, since
        forces of liquefied ground are constant over several steps.
    """

    dt: float | Literal["auto"] = "auto"
    threads: int = 1
    energies: bool = True
    balance: float = BALANCE

    def __post_init__(self) -> None:
        if self.threads < 1:
            raise ValueError(f"threads must be at least 1, but is {self.threads}")
        if self.dt != "auto" and not self.dt > 0.0:
            raise ValueError(f"dt must be positive or 'auto', but is {self.dt}")

    def step_of(self, model: DiscModel) -> float:
        """Return the time step of a run of this model (s). Raises StepTooLargeError, which names the stable time
        step."""
        stable = largest_step(model)
        if self.dt == "auto":
            if not np.isfinite(stable.seconds):
                raise StepTooLargeError("no two discs can touch, so that no contact limits the time step: give dt in s")
            return AUTO_SHARE * stable.seconds
        self._refuse(model, self.dt, stable)
        return self.dt

    def _refuse(self, model: DiscModel, dt: float, stable: StableStep) -> None:
        if dt > stable.seconds:
            d = stable.disc
            raise StepTooLargeError(
                f"dt = {dt:.4g} s is above the stable step of {stable.seconds:.4g} s that disc {d} at x = "
                f"{model.x[d]:.4g} m, z = {model.z[d]:.4g} m allows at t = {model.time:.6g} s. Use dt = 'auto' or less."
            )

    def measure(self, model: DiscModel) -> EnergyBalance:
        """Measure the energy balance of a model in its present state."""
        return self.measure_layout(model, pack(model))

    def run(
        self,
        model: DiscModel,
        duration: float | None = None,
        *,
        steps: int | None = None,
        every: float | None = None,
        on_output: OnOutput | None = None,
        on_interval: OnInterval | None = None,
    ) -> EnergyBalance | None:
        """Advance the model by `duration` seconds (rounded to whole steps), or by a number of steps, which may be 0.

        on_output is called with the model every `every` seconds and at the end; it may read and save the model, but not
        change it. on_interval is called at the beginning of each of these intervals, with the model and the horizontal
        force (n,) on every disc from contacts, rigid lines and liquefied ground (N per metre); it may read positions
        and change velocities, but nothing else: the model has no contacts then. Returns the energy balance at the end,
        None if it is not computed. Raises DemError, with the model in the state in which the error was found, and
        ValueError unless either a duration or a number of steps is given.
        """
        model.refresh_list()
        dt = self.step_of(model)
        if (duration is None) == (steps is None):
            raise ValueError("give either a duration in s or a number of steps")
        total = steps if steps is not None else max(1, round(float(duration or 0.0) / dt))
        if total < 0:
            raise ValueError(f"a number of steps cannot be negative, but is {steps}")
        between = total if every is None else max(1, round(every / dt))
        with deferred_interruption() as let_through, closing(EngineRun(self, model, dt)) as run:
            run.when_whole = let_through
            energies = run.balance() if self.energies and total == 0 else None
            end = model.steps + total
            begin = model.steps
            while model.steps < end:
                stop = min(end, begin + ((model.steps - begin) // between + 1) * between)
                if on_interval is not None:
                    run.change_velocities(on_interval)
                energies = run.advance(stop - model.steps, on_output is not None)
                if on_output is not None and ((model.steps - begin) % between == 0 or model.steps == end):
                    on_output(model)
        return energies

    def measure_layout(self, model: DiscModel, layout: Layout) -> EnergyBalance:
        """Measure the energy balance of a model whose contacts are in a layout."""
        now = acceleration_on_discs(model)
        loads = Loads(now.times, now.with_level(model.gravity))
        measured = energy.energies(layout, springs_of(model), law_of(model), loads, model.last_dt)
        return EnergyBalance.of(measured, model.energy_sums, model.energy_edited, model.turnover)


class EngineRun:
    """Runs the engine once: holds the layout in memory and the threads, and calls the stepping kernel.

    Parameters
    ----------
    engine : settings of the run
    model : discs with a neighbour list for their present positions. Their state is written back by `advance` and
        `close`; while there is a layout, the model has no pairs.
    dt : time step (s)
    """

    def __init__(self, engine: Engine, model: DiscModel, dt: float) -> None:
        self.engine, self.model, self.dt = engine, model, dt
        model.steps_between_looks = steps_between_looks(model, dt)
        keep_freed_arrays(len(model))
        # without the JIT there are no atomic instructions to meet by
        self.threads = 1 if config.DISABLE_JIT else engine.threads
        # The main thread does not step itself: who is interrupted can wait for the kernel and still know how far it
        # came. Others are not interrupted, and to hand on a short call takes longer than its steps.
        alone = self.threads == 1 and current_thread() is not main_thread()
        self.pool = None if alone else ThreadPoolExecutor(self.threads)
        self.working: list[Future[tuple[int, float, int]]] = []
        self.in_ranges = threaded(self.pool, self.threads)
        self.room = ReusedMemory(len(model))
        self.layout: Layout | None = None  # while there is one, the model has no pairs
        self.springs, self.law = springs_of(model), law_of(model)  # as they were when the layout was made
        self.stable: StableStep | None = None  # as it was when the list was made, if that was in this run
        self.share: float | None = None  # of the stable step, that steps with a new list are at most; None: refused
        self.look: MeasurementInterval | None = None  # at a compliant base
        self.free = FreeDiscs(model) if model.base_impedance > 0.0 else None
        self.when_whole: Callable[[], None] = lambda: None  # called when a call of the kernel is over and booked
        self.pack()
        self.begin_energy_balance()

    def close(self) -> None:
        """Write the state back into the model, after errors too, and release the threads."""
        if self.working:
            self.collect()
        self.update()
        if self.pool is not None:
            self.pool.shutdown()

    def pack(self) -> Layout:
        """Return the layout of the discs for the kernels, which is made from the model if there is none yet."""
        if self.layout is None:
            self.springs, self.law = springs_of(self.model), law_of(self.model)  # while the model has its contacts
            self.layout = pack(self.model, keep_pairs=False, in_ranges=self.in_ranges, room=self.room)
        return self.layout

    def update(self) -> None:
        """Write the layout back into the model, and delete it."""
        if self.layout is not None:
            unpack(self.layout, self.model, self.in_ranges)
            self.layout = None

    def show(self) -> None:
        """Write positions and velocities back into the model; the contacts are only in the layout."""
        if self.layout is not None:
            unpack_motion(self.layout, self.model)
        check_finite(self.model)
        check_escape(self.model)

    def begin_energy_balance(self) -> None:
        """Count as edits, in the energy balance, the energy of changes of the model since the last run."""
        if not self.engine.energies:
            self.model.energy_known = float("nan")
            return
        model = self.model
        energies = self.engine.measure_layout(model, self.pack())
        if np.isnan(model.energy_known):
            model.energy_edited += energies.gap
        else:
            model.energy_edited += energies.kinetic + energies.stored + energies.dissipated - model.energy_known
        model.energy_known = energies.kinetic + energies.stored + energies.dissipated

    def change_velocities(self, change: OnInterval) -> None:
        """Let a function change the velocities of the model; refuse a time step that has become too long for them."""
        model = self.model
        layout = self.pack()
        change(model, forces_along_x(model, layout, self.springs, self.law))
        self.engine._refuse(model, self.dt, StableStep(*step_at_speed(model)))
        pack_motion(layout, model)
        if self.free is not None:
            self.free.measure(model)
        self.begin_energy_balance()

    def advance(self, steps: int, whole: bool = True) -> EnergyBalance | None:
        """Take this number of steps, and write the resulting state back into the model, or positions and velocities
        alone unless `whole`."""
        energies = self.go(steps)
        self.end_look()  # here, so that a run from a checkpoint has the same bits
        if whole:
            self.update()
        self.show()
        if energies is not None:
            self.model.energy_known = energies.kinetic + energies.stored + energies.dissipated
        return energies

    def go(self, steps: int) -> EnergyBalance | None:
        """Take this number of steps without writing the state back, in calls of the kernel that are short enough to be
        interrupted.
        """
        model, engine = self.model, self.engine
        call = max(CALL_STEPS, int(CALL_WORK / len(model)))
        end = model.steps + steps
        measured = model.steps
        while model.steps < end:
            reason = self.take_stretch(min(call, end - model.steps))
            if reason != DONE:
                self.update()
                check_finite(model)
                check_speed(model, self.dt)
                check_escape(model)
            if reason == OVERLAP:
                check_overlap(model)
            self.when_whole()  # before a new list, which sorts the contacts anew
            if reason == MOVED:
                self.list_anew()
            elif engine.energies and measured + call <= model.steps < end:
                self.balance()
                measured = model.steps
        return self.balance() if engine.energies else None

    def list_anew(self) -> None:
        """Make the neighbour list again, and check the time step while the layout is made."""
        model = self.model
        model.make_list(self.in_ranges)
        find = step_finder(model, self.dt if self.share is None else np.inf)
        if self.pool is None or self.threads == 1:
            self.stable = find()
        else:
            looking = self.pool.submit(find)
            self.pack()
            self.stable = looking.result()
        if self.share is not None:
            self.dt = min(self.dt, self.share * self.stable.seconds)
        self.engine._refuse(model, self.dt, self.stable)

    def balance(self) -> EnergyBalance:
        """Compute the present energy balance. Raises EnergyBalanceError."""
        model, engine = self.model, self.engine
        energies = engine.measure_layout(model, self.pack())
        model.turnover = energies.turnover
        try:
            looser = LIQUEFIED_BALANCE_RATIO if len(model.liquefied) else 1.0
            check_balance(model, energies, looser * engine.balance)
        except DemError:
            self.update()
            raise
        return energies

    def take_stretch(self, steps: int) -> int:
        """Take up to `steps` steps, and update the motion of a compliant base; return the reason why the kernel
        returned."""
        model, dt = self.model, self.dt
        if self.free is None:
            return self.call_kernel(steps)
        self.look = self.look or MeasurementInterval(model, dt, self.free)
        since, left = model.time, self.look.steps_left(model, dt)
        reason = self.call_kernel(min(steps, left))
        self.look.follow(model, since)
        if self.look.steps_left(model, dt) < 1:
            self.end_look()
        return reason

    def end_look(self) -> None:
        """Measure the force on a compliant base, if enough steps were taken since the last measurement."""
        if self.look is not None:
            unpack_velocities(self.pack(), self.model)
            self.look.end_now(self.model, self.dt)
        self.look = None

    def call_kernel(self, steps: int) -> int:
        """Take up to `steps` steps in all threads; return the reason why the kernel returned."""
        arguments = self.arguments(steps)
        if self.pool is None:
            return self.add(*take_steps(*arguments[0]))
        self.working = [self.pool.submit(take_steps, *part) for part in arguments]
        return self.collect()

    def arguments(self, steps: int) -> list[tuple[Any, ...]]:
        """Return the arguments of the stepping kernel for every thread."""
        model, threads = self.model, self.threads
        barrier, stops = new_barrier(threads), np.zeros((2, threads), np.int64)
        layout = self.pack()
        clock = Clock(steps, self.dt, model.last_dt, model.time, model.steps)
        acceleration = felt_until(model, model.time + steps * self.dt, self.look)
        loads = Loads(acceleration.times, acceleration.with_level(model.gravity))
        entries = Entries(self.engine.energies, model.energy_sums)
        return [
            (
                Team(thread, threads, barrier, stops), clock, layout, self.springs, self.law, loads, entries,
                model.leeway**2, *neighbour_slices(thread, threads, layout), new_buffer(),
            )
            for thread in range(threads)
        ]  # fmt: skip

    def collect(self) -> int:
        """Wait for the kernel and count its steps; return the reason why the kernel returned."""
        results = [thread.result() for thread in self.working]  # of all, before any is believed
        self.working = []
        return self.add(*results[0])

    def add(self, taken: int, now: float, reason: int) -> int:
        """Count the steps that the kernel took up to the time `now` (s); return the reason why it returned."""
        self.model.steps += taken
        self.model.time = now
        self.model.last_dt = self.dt
        return reason
