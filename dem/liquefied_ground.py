"""Prepares the state of liquefied soil discs, and the list of their pairs: which discs liquefy, their degree of
liquefaction, pore pressure and residual strength. The laws are in `kernels.liquefied_pairs`.
"""

from typing import NamedTuple

import numpy as np

from dem.chunked_map import Ranges, pairs_near, serial
from dem.kernels import liquefied_pairs as bond
from dem.kernels.liquefied_bonds import BOND_LIMIT, FITTED_STRENGTH, STRAINING_SHARE, limiting_strains
from dem.kernels.liquefied_lists import densities
from dem.kernels.liquefied_stress import measured_shear
from dem.kernels.neighbours import Near, known_pairs
from dem.pressure_shear import take_back_shear
from dem.state import DiscState

FADING_STEPS = 20  # steps in which springs and bonds change as ground liquefies, or clay loses its contacts
REACH = 2.0  # mean diameters: with 1.6 the pressure alone would hold a hundredth of itself as shear
WATER_STIFFNESS = 30.0  # stiffness of the pore water over the mean overburden
BULK_VISCOSITY = 0.3  # viscosity of volume over density, speed of sound in the water, and reach
# Strain of a bond, half the shear strain of the ground, at which residual strength is reached: at the earliest, since
# stiffer bonds require shorter steps, and at the latest, before the ground has sheared by 5 %.
SMALLEST_STRAIN, LARGEST_STRAIN = 0.004, 0.02
BOND_STRAIN_RATIO = 0.5 * FITTED_STRENGTH  # strain of a bond at its limit over strength over shear modulus s/G
SHEAR_MODULUS = 0.23  # of patches of soil discs, over kn: their E is 0.6 kn, with a Poisson's ratio of 0.3
# Of the median density of a layer: discs at a free surface, looser than the second, take the first.
LOOSE_DENSITY, LOOSEST_DENSITY = 0.95, 0.85
LONGEST_INTERVAL = 1.2  # time between two updates of pair forces, times a bound on their highest angular frequency
# Sums over the pairs of a disc, as integrals over a uniform density of discs between a diameter and the reach H: twice
# sum w/r over sum w r, times H^2; for the pore water a multiple of the integral, as discs also come nearer.
BOND_STIFFNESS_SUM, WATER_STIFFNESS_SUM = 4.8, 3.0
# Share of the longest update interval that is used: with more, sliding clay gains energy.
BALANCED_INTERVAL = 0.6
MOST_STEPS = 4  # between two looks: half a period of the fastest contacts, beyond which these resonate
# Rate (per unit of strain) at which the strength of bonds follows the deficit of stress: 1/e within a strain of 1/40.
ADJUSTMENT_RATE = 40.0
LARGEST_DEFICIT = 0.5  # of the requested strength
LARGEST_CHANGE = 0.1  # from one neighbour list to the next
# Factor on the requested strength: the measured strength of discs with few neighbours is inaccurate. Next to rough
# ground that does not liquefy, pressure along lines of centres carries a third of the shear stress, and around single
# discs all of it.
LEAST_FACTOR, MOST_FACTOR = 0.1, 2.0
LEAST_STRENGTH = 1.0  # Pa
# Mobilised share of the strength of bonds: ground with less than the first does not slip, with more than the second all
# of it does.
NO_SLIP_SHARE, FULL_SLIP_SHARE = 0.8, 0.9
FEWEST_COLUMNS = 3  # columns of cells in a period


class Onset(NamedTuple):
    """Holds the state of the ground at the onset of liquefaction; arrays of all discs.

    Attributes
    ----------
    discs (n,) : mask of the discs that liquefy
    area (n,) : area of every disc with its voids, whether it liquefies or not (m2)
    pressure (n,) : effective overburden that pore water takes over (Pa)
    strength (n,) : residual strength (Pa)
    strain (n,) : strain of bonds, half the shear strain, at which the residual strength is reached
    knee, soft_to (n,) : knee of the bilinear law at the strain potential: share of the residual strength (``knee``),
        and share of the strain at which the steep line begins (``soft_to``); 0 without a strain potential
    peak : whether bonds have a larger limit until they have slipped (`EXTRA_STRENGTH`)
    """

    discs: np.ndarray
    area: np.ndarray
    pressure: np.ndarray
    strength: np.ndarray
    strain: np.ndarray
    knee: np.ndarray | float = 0.0
    soft_to: np.ndarray | float = 0.0
    peak: bool = True


def elastic_strain(model: DiscState, strength: np.ndarray) -> np.ndarray:
    """Return the strain of bonds at which ground with the shear modulus of its stratum reaches a strength.

    Parameters
    ----------
    model : discs with the contact stiffness kn of their layers; the shear modulus is `SHEAR_MODULUS` kn
    strength (n,) : shear strength of the ground at each disc (Pa)

    Returns
    -------
    Strain (n,): `BOND_STRAIN_RATIO` times strength over shear modulus.
    """
    modulus = SHEAR_MODULUS * np.append([layer.kn for layer in model.springs.layers], 1.0)[model.layer]
    return np.asarray(BOND_STRAIN_RATIO * strength / modulus)


def list_liquefied(state: DiscState, in_ranges: Ranges = serial) -> None:
    """Make the list of pairs with a liquefied disc for the present positions. History variables of bonds are copied
    from the old list."""
    if not len(state.liquefied):
        return
    order = state.order
    wet = is_liquefying(state)[order]
    # pairs of which neither has liquefied are left out as pairs of fixed discs are
    near = Near(state.x[order], state.z[order], state.radius[order], ~wet, 0.0, state.reach + state.skin, state.repeats)
    known = known_pairs(state.liquefied_i, state.liquefied_j, state.places)
    first, second, old = pairs_near(near, known, np.zeros(len(state.liquefied_i)), in_ranges)
    state.bonds = np.concatenate([state.bonds, np.zeros((1, bond.MEMORY))])[old]
    before = _in_pairs(state)
    state.liquefied_i, state.liquefied_j = order[first], order[second]
    # who comes near for the first time was not followed until now, and nothing holds who is no longer near
    take_back_shear(state)
    now = _in_pairs(state)
    came = now & ~before
    state.liquefied[came, bond.AT_X], state.liquefied[came, bond.AT_Z] = state.x[came], state.z[came]
    state.liquefied[~now, bond.FORCE_X] = state.liquefied[~now, bond.FORCE_Z] = 0.0


def match_strength(state: DiscState) -> None:
    """Adjust the strength of bonds, so that strained ground has its prescribed strength with a new list of pairs.

    Without the adjustment the strength would depend on the arrangement of the discs, since the pressure between discs
    that move past each other contributes shear stress. Bonds along a straight row of fixed discs are not adjusted:
    discs slip along such a row at less than the stress between the discs beside it, and `FITTED_STRENGTH` is for this
    case.
    """
    if not len(state.liquefied):
        return
    wet = state.liquefied
    displacement = np.array([state.x - state.x_list, state.z - state.z_list])
    stress, strain, used = measured_shear(
        wet, displacement, np.array([state.liquefied_i, state.liquefied_j]), state.bonds, state.reach, state.repeats
    )
    measured = wet[:, bond.SHARE] == 1.0
    if not state.rough_base:
        measured[state.liquefied_i[state.fixed[state.liquefied_j]]] = False
        measured[state.liquefied_j[state.fixed[state.liquefied_i]]] = False
    slipped = (
        np.where(measured, np.clip((used - NO_SLIP_SHARE) / (FULL_SLIP_SHARE - NO_SLIP_SHARE), 0.0, 1.0), 0.0) * strain
    )
    factor = state.strength_factor
    required = np.maximum(wet[:, bond.STRENGTH] / factor, LEAST_STRENGTH)
    lacking = np.clip(1.0 - stress / required, -LARGEST_DEFICIT, LARGEST_DEFICIT)
    change = np.clip(ADJUSTMENT_RATE * slipped * lacking, -LARGEST_CHANGE, LARGEST_CHANGE)
    now = np.clip(factor * np.exp(change), LEAST_FACTOR, MOST_FACTOR)
    change_strength(state, now / factor)  # at their stiffness, and with it the stable step, unchanged
    state.strength_factor = now


def _in_pairs(state: DiscState) -> np.ndarray:
    """Return the mask (n,) of the liquefied discs and of discs with a liquefied one within reach."""
    is_in_pair = np.zeros(len(state), bool)
    is_in_pair[state.liquefied_i] = is_in_pair[state.liquefied_j] = True
    return is_in_pair


def liquefy(model: DiscState, onset: Onset) -> None:
    """Start the liquefaction of discs, at degree 0 until `set_share`.

    Discs whose liquefaction began earlier are unchanged. The present overburden and density are the reference of the
    pore pressure.

    Parameters
    ----------
    model : soil discs; their fields and pairs of liquefied ground are changed
    onset : discs that liquefy, with overburden and residual strength

    Raises
    ------
    ValueError
        For discs with the law "paper", and for a period shorter than three times the reach of the pore water.
    """
    if model.law != "soil":
        raise ValueError(
            "discs: the laws of liquefied ground need law='soil'; with law='paper', liquefaction reduces the springs"
        )
    reach = model.reach or 2.0 * REACH * float(model.radius[~model.fixed].mean())
    if model.period is not None and model.period[0] < FEWEST_COLUMNS * (reach + model.skin):
        raise ValueError(
            f"discs: liquefied ground needs a period of at least {FEWEST_COLUMNS * (reach + model.skin):.3g} m, "
            f"three times the range of its pore pressure kernel; it is {model.period[0]:g} m"
        )
    if not len(model.liquefied):
        model.liquefied = np.zeros((len(model), bond.FIELDS))
        model.strength_factor = np.ones(len(model))
        model.reach = reach
    wet, new = model.liquefied, onset.discs & ~is_liquefying(model)
    wet[:, bond.AREA] = np.where(wet[:, bond.AREA] > 0.0, wet[:, bond.AREA], onset.area)
    wet[new, bond.PRESSURE] = onset.pressure[new]
    wet[new, bond.STRENGTH] = onset.strength[new]
    wet[new, bond.STRAIN] = onset.strain[new]
    wet[new, bond.KNEE_STRENGTH] = np.broadcast_to(onset.knee, len(wet))[new]
    wet[new, bond.KNEE_STRAIN] = np.broadcast_to(onset.soft_to, len(wet))[new]
    wet[new, bond.STRATUM] = model.layer[new]
    wet[:, bond.AT_X], wet[:, bond.AT_Z] = model.x, model.z
    for k in np.unique(model.layer[new]):
        new_in_layer = new & (model.layer == k)
        wet[new_in_layer, bond.STIFFNESS] = WATER_STIFFNESS * float(onset.pressure[new_in_layer].mean())
    list_liquefied(model)
    model.bonds[new[model.liquefied_i] | new[model.liquefied_j], bond.EXTRA_SHARE_AT] = float(onset.peak)
    set_reference_density(model, new)
    speed = np.sqrt(wet[new, bond.STIFFNESS] * model.mass[new] / wet[new, bond.AREA])  # density times speed of sound
    wet[new, bond.VISCOSITY] = BULK_VISCOSITY * model.reach * speed


def set_reference_density(model: DiscState, discs: np.ndarray) -> None:
    """Set the density at which discs have the pore pressure of the onset to their present density.

    Discs at a free surface take the density of their layer.

    Parameters
    ----------
    model : discs with the fields of liquefied ground, which are changed
    discs (n,) : mask of the discs whose density is set
    """
    wet, density = model.liquefied, _densities(model)
    for k in np.unique(model.layer[discs]):
        in_layer = discs & (model.layer == k)
        middle = np.median(density[in_layer])
        wet[in_layer, bond.DENSITY] = np.where(
            density[in_layer] < LOOSEST_DENSITY * middle, LOOSE_DENSITY * middle, density[in_layer]
        )
    wet[discs, bond.PRESENT_DENSITY] = density[discs]


def longest_look(model: DiscState) -> tuple[float, int]:
    """Return the longest time for which forces of liquefied ground may be constant.

    The time is `LONGEST_INTERVAL` over the highest angular frequency of a disc on its bonds and pore water: the square
    of this frequency is twice the sum of their stiffness over the mass, as for contacts.

    Parameters
    ----------
    model : discs with the fields of liquefied ground

    Returns
    -------
    The time (s), and the number of the disc that limits it; (inf, -1) without liquefied ground.
    """
    which = np.flatnonzero(is_liquefying(model))
    if not len(which):
        return np.inf, -1
    wet = model.liquefied[which]
    steepest = (1.0 - wet[:, bond.KNEE_STRENGTH]) / (1.0 - wet[:, bond.KNEE_STRAIN])
    strain = np.where(wet[:, bond.KNEE_STRAIN] > 0.0, STRAINING_SHARE, 1.0) * wet[:, bond.STRAIN]
    bonds = BOND_STIFFNESS_SUM * BOND_LIMIT * steepest * wet[:, bond.STRENGTH] / strain
    square = 2.0 * (bonds + WATER_STIFFNESS_SUM * wet[:, bond.STIFFNESS]) * wet[:, bond.AREA]
    square /= model.mass[which] * model.reach**2
    highest = int(np.argmax(square))
    return float(LONGEST_INTERVAL / np.sqrt(square[highest])), int(which[highest])


def steps_between_looks(model: DiscState, dt: float) -> int:
    """Return the number of time steps for which forces of liquefied ground are constant.

    Parameters
    ----------
    model : discs with the fields of liquefied ground
    dt : time step (s)

    Returns
    -------
    `BALANCED_INTERVAL` times the longest time of `longest_look` over the step, from 1 to `MOST_STEPS`.
    """
    return int(np.clip(BALANCED_INTERVAL * longest_look(model)[0] / dt, 1, MOST_STEPS))


def _densities(model: DiscState) -> np.ndarray:
    """Return the density of the areas of discs (n,) at the last evaluation of the pairs; only valid for liquefied
    discs."""
    wet = model.liquefied
    x, z, area = (np.ascontiguousarray(wet[:, field]) for field in (bond.AT_X, bond.AT_Z, bond.AREA))
    return densities(x, z, area, model.liquefied_i, model.liquefied_j, model.reach, model.repeats)


def change_areas(model: DiscState, factor: np.ndarray) -> None:
    """Multiply the areas of discs with their voids by a factor (n,), for example where ground drains. The pore pressure
    changes accordingly."""
    if not len(model.liquefied):
        return
    model.liquefied[:, bond.AREA] *= factor
    liquefying = is_liquefying(model)
    model.liquefied[liquefying, bond.PRESENT_DENSITY] = _densities(model)[liquefying]


def is_liquefying(model: DiscState) -> np.ndarray:
    """Return which discs have begun to liquefy, to any degree.

    Parameters
    ----------
    model : discs, with or without liquefied ones

    Returns
    -------
    Mask (n,).
    """
    return model.liquefied[:, bond.STIFFNESS] > 0.0 if len(model.liquefied) else np.zeros(len(model), bool)


def set_share(model: DiscState, share: np.ndarray) -> None:
    """Set the degree of liquefaction of discs, 0 to 1.

    Parameters
    ----------
    model : discs after `liquefy`; their column SHARE is changed
    share (n,) : degree of liquefaction; of no effect for discs whose liquefaction has not begun
    """
    wet = model.liquefied
    wet[:, bond.SHARE] = np.where(is_liquefying(model), share, 0.0)


def change_strength(model: DiscState, factor: np.ndarray) -> None:
    """Multiply the strength of liquefied discs by a factor; the stiffness of their bonds is unchanged.

    Parameters
    ----------
    model : discs after `liquefy`; strength (Pa) and strain of their bonds are changed
    factor (n,) : factor for each disc
    """
    model.liquefied[:, bond.STRENGTH] *= factor
    model.liquefied[:, bond.STRAIN] *= factor


def set_bonds(
    model: DiscState, discs: np.ndarray, strength: np.ndarray, strain: np.ndarray, knee: np.ndarray, soft_to: np.ndarray
) -> None:
    """Give bonds the law of ground that liquefies.

    Bonds keep their displacement, and so their force, if no stiffness changes and their strength allows it.

    Parameters
    ----------
    model : discs after `liquefy`; fields and history of their bonds are changed
    discs (n,) : mask of the discs whose law changes
    strength (n,) : strength (Pa), without the factor of `match_strength`
    strain (n,) : strain of bonds at which the strength is reached
    knee, soft_to (n,) : see `Onset`
    """
    wet, pairs, factor = model.liquefied, np.array([model.liquefied_i, model.liquefied_j]), model.strength_factor
    before = limiting_strains(wet, pairs)
    fields = (bond.STRENGTH, bond.STRAIN, bond.KNEE_STRENGTH, bond.KNEE_STRAIN)
    for column, values in zip(fields, (strength * factor, strain * factor, knee, soft_to), strict=True):
        wet[discs, column] = values[discs]
    ratio = before / limiting_strains(wet, pairs)
    model.bonds[:, [bond.ALONG_AT, bond.ACROSS_AT]] *= ratio[:, None]
    model.bonds[:, bond.LIMIT_ENERGY_AT] /= ratio * ratio


def pressure_forces(model: DiscState) -> np.ndarray:
    """Return the force of the pore pressure on the diameter of each disc that has liquefied.

    Parameters
    ----------
    model : discs, with or without liquefied ones

    Returns
    -------
    Force (discs whose liquefaction has begun,) in N per metre: diameter times degree of liquefaction times effective
    overburden; empty without liquefied discs.
    """
    if not len(model.liquefied):
        return np.zeros(0)
    which = is_liquefying(model)
    wet = model.liquefied[which]
    return np.asarray(2.0 * model.radius[which] * wet[:, bond.SHARE] * wet[:, bond.PRESSURE])
