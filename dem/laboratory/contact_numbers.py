"""Defines the dimensionless numbers of contacts that govern a patch of soil discs.

Two patches whose contacts have equal dimensionless numbers behave alike, except for the scales of stress and length.
The strength of a patch is proportional to the pressure and the modulus to kn; size and weight of the discs have no
influence. The module `strength_map` describes the dimensionless numbers.
"""

from typing import NamedTuple

import numpy as np

from dem.laboratory.patch import PatchSample
from dem.laboratory.soil_contacts import SoilContacts
from dem.laboratory.strength_map import strength_map
from dem.springs import ATTRACTION, ROLLING, Strength, soil_discs

RADIUS, PRESSURE, DENSITY = 0.75, 1e5, 2000.0  # m, Pa, kg/m3: patches of any others are scaled copies
# Steps of the numbers: of friction, of the binary logarithms of cohesion number and kappa, and of that of kappa without
# cohesion, where strength hardly depends on it.
FRICTIONS, DOUBLINGS, SAND_DOUBLINGS = 0.05, 0.5, 2.0


class ContactNumbers(NamedTuple):
    """Holds the dimensionless numbers of contacts under a confining pressure p.

    Attributes
    ----------
    turns : whether the discs rotate
    friction : friction coefficient mu
    cohesion : cohesion number C / (2 r p)
    kappa : stiffness number: kn over the sum of the pressure and the attraction of the contacts
    """

    turns: bool
    friction: float
    cohesion: float
    kappa: float

    @classmethod
    def of(cls, contacts: SoilContacts, pressure: float) -> "ContactNumbers":
        """Return the numbers of the contacts of a soil at a confining pressure (Pa)."""
        pressed = pressure + ATTRACTION * contacts.cohesion
        return cls(contacts.turns, contacts.friction, contacts.cohesion / pressure, contacts.stiffness / pressed)

    @property
    def nearest(self) -> "ContactNumbers":
        """Return the numbers rounded to steps, so that similar contacts have the same numbers."""
        doublings = DOUBLINGS if self.cohesion > 0.0 else SAND_DOUBLINGS
        cohesion = _step(self.cohesion, DOUBLINGS) if self.cohesion > 0.0 else 0.0
        friction = round(FRICTIONS * round(self.friction / FRICTIONS), 9)
        return self._replace(friction=friction, cohesion=cohesion, kappa=_step(self.kappa, doublings))

    @property
    def stiffness(self) -> float:
        """Return the contact stiffness kn over the pressure."""
        return self.kappa * (1.0 + ATTRACTION * self.cohesion)

    @property
    def strength(self) -> float:
        """Return half the deviator stress after the peak over the pressure, by the strength map."""
        table, unit = strength_map(self.turns), np.ones(1)
        by_softness = table.gained_by_softness(self.stiffness, unit, self.cohesion)
        return float((table.strength(self.friction, self.cohesion, unit) * by_softness)[0])

    @property
    def modulus(self) -> float:
        """Return Young's modulus in plane strain over kn, by the strength map."""
        return strength_map(self.turns).modulus_over_kn(self.friction, self.cohesion, self.kappa)

    def sample(self, seed: int, allowed_overlap: float = 1.0) -> PatchSample:
        """Return a random patch with these numbers at `PRESSURE`.

        ``seed``: seed of the packing; ``allowed_overlap``: overlap over the mean radius at which a test is stopped.
        """
        strength = Strength(self.friction, self.cohesion * 2.0 * RADIUS * PRESSURE, ROLLING if self.turns else np.inf)
        layer = soil_discs(
            "patch", self.stiffness * PRESSURE, strength, DENSITY, DENSITY, RADIUS, 0.0, allowed_overlap=allowed_overlap
        )
        return PatchSample(layer, "random", RADIUS, seed, law="soil")


def _step(value: float, doublings: float) -> float:
    """Return the number of a geometric series with a term of 1 that is nearest to a value; ``doublings``: logarithm to
    base 2 of the ratio of neighbouring terms.
    """
    return float(2.0 ** (doublings * round(float(np.log2(value)) / doublings)))
