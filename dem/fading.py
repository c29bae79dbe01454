"""Contacts of soil discs that fade out as their layer liquefies, in the table of constants by pair of layers."""

from collections.abc import Sequence

import numpy as np

from dem.kernels.contact import ALLOWED, CN, CT, KN, KS, STOP

ANY_OVERLAP = 2.0  # half of the sum of radii, and more


def share_left(faded: Sequence[float]) -> np.ndarray:
    """Share of the contacts between n layers, and with the boundary, that is left (n + 1, n + 1).

    faded: by layer, what is gone. A contact is gone as far as it is for the one of its layers that has less.
    """
    left = 1.0 - np.array([*faded, 0.0])
    return np.asarray(np.minimum(left[:, None], left[None, :]))


def fade(pairs: np.ndarray, left: np.ndarray) -> None:
    """Takes what is gone off the stiffness of contacts (CONSTANTS, n + 1, n + 1): they may overlap as they like."""
    pairs[[KN, KS, CN, CT, STOP]] *= left
    pairs[ALLOWED] = np.where(left < 1.0, ANY_OVERLAP, pairs[ALLOWED])
