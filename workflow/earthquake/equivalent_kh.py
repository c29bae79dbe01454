"""Computes the cyclic seismic coefficient that is equivalent to an earthquake for which there is no record.

Uniform cycles of 0.65 of the peak are equivalent to the irregular cycles of an earthquake (Seed & Idriss 1971). The
number of cycles follows from the magnitude scaling factor of the triggering relations; the period of the cycles is the
mean period of the motion.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meshes.section.quantity import GRAVITY
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.attenuation import PeakMotion, Site

# Amplitude of equivalent uniform cycles over the peak (Seed & Idriss 1971), as in the cyclic stress ratio.
SHARE_OF_PEAK = 0.65
LARGEST_KH = 1.0  # of the Kh that slides take
CYCLE_POWER = 0.34  # by which the strength of sand falls with the number of cycles, N^-0.34 (Idriss & Boulanger 2008)
CYCLES_OF_7_5 = 15.0  # uniform cycles of an earthquake of magnitude 7.5 (Seed & Idriss 1982)
REFERENCE_MAGNITUDE = 7.5  # the magnitude where an input gives none: the one at which triggering relations are drawn
SITES: Mapping[Site, float] = {
    "rock": 0.0,
    "average": 0.27,
    "soft": 0.27,
}  # ground that liquefies lies on deep soil unless rock is said
BAND = (0.25, 20.0)  # Hz over which the mean period of a record is taken


@dataclass(frozen=True)
class EquivalentKh:
    """Holds uniform ``cycles`` of a cyclic Kh (-) with a ``period`` (s), and the sources of all three, in words."""

    kh: float
    cycles: float
    period: float
    description: str


def cycles_of_magnitude(magnitude: float) -> float:
    """Return the number of uniform cycles at 0.65 of the peak: N = 15 MSF^(-1/0.34), MSF = 6.9 exp(-M/4) - 0.058
    (Idriss & Boulanger 2008).

    The number is 15 at M 7.5, 7 at 6.5, and at least 1; the limit of 1.8 of MSF is disregarded.
    """
    factor = max(6.9 * math.exp(-magnitude / 4.0) - 0.058, 0.2)
    return max(1.0, CYCLES_OF_7_5 * factor ** (-1.0 / CYCLE_POWER))


def mean_period(magnitude: float, distance: float | None = None, site: Site = "average") -> float:
    """Return the mean period T_m (s): ln T_m = -1.00 + 0.18 (M - 6) + 0.0038 R + 0.27 on deep soil (Rathje et al.
    2004).

    Larger magnitudes M than 7.25 count as 7.25. ``distance`` R to the fault is in m, 20 km if it is not known: T_m
    changes by 4 % in 10 km.
    """
    kilometres = 20.0 if distance is None else distance / 1000.0
    return math.exp(-1.0 + 0.18 * (min(magnitude, 7.25) - 6.0) + 0.0038 * kilometres + SITES[site])


def cycles_of_record(record: Accelerogram) -> float:
    """Return the number of uniform cycles at 0.65 of a record's peak: each half wave counts ½ (its peak / 0.65 of the
    largest)^(1/0.34)."""
    waves = np.split(np.abs(record.acceleration), np.flatnonzero(np.diff(np.sign(record.acceleration))) + 1)
    peaks = np.array([wave.max() for wave in waves if len(wave)])
    return float(0.5 * np.sum((peaks / (SHARE_OF_PEAK * record.peak)) ** (1.0 / CYCLE_POWER)))


def mean_period_of_record(record: Accelerogram) -> float:
    """Return the mean period (s) of a record: 1/f weighted by its squared Fourier amplitudes between 0.25 and 20 Hz
    (Rathje)."""
    step = max(1e-3, float(record.time[-1] - record.time[0]) / (len(record.time) - 1))
    time = np.arange(record.time[0], record.time[-1], step)
    values = np.interp(time, record.time, record.acceleration)
    length = 2 ** (len(values) - 1).bit_length()
    frequency, power = np.fft.rfftfreq(length, step), np.abs(np.fft.rfft(values, length)) ** 2
    counts = (frequency >= BAND[0]) & (frequency <= BAND[1])
    return float(np.sum(power[counts] / frequency[counts]) / np.sum(power[counts]))


def equivalent_kh(
    motion: PeakMotion, magnitude: float | None, distance: float | None, site: Site, record: Accelerogram | None
) -> EquivalentKh:
    """Return the cycles of Kh = 0.65 a_max/g that are equivalent to an earthquake.

    Parameters
    ----------
    motion : peak acceleration of the earthquake
    magnitude, distance, site : magnitude, distance (m) and site class, which determine cycles and period if there is no
        record; by default M 7.5 and 20 km
    record : record of the ground surface, which determines cycles and mean period
    """
    peak = motion.median / GRAVITY
    words = f"{SHARE_OF_PEAK:g} of the peak of {peak:.3g} g (Seed & Idriss 1971)"
    kh = min(LARGEST_KH, round(SHARE_OF_PEAK * peak, 3))
    words += f", at most {LARGEST_KH:g}" if kh == LARGEST_KH else ""
    if record is not None:
        cycles, period = cycles_of_record(record), mean_period_of_record(record)
        counted = f"counted in {record.name}, with its mean period"
    else:
        cycles = cycles_of_magnitude(REFERENCE_MAGNITUDE if magnitude is None else magnitude)
        period = mean_period(REFERENCE_MAGNITUDE if magnitude is None else magnitude, distance, site)
        of = f"M {REFERENCE_MAGNITUDE:g}, since no magnitude is given," if magnitude is None else f"M {magnitude:g}"
        counted = f"of {of} (Idriss & Boulanger 2008) with its mean period (Rathje et al. 2004)"
    cycles, period = round(cycles, 1), round(period, 2)
    return EquivalentKh(
        kh, cycles, period, f"{words}, in both directions in {cycles:g} cycles {counted} of {period:g} s"
    )
