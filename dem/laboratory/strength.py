"""Derives strength from test curves: peak, verdict, dilation, and the Mohr-Coulomb line through several tests."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dem.laboratory.loading import Curve

FALL = 0.02  # of the peak: what a test must lose to have passed one, or gain in its last fifth to be rising still
WINDOW = 0.05  # of the records on either side, for the slope at the peak


@dataclass(frozen=True)
class MeasuredStrength:
    """Holds the strength of a test: at its largest resistance, and at its end.

    Attributes
    ----------
    verdict : "peak", "levels off", "still rising" (then the strength is the resistance at the largest strain) or
        "stopped"
    strain : strain at the largest resistance
    major, minor : principal stresses at the largest resistance (Pa, compression positive)
    normal, shear : stresses on the horizontal plane at the largest resistance (Pa)
    major_last, minor_last : mean principal stresses in the last tenth of the test (Pa)
    dilation : angle of dilation at the largest resistance (rad)
    cracked : share of cracked pore springs at the largest resistance
    """

    verdict: str
    strain: float
    major: float
    minor: float
    normal: float
    shear: float
    major_last: float
    minor_last: float
    dilation: float
    cracked: float


def strength(curve: Curve) -> MeasuredStrength:
    """Return the strength of one test. Raises ValueError for a curve that ended before its third record."""
    if len(curve.strain) < 3:
        raise ValueError(f"{curve.kind} test at {curve.pressure:g} Pa: it stopped at the start. {curve.stopped}")
    resistance = curve.resistance
    at = int(np.argmax(resistance))
    major, minor = curve.principal
    end = -max(1, len(major) // 10)
    return MeasuredStrength(
        verdict=verdict(resistance, bool(curve.stopped)), strain=float(curve.strain[at]), major=float(major[at]),
        minor=float(minor[at]), normal=-float(curve.stress[at, 1, 1]), shear=float(curve.shear[at]),
        major_last=float(major[end:].mean()), minor_last=float(minor[end:].mean()), dilation=dilation(curve, at),
        cracked=float(curve.cracked[at]),
    )  # fmt: skip


def verdict(resistance: np.ndarray, stopped: bool = False) -> str:
    """Return whether a test has passed a peak, levels off, still rises, or was stopped before its peak."""
    top = float(resistance.max())
    if resistance[-1] < (1.0 - FALL) * top:
        return "peak"
    if stopped:
        return "stopped"
    return "still rising" if resistance[: -(-4 * len(resistance) // 5)].max() < (1.0 - FALL) * top else "levels off"


def dilation(curve: Curve, at: int) -> float:
    """Return the dilation angle psi (rad) at a record, from the slope of the volumetric strain over some records around
    it.

    Biaxial: sin psi = d eps_v / d(eps_1 - eps_3), where eps_3 is the strain of the sides, in plane strain; simple
    shear: tan psi = d eps_v / d gamma (Bolton 1986, Geotechnique 36, 65). The angle is positive if the patch grows.
    """
    reach = max(1, round(WINDOW * len(curve.strain)))
    part = slice(max(0, at - reach), at + reach + 1)
    if curve.kind == "biaxial":
        # eps_v = -(eps_1 + eps_3) with compression positive
        slope = np.polyfit(2.0 * curve.strain[part] + curve.volumetric[part], curve.volumetric[part], 1)[0]
        return float(np.arcsin(np.clip(slope, -1.0, 1.0)))
    return float(np.arctan(np.polyfit(curve.strain[part], curve.volumetric[part], 1)[0]))


def from_principal(major: Sequence[float], minor: Sequence[float]) -> tuple[float, float]:
    """Fit c (Pa) and phi (rad) of the line sigma_1 = sigma_3 N + 2 c sqrt(N), by least squares.

    N = (1 + sin phi)/(1 - sin phi). Both c and phi are NaN if the major stress does not rise with the minor stress, as
    then there is no friction angle.
    """
    slope, start = np.polyfit(minor, major, 1)
    if not slope > 0.0:
        return float("nan"), float("nan")
    return float(start / (2.0 * np.sqrt(slope))), float(np.arcsin((slope - 1.0) / (slope + 1.0)))


def from_plane(normal: Sequence[float], shear: Sequence[float]) -> tuple[float, float]:
    """Fit c (Pa) and phi (rad) of the line tau = c + sigma tan phi, by least squares."""
    slope, start = np.polyfit(normal, shear, 1)
    return float(start), float(np.arctan(slope))


def known(value: float) -> float | None:
    """Return the number, or None if it is NaN."""
    return float(value) if np.isfinite(value) else None
