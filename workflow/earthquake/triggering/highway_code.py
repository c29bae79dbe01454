"""Assesses triggering by the Specifications for Highway Bridges, Part V, of the Japan Road Association, in three
editions.

The edition of 1990 gives the F_L of the paper on section S-13. The editions of 1996 and 2002 have the same equations as
the edition of 2012. The edition of 2017 has another correction for fines. Stresses are in kPa, grain sizes in mm, fines
in percent.
"""

import math
from typing import Literal

from workflow.earthquake.triggering.blow_count import BlowCount, Resistance, SurfaceMotion

SOURCE = "Japan Road Association, Specifications for Highway Bridges, Part V: Seismic Design"
VALIDITY = "alluvial sand to a depth of 20 m; the code needs no magnitude"
LARGEST_DEPTH = 20.0  # m
KGF = 98.0665  # kPa in a kgf/cm²
MotionType = Literal["I", "II"]


def stress_ratio(point: BlowCount, shaking: SurfaceMotion) -> float:
    """Return the shear stress ratio L = r_d k σv/σ'v with r_d = 1 - 0.015 z, in all editions; k is the peak
    acceleration at the surface over g."""
    return (1.0 - 0.015 * point.depth) * shaking.peak * point.total / point.effective


def grain_size_term(d50: float) -> float:
    """Return the grain size term R2 of 1990: 0.19 up to D50 = 0.05 mm, 0.225 log(0.35/D50) up to 0.6 mm, -0.05 beyond;
    D50 in mm."""
    if d50 <= 0.05:
        return 0.19
    return 0.225 * math.log10(0.35 / d50) if d50 <= 0.6 else -0.05


def resistance_1990(point: BlowCount) -> float:
    """Return the resistance R = R1 + R2 + R3: R1 = 0.0882 √(N/(σ'v + 0.7)), σ'v in kgf/cm²; R3 = 0.004 FC - 0.16 from
    FC = 40 % on.

    Raises ValueError without a mean grain size.
    """
    if point.d50 is None:
        raise ValueError('d50: missing; the highway code of 1990 needs the mean grain size, such as "0.25 mm"')
    first = 0.0882 * math.sqrt(point.N / (point.effective / KGF + 0.7))
    third = 0.004 * point.fines - 0.16 if point.fines >= 40.0 else 0.0
    return first + grain_size_term(point.d50) + third


def normalised(point: BlowCount) -> float:
    """Return the normalised blow count N1 = 170 N / (σ'v + 70), σ'v in kPa."""
    return 170.0 * point.N / (point.effective + 70.0)


def corrected_2012(n1: float, fines: float) -> float:
    """Return the corrected blow count Na = c1 N1 + c2: c1 = 1, (FC + 40)/50 from 10 %, FC/20 - 1 from 60 %; c2 = 0, (FC
    - 10)/18 from 10 %."""
    if fines < 10.0:
        return n1
    first = (fines + 40.0) / 50.0 if fines < 60.0 else fines / 20.0 - 1.0
    return first * n1 + (fines - 10.0) / 18.0


def corrected_2017(n1: float, fines: float) -> float:
    """Return the corrected blow count Na = c (N1 + 2.47) - 2.47: c = 1, (FC + 20)/30 from 10 %, (FC - 16)/12 from
    40 %."""
    factor = 1.0
    if fines >= 10.0:
        factor = (fines + 20.0) / 30.0 if fines < 40.0 else (fines - 16.0) / 12.0
    return factor * (n1 + 2.47) - 2.47


def of_gravel(n1: float, d50: float) -> float:
    """Return the corrected blow count of gravel, Na = (1 - 0.36 log(D50/2)) N1, for D50 of at least 2 mm."""
    return (1.0 - 0.36 * math.log10(d50 / 2.0)) * n1


def resistance_2012(corrected: float) -> float:
    """Return the cyclic triaxial strength ratio R_L = 0.0882 √(Na/1.7), and from Na = 14 on 1.6e-6 (Na - 14)^4.5
    more."""
    dense = 1.6e-6 * (corrected - 14.0) ** 4.5 if corrected >= 14.0 else 0.0
    return 0.0882 * math.sqrt(corrected / 1.7) + dense


def resistance_2017(corrected: float) -> float:
    """Return the cyclic triaxial strength ratio R_L = 0.0882 √((0.85 Na + 2.1)/1.7) below Na = 14, from there on as in
    2012."""
    if corrected < 14.0:
        return 0.0882 * math.sqrt((0.85 * corrected + 2.1) / 1.7)
    return resistance_2012(corrected)


def motion_factor(resistance: float, motion: MotionType) -> float:
    """Return the factor of the motion c_W: 1 for motions of type I (at plate boundaries); for type II (inland) 1, 3.3
    R_L + 0.67, or 2, by R_L."""
    if motion == "I" or resistance <= 0.1:
        return 1.0
    return 3.3 * resistance + 0.67 if resistance <= 0.4 else 2.0


def assess_1990(point: BlowCount, shaking: SurfaceMotion) -> Resistance:
    """Return F_L at a test by the edition of 1990. Raises ValueError without a mean grain size."""
    return Resistance(normalised(point), None, stress_ratio(point, shaking), max(0.0, resistance_1990(point)))


def assess_later(
    point: BlowCount, shaking: SurfaceMotion, form: Literal["2012", "2017"], motion: MotionType
) -> Resistance:
    """Return F_L at a test by the edition of 2012 or 2017, its ``form``: c_W R_L over L.

    ``point``: blow count; ``shaking``: acceleration and magnitude; ``motion``: type 1 or 2 of the code.
    """
    n1 = normalised(point)
    if point.d50 is not None and point.d50 >= 2.0:
        na = of_gravel(n1, point.d50)
    else:
        na = corrected_2012(n1, point.fines) if form == "2012" else corrected_2017(n1, point.fines)
    resistance = resistance_2012(na) if form == "2012" else resistance_2017(na)
    return Resistance(n1, na, stress_ratio(point, shaking), motion_factor(resistance, motion) * resistance)


def why_not(point: BlowCount) -> str:
    """Return the reason why the code requires no assessment of a soil; empty if the code requires one."""
    if point.depth > LARGEST_DEPTH:
        return f"deeper than {LARGEST_DEPTH:g} m"
    if point.fines > 35.0 and point.plasticity is not None and point.plasticity > 15.0:
        return f"fines {point.fines:g} % above 35 % with a plasticity index of {point.plasticity:g} % above 15 %"
    if point.d50 is not None and point.d50 > 10.0:
        return f"D50 = {point.d50:g} mm is above 10 mm"
    return ""
