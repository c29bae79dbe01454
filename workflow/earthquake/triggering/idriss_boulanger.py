"""Assesses triggering by Idriss & Boulanger (2008) from blow counts.

I. M. Idriss, R. W. Boulanger, Soil Liquefaction during Earthquakes, Monograph MNO-12, Earthquake Engineering Research
Institute (2008). Stresses in kPa.
"""

import math

from workflow.earthquake.triggering.blow_count import ATMOSPHERE, BlowCount, Resistance, SurfaceMotion

SOURCE = "I. M. Idriss, R. W. Boulanger, Soil Liquefaction during Earthquakes, EERI MNO-12 (2008)"
VALIDITY = "sands to non-plastic silts; M 5-8.5; to a depth of 34 m, of little certainty below 20 m"
MAGNITUDES = (5.0, 8.5)
LARGEST_DEPTH = 34.0  # m, of the stress reduction
PLASTIC_INDEX = 7.0  # %, plasticity index from which a soil behaves as clay
LARGEST_BLOW_COUNT = 37.5  # (N1)60cs from which sand does not liquefy at all
# Rod length (m) up to which C_R holds; longer ones have 1.
RODS = ((3.0, 0.75), (4.0, 0.80), (6.0, 0.85), (10.0, 0.95))


def stress_reduction(depth: float, magnitude: float) -> float:
    """Return the stress reduction factor r_d = exp(α + β M), α = -1.012 - 1.126 sin(z/11.73 + 5.133), β = 0.106 + 0.118
    sin(z/11.28 + 5.142)."""
    alpha = -1.012 - 1.126 * math.sin(depth / 11.73 + 5.133)
    beta = 0.106 + 0.118 * math.sin(depth / 11.28 + 5.142)
    return math.exp(alpha + beta * magnitude)


def stress_ratio(point: BlowCount, shaking: SurfaceMotion) -> float:
    """Return the cyclic stress ratio CSR = 0.65 (σv/σ'v) a_max r_d of the earthquake, at its magnitude."""
    return 0.65 * point.total / point.effective * shaking.peak * stress_reduction(point.depth, shaking.magnitude)


def magnitude_scaling(magnitude: float) -> float:
    """Return the magnitude scaling factor MSF = 6.9 exp(-M/4) - 0.058, at most 1.8."""
    return min(1.8, 6.9 * math.exp(-magnitude / 4.0) - 0.058)


def overburden_correction(corrected: float, effective: float) -> float:
    """Return the overburden correction C_N = (Pa/σ'v)^m, at most 1.7, with m = 0.784 - 0.0768 √(N1)60cs, (N1)60cs at
    most 46."""
    exponent = 0.784 - 0.0768 * math.sqrt(min(46.0, corrected))
    return min(1.7, (ATMOSPHERE / effective) ** exponent)


def fines_correction(fines: float) -> float:
    """Return the fines correction Δ(N1)60 = exp(1.63 + 9.7/(FC + 0.01) - (15.7/(FC + 0.01))²)."""
    return math.exp(1.63 + 9.7 / (fines + 0.01) - (15.7 / (fines + 0.01)) ** 2)


def overburden_factor(corrected: float, effective: float) -> float:
    """Return the overburden factor K_σ = 1 - C_σ ln(σ'v/Pa), at most 1.1, with C_σ = 1/(18.9 - 2.55 √(N1)60cs), at most
    0.3."""
    slope = min(0.3, 1.0 / (18.9 - 2.55 * math.sqrt(min(37.0, corrected))))
    return min(1.1, 1.0 - slope * math.log(effective / ATMOSPHERE))


def resistance_ratio(corrected: float) -> float:
    """Return the cyclic resistance ratio CRR at M = 7.5 and σ'v = 1 atm: exp(N/14.1 + (N/126)² - (N/23.6)³ + (N/25.4)⁴
    - 2.8), N = (N1)60cs."""
    powers = corrected / 14.1 + (corrected / 126.0) ** 2 - (corrected / 23.6) ** 3 + (corrected / 25.4) ** 4
    return math.exp(powers - 2.8)


def rod_correction(length: float) -> float:
    """Return the rod correction C_R for rods of a length (m), including the part above the ground."""
    return next((factor for up_to, factor in RODS if length < up_to), 1.0)


def normalised(point: BlowCount, energy_ratio: float, rods_above: float) -> tuple[float, float]:
    """Return (N1)60 and (N1)60cs of a test.

    ``energy_ratio`` of the hammer is in percent, ``rods_above`` the ground in m. C_N depends on (N1)60cs, which is
    found by iteration.
    """
    at_60 = point.N * energy_ratio / 60.0 * rod_correction(point.depth + rods_above)
    fines = fines_correction(point.fines)
    clean = at_60 + fines
    for _ in range(100):
        before, clean = clean, at_60 * overburden_correction(clean, point.effective) + fines
        if abs(clean - before) < 1e-9:
            break
    return clean - fines, clean


def assess(point: BlowCount, shaking: SurfaceMotion, energy_ratio: float, rods_above: float) -> Resistance:
    """Return F_L at a test: CRR MSF K_σ over CSR.

    ``point``: blow count; ``shaking``: acceleration and magnitude; ``energy_ratio``: energy ratio of the hammer (%);
    ``rods_above``: length of the rods above ground (m).
    """
    n1, clean = normalised(point, energy_ratio, rods_above)
    load = stress_ratio(point, shaking)
    if clean >= LARGEST_BLOW_COUNT:
        return Resistance(n1, clean, load, math.inf)
    at_rest = resistance_ratio(clean) * magnitude_scaling(shaking.magnitude)
    return Resistance(n1, clean, load, at_rest * overburden_factor(clean, point.effective))


def why_not(point: BlowCount) -> str:
    """Return the reason why a soil is not assessed by this method; empty if it is."""
    if point.plasticity is not None and point.plasticity >= PLASTIC_INDEX:
        return f"plasticity index {point.plasticity:g} % is at least {PLASTIC_INDEX:g} %: behaves as clay"
    if point.depth > LARGEST_DEPTH:
        return f"deeper than {LARGEST_DEPTH:g} m"
    return ""
