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
    elastic_strain,
    is_liquefying,
    set_bonds,
)
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.slides.edge_strength import edge_shares
from dem.springs import Law, LayerSprings
from meshes.section.section import Section
from meshes.section.strain_potential import REGAINING_STRAIN, soft_range

# Strain of bonds over that of soft ground, in which discs do not follow the mean motion: with the strain of the ground
# crusts move 1.2 to 1.3 times as far as in closed form.
SOFT_BOND_SHARE = 0.82
NO_LIMIT = 2.0  # overlap over radius: soft layers let the paper's discs go through each other
NO_STRENGTH = 1e-6  # Pa
NO_STRAIN = 1e-9
WHOLE = Case(friction=1.0, cohesion=1.0)  # ground before liquefaction


def liquefied(
    layers: list[LayerSprings], which: list[int], case: Case | None, share: float = 1.0
) -> list[LayerSprings]:
    """Return the springs of all layers of discs with the law "paper" when some have liquefied to the degree ``share``.

    Springs are multiplied by the factors of the case to the power of the share, and their overlap is not limited.
    which: numbers of the layers that liquefy.
    """
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            factors = (case.stiffness, case.damping_left, case.friction)
            layer = layer.liquefied(*(float(max(f, 1e-12) ** share) if share < 1.0 else f for f in factors))
        out.append(replace(layer, allowed_overlap=NO_LIMIT))
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


def residual(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> Onset:
    """Return the state of soil discs after liquefaction: overburden, and residual strength by the case.

    Near the lower edge of a layer the strength is reduced, so that the layer slips at this edge (`edge_shares`). The
    strength s is reached at a shear strain s/G, with the shear modulus G by the case, but at most at a strain
    `LARGEST_STRAIN` of bonds; ground with a strain potential reaches s only beyond its soft range
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
            soft = soft_range(remaining.strain_potential, pressure[in_layer], wanted[in_layer])
            of_bonds = SOFT_BOND_SHARE * soft.strain
            strain[in_layer] = BOND_STRAIN_RATIO * (of_bonds + REGAINING_STRAIN)
            knee[in_layer] = soft.stress / wanted[in_layer]
            soft_to[in_layer] = of_bonds / (of_bonds + REGAINING_STRAIN)
    return Onset(discs, area, pressure, strength, strain, knee, soft_to)


def before_liquefaction(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> Onset:
    """Return the state of sand before liquefaction, whose strength is p tan phi + c, with the effective overburden p,
    and at least the residual strength; without a section, which has phi and c, the strength is p.

    The stiffness of its bonds is that after liquefaction, as far as the strain `LARGEST_STRAIN` allows; ground with a
    strain potential has the shear modulus of its stratum.

    Parameters
    ----------
    model : the discs at rest
    ground : the ground in which the discs lie
    strata : numbers of the strata that liquefy
    case : stiffness and strength after liquefaction

    Returns
    -------
    The state of all discs; strength in Pa.
    """
    after = residual(model, ground, strata, case)
    known = ground.section is not None
    strength = _strength_by_case(model, ground, strata, WHOLE).strength if known else after.pressure
    strength = np.maximum(strength, after.strength)
    soft = np.broadcast_to(after.soft_to, len(model)) > 0.0
    same_stiffness = after.strain * strength / np.maximum(after.strength, NO_STRENGTH)
    strain = np.where(soft, elastic_strain(model, np.maximum(strength, NO_STRENGTH)), same_stiffness)
    strain = np.clip(strain, SMALLEST_STRAIN, LARGEST_STRAIN)
    return after._replace(strength=strength, strain=strain, knee=0.0, soft_to=0.0)


class Weakening:
    """Lowers the strength of strata that liquefy, from that of the discs at the start to the residual strength.

    Parameters
    ----------
    start : discs at rest, whose strata that liquefy have the laws of liquefied ground already: clay by
        `dem.search.undrained_clay`, sand by `dem.slides.before_liquefaction`
    ground : the ground in which the discs lie
    strata : numbers of the strata that liquefy
    case : stiffness and strength after liquefaction
    """

    def __init__(self, start: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> None:
        wet, factor = start.liquefied, start.strength_factor
        self.layer, self.discs = start.layer, is_liquefying(start) & np.isin(start.layer, strata)
        self.strength, self.strain = wet[:, bond.STRENGTH] / factor, wet[:, bond.STRAIN] / factor
        after = residual(start, ground, strata, case)
        clay = np.array([*(layer.undrained_strength > 0.0 for layer in start.springs.layers), False])[start.layer]
        self.residual = np.where(clay, _strength_by_case(start, ground, strata, case).strength, after.strength)
        same_stiffness = self.strain * self.residual / np.maximum(self.strength, NO_STRENGTH)
        # of the strain after liquefaction, the strain potential and the rest; stress at the strain potential
        self.potential = np.where(clay, 0.0, after.strain * after.soft_to)
        self.regaining = np.where(clay, same_stiffness, after.strain) - self.potential
        self.at_potential = np.where(clay, 0.0, after.strength * after.knee)

    def apply(self, model: DiscModel, shares: Mapping[int, float]) -> None:
        """Set the strength of the strata by their degree of liquefaction, from 0 to 1; bonds keep their displacement.

        model: discs, which are changed; shares: degree of liquefaction by stratum.
        """
        degree = np.array([shares.get(k, 0.0) for k in range(len(model.springs.layers))] + [0.0])[self.layer]
        strength = self.strength + degree * (self.residual - self.strength)
        potential = degree * self.potential
        strain = np.maximum((1.0 - degree) * self.strain + degree * self.regaining, NO_STRAIN) + potential
        at_potential = degree * self.at_potential
        knee = at_potential / np.maximum(strength, NO_STRENGTH)
        set_bonds(model, self.discs, strength, strain, knee, potential / strain)


def _not_consolidated(model: DiscModel, ground: Ground) -> np.ndarray:
    """Return the part (n,) in Pa of the surcharges above discs under which the ground has not consolidated."""
    if ground.section is None:
        return np.zeros(len(model))
    loads, x = ground.section.surface_loads, ground.to_local(model.x, model.z)[0]
    return loads.pressure(x, x) - loads.consolidated(x, x)
