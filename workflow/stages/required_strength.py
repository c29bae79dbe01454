"""Finds strict bounds of the strength of some strata with which the ground just stands under its weight."""

import math
from collections.abc import Collection

from fem.settings import BoundsSettings, FemSettings
from meshes.errors import InputError, NoAnswerError
from meshes.section.section import Section

# Gap, triangles and computing work (s of a reference machine) of the bounds of each factor of safety.
CELLS, GAP, SECONDS = 5000, 0.02, 60.0
# Largest number of strengths that are tried, and the step to the next one as a multiple of that by linear
# extrapolation: the factor rises ever less with the strength.
MOST_TRIALS, STEP = 4, 1.3


def bounds_of_multiple(
    section: Section, numbers: Collection[int], fem: FemSettings, settings: BoundsSettings, factor: float, guess: float
) -> tuple[float | None, float | None]:
    """Return strict bounds of the multiple of the cohesion of some strata with which the factor of safety is 1.

    All strengths over the factor of safety F are just enough. Where F is below 1, the other ground has less than that,
    so that the strata need at least their strength over the upper bound of F. Where F is above 1, the other ground has
    more, and they need at most their strength over the lower bound of F.

    Parameters
    ----------
    section : section whose factor of safety is below 1 at Kh = 0, between sides held horizontally
    numbers : numbers of the strata, which have no friction
    fem, settings : settings of elements and bounds
    factor : factor of safety of the section (-), below 1
    guess : multiple with which the ground about stands (-), above 1

    Returns
    -------
    Lower and upper bound (-); None for one that was not found.
    """
    from fem.limit.safety_bounds import safety_bounds
    from fem.search.required_strength import with_multiple

    close = settings.changed(max_cells=CELLS, gap=GAP, seconds=SECONDS, davis=False)
    low = high = None
    multiple = guess
    for _ in range(MOST_TRIALS):
        try:
            strict = safety_bounds(with_multiple(section, numbers, multiple), fem, close, 0.0, 1.0, smooth_sides=True)
        except (NoAnswerError, InputError):
            break
        if strict.shallow_failure is not None or strict.lower <= 0.0 or not math.isfinite(strict.upper):
            break  # bounds of strengthened ground, or none
        if strict.upper <= 1.0:
            low = max(low or 0.0, multiple / strict.upper)
        if strict.lower >= 1.0:
            high = min(high or multiple, multiple / strict.lower)
        if low is not None and high is not None:
            break
        rise = (0.5 * (strict.lower + strict.upper) - factor) / (multiple - 1.0)
        if rise <= 0.0:
            break
        multiple += STEP * (1.0 - (strict.lower if high is None else strict.upper)) / rise
    return low, high
