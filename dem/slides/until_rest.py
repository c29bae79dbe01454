"""Runs discs until they are at rest."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.errors import StepTooLargeError
from dem.model import DiscModel

STEP_SHARE = 0.5  # of the stable step
DAMPED_STEP_SHARE = 0.8  # of the stable step, while velocities are damped
SETTLING_TIME = 4.0  # s in which the ground comes to rest by damping
UPDATE_INTERVAL = 0.04  # s between two updates of the velocities of discs that are damped, and of the walls of slides
DAMPING_FACTOR = 0.9  # of the velocities, left after each UPDATE_INTERVAL of that
STEP_REDUCTION = 0.8  # factor on a time step that has become too long
CHECKS_AT_REST = 3  # consecutive checks without movement
MASS_AT_REST = 0.98  # share of the mass that must be at rest; single discs may roll on


@dataclass(frozen=True)
class UntilRest:
    """Holds the result of a run until rest.

    Attributes
    ----------
    rested : bool
        Whether the discs are at rest.
    seconds : float
        Model time of the run (s).
    time : (k,)
        Times of the records (s since the beginning).
    moved : (k,)
        At each record, displacement since the previous record (m) that 98 % of the mass did not exceed.
    """

    rested: bool
    seconds: float
    time: np.ndarray
    moved: np.ndarray


def run_until_rest(
    model: DiscModel,
    *,
    still: float,
    longest: float,
    every: float = 0.5,
    at_least: float = 0.0,
    step_share: float = STEP_SHARE,
    on_look: Callable[[DiscModel], None] | None = None,
) -> UntilRest:
    """Run discs until 98 % of their mass moves less than `still` between records, three times in a row.

    Parameters
    ----------
    model
        The discs; they are changed.
    still
        Displacement between two records below which discs count as at rest (m).
    longest
        Time after which the run ends (s).
    every
        Interval of the records (s).
    at_least
        Time before which the run does not end (s), such as the duration of a record or of Kh.
    step_share
        Time step over the stable time step; it is renewed at every record, and shortened if a contact stiffens in
        between.
    on_look
        Function that is called at every record.

    Returns
    -------
    UntilRest
        Whether and when the discs came to rest.

    Raises
    ------
    DemError
        If the engine stops with an error.
    ValueError
        If times or the displacement are not positive.
    """
    if not (still > 0.0 and longest > 0.0 and every > 0.0):
        raise ValueError(f"still, longest and every must be positive, but are {still} m, {longest} s and {every} s")
    begin, free = model.time, ~model.fixed
    times, moved = [], []
    quiet = 0
    while model.time - begin < longest - 1e-9 and quiet < CHECKS_AT_REST:
        before = np.array([model.x, model.z])
        _advance(model, every, step_share)
        displacement = np.hypot(*(np.array([model.x, model.z]) - before))[free]
        order = np.argsort(displacement)
        share = np.cumsum(model.mass[free][order]) / model.mass[free].sum()
        moved.append(float(displacement[order][min(int(np.searchsorted(share, MASS_AT_REST)), len(displacement) - 1)]))
        times.append(model.time - begin)
        quiet = quiet + 1 if moved[-1] < still and times[-1] >= at_least else 0
        if on_look is not None:
            on_look(model)
    return UntilRest(quiet >= CHECKS_AT_REST, model.time - begin, np.array(times), np.array(moved))


def _advance(model: DiscModel, seconds: float, share: float) -> None:
    """Advance the discs by some seconds, with shorter steps where a contact has become stiffer."""
    end = model.time + seconds
    for _ in range(10):
        engine = Engine(dt=share * largest_step(model).seconds, energies=False)
        try:
            engine.run(model, end - model.time)
            return
        except StepTooLargeError:
            share *= STEP_REDUCTION
            if end - model.time < 1e-9:
                return
    engine.run(model, end - model.time)


def come_to_rest(model: DiscModel, on_interval: Callable[[DiscModel, np.ndarray], None] | None = None) -> None:
    """Let discs come to rest under their weight, with damped velocities.

    Parameters
    ----------
    model : discs, which are changed
    on_interval : function that moves walls every `UPDATE_INTERVAL`, as in `Engine.run`
    """
    model.set_velocity(0.0, 0.0)
    for _ in range(round(SETTLING_TIME / UPDATE_INTERVAL)):
        engine = Engine(dt=DAMPED_STEP_SHARE * largest_step(model).seconds, energies=False)
        engine.run(model, UPDATE_INTERVAL, on_interval=on_interval)
        model.set_velocity(DAMPING_FACTOR * model.vx, DAMPING_FACTOR * model.vz)
    model.set_velocity(0.0, 0.0)
