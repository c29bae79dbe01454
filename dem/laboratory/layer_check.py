"""Stores the comparison of a layer of soil with its discs."""

# ruff: noqa: N815 (units are written as they are)

from dataclasses import dataclass


@dataclass(frozen=True)
class LayerCheck:
    """Compares a stratum with its discs at three confining pressures.

    Each number is a mean over several random packings, or None if it is missing.

    Attributes
    ----------
    stratum : name of the stratum
    pressures_Pa, strength_soil_Pa, strength_discs_Pa, peak_discs_Pa (3,) : confining pressures, and half the deviator
        stress: of the soil at failure, of the discs after their peak, and of the discs at the peak of their mean curve
    E_soil_Pa, E_discs_Pa : Young's modulus of the soil, and of the discs at small strain
    c_soil_Pa, c_discs_Pa, phi_soil_deg, phi_discs_deg : Mohr-Coulomb parameters. The parameters of the discs follow
        from their strengths after the peak, with c = 0 where the soil has no cohesion.
    dilation_deg : dilation angle of the discs at the peak
    friction, cohesion_N, stiffness_N_m : friction mu, cohesion C and stiffness kn of the contacts
    notes : notes on properties of the soil that discs cannot have, and on tests that failed
    """

    stratum: str
    pressures_Pa: tuple[float, ...]
    strength_soil_Pa: tuple[float, ...]
    strength_discs_Pa: tuple[float | None, ...]
    peak_discs_Pa: tuple[float | None, ...]
    E_soil_Pa: float
    E_discs_Pa: float | None
    c_soil_Pa: float
    c_discs_Pa: float | None
    phi_soil_deg: float
    phi_discs_deg: float | None
    dilation_deg: float | None
    friction: float
    cohesion_N: float
    stiffness_N_m: float
    notes: tuple[str, ...]
