"""The dimensionless numbers of contacts that govern a patch of soil discs, and the patch that has them.

Patches of equal numbers differ by their scale alone: their strength goes with the pressure, their modulus with kn, and
neither size nor weight of the discs counts. `strength_map` says which numbers there are.
"""

from typing import NamedTuple

import numpy as np

from dem.laboratory.patch import Sample
from dem.laboratory.soil_contacts import SoilContacts
from dem.laboratory.strength_map import strength_map
from dem.springs import ATTRACTION, ROLLING, Strength, soil_discs

RADIUS, PRESSURE, DENSITY = 0.75, 1e5, 2000.0  # m, Pa, kg/m3: patches of any others are scaled copies
# Steps of the numbers: of friction, of the binary logarithms of cohesion number and kappa, and of that of kappa without
# cohesion, where strength hardly depends on it.
FRICTIONS, DOUBLINGS, SAND_DOUBLINGS = 0.05, 0.5, 2.0


class ContactNumbers(NamedTuple):
    """Dimensionless numbers of contacts under a confining pressure p.

    Attributes
    ----------
    turns : bool
        Whether the discs turn.
    friction : float
        mu.
    cohesion : float
        Cohesion number C / (2 r p).
    kappa : float
        kn over the pressure and the pull of the contacts.
    """

    turns: bool
    friction: float
    cohesion: float
    kappa: float

    @classmethod
    def of(cls, contacts: SoilContacts, pressure: float) -> "ContactNumbers":
        """Those of the contacts of a soil at a confining pressure (Pa)."""
        pressed = pressure + ATTRACTION * contacts.cohesion
        return cls(contacts.turns, contacts.friction, contacts.cohesion / pressure, contacts.stiffness / pressed)

    @property
    def nearest(self) -> "ContactNumbers":
        """The numbers at the nearest steps: contacts that are much alike have the same."""
        doublings = DOUBLINGS if self.cohesion > 0.0 else SAND_DOUBLINGS
        cohesion = _step(self.cohesion, DOUBLINGS) if self.cohesion > 0.0 else 0.0
        friction = round(FRICTIONS * round(self.friction / FRICTIONS), 9)
        return self._replace(friction=friction, cohesion=cohesion, kappa=_step(self.kappa, doublings))

    @property
    def stiffness(self) -> float:
        """kn over the pressure."""
        return self.kappa * (1.0 + ATTRACTION * self.cohesion)

    @property
    def strength(self) -> float:
        """Half the deviator after the peak over the pressure, by the map."""
        table, one = strength_map(self.turns), np.ones(1)
        by_softness = table.gained_by_softness(self.stiffness, one, self.cohesion)
        return float((table.strength(self.friction, self.cohesion, one) * by_softness)[0])

    @property
    def modulus(self) -> float:
        """Young's modulus in plane strain over kn, by the map."""
        return strength_map(self.turns).modulus_over_kn(self.friction, self.cohesion, self.kappa)

    def sample(self, seed: int, allowed_overlap: float = 1.0) -> Sample:
        """A random patch with these numbers at `PRESSURE`.

        ``seed``: of its packing; ``allowed_overlap``: over the mean radius, at which a test is stopped.
        """
        strength = Strength(self.friction, self.cohesion * 2.0 * RADIUS * PRESSURE, ROLLING if self.turns else np.inf)
        layer = soil_discs(
            "patch", self.stiffness * PRESSURE, strength, DENSITY, DENSITY, RADIUS, 0.0, allowed_overlap=allowed_overlap
        )
        return Sample(layer, "random", RADIUS, seed, law="soil")


def _step(value: float, doublings: float) -> float:
    """The nearest of the numbers that are so many doublings apart from each other, 1 among them."""
    return float(2.0 ** (doublings * round(float(np.log2(value)) / doublings)))
