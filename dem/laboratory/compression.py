"""Compresses a patch of soil discs beyond its peak: stiffness, peak and residual strength."""

from dataclasses import dataclass

import numpy as np

from dem.laboratory.loading import confine, load, probe
from dem.laboratory.patch import PatchSample
from dem.laboratory.strength import dilation

STRAIN = 0.15  # axial, at the end
AFTER = 0.08  # from here on is after the peak
RATE = 4e-4  # strain per sqrt(m / kn)
BINS = 30  # intervals of `STRAIN` in which the course of the stress is recorded
INERTIAL = 6e-3  # inertial number at most; half of both changes the strength by less than seeds do


@dataclass(frozen=True)
class PatchStrength:
    """Holds the strength of one patch at one pressure.

    Attributes
    ----------
    pressure : confining pressure (Pa)
    E : Young's modulus in plane strain of a soil with the stiffness of the confined patch (Pa)
    peak, after : half the deviator stress (Pa): at the peak, and its mean from a strain of `AFTER` to `STRAIN`
    dilation : angle of dilation at the peak (rad)
    course (BINS,) : half the deviator stress in each of `BINS` equal intervals of strain up to `STRAIN` (Pa). The curve
        of one patch scatters, unlike the curve of a sample with many more grains; so the peak is taken from the mean
        curve of several patches.
    """

    pressure: float
    E: float
    peak: float
    after: float
    dilation: float
    course: np.ndarray


def compress(sample: PatchSample, pressure: float) -> PatchStrength:
    """Confine a sample, measure its stiffness by small strains, and compress it in plane strain.

    Raises DemError if the sample does not come to rest or cannot be compressed to `STRAIN`.
    """
    patch = sample.patch()
    confine(patch, pressure)
    stiffness, _ = probe(patch, pressure)
    rate = min(RATE, INERTIAL / patch.inertia(pressure))
    curve = load(patch, "biaxial", pressure, STRAIN, rate, stiffness, to_the_end=True)
    half = 0.5 * curve.deviator
    at = int(np.argmax(half))
    late = curve.strain > AFTER
    after = float(half[late].mean()) if late.any() else float(half[-1])
    course = np.interp(STRAIN * (np.arange(BINS) + 0.5) / BINS, curve.strain, half)
    return PatchStrength(pressure, stiffness.E, float(half[at]), after, dilation(curve, at), course)
