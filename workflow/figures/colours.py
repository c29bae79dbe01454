"""Chooses the colours of soils in pictures."""

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import to_hex, to_rgb

from meshes.section.cutting import soil_numbers

# Soils by their place in the section; read against black lines and white paper, and by the colour-blind.
SOILS = (
    "#e8cf9a", "#b5a68c", "#dcb272", "#c8925a", "#b98b6b", "#d7c27f", "#94a58b",
    "#cdb08a", "#8b97a3", "#77707a", "#a9b9a0", "#c9a3a0",
)  # fmt: skip


def soil_colour(index: int) -> str:
    """Return the colour of the stratum with this index; after the twelfth the colours repeat, darker."""
    again, place = divmod(index, len(SOILS))
    return to_hex(np.array(to_rgb(SOILS[place])) * 0.72**again)


def soil_colours(names: Sequence[str]) -> list[str]:
    """Return the colours of strata by their names; parts of one soil have the same colour.

    Parameters
    ----------
    names : names of the n strata of a section, from top to bottom

    Returns
    -------
    n colours, such as "#e8cf9a".
    """
    return [soil_colour(number) for number in soil_numbers(names)]
