"""What liquefaction takes from layers, and what strength it leaves them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from dem.ground import Ground
from dem.laboratory.soil_contacts import constant_strength_contacts
from dem.laboratory.strength_map import ContactStrength, strength_map
from dem.model import DiscModel
from dem.settings import Case
from dem.springs import LayerSprings, Strength
from meshes.section.overburden import mean_effective_stress

MORE = 1.25  # times the residual strength, from which on it is told that discs hold more
NOTHING = Strength(0.0)
NO_LIMIT = 2.0  # overlap over radius: soft layers let the paper's discs go through each other


def liquefied(
    layers: list[LayerSprings],
    which: list[int],
    case: Case | None,
    share: float = 1.0,
    residual: Mapping[int, Strength] | None = None,
) -> list[LayerSprings]:
    """The layers with some of them liquefied; share < 1: on the way, factors to that power.

    residual: what contacts of each liquefied layer keep at least, see `residual_contacts`. Overlap is limited in soil
    discs alone, which stiffen where they are deep in each other; the paper's may go through each other.
    """
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            power = [float(max(factor, 1e-12) ** share) if share < 1.0 else factor for factor in
                     (case.stiffness, case.damping_left, case.friction)]  # fmt: skip
            gone = layer.liquefied(*power)
            cohesion = layer.contact_cohesion * (1.0 - share * (1.0 - case.cohesion))
            kept = (residual or {}).get(k, NOTHING)
            if kept.cohesion > 0.0:
                friction = layer.friction + share * (kept.friction - layer.friction)
                cohesion = max(cohesion, layer.contact_cohesion + share * (kept.cohesion - layer.contact_cohesion))
            else:
                friction = max(gone.friction, kept.friction)
            layer = replace(gone, friction=friction, contact_cohesion=cohesion)
        out.append(layer if layer.stop > 0.0 else replace(layer, allowed_overlap=NO_LIMIT))
    return out


def residual_contacts(
    model: DiscModel, ground: Ground, strata: Sequence[int], case: Case | None
) -> dict[int, Strength]:
    """What contacts hold with which strata of soil discs keep the residual strength of a case; none for the paper's.

    A strength over the vertical effective stress is friction: it is the same share of it at every depth, and for discs
    of every size, and follows the ground's own weight as that moves. A strength as such is cohesion, as a clay has it,
    for the confining pressures of the stratum.
    """
    if case is None or model.law != "soil":
        return {}
    found = {}
    for k in strata:
        name = model.springs.layers[k].name
        strength = case.strength_of(name)
        if strength > 0.0:
            fitted = _constant(ground, k, strength)
            found[k] = Strength(fitted.friction, fitted.cohesion * 2.0 * ground.radius)
        else:
            found[k] = Strength(strength_map().residual_friction(case.residual_of(name)))
    return found


def _constant(ground: Ground, stratum: int, strength: float) -> ContactStrength:
    """Contacts with this strength (Pa) at a quarter, a half and all of the mean effective stress of a stratum."""
    stress = strength if ground.section is None else mean_effective_stress(ground.section, stratum)
    return constant_strength_contacts(strength, stress)


def stronger_than_asked(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case) -> list[str]:
    """A sentence on every stratum whose discs hold more by their geometry than the strength that it shall keep."""
    told = []
    for k in strata if model.law == "soil" else ():
        name = model.springs.layers[k].name
        wanted = case.strength_of(name)
        kept = float(_constant(ground, k, wanted).expected[1]) if wanted > 0.0 else 0.0
        if kept > MORE * wanted:
            told.append(
                f'"{name}" is too weak for discs: in the middle of its stress discs keep {kept / 1e3:.2g} kPa for '
                f"{wanted / 1e3:.2g} kPa, by their geometry"
            )
    return told


def held_by_geometry(model: DiscModel, strata: Sequence[int], case: Case) -> list[str]:
    """A sentence on soil discs that cannot be as weak as the case has them, or none."""
    least = strength_map().least
    names = [model.springs.layers[k].name for k in strata]
    weaker = [name for name in names if case.residual_of(name) < least and not case.strength_of(name)]
    if model.law != "soil" or case.friction > 0.0 or case.cohesion > 0.0 or not weaker:
        return []
    listed = ", ".join(f'"{name}"' for name in weaker)
    return [
        f"discs without friction and cohesion still hold by their geometry, as {least:.2f} of their vertical stress "
        f"would: {listed} cannot be weaker than that, and a layer that is slides further; "
        "thin ones hold more, so that smaller discs slide further than these (noshiro converge)"
    ]
