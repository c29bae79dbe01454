"""The seismic coefficient and the duration that stand for an earthquake where no record shakes the ground."""

from dataclasses import dataclass

import numpy as np

from meshes.section.quantity import GRAVITY
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.attenuation import Motion

SHARE = 0.65  # of the peak: the mean of the cycles that count (Seed & Idriss 1971), as in the cyclic stress ratio
LARGEST = 1.0  # of the Kh that slides take
ARIAS = (0.05, 0.95)  # shares of the Arias intensity between which the significant duration lies
SEED_IDRISS = "H. B. Seed, I. M. Idriss, J. Soil Mech. Found. Div. 97 (1971) 1249-1273"
DOBRY = "R. Dobry, I. M. Idriss, E. Ng, Bull. Seism. Soc. Am. 68 (1978) 1487-1520"


@dataclass(frozen=True)
class EquivalentKh:
    """A constant Kh (-) for so many ``seconds``, or for ever where nothing says how long; and where both come from."""

    kh: float
    seconds: float | None
    words: str


def significant_duration(record: Accelerogram) -> float:
    """Seconds between 5 and 95 % of a record's Arias intensity (Trifunac & Brady 1975)."""
    power = record.acceleration**2
    grown = np.append(0.0, np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(record.time)))
    first, last = (record.time[int(np.searchsorted(grown, share * grown[-1]))] for share in ARIAS)
    return float(last - first)


def duration_of_magnitude(magnitude: float) -> float:
    """Significant duration (s) on rock, log10 D = 0.432 M - 1.83 (Dobry, Idriss & Ng 1978; M 4.5-7.6)."""
    return float(10.0 ** (0.432 * magnitude - 1.83))


def equivalent_kh(motion: Motion, magnitude: float | None, record: Accelerogram | None) -> EquivalentKh:
    """Kh = 0.65 a_max/g over the significant duration of the record, or of the magnitude where there is none."""
    peak = motion.median / GRAVITY
    words = f"{SHARE:g} of the peak of {peak:.3g} g (Seed & Idriss 1971)"
    kh = min(LARGEST, round(SHARE * peak, 3))
    words += f", at most {LARGEST:g}" if kh == LARGEST else ""
    if record is not None:
        seconds = round(significant_duration(record), 1)
        return EquivalentKh(kh, seconds, f"{words}, for the significant duration of {record.name}, {seconds:g} s")
    if magnitude is None:
        return EquivalentKh(kh, None, f"{words}, for ever, since there is neither a magnitude nor a record")
    seconds = round(duration_of_magnitude(magnitude), 1)
    told = f"{words}, for the significant duration of M {magnitude:g}, {seconds:g} s (Dobry, Idriss & Ng 1978)"
    return EquivalentKh(kh, seconds, told)
