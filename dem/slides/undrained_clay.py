"""Undrained clay of soil discs: its volume is constant, and its strength is s_u at every strain.

Contacts with cohesion hold clay while it is at rest, but once they break, a packing of discs keeps some friction, and
parts where it dilates. So clay that may flow takes the laws of liquefied ground (`dem.liquefied_ground`): pore pressure
by volume bears its weight, and bonds have the strength s_u. With contacts, slumps of clay let go at once ran 2.0, 0.63
and 0.90 of a continuum for γH/s_u of 5, 10 and 20, a vertical cut of γH/s_u = 3 moved by a fifth of its height.
"""

from dataclasses import replace

import numpy as np

from dem.engine.engine import Engine, largest_step
from dem.liquefied_ground import LEAST_STRAIN, MOST_STRAIN, Onset, liquefy, set_share
from dem.model import DiscModel
from dem.slides.liquefied_strength import SHEAR_MODULUS
from dem.slides.overburden import effective_overburden
from dem.slides.volume import area_with_voids

STEPS = 20  # in which contacts fade out
SHARE = 0.5  # of the stable step


def replace_contacts_of_clay(model: DiscModel, seconds: float) -> bool:
    """Replace the contacts of clay by pore pressure and bonds of its undrained strength; other layers keep theirs.

    Parameters
    ----------
    model
        Discs at rest; they are changed. Clay are layers with an undrained strength.
    seconds
        Time in which its contacts fade out (s).

    Returns
    -------
    bool
        Whether there is clay.

    Raises
    ------
    DemError
        If a run of the engine stops.
    """
    layers = list(model.springs.layers)
    clay = [k for k, layer in enumerate(layers) if layer.undrained_strength > 0.0]
    if not clay:
        return False
    discs = np.isin(model.layer, clay) & ~model.fixed
    liquefy(model, _state_of_clay(model, discs))
    for share in np.linspace(0.0, 1.0, STEPS + 1)[1:]:
        model.set_springs([replace(s, faded=float(share)) if k in clay else s for k, s in enumerate(layers)])
        set_share(model, np.where(discs, share, 0.0))
        Engine(dt=SHARE * largest_step(model).seconds, energies=False).run(model, seconds / STEPS)
    return True


def _state_of_clay(model: DiscModel, discs: np.ndarray) -> Onset:
    """What bears clay afterwards: its overburden as pore pressure, s_u, and the strain s_u/G at which s_u is reached.

    discs: mask (n,) of those of clay.
    """
    layers = model.springs.layers
    strength, modulus = np.zeros(len(model)), np.ones(len(model))
    for k, layer in enumerate(layers):
        here = discs & (model.layer == k)
        strength[here], modulus[here] = layer.undrained_strength, SHEAR_MODULUS * layer.kn
    strain = np.clip(strength / modulus, LEAST_STRAIN, MOST_STRAIN)
    return Onset(discs, area_with_voids(model), effective_overburden(model), strength, strain)
