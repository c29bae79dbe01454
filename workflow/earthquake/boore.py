"""Computes the peak acceleration of shallow crustal earthquakes anywhere by the relation of Boore, Stewart, Seyhan &
Atkinson (2014).

The library pygmm has this relation, but requires another numpy than dolfinx was built with; the tests compare with its
numbers.
"""

import math
from typing import Literal

import numpy as np

from meshes.section.quantity import GRAVITY
from workflow.earthquake.attenuation import PeakMotion, ValidRange, check_range

BOORE = "D. M. Boore, J. P. Stewart, E. Seyhan, G. M. Atkinson, Earthquake Spectra 30 (2014) 1057-1085"
RELATION = "Boore et al. (2014)"
Slip = Literal["unknown", "strike-slip", "normal", "reverse"]

# Coefficients of the peak acceleration, in the order of the equations, revision of 2014-07-15.
EVENT: dict[Slip, float] = {"unknown": 0.4473, "strike-slip": 0.4856, "normal": 0.2459, "reverse": 0.4539}
HINGE, BELOW, BELOW_SQUARED, ABOVE = 5.5, 1.431, 0.05053, -0.1662
SPREADING, WITH_MAGNITUDE, ANELASTIC, NEAR_DEPTH, REFERENCE_MAGNITUDE = -1.134, 0.1917, -0.008088, 4.5, 4.5
LINEAR, V_LIMIT, V_REFERENCE = -0.6, 1500.0, 760.0
F3, F4, F5 = 0.1, -0.15, -0.00701
TAU, PHI = (0.398, 0.348), (0.695, 0.495)
PHI_FAR, FAR_DISTANCES, PHI_SOFT, SOFT_VELOCITIES = 0.1, (110.0, 270.0), 0.07, (225.0, 300.0)


def boore(magnitude: float, distance: float, velocity: float, slip: Slip) -> PeakMotion:
    """Return the peak acceleration A (over g) by ln A = F_E + F_P + F_S: magnitude and mechanism, path, and site. There
    is no further term for a basin or a region.

    F_E = e + e4 (M - 5.5) + e5 (M - 5.5)² up to M 5.5, e + e6 (M - 5.5) above; F_P = (c1 + c2 (M - 4.5)) ln R + c3 (R -
    1), R² = R_JB² + 4.5² in km; F_S = c ln(V/760) + f2 ln((A_r + f3)/f3) with A_r the acceleration at V = 760 m/s and
    f2 = f4 (exp(f5 (min(V, 760) - 360)) - exp(400 f5)). ``distance`` is R_JB, to the fault's projection on the ground,
    ``velocity`` V the mean V_s of the uppermost 30 m (m/s), ``slip`` the mechanism of the fault. A is the mean of both
    horizontal components (RotD50). Raises InputError outside M 3-8.5 (normal faults: 7), R_JB up to 400 km, V 150-1500
    m/s.
    """
    kilometres = distance / 1000.0
    check_range(
        RELATION,
        (ValidRange("magnitude", 3.0, 7.0 if slip == "normal" else 8.5), magnitude),
        (ValidRange("distance", 0.0, 400.0, "km"), kilometres),
        (ValidRange("vs30", 150.0, 1500.0, "m/s"), velocity),
    )
    above = magnitude - HINGE
    event = EVENT[slip] + (ABOVE * above if above > 0.0 else BELOW * above + BELOW_SQUARED * above**2)
    far = math.hypot(kilometres, NEAR_DEPTH)
    path = (SPREADING + WITH_MAGNITUDE * (magnitude - REFERENCE_MAGNITUDE)) * math.log(far) + ANELASTIC * (far - 1.0)
    rock = math.exp(event + path)
    softer = F4 * (math.exp(F5 * (min(velocity, V_REFERENCE) - 360.0)) - math.exp(F5 * (V_REFERENCE - 360.0)))
    site = LINEAR * math.log(min(velocity, V_LIMIT) / V_REFERENCE) + softer * math.log((rock + F3) / F3)
    sigma = _spread(magnitude, kilometres, velocity) / math.log(10.0)
    validity = "M 3-8.5 (normal faults 3-7), 0-400 km, V_s30 150-1500 m/s; shallow crustal earthquakes; mean component"
    terms = f"{RELATION}, {slip} slip, V_s30 = {velocity:g} m/s"
    return PeakMotion(GRAVITY * rock * math.exp(site), sigma, terms, BOORE, validity)


def _spread(magnitude: float, kilometres: float, velocity: float) -> float:
    """Return the standard deviation of ln A from its parts between earthquakes (τ) and within one earthquake (φ). The
    standard deviation is smaller on soft ground, and larger far away."""
    tau, phi = (float(np.interp(magnitude, (4.5, 5.5), ends)) for ends in (TAU, PHI))
    phi += PHI_FAR * float(np.interp(math.log(max(kilometres, 0.1)), np.log(FAR_DISTANCES), (0.0, 1.0)))
    phi -= PHI_SOFT * float(np.interp(math.log(velocity), np.log(SOFT_VELOCITIES), (1.0, 0.0)))
    return math.hypot(tau, phi)
