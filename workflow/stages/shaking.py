"""Determines the base motion of the discs, a record or cycles of Kh, and the onset of liquefaction of each stratum."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dem.settings import AVERAGE
from dem.slides.drive import STEP_DURATION, Shaking, cycles
from workflow.config import Config
from workflow.earthquake import accelerogram
from workflow.earthquake.column import column_of
from workflow.earthquake.equivalent_kh import CYCLE_POWER
from workflow.stages.liquefaction import lowest_factors


def shaking_of(config: Config, strata: Sequence[int]) -> Shaking | None:
    """Return the acceleration of the slides in time, with the times at which strata begin to liquefy.

    The acceleration is a record of the base, the average acceleration of the soil above the slip surface (Makdisi &
    Seed 1978) from a site response to a record of the rock, or cycles of Kh.

    F_L is strength over stress, and the stress is proportional to the peak acceleration: ground with F_L = 0.6
    liquefies under a record with 0.6 of the peak, so it liquefies when this acceleration is reached. With cycles it
    liquefies after a share F_L^(1/0.34) of them (Idriss & Boulanger 2008).

    Parameters
    ----------
    config : section and settings. An unreadable record raises InputError.
    strata : indices of the strata that liquefy

    Returns
    -------
    Times (s), accelerations (m/s²) and onsets; None for a constant Kh.
    """
    settings = config.slide
    if not settings.accelerogram:
        return cycles(settings, strata, passed=_passed(config, strata))
    time, acceleration = _average(config) if settings.accelerogram == AVERAGE else _record(config)
    acceleration, of_the_base = settings.scale * acceleration, settings.accelerogram != AVERAGE
    if settings.liquefies_at != "F_L":
        return Shaking(time, acceleration, dict.fromkeys(strata, settings.liquefies_at), of_the_base)
    lowest = lowest_factors(config)
    factors = {k: min(1.0, lowest[k] or 1.0) if k < len(lowest) else 1.0 for k in strata}
    size = np.abs(acceleration)
    reached = {k: int(np.argmax(size >= factor * size.max())) for k, factor in factors.items()}
    return Shaking(time, acceleration, {k: float(time[place] - time[0]) for k, place in reached.items()}, of_the_base)


def _passed(config: Config, strata: Sequence[int]) -> dict[int, float]:
    """Return the share of the cycles after which each stratum has liquefied in full.

    Strength falls with the number of cycles as N^-0.34 (Idriss & Boulanger 2008), so that a layer liquefies after a
    share F_L^(1/0.34) of the cycles: with F_L = 0.5 after an eighth. Layers without blow counts liquefy at the
    beginning.
    """
    if config.slide.liquefies_at != "F_L":
        return {}
    lowest = lowest_factors(config)
    factors = {k: min(1.0, lowest[k] or 0.0) if k < len(lowest) else 0.0 for k in strata}
    return {k: factor ** (1.0 / CYCLE_POWER) for k, factor in factors.items()}


def _record(config: Config) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s), rising, and accelerations (m/s²) of the record that [slide] names."""
    record = accelerogram.read(Path(config.slide.accelerogram), config.slide.unit, config.slide.component)
    return record.time + STEP_DURATION * np.append(0.0, np.cumsum(np.diff(record.time) <= 0.0)), record.acceleration


def _average(config: Config) -> tuple[np.ndarray, np.ndarray]:
    """Return times (s) and average accelerations (m/s²) of the soil above the slip surface, under the record of
    [site_response]."""
    column = column_of(config.section, config.site_response)
    average = column.average_above(float(config.site_response.slip_depth or 0.0))
    return column.step * np.arange(len(average)), average
