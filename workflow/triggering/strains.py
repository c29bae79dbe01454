"""Strains of ground that liquefies, from F_L and (N1)60cs.

Ishihara & Yoshimine (1992) measured them on clean sand; Yoshimine et al. (2006) put the curves into equations, and
Idriss & Boulanger (2008) those in terms of blow counts. Strains without a unit.
"""

import math

ISHIHARA_YOSHIMINE = (
    "K. Ishihara, M. Yoshimine, Soils and Foundations 32 (1992) 173-188, as Idriss & Boulanger (2008) have it"
)
STRAIN_VALIDITY = "clean sand, and silty sand by (N1)60cs; level ground"
SEED = "H. B. Seed, P. P. Martin, J. Lysmer, J. Geotech. Eng. Div. 102 (1976) 323-346"
PRESSURE_VALIDITY = "clean sand, undrained; F_L from 1 to 2"
SAFE = 2.0  # F_L from which there is no strain
# b, the slope of cyclic strength against cycles, and α, how pore pressure rises with cycles (Seed et al. 1976).
CYCLIC_SLOPE, RISE = 0.34, 0.7


def limiting_shear_strain(clean: float) -> float:
    """γ_lim = 1.859 (1.1 - √(N/46))³, from 0 to 0.5, N = (N1)60cs."""
    return min(0.5, max(0.0, 1.859 * (1.1 - math.sqrt(clean / 46.0)) ** 3))


def limiting_factor(clean: float) -> float:
    """F_α = 0.032 + 0.69 √N - 0.13 N, N = (N1)60cs of at least 7: F_L at which γ_lim is reached."""
    n = max(7.0, clean)
    return 0.032 + 0.69 * math.sqrt(n) - 0.13 * n


def shear_strain(factor: float, clean: float) -> float:
    """γ_max = 0.035 (2 - F_L)(1 - F_α)/(F_L - F_α), at most γ_lim; γ_lim up to F_L = F_α, 0 from F_L = 2 on."""
    if factor >= SAFE:
        return 0.0
    limit, alpha = limiting_shear_strain(clean), limiting_factor(clean)
    if factor <= alpha:
        return limit
    return max(0.0, min(limit, 0.035 * (SAFE - factor) * (1.0 - alpha) / (factor - alpha)))


def volumetric_strain(factor: float, clean: float) -> float:
    """ε_v = 1.5 exp(-0.369 √N) min(0.08, γ_max): what drains away after the earthquake."""
    return 1.5 * math.exp(-0.369 * math.sqrt(clean)) * min(0.08, shear_strain(factor, clean))


def pore_pressure_ratio(factor: float) -> float:
    """Excess pore pressure over σ'v: r_u = (2/π) arcsin(F_L^(-1/(2 α b))), 1 where F_L is at most 1.

    Cycles over those to liquefaction are F_L^(-1/b), with the slope b = 0.34 of cyclic strength (Idriss & Boulanger
    2008), and r_u rises with them as Seed, Martin & Lysmer (1976) have it, α = 0.7.
    """
    if factor <= 1.0:
        return 1.0
    return 2.0 / math.pi * math.asin(factor ** (-1.0 / (2.0 * RISE * CYCLIC_SLOPE)))
