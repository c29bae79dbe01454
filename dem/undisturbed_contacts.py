"""Follows the contacts that ground of soil discs has had since it came to rest, whose friction is smaller.

Sand resists shear by the friction of its grains and by its dilation, and a dense packing dilates until it has sheared
by some ten per cent (Rowe 1962, Proc. R. Soc. A 269, 500-527). Ground of discs settles to a porosity of 0.20 to 0.21
(by area, without overlaps), at which the peak of its strength in compression is 1.1 to 1.9 times the strength after it,
while the continuum is perfectly plastic. Contacts of undisturbed sand therefore have the friction mu (1 - b mu), with
b = `soil_contacts.DILATION_SHARE`. A contact that has opened, or whose branch vector has turned by
`DISTURBING_ROTATION`, has the friction mu from then on, as every new contact has: friction takes the place of the
dilation that ends.

Slopes of cohesive ground with friction fail by cracks and at smaller strains: with b = 0.6 a slope of 12 m with
c = 10 kPa and 25° would fail at Kh = 0.12 to 0.16, where elements fail at 0.18 (psi = 0) to 0.24 (psi = phi); with mu
it fails at 0.18 to 0.20. So b falls to zero as the cohesion number C/(2 r p) of the contacts rises from 0 to
`strength_map.EVEN_COHESION`.

Patches of this porosity with kn = 800 p, means of six: half the deviator stress over the pressure in compression, at
the peak of the mean curve and from 8 to 15 % of axial strain, and the shear stress over the normal stress in simple
shear, from 2 to 5 % and from 10 to 29 % of shear strain.

| mu | b | peak | after | shear | after |
|---|---|---|---|---|---|
| 0.25 | 0 | 0.88 | 0.79 | 0.38 | 0.40 |
| | 0.45 | 0.81 | 0.73 | 0.35 | 0.39 |
| 0.378 | 0 | 1.51 | 1.19 | 0.49 | 0.49 |
| | 0.45 | 1.27 | 1.16 | 0.44 | 0.48 |
| 0.5 | 0 | 2.15 | 1.53 | 0.58 | 0.55 |
| | 0.45 | 1.64 | 1.50 | 0.50 | 0.54 |
| 0.677 | 0 | 2.91 | 1.56 | 0.71 | 0.69 |
| | 0.45 | 2.07 | 1.85 | 0.57 | 0.64 |

Sand dilates less in simple shear. With b = 0.3 its strength there has no peak and no delay, but in compression a peak
of 1.1 to 1.25; with b = 0.6 it has no peak in compression, but at 2 % of shear 0.63 to 0.75 of the sine of the friction
angle, and a quay of rubble fails at 0.17 where elements fail at 0.28. b lies between both.
"""

import numpy as np

from dem.state import DiscState, nearest_image

DISTURBING_ROTATION = np.radians(20.0)  # rad


def mark_undisturbed(state: DiscState) -> None:
    """Mark the present contacts of soil discs as contacts of undisturbed ground.

    Parameters
    ----------
    state : discs at rest; the mask of their undisturbed contacts, and the positions to which it refers (m), are
        replaced. Discs with the law "paper" are unchanged.
    """
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
