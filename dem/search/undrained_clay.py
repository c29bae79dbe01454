"""Models undrained clay by soil discs. The volume of the clay is constant, and its strength is s_u at every strain.

Contacts with cohesion hold clay while discs are filled in. But once the contacts break, a packing of discs keeps some
friction, and parts of the packing dilate. Clay at rest therefore takes the laws of liquefied ground
(`dem.liquefied_ground`): pore pressure by volume carries its weight, and bonds have the strength s_u. With contacts,
the run-out of released clay columns was 2.0, 0.63 and 0.90 times that of a continuum for γH/s_u of 5, 10 and 20; and a
cutting in clay whose critical Kh is 0.129 to 0.134 by strict bounds failed at 0.12 to 0.24, by packing. With the laws
of liquefied ground the same cutting fails at 0.15 to 0.16. Stresses are in Pa.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dem.disc_area import area_with_voids
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.ground import Ground
from dem.laboratory.soil_contacts import rock_strength
from dem.liquefied_ground import (
    FADING_STEPS,
    LARGEST_STRAIN,
    SMALLEST_STRAIN,
    Onset,
    change_strength,
    elastic_strain,
    is_liquefying,
    liquefy,
    set_share,
)
from dem.model import DiscModel
from dem.overburden import effective_overburden
from dem.springs import LayerSprings

STEP_SHARE = 0.5  # of the stable step


def replace_contacts_of_clay(model: DiscModel, seconds: float, ground: Ground | None = None) -> bool:
    """Replace the contacts of clay by pore pressure and bonds of its undrained strength; other layers keep theirs.

    Parameters
    ----------
    model : discs at rest, which are changed. Clay is every layer with an undrained strength.
    seconds : time in which the contacts of clay fade out (s)
    ground : packing of the discs and its place in a section, whose clay may be stronger at one place than at another;
        None for clay of one strength

    Returns
    -------
    Whether there is clay.

    Raises
    ------
    DemError : if a run of the engine stops
    """
    layers = list(model.springs.layers)
    clay = [k for k, layer in enumerate(layers) if layer.undrained_strength > 0.0]
    if not clay:
        return False
    discs = np.isin(model.layer, clay) & ~model.fixed
    liquefy(model, _state_of_clay(model, discs, undrained_strength(model, ground)))
    for share in np.linspace(0.0, 1.0, FADING_STEPS + 1)[1:]:
        model.set_springs([replace(s, faded=float(share)) if k in clay else s for k, s in enumerate(layers)])
        set_share(model, np.where(discs, share, 0.0))
        Engine(dt=STEP_SHARE * largest_step(model).seconds, energies=False).run(model, seconds / FADING_STEPS)
    return True


def set_strengths(model: DiscModel, layers: Sequence[LayerSprings]) -> None:
    """Give the discs of every layer new constants. The strength of the bonds of clay is multiplied by the ratio of the
    new to the old undrained strength.

    model: discs, which are changed; layers: their new constants.
    """
    before = np.array([layer.undrained_strength for layer in model.springs.layers])
    after = np.array([layer.undrained_strength for layer in layers])
    model.set_springs(list(layers))
    clay = is_liquefying(model) & (before > 0.0)[model.layer]
    if clay.any():
        change_strength(model, np.where(clay, (after / np.where(before > 0.0, before, 1.0))[model.layer], 1.0))


def undrained_strength(model: DiscModel, ground: Ground | None = None) -> np.ndarray:
    """Return the undrained strength s_u (n,) of all discs of clay in Pa, and 0 for other discs. The parameters are
    explained in `replace_contacts_of_clay`.

    Clay that is as strong as rock at some places has the strength of rock (`rock_strength`) there.
    """
    layers = model.springs.layers
    strength = np.append([layer.undrained_strength for layer in layers], 0.0)[model.layer]
    if ground is None or ground.section is None:
        return strength
    section, discs_of_clay = ground.section, np.flatnonzero((strength > 0.0) & ~model.fixed)
    points = np.column_stack(ground.to_local(model.x[discs_of_clay], model.z[discs_of_clay]))
    field = section.cohesion_field
    means = np.array([soil.cohesion for soil in field.means()])[model.layer[discs_of_clay]]
    strength[discs_of_clay] = np.minimum(
        strength[discs_of_clay] * field.at(points, points, model.layer[discs_of_clay]) / means, rock_strength(section)
    )
    return strength


def _state_of_clay(model: DiscModel, discs: np.ndarray, strength: np.ndarray) -> Onset:
    """Return the pore pressure (overburden), the undrained strength s_u, and the strain of bonds at which clay reaches
    s_u, at a shear strain s_u/G.

    discs: mask (n,) of the discs of clay; strength: s_u (n,) of the discs.
    """
    strain = np.clip(elastic_strain(model, strength), SMALLEST_STRAIN, LARGEST_STRAIN)
    return Onset(discs, area_with_voids(model), effective_overburden(model), strength, strain, peak=False)
