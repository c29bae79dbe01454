"""Compresses a patch of soil discs beyond its peak: stiffness, peak and residual strength."""

from dataclasses import dataclass

import numpy as np

from dem.laboratory.loading import confine, load, probe
from dem.laboratory.patch import PatchSample
from dem.laboratory.strength import dilation

LAST_STRAIN = 0.15  # axial strain at the end of the test
POST_PEAK_STRAIN = 0.08  # axial strain from which the strength after the peak is averaged
STRAIN_RATE = 4e-4  # strain per sqrt(m / kn)
BINS = 30  # intervals of `LAST_STRAIN` in which the course of the stress is recorded
INERTIAL_NUMBER = 6e-3  # at most; halving it and the rate changes the strength by less than the scatter of seeds


@dataclass(frozen=True)
class PatchStrength:
    """Holds the strength of one patch at one pressure.

    Attributes
    ----------
    pressure : confining pressure (Pa)
    E : Young's modulus in plane strain of a soil with the stiffness of the confined patch (Pa)
    peak, post_peak : half the deviator stress (Pa): at the peak, and its mean from a strain of `POST_PEAK_STRAIN` to
        `LAST_STRAIN`
    dilation : angle of dilation at the peak (rad)
    course (BINS,) : half the deviator stress in each of `BINS` equal intervals of strain up to `LAST_STRAIN` (Pa). The
        curve of one patch scatters, unlike the curve of a sample with many more grains; so the peak is taken from the
        mean curve of several patches.
    """

    pressure: float
    E: float
    peak: float
    post_peak: float
    dilation: float
    course: np.ndarray


def compress(sample: PatchSample, pressure: float) -> PatchStrength:
    """Confine a sample, measure its stiffness by small strains, and compress it in plane strain.

    Raises DemError if the sample does not come to rest or cannot be compressed to `LAST_STRAIN`.
    """
    patch = sample.patch()
    confine(patch, pressure)
    stiffness, _ = probe(patch, pressure)
    rate = min(STRAIN_RATE, INERTIAL_NUMBER / patch.inertia(pressure))
    curve = load(patch, "biaxial", pressure, LAST_STRAIN, rate, stiffness, to_the_end=True)
    half = 0.5 * curve.deviator
    at = int(np.argmax(half))
    late = curve.strain > POST_PEAK_STRAIN
    after = float(half[late].mean()) if late.any() else float(half[-1])
    course = np.interp(LAST_STRAIN * (np.arange(BINS) + 0.5) / BINS, curve.strain, half)
    return PatchStrength(pressure, stiffness.E, float(half[at]), after, dilation(curve, at), course)
