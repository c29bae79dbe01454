"""Assesses triggering by Boulanger & Idriss (2014) from cone penetration tests.

R. W. Boulanger, I. M. Idriss, CPT and SPT Based Liquefaction Triggering Procedures, Report UCD/CGM-14/01, University of
California at Davis (2014); numbers of equations are that report's. Stresses in kPa.
"""

import math
from dataclasses import dataclass

from workflow.earthquake.triggering.blow_count import ATMOSPHERE, Resistance, SurfaceMotion
from workflow.earthquake.triggering.idriss_boulanger import LARGEST_DEPTH, stress_reduction

SOURCE = "R. W. Boulanger, I. M. Idriss, CPT and SPT Based Liquefaction Triggering Procedures, UCD/CGM-14/01 (2014)"
VALIDITY = "sands to non-plastic silts, soil behaviour index up to 2.6; M 5-8.5; its cases are less than 12 m deep"
MAGNITUDES = (5.0, 8.5)
LARGEST_SAND_INDEX = 2.6  # soil behaviour index beyond which a soil counts as clay
LARGEST_RESISTANCE = 211.0  # qc1Ncs, which is a relative density of 0.9: beyond it sand does not liquefy
MOST_ITERATIONS = 100  # in which C_N and qc1Ncs, which depend on each other, are found


@dataclass(frozen=True)
class ConeTest:
    """Holds the input of the method at one depth: ``depth`` (m), cone resistance ``q`` (corrected) and ``sleeve``
    friction, ``total`` and ``effective`` vertical stress (kPa), ``fines`` (%) or None for fines by the soil behaviour
    index."""

    depth: float
    q: float
    sleeve: float
    total: float
    effective: float
    fines: float | None = None

    @property
    def index(self) -> float:
        """Return the soil behaviour type index I_c = √((3.47 - lg Q)² + (1.22 + lg F)²), eq. 2.26, Q with the exponent
        n of Robertson & Wride (1998).

        n = 1 for clays, 0.5 for sands, and 0.75 for soils whose I_c is below the limit of clay with n = 1, but above it
        with n = 0.5.
        """
        ratio = max(0.1, 100.0 * self.sleeve / max(self.q - self.total, 1e-9))

        def by(exponent: float) -> float:
            q = (self.q - self.total) / ATMOSPHERE * (ATMOSPHERE / self.effective) ** exponent
            return math.hypot(3.47 - math.log10(max(1.0, q)), 1.22 + math.log10(ratio))

        if by(1.0) >= LARGEST_SAND_INDEX:
            return by(1.0)
        return by(0.5) if by(0.5) <= LARGEST_SAND_INDEX else by(0.75)


def fines_of(index: float) -> float:
    """Return the fines content FC = 80 I_c - 137, from 0 to 100 %, eq. 2.29 with C_FC = 0."""
    return min(100.0, max(0.0, 80.0 * index - 137.0))


def fines_correction(resistance: float, fines: float) -> float:
    """Return the fines correction Δqc1N = (11.9 + qc1N/14.6) exp(1.63 - 9.7/(FC + 2) - (15.7/(FC + 2))²), eq. 2.22."""
    return (11.9 + resistance / 14.6) * math.exp(1.63 - 9.7 / (fines + 2.0) - (15.7 / (fines + 2.0)) ** 2)


def overburden_correction(clean: float, effective: float) -> float:
    """Return the overburden correction C_N = (Pa/σ'v)^m, at most 1.7, m = 1.338 - 0.249 qc1Ncs^0.264, qc1Ncs from 21 to
    254, eqs. 2.15."""
    exponent = 1.338 - 0.249 * min(254.0, max(21.0, clean)) ** 0.264
    return min(1.7, (ATMOSPHERE / effective) ** exponent)


def overburden_factor(clean: float, effective: float) -> float:
    """Return the overburden factor K_σ = 1 - C_σ ln(σ'v/Pa), at most 1.1, C_σ = 1/(37.3 - 8.27 qc1Ncs^0.264), at most
    0.3, eqs. 2.16."""
    slope = min(0.3, 1.0 / (37.3 - 8.27 * min(LARGEST_RESISTANCE, clean) ** 0.264))
    return min(1.1, 1.0 - slope * math.log(effective / ATMOSPHERE))


def magnitude_scaling(magnitude: float, clean: float) -> float:
    """Return the magnitude scaling factor MSF = 1 + (MSFmax - 1)(8.64 exp(-M/4) - 1.325), MSFmax = 1.09 +
    (qc1Ncs/180)³, at most 2.2, eqs. 2.19, 2.20."""
    most = min(2.2, 1.09 + (clean / 180.0) ** 3)
    return 1.0 + (most - 1.0) * (8.64 * math.exp(-magnitude / 4.0) - 1.325)


def resistance_ratio(clean: float) -> float:
    """Return the cyclic resistance ratio CRR at M = 7.5 and 1 atm: exp(q/113 + (q/1000)² - (q/140)³ + (q/137)⁴ - 2.8),
    q = qc1Ncs, eq. 2.24."""
    return math.exp(clean / 113.0 + (clean / 1000.0) ** 2 - (clean / 140.0) ** 3 + (clean / 137.0) ** 4 - 2.8)


def normalised(point: ConeTest) -> tuple[float, float]:
    """Return the normalised cone resistances qc1N and qc1Ncs."""
    fines = fines_of(point.index) if point.fines is None else point.fines
    resistance = clean = point.q / ATMOSPHERE
    for _ in range(MOST_ITERATIONS):
        before = clean
        resistance = overburden_correction(clean, point.effective) * point.q / ATMOSPHERE
        clean = resistance + fines_correction(resistance, fines)
        if abs(clean - before) < 1e-9:
            break
    return resistance, clean


def equivalent_count(resistance: float) -> float:
    """Return the (N1)60 of sand of the same relative density: D_R = √(N/46) = 0.478 q^0.264 - 1.063, q = qc1N.

    Both relations of D_R are from Idriss & Boulanger (2008). The consequences of liquefaction are computed from this
    (N1)60.
    """
    return 46.0 * max(0.0, 0.478 * resistance**0.264 - 1.063) ** 2


def assess(point: ConeTest, shaking: SurfaceMotion) -> Resistance:
    """Return F_L at a depth: CRR MSF K_σ over CSR = 0.65 (σv/σ'v) a_max r_d, eqs. 2.2 and 2.14."""
    resistance, clean = normalised(point)
    reduction = stress_reduction(point.depth, shaking.magnitude)
    load = 0.65 * point.total / point.effective * shaking.peak * reduction
    if clean >= LARGEST_RESISTANCE:
        return Resistance(resistance, clean, load, math.inf)
    capacity = resistance_ratio(clean) * magnitude_scaling(shaking.magnitude, clean)
    return Resistance(resistance, clean, load, capacity * overburden_factor(clean, point.effective))


def why_not(point: ConeTest) -> str:
    """Return the reason why a soil is not assessed by this method; empty if it is."""
    if point.q <= point.total:
        return "its cone resistance is below the weight of the soil above"
    if point.index > LARGEST_SAND_INDEX:
        return f"soil behaviour index {point.index:.2f} is above {LARGEST_SAND_INDEX:g}: behaves as clay"
    if point.depth > LARGEST_DEPTH:
        return f"deeper than {LARGEST_DEPTH:g} m"
    return ""
