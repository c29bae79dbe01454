"""The record that shakes the discs, and when each stratum liquefies under it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dem.slides.drive import Shaking
from workflow.earthquake import accelerogram
from workflow.settings import Input

APART = 1e-6  # s between the two ends of a step of a record


def shaking_of(given: Input, strata: Sequence[int]) -> Shaking | None:
    """The record of [slide] with the times at which strata liquefy; None where Kh is held.

    F_L is strength over stress, and the stress goes with the peak acceleration: ground with F_L = 0.6 is brought to
    liquefaction by a record of 0.6 of the peak, so it liquefies once that is reached. Raises InputError.
    """
    settings = given.slide
    if not settings.accelerogram:
        return None
    record = accelerogram.read(Path(settings.accelerogram), settings.unit).scaled(settings.scale)
    time = record.time + APART * np.append(0.0, np.cumsum(np.diff(record.time) <= 0.0))
    if settings.liquefies_at != "F_L":
        return Shaking(time, record.acceleration, dict.fromkeys(strata, settings.liquefies_at))
    lowest = [one.lowest for one in given.assessment().strata] if given.triggering.borings else []
    factors = {k: min(1.0, lowest[k] or 1.0) if k < len(lowest) else 1.0 for k in strata}
    size = np.abs(record.acceleration)
    reached = {k: int(np.argmax(size >= factor * size.max())) for k, factor in factors.items()}
    return Shaking(time, record.acceleration, {k: float(time[place] - time[0]) for k, place in reached.items()})
