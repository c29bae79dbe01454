"""Finds contacts with which discs have the stiffness and strength of each stratum, from the strength map. A stratum is
represented by the stress in its middle; see `soil_contacts`.
"""

from dataclasses import dataclass

from dem.laboratory.element_table import middle_stresses
from dem.laboratory.soil_contacts import SoilContacts, soil_contacts
from dem.springs import LayerSprings
from meshes.section.section import Section, Stratum


@dataclass(frozen=True)
class SoilLayer(SoilContacts):
    """Holds the required strength of a stratum, and the contacts with which random discs come closest to it.

    Attributes
    ----------
    stratum : the soil of the stratum
    """

    stratum: Stratum

    def springs(self, radius: float, void_ratio: float) -> LayerSprings:
        """Return the constants of discs of a given mean radius (m) in a packing of a given void ratio."""
        s = self.stratum
        return self.discs(s.name, s.density_seismic, radius, void_ratio, buoyant_density=s.density_ordinary)


def soil_layers(section: Section) -> list[SoilLayer]:
    """Fit contacts of discs to every stratum of a section.

    Parameters
    ----------
    section : Section
        The strata; a cohesion that varies is replaced by its mean over the stratum.

    Returns
    -------
    list of SoilLayer
        Contacts of the strata, from the top down.
    """
    strata = section.cohesion_field.means()
    stresses = middle_stresses(section)
    typical = float(stresses[stresses > 0.0].min()) if (stresses > 0.0).any() else 1e4
    return [_fitted(s, float(v) if v > 0.0 else typical) for s, v in zip(strata, stresses, strict=True)]


def _fitted(stratum: Stratum, stress: float) -> SoilLayer:
    contacts = soil_contacts(stratum.cohesion, stratum.friction_angle, stress, stratum.youngs_modulus)
    return SoilLayer(**vars(contacts), stratum=stratum)
