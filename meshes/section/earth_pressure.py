"""Gives the limits of the effective earth pressure of level ground (Rankine 1857); compression is positive."""

import numpy as np


def active_pressure(vertical: np.ndarray, sine: np.ndarray | float, cohesive: np.ndarray) -> np.ndarray:
    """Return the horizontal pressure at which ground yields that gives way.

    Parameters
    ----------
    vertical (n,) : vertical effective stress σ_v (Pa)
    sine : sin φ of the ground, (n,) or one value
    cohesive (n,) : c cos φ of the ground (Pa)

    Returns
    -------
    (σ_v (1 - sin φ) - 2 c cos φ) / (1 + sin φ), (n,) in Pa; negative where the ground stands by its cohesion.
    """
    return np.asarray((vertical * (1.0 - sine) - 2.0 * cohesive) / (1.0 + sine))


def passive_pressure(vertical: np.ndarray, sine: np.ndarray | float, cohesive: np.ndarray) -> np.ndarray:
    """Return the horizontal pressure at which ground yields that is pushed.

    Parameters
    ----------
    vertical (n,) : vertical effective stress σ_v (Pa)
    sine : sin φ of the ground, (n,) or one value
    cohesive (n,) : c cos φ of the ground (Pa)

    Returns
    -------
    (σ_v (1 + sin φ) + 2 c cos φ) / (1 - sin φ), (n,) in Pa.
    """
    return np.asarray((vertical * (1.0 + sine) + 2.0 * cohesive) / (1.0 - sine))
