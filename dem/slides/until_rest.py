"""Runs discs until they are at rest."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.errors import StepTooLargeError
from dem.model import DiscModel

STEP_SHARE = 0.5  # of the stable step
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
