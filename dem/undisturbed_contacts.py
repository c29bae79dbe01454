"""Follows the contacts that ground of soil discs has had since it came to rest, whose friction is smaller.

Sand resists shear by the friction of its grains and by its dilation, and a dense packing dilates until it has sheared
by some ten per cent (Rowe 1962, Proc. R. Soc. A 269, 500-527). Discs settle to a porosity of 0.20, at which the peak of
their strength is 1.3 to 2.5 times the strength after it, while the continuum is perfectly plastic: a bare slope of
sand with 33° stood at 39°. Contacts of undisturbed sand therefore have the friction mu (1 - b mu), with b =
`soil_contacts.DILATION_SHARE`. With it, bare slopes of 10 m fail at 0 to 4° above the friction angle after the peak. A
contact that has opened, or whose branch vector has turned by `DISTURBING_ROTATION`, has the friction mu from then on,
as every new contact has: friction takes the place of the dilation that ends.

Slopes of cohesive ground with friction fail by cracks and at smaller strains: with mu (1 - b mu) a slope of 12 m with
c = 10 kPa and 25° would fail at Kh = 0.12 to 0.16, where elements fail at 0.18 (psi = 0) to 0.24 (psi = phi); with mu
it fails at 0.18 to 0.20. So b falls to zero as the cohesion number C/(2 r p) of the contacts rises from 0 to
`strength_map.EVEN_COHESION`.

Half the deviator stress over the pressure p of patches of porosity 0.20 with kn = 1600 p, means of six: at the peak of
the mean curve, and from 8 to 15 % of axial strain.

| mu | peak, mu everywhere | after | peak | after |
|---|---|---|---|---|
| 0.25 | 1.09 | 0.82 | 0.94 | 0.78 |
| 0.378 | 1.85 | 1.16 | 1.38 | 1.15 |
| 0.5 | 2.61 | 1.45 | 1.86 | 1.48 |
| 0.677 | 3.82 | 1.54 | 2.30 | 1.74 |
"""

import numpy as np

from dem.state import DiscState, nearest_image

DISTURBING_ROTATION = np.radians(20.0)  # rad


def mark_undisturbed(state: DiscState) -> None:
    """Mark the present contacts of soil discs as contacts of undisturbed ground."""
    if state.law == "soil":
        state.undisturbed_x, state.undisturbed_z = state.x.copy(), state.z.copy()
        state.undisturbed = state.distance() < state.radius[state.pair_i] + state.radius[state.pair_j]


def still_undisturbed(state: DiscState, old: np.ndarray) -> np.ndarray:
    """Return the mask (pairs,) of the pairs of a new list that are still contacts of undisturbed ground; empty if none
    were marked.

    old: place of each pair in the list before, to which the mask of the state belongs; -1 for new pairs.
    """
    if not len(state.undisturbed):
        return state.undisturbed
    i, j = state.pair_i, state.pair_j
    apart = state.undisturbed_x[j] - state.undisturbed_x[i], state.undisturbed_z[j] - state.undisturbed_z[i]
    now, then = state.branch(), np.array(nearest_image(*apart, state.repeats))
    distance = np.hypot(*now)
    unturned = np.sum(now * then, axis=0) > np.cos(DISTURBING_ROTATION) * distance * np.hypot(*then)
    touching = distance < state.radius[i] + state.radius[j]
    return np.asarray(np.append(state.undisturbed, False)[old] & touching & unturned)
