"""Estimates lateral spreading by regression, and by integration of strains over depth."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

YOUD = "T. L. Youd, C. M. Hansen, S. F. Bartlett, J. Geotech. Geoenviron. Eng. 128 (2002) 1007-1017"
ZHANG = "G. Zhang, P. K. Robertson, R. W. I. Brachman, J. Geotech. Geoenviron. Eng. 130 (2004) 861-871"
LOOSE_BLOW_COUNT = 15.0  # (N1)60 below which a saturated layer counts in Youd's thickness
LDI_DEPTH = 23.0  # m, to which shear strains are added up
# Of Zhang et al. (2004), Fig. 1: relative density (%), factor and power of γ_max (%) = factor F_L^power, and its limit.
CURVES = (
    (40.0, 3.31, -7.97, 51.2),
    (50.0, 4.22, -6.39, 34.1),
    (60.0, 3.58, -4.42, 22.7),
    (70.0, 3.20, -2.89, 14.5),
    (80.0, 3.22, -2.08, 10.0),
    (90.0, 3.26, -1.80, 6.2),
)


@dataclass(frozen=True)
class Spreading:
    """Holds the input of the relation of Youd et al. (2002).

    Attributes
    ----------
    magnitude, distance : magnitude of the earthquake, and distance (km)
    slope : slope of the ground (%), or W = 100 H/L (%) at a distance L from a free face of height H
    thickness : thickness of saturated layers with (N1)60 below 15 (m)
    fines : mean fines content of these layers (%)
    d50 : mean grain size of these layers (mm)
    free_face : whether there is a free face
    """

    magnitude: float
    distance: float
    slope: float
    thickness: float
    fines: float
    d50: float
    free_face: bool = False


def youd(site: Spreading) -> float:
    """Return the displacement (m) by Youd, Hansen & Bartlett (2002), Eq. 6b for gently sloping ground, 6a towards a
    free face.

    log D = -16.213 + 1.532 M - 1.406 log R* - 0.012 R + 0.338 log S + 0.540 log T + 3.413 log(100 - F)
    - 0.795 log(D50 + 0.1), R* = R + 10^(0.89 M - 5.64), R at least 0.5 km; towards a free face -16.713 and 0.592 log W
    instead of -16.213 and 0.338 log S.
    """
    distance = max(0.5, site.distance)
    near = distance + 10.0 ** (0.89 * site.magnitude - 5.64)
    begins, power = (-16.713, 0.592) if site.free_face else (-16.213, 0.338)
    logarithm = begins + 1.532 * site.magnitude - 1.406 * math.log10(near) - 0.012 * distance
    logarithm += power * math.log10(site.slope) + 0.540 * math.log10(site.thickness)
    logarithm += 3.413 * math.log10(100.0 - site.fines) - 0.795 * math.log10(site.d50 + 0.1)
    return 10.0**logarithm


def why_not_youd(site: Spreading) -> str:
    """Return the reason why a site is outside the range of Youd et al.; empty if it is inside."""
    limits = (
        ("magnitude", site.magnitude, 6.0, 8.0, ""),
        ("free-face ratio", site.slope, 1.0, 20.0, " %") if site.free_face else ("slope", site.slope, 0.1, 6.0, " %"),
        ("thickness with (N1)60 below 15", site.thickness, 1.0, 15.0, " m"),
        ("fines", site.fines, 0.0, 50.0, " %"),
        ("mean grain size", site.d50, 0.1, 1.0, " mm"),
    )
    messages = [
        f"{name} {value:.3g}{unit} is not within {low:g}-{high:g}{unit}"
        for name, value, low, high, unit in limits
        if not low <= value <= high
    ]
    return "; ".join(messages)


def maximum_shear_strain(factor: float, clean: float) -> float:
    """Return γ_max (-) by Zhang et al. (2004) from F_L and (N1)60cs; D_r = 14 √(N1)60cs, at most 42 blows.

    The curves are interpolated between two densities; 0 from F_L = 2 on.
    """
    if factor >= 2.0:
        return 0.0
    density = 14.0 * math.sqrt(min(42.0, clean))
    if density <= CURVES[0][0]:
        return _on_curve(0, factor)
    if density >= CURVES[-1][0]:
        return _on_curve(len(CURVES) - 1, factor)
    k = next(k for k in range(len(CURVES)) if CURVES[k + 1][0] >= density)
    share = (density - CURVES[k][0]) / (CURVES[k + 1][0] - CURVES[k][0])
    return (1.0 - share) * _on_curve(k, factor) + share * _on_curve(k + 1, factor)


def _on_curve(number: int, factor: float) -> float:
    density, scale, power, limit = CURVES[number]
    value = scale * factor**power
    if density == CURVES[0][0] and factor < 1.0:  # this curve ends in a straight line
        value = 250.0 * (1.0 - factor) + 3.5
    return 0.01 * min(limit, value)


def displacement_index(layers: Sequence[tuple[float, float, float]]) -> float:
    """Return the lateral displacement index LDI = ∫ γ_max dz (m) down to 23 m; ``layers`` are (top, bottom, γ_max),
    depths in m."""
    return sum(
        (min(bottom, LDI_DEPTH) - min(top, LDI_DEPTH)) * strain for top, bottom, strain in layers if bottom > top
    )


def zhang(index: float, slope: float) -> float:
    """Return the displacement (m) of gently sloping ground: (S + 0.2) LDI, S the slope (%) from 0.2 to 3.5."""
    return (slope + 0.2) * index


def zhang_free_face(index: float, distance: float, height: float) -> float:
    """Return the displacement (m) at a distance L from a free face of height H (m): 6 (L/H)^-0.8 LDI, L/H from 4
    to 40."""
    return 6.0 * (distance / height) ** -0.8 * index
