"""Computes the settlement of a crest by a slide and by reconsolidation, and the remaining freeboard."""

from collections.abc import Sequence

import numpy as np

from workflow.estimates.crest import Crest

PLACES = 401  # of the crest's width between the feet


def crest_level(surface: np.ndarray, crest: Crest) -> float | None:
    """Return the elevation of the highest ground as wide as the crest between the feet of a structure.

    Water flows over a structure where its highest ground is lower than the water. The level is a mean over the width of
    the crest, because a surface of discs is rough. The highest place counts, because a crest that moved sideways still
    retains water.

    Parameters
    ----------
    surface (n, 2) : points of the ground surface (m), before or after a slide
    crest : the crest as it was before the slide

    Returns
    -------
    Elevation (m); None if the surface does not reach from foot to foot.
    """
    line = surface[np.argsort(surface[:, 0], kind="stable")]
    if not len(line) or line[0, 0] > crest.left or line[-1, 0] < crest.right:
        return None
    start, end = max(crest.start, line[0, 0]), min(crest.end, line[-1, 0])
    places = np.linspace(start, end, PLACES)
    x = np.unique(np.concatenate([places, line[:, 0].clip(start, end), [crest.left, crest.right]]))
    z = np.interp(x, *line.T)
    if crest.width <= 0.0:
        return float(z.max())
    area = np.concatenate([[0.0], np.cumsum(0.5 * (z[1:] + z[:-1]) * np.diff(x))])
    first = x[x <= end - crest.width + 1e-9]
    return float(np.max((np.interp(first + crest.width, x, area) - np.interp(first, x, area)) / crest.width))


def crest_settlement(before: np.ndarray, after: np.ndarray, crest: Crest) -> float | None:
    """Return the decrease of the highest level of a structure by a slide.

    Parameters
    ----------
    before, after : (n, 2) ndarray
        Points of the ground surface (m).
    crest : Crest

    Returns
    -------
    Settlement (m), down positive; None if a surface does not reach over the crest.
    """
    was, became = crest_level(before, crest), crest_level(after, crest)
    return None if was is None or became is None else was - became


def reconsolidation_settlement(thickness: Sequence[float], volumetric_strain: Sequence[float]) -> float:
    """Return the settlement of level ground as the excess pore pressure drains: S = Σ ε_v Δh.

    Only vertical strain is considered (K. Ishihara & M. Yoshimine, Soils and Foundations 32 (1992) 173-188; I. M.
    Idriss & R. W. Boulanger, Soil Liquefaction during Earthquakes, EERI MNO-12, 2008, section 4.4).

    Parameters
    ----------
    thickness : thickness of the liquefied layers below the crest (m)
    volumetric_strain : volumetric strain of each layer (-)

    Returns
    -------
    Settlement (m), down positive.
    """
    return float(sum(h * strain for h, strain in zip(thickness, volumetric_strain, strict=True)))


def freeboard(elevation: float, settlement: float, water: float) -> float:
    """Return the height of a crest above the water after the earthquake.

    Parameters
    ----------
    elevation : elevation of the crest before the earthquake (m)
    settlement : settlement of the crest (m), down positive
    water : elevation of the water beside the structure (m)

    Returns
    -------
    Freeboard (m); negative if water flows over the crest.
    """
    return elevation - settlement - water
