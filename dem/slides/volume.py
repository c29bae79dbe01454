"""Keeps the volume of undrained ground constant: its discs swell as their packing gets denser.

Clay and liquefied ground do not drain during an earthquake, but for the prescribed volumetric strain. Random discs are
looser than undrained soil and get denser as they shear. Liquefied discs get denser as their arrangement becomes
regular, since the density that determines their pore pressure is larger in random arrangements: level ground sank by
1.5 % of a liquefied layer without any drainage. The loss of volume of a denser packing is compensated, stratum by
stratum, by swelling of the discs. All discs of a stratum swell by the same factor, so that the packing and its strength
are unchanged. Areas are volumes per metre out of plane (m2).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from dem.disc_area import area_per_disc
from dem.model import DiscModel

SMALLEST_ERROR = 0.003  # of the area: smaller errors are not corrected, so that ground at rest is not disturbed
LARGEST_CORRECTION = 0.002  # of the area in one update


def undrained_strata(start: DiscModel, liquefy: Sequence[int]) -> list[int]:
    """Return the strata of soil discs that keep their volume: those with undrained strength, and those that
    ``liquefy``."""
    if start.law != "soil":
        return []
    return [k for k, layer in enumerate(start.springs.layers) if k in liquefy or layer.undrained_strength > 0.0]


def volume_change(start: DiscModel, model: DiscModel) -> np.ndarray:
    """Return the relative growth of the area of the ground of each stratum (n,), negative where it got denser.

    The growth is 0 for a stratum without three discs that are neighbours.
    """
    return np.nan_to_num(area_per_disc(model, start) / area_per_disc(start, start) - 1.0)


def shortening(model: DiscModel, strata: Sequence[int]) -> float:
    """Return the mean overlap of the contacts of some strata, over the distance of just touching discs.

    Contacts that fade by liquefaction do not count.
    """
    i, j = model.pair_i, model.pair_j
    touching = model.radius[i] + model.radius[j]
    over = (touching - model.distance()) / touching
    overlapping = (over > 0.0) & ~model.fading & (np.isin(model.layer[i], strata) | np.isin(model.layer[j], strata))
    return float(over[overlapping].mean()) if overlapping.any() else 0.0


def required_areas(
    model: DiscModel,
    start: DiscModel,
    before: np.ndarray,
    strata: Sequence[int],
    sizes: Sequence[float],
    drained: Mapping[int, float],
) -> list[float]:
    """Return the required area of the discs of some strata over their area at the start; `sizes` is the present ratio.

    before: `area_per_disc` at the start; drained: prescribed drained share of the volume, by stratum. The shortening of
    softer springs is not compensated.
    model: discs now; start: discs at the start.
    """
    now = area_per_disc(model, start)
    out = []
    for k, size in zip(strata, sizes, strict=True):
        gave_way = max(0.0, 2.0 * (shortening(model, [k]) - shortening(start, [k])))
        missing = before[k] * (1.0 - drained.get(k, 0.0) - gave_way) / now[k] - 1.0
        out.append(size * (1.0 + LARGEST_CORRECTION) if missing > SMALLEST_ERROR else size)
    return out
