"""Computes the constants of liquefied layers, and the residual strength of soil discs."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dem.case import Case, RemainingStrength
from dem.disc_area import area_with_voids
from dem.ground import Ground
from dem.kernels import liquefied_pairs as bond
from dem.liquefied_ground import (
    BOND_STRAIN_RATIO,
    LARGEST_STRAIN,
    SMALLEST_STRAIN,
    Onset,
    change_strength,
    elastic_strain,
    is_liquefying,
)
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.slides.edge_strength import edge_shares
from dem.springs import Law, LayerSprings
from meshes.section.section import Section
from meshes.section.strain_potential import REGAINING_STRAIN, stress_at_potential

NO_LIMIT = 2.0  # overlap over radius: soft layers let the paper's discs go through each other
NO_STRENGTH = 1e-6  # Pa
ROUNDING = 1e-12  # smallest relative change of a strength


def liquefied(
    layers: list[LayerSprings], which: list[int], case: Case | None, share: float = 1.0, law: Law = "paper"
) -> list[LayerSprings]:
    """Return the springs of all layers when some have liquefied to the degree ``share``.

    Springs of discs with the law "paper" are multiplied by the factors of the case to the power of the share, and their
    overlap is not limited. Contacts of soil discs fade out, since pore water then carries the load
    (`dem.liquefied_ground`). which: numbers of the layers that liquefy; law: contact law.
    """
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            if law == "soil":
                layer = replace(layer, faded=max(share, layer.faded))
            else:
                factors = (case.stiffness, case.damping_left, case.friction)
                layer = layer.liquefied(*(float(max(f, 1e-12) ** share) if share < 1.0 else f for f in factors))
        out.append(layer if law == "soil" else replace(layer, allowed_overlap=NO_LIMIT))
    return out


def effect_of(case: Case, section: Section, strata: Sequence[int], law: Law) -> Hashable:
    """Return all parameters of the discs that a case changes.

    Two cases with equal parameters have the same slide, to the last bit. For discs with the law "paper" the changed
    parameters are the factors of the case. For soil discs they are the residual strength of each stratum, and its
    stiffness unless it follows from a strain potential (see `onset`).

    Parameters
    ----------
    case : stiffness and strength after liquefaction
    section : the ground
    strata : numbers of the strata that liquefy
    law : contact law of the discs

    Returns
    -------
    Parameters, to be compared with those of another case.
    """
    felt = tuple(strata), case.volumetric_strain, bool(case.residual or case.residual_strength)  # notes name the last
    if law == "paper":
        return *felt, case.stiffness, case.damping_left, case.friction
    remains_of = [case.remains_of(section, k) for k in strata]
    return *felt, tuple((remains, 0.0 if remains.strain_potential else case.stiffness) for remains in remains_of)


class _StrengthByCase(NamedTuple):
    """Holds the residual strength of discs by a case of liquefaction; arrays of all discs, 0 where nothing liquefies.

    Attributes
    ----------
    pressure (n,) : effective overburden (Pa)
    strength (n,) : residual strength (Pa)
    increase (n,) : increase of this strength with the overburden (-)
    remains : what each stratum retains, by its number
    """

    pressure: np.ndarray
    strength: np.ndarray
    increase: np.ndarray
    remains: Mapping[int, RemainingStrength]


def _strength_by_case(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> _StrengthByCase:
    """Return the residual strength of discs: a ratio of the vertical effective stress at present, a stress, or shares
    of the friction and cohesion of the soil (`Case.remains_of`)."""
    pressure, section = effective_overburden(model), ground.section
    consolidated = pressure - _not_consolidated(model, ground)
    strength, increase = np.zeros(len(model)), np.zeros(len(model))
    remains: dict[int, RemainingStrength] = {}
    for k in strata:
        in_layer = model.layer == k
        remaining = remains[k] = (
            case.residual_remains(model.springs.layers[k].name) if section is None else case.remains_of(section, k)
        )
        increase[in_layer] = remaining.residual
        if section is not None:
            soil = section.cohesion_field.means()[k]
            strength[in_layer] = (
                remaining.friction * np.tan(soil.friction_angle) * pressure[in_layer]
                + remaining.cohesion * soil.cohesion
            )
            increase[in_layer] += remaining.friction * np.tan(soil.friction_angle)
        strength[in_layer] += remaining.residual * np.maximum(consolidated[in_layer], 0.0) + remaining.strength
    return _StrengthByCase(pressure, strength, increase, remains)


def onset(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> Onset:
    """Return the state of soil discs at the onset of liquefaction: overburden, and residual strength by the case.

    Near the lower edge of a layer the strength is reduced, so that the layer slips at this edge (`edge_shares`). The
    strength s is reached at a shear strain s/G, with the shear modulus G by the case, but at most at a strain
    `LARGEST_STRAIN` of bonds; ground with a strain potential reaches s only beyond this potential
    (`meshes.section.strain_potential`). model: model of the discs; ground: the ground in which the discs lie; strata:
    numbers of those that liquefy; case: stiffness and strength after liquefaction.
    """
    pressure, strength, increase, remains = _strength_by_case(model, ground, strata, case)
    area, discs = area_with_voids(model), np.isin(model.layer, strata) & ~model.fixed
    strength = strength * edge_shares(model, discs, strength, increase, pressure, area)
    knee, soft_to = np.zeros(len(model)), np.zeros(len(model))
    wanted = np.maximum(strength, NO_STRENGTH)
    elastic = elastic_strain(model, wanted) / case.stiffness
    strain = np.maximum(elastic * LARGEST_STRAIN / (elastic + LARGEST_STRAIN), SMALLEST_STRAIN)
    for k, remaining in remains.items():
        if remaining.strain_potential > 0.0:
            in_layer = model.layer == k
            strain[in_layer] = BOND_STRAIN_RATIO * (remaining.strain_potential + REGAINING_STRAIN)
            knee[in_layer] = stress_at_potential(pressure[in_layer], wanted[in_layer]) / wanted[in_layer]
            soft_to[in_layer] = remaining.strain_potential / (remaining.strain_potential + REGAINING_STRAIN)
    return Onset(discs, area, pressure, strength, strain, knee, soft_to)


def weaken_clay(model: DiscModel, start: DiscModel, ground: Ground, shares: Mapping[int, float], case: Case) -> None:
    """Lower the strength of clay in strata that liquefy from s_u to the residual strength of the case, by their degree
    of liquefaction. Clay has the laws of liquefied ground already (`dem.search.undrained_clay`).

    model: discs, which are changed; start: discs at the start; ground: the ground in which the discs lie; shares:
    degree of liquefaction by stratum; case: strength after liquefaction.
    """
    clay = is_liquefying(start) & np.isin(start.layer, list(shares))
    if not clay.any():
        return
    before = start.liquefied[clay, bond.STRENGTH] / start.strength_factor[clay]
    after = _strength_by_case(start, ground, list(shares), case).strength[clay]
    share = np.array([shares[k] for k in start.layer[clay]])
    factor = np.ones(len(model))
    wanted = (before + share * (after - before)) * model.strength_factor[clay]
    change = wanted / model.liquefied[clay, bond.STRENGTH]
    factor[clay] = np.where(np.abs(change - 1.0) > ROUNDING, change, 1.0)  # the same bits if it is repeated
    change_strength(model, factor)


def degrees_of_discs(start: DiscModel, shares: Mapping[int, float]) -> np.ndarray:
    """Return the degree of liquefaction (n,) of all discs from those of the strata: fixed discs have none, and clay,
    whose contacts are replaced from the ``start``, has all of it."""
    degree = np.ones(len(start))
    for k, share in shares.items():
        degree[(start.layer == k) & ~is_liquefying(start)] = share
    return np.where(start.fixed, 0.0, degree)


def _not_consolidated(model: DiscModel, ground: Ground) -> np.ndarray:
    """Return the part (n,) in Pa of the surcharges above discs under which the ground has not consolidated."""
    if ground.section is None:
        return np.zeros(len(model))
    loads, x = ground.section.surface_loads, ground.to_local(model.x, model.z)[0]
    return loads.pressure(x, x) - loads.consolidated(x, x)
