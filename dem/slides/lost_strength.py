"""What liquefaction takes from layers, and what strength it leaves them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from dem.laboratory.strength_map import strength_map
from dem.model import DiscModel
from dem.settings import Case
from dem.springs import LayerSprings

NO_LIMIT = 2.0  # overlap over radius: soft layers let the paper's discs go through each other


def liquefied(
    layers: list[LayerSprings],
    which: list[int],
    case: Case | None,
    share: float = 1.0,
    residual: Mapping[int, float] | None = None,
) -> list[LayerSprings]:
    """The layers with some of them liquefied; share < 1: on the way, factors to that power.

    residual: friction that each liquefied layer keeps at least, see `residual_friction`. Overlap is limited in soil
    discs alone, which stiffen where they are deep in each other; the paper's may go through each other.
    """
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            power = [float(max(factor, 1e-12) ** share) if share < 1.0 else factor for factor in
                     (case.stiffness, case.damping, case.friction)]  # fmt: skip
            cohesion = layer.contact_cohesion * (1.0 - share * (1.0 - case.cohesion))
            gone = layer.liquefied(*power)
            friction = max(gone.friction, (residual or {}).get(k, 0.0))
            layer = replace(gone, friction=friction, contact_cohesion=cohesion)
        out.append(layer if layer.stop > 0.0 else replace(layer, allowed_overlap=NO_LIMIT))
    return out


def residual_friction(model: DiscModel, strata: Sequence[int], case: Case | None) -> dict[int, float]:
    """mu of contacts with which strata of soil discs keep the residual strength of a case; none for the paper's discs.

    A strength over the vertical effective stress is friction: it is the same share of it at every depth, and for discs
    of every size, and follows the ground's own weight as that moves.
    """
    if case is None or model.law != "soil":
        return {}
    return {k: strength_map().residual_friction(case.residual_of(model.springs.layers[k].name)) for k in strata}


def held_by_geometry(model: DiscModel, strata: Sequence[int], case: Case) -> list[str]:
    """A sentence on soil discs that cannot be as weak as the case has them, or none."""
    least = strength_map().least
    names = [model.springs.layers[k].name for k in strata]
    weaker = [name for name in names if case.residual_of(name) < least]
    if model.law != "soil" or case.friction > 0.0 or case.cohesion > 0.0 or not weaker:
        return []
    listed = ", ".join(f'"{name}"' for name in weaker)
    return [
        f"discs without friction and cohesion still hold by their geometry, as {least:.2f} of their vertical stress "
        f"would: {listed} cannot be weaker than that, and a layer that is slides further; "
        "thin ones hold more, so that smaller discs slide further than these (noshiro converge)"
    ]
