"""What liquefaction takes from layers, and what strength it leaves them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dem.ground import Ground
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

    residual: cohesion of a contact (N) that each liquefied layer of soil discs keeps. Overlap is limited in soil discs
    alone, which stiffen where they are deep in each other; the paper's may go through each other.
    """
    out = []
    for k, layer in enumerate(layers):
        if case is not None and k in which:
            power = [float(max(factor, 1e-12) ** share) if share < 1.0 else factor for factor in
                     (case.stiffness, case.damping, case.friction)]  # fmt: skip
            kept = layer.contact_cohesion * (1.0 - share * (1.0 - case.cohesion)) + share * (residual or {}).get(k, 0.0)
            layer = replace(layer.liquefied(*power), contact_cohesion=kept)
        out.append(layer if layer.stop > 0.0 else replace(layer, allowed_overlap=NO_LIMIT))
    return out


def residual_cohesion(model: DiscModel, ground: Ground, strata: Sequence[int], case: Case | None) -> dict[int, float]:
    """Cohesion of a contact (N) with which strata without friction keep the residual strength of a case.

    The vertical stress is that in the middle of the stratum where it is most, of the discs above it; what strength
    contacts of some cohesion have stands in `strength_map`.
    """
    ratios = {} if case is None else {k: case.residual_of(model.springs.layers[k].name) for k in strata}
    if not any(ratios.values()):
        return {}
    free = ~model.fixed
    x, z = ground.to_section(model.x[free], model.z[free])
    column = ((x - x.min()) / (8.0 * ground.radius)).astype(int)
    down = np.array(model.gravity) / np.hypot(*model.gravity)
    weight = (model.mass * (down @ np.array(model.pull)))[free] / (8.0 * ground.radius)
    layer = model.layer[free]
    found = {}
    for k in strata:
        most = 0.0
        for c in np.unique(column[layer == k]):
            here = column == c
            middle = float(np.median(z[here & (layer == k)]))
            most = max(most, float(weight[here & (z > middle)].sum()))
        found[k] = strength_map().residual_cohesion(ratios[k], most) * 2.0 * ground.radius
    return found


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
        f"would: {listed} cannot be weaker than that, and a layer that is slides further"
    ]
