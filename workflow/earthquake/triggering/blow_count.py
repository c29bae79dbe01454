"""Holds a standard penetration test with its stresses, and the resistance by a method of triggering.

Stresses in kPa, depths in m, fines and plasticity in percent, grain sizes in mm, as in the published relations.
"""

from dataclasses import dataclass

KPA = 1000.0  # Pa
ATMOSPHERE = 101.325  # kPa


@dataclass(frozen=True)
class BlowCount:
    """Holds the input of a triggering method on one test.

    Attributes
    ----------
    depth : depth below the ground (m)
    N : measured blows for 30 cm
    total, effective : vertical stresses before the earthquake (kPa); the total stress is that of the ground alone,
        without the water that stands on the ground
    fines : fines content (%)
    d50 : mean grain size (mm); None if not known
    plasticity : plasticity index (%); None if not known
    energy_ratio : energy ratio of the hammer (% of free fall); None for the common value of the settings
    """

    depth: float
    N: float
    total: float
    effective: float
    fines: float
    d50: float | None = None
    plasticity: float | None = None
    energy_ratio: float | None = None


@dataclass(frozen=True)
class SurfaceMotion:
    """Holds the earthquake as input of a method: ``peak`` acceleration over g at the surface, and magnitude."""

    peak: float
    magnitude: float


@dataclass(frozen=True)
class Resistance:
    """Holds the result of a method at a test: F_L = ``resistance`` / ``load``.

    Attributes
    ----------
    normalised : the blow count at an effective stress of one atmosphere, without correction for fines: (N1)60 or N1
    corrected : the same with correction for fines: (N1)60cs or Na; None if the method has none
    load : cyclic stress ratio of the earthquake
    resistance : cyclic resistance ratio of the soil in this earthquake
    """

    normalised: float
    corrected: float | None
    load: float
    resistance: float

    @property
    def factor(self) -> float:
        """Return F_L, at most 2, the end of the range of experience."""
        return min(2.0, self.resistance / self.load)
