"""Computes the liquefaction potential P_L of a boring (Iwasaki et al. 1978)."""

from collections.abc import Sequence

SOURCE = "T. Iwasaki, F. Tatsuoka, K. Tokida, S. Yasuda, 2nd Int. Conf. Microzonation, San Francisco (1978) 885-896"
LARGEST_DEPTH = 20.0  # m
# P_L up to which damage is what (Iwasaki et al. 1982): the words of the method's authors.
RISKS = ((0.0, "very low"), (5.0, "low"), (15.0, "high"))


def potential(layers: Sequence[tuple[float, float, float | None]]) -> float:
    """Return the liquefaction potential P_L = ∫ F w dz from the ground to 20 m.

    F = 1 - F_L where F_L < 1, else 0, and w = 10 - z/2 with the depth z in m.

    Parameters
    ----------
    layers : (top, bottom, F_L) of each layer, depths in m; F_L is None if the soil does not liquefy

    Returns
    -------
    P_L, from 0 to 100.
    """
    total = 0.0
    for top, bottom, factor in layers:
        top, bottom = min(top, LARGEST_DEPTH), min(bottom, LARGEST_DEPTH)
        if factor is None or factor >= 1.0 or bottom <= top:
            continue
        weight = 10.0 * (bottom - top) - 0.25 * (bottom**2 - top**2)
        total += (1.0 - factor) * weight
    return total


def risk(value: float) -> str:
    """Return the risk of liquefaction damage in the words of Iwasaki et al. (1982).

    Parameters
    ----------
    value : liquefaction potential P_L (0 to 100)

    Returns
    -------
    "very low" for 0, "low" up to 5, "high" up to 15, else "very high".
    """
    return next((word for up_to, word in RISKS if value <= up_to), "very high")
