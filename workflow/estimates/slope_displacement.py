"""Displacement of slopes from peak acceleration and magnitude, by regression over sliding blocks."""

import math

BRAY_TRAVASAROU = "J. D. Bray, T. Travasarou, J. Geotech. Geoenviron. Eng. 133 (2007) 381-392"
BRAY_MACEDO = "J. D. Bray, J. Macedo, J. Geotech. Geoenviron. Eng. 145 (2019) 04019106"
CM = 0.01  # m
# Seismic coefficients and magnitudes for which both were fitted.
COEFFICIENTS, MAGNITUDES_2007, MAGNITUDES_2019 = (0.01, 0.5), (5.5, 7.6), (5.5, 7.9)
SPREAD_2007, SPREAD_2019 = 0.66, 0.72  # standard deviation of the natural logarithm


def bray_travasarou(kc: float, peak: float, magnitude: float) -> float:
    """Median displacement (m) of a rigid mass: Bray & Travasarou (2007), Eq. 5 with a period of 0.

    ln D = -0.22 - 2.83 ln ky - 0.333 (ln ky)² + 0.566 ln ky ln a + 3.04 ln a - 0.244 (ln a)² + 0.278 (M - 7), D in cm,
    ``peak`` a over g.
    """
    k, a = math.log(kc), math.log(peak)
    value = -0.22 - 2.83 * k - 0.333 * k**2 + 0.566 * k * a + 3.04 * a - 0.244 * a**2 + 0.278 * (magnitude - 7.0)
    return CM * math.exp(value)


def bray_macedo(kc: float, peak: float, magnitude: float) -> float:
    """Median displacement (m) of a rigid mass, ordinary motions of shallow crustal earthquakes: Bray & Macedo (2019).

    ln D = -4.684 - 2.482 ln ky - 0.244 (ln ky)² + 0.344 ln ky ln a + 2.649 ln a - 0.090 (ln a)² + 0.603 M, D in cm,
    if it is not zero.
    """
    k, a = math.log(kc), math.log(peak)
    value = -4.684 - 2.482 * k - 0.244 * k**2 + 0.344 * k * a + 2.649 * a - 0.090 * a**2 + 0.603 * magnitude
    return CM * math.exp(value)
