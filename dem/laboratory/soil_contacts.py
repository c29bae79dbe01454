"""Finds contacts with which random discs have the cohesion and friction angle of a soil at a given stress, or of every
stratum of a section at the stress in its middle.

Strength is compared at a quarter, a half and all of the vertical effective stress. The required strength at a confining
pressure p is half the deviator stress at failure of Mohr-Coulomb, (p sin phi + c cos phi) / (1 - sin phi). For clay
without friction the required strength is c_u, and for sand it is p sin phi / (1 - sin phi).
"""

from dataclasses import dataclass, replace

import numpy as np

from dem.laboratory.element_table import SHARES, middle_stresses
from dem.laboratory.strength_map import EVEN_COHESION, ContactStrength, strength_map
from dem.springs import ROLLING, LayerSprings, Strength, soil_discs
from meshes.section.layering import middles
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum

# kn over the stress of the layer: below the first, strength falls; above the second, it does not depend on kn any more,
# and the time step falls. The second holds where no modulus is given, too.
SMALLEST_STIFFNESS, LARGEST_STIFFNESS = 200.0, 800.0
LEAST_RIGIDITY = 50.0  # E over strength; of clays some 150 to 1000
# kn over strength below which the contacts of cohesive ground open widely; it may then be stiffer than
# LARGEST_STIFFNESS.
FIRM_STIFFNESS = 200.0
STRENGTH_TOLERANCE = 0.09  # of the required strength
DILATION_SHARE = 0.45  # of mu squared: share of dilation in the friction of undisturbed sand
OVERLAP = 0.5  # of a radius, that soil discs may reach whatever softens
# Strength of rock and concrete over the largest total overburden: a vertical cut of the whole height stands with 0.26.
# Bonds that are stronger would be stiffer, too, and vibrate on a compliant base.
STRENGTH_MARGIN = 1.2
COLUMNS = 100  # of a section, in which that is found


@dataclass(frozen=True)
class SoilContacts:
    """Holds the contacts with which random discs come closest to a soil.

    Attributes
    ----------
    stress : float
        Vertical effective stress for which the contacts are fitted (Pa).
    pressures : (3,)
        Confining pressures at which strength is compared (Pa).
    required_strength : (3,)
        Half the deviator stress at failure of the soil at these pressures (Pa).
    expected_strength : (3,)
        Half the deviator stress at failure of the discs at these pressures, by the strength map (Pa).
    friction : float
        Friction coefficient mu of the contacts.
    cohesion : float
        Cohesion C of the contacts over the mean diameter (Pa).
    stiffness : float
        Normal stiffness kn of the contacts (N/m).
    turns : bool
        Whether the discs rotate: discs of soil with friction do, discs of clay do not.
    notes : tuple of str
        Sentences on properties of the soil that discs cannot have.
    """

    stress: float
    pressures: np.ndarray
    required_strength: np.ndarray
    expected_strength: np.ndarray
    friction: float
    cohesion: float
    stiffness: float
    turns: bool
    notes: tuple[str, ...]

    def strength(self, radius: float) -> Strength:
        """Return the strength of the contacts between discs of this mean radius (m)."""
        return Strength(self.friction, self.cohesion * 2.0 * radius, ROLLING if self.turns else np.inf)

    def discs(
        self,
        name: str,
        density: float,
        radius: float,
        void_ratio: float,
        *,
        buoyant_density: float | None = None,
    ) -> LayerSprings:
        """Return the constants of a layer of discs that behave like this soil.

        Parameters
        ----------
        name
            Name of the layer.
        density
            Density of the soil, saturated below water (kg/m3).
        radius
            Mean radius of the discs (m).
        void_ratio
            Area of voids over area of discs in the packing, so that the layer has the mass and the weight of the soil.
        buoyant_density
            Buoyant density of soil below water (kg/m3), for its weight; `density` if None.

        Returns
        -------
        LayerSprings
            Constants for `DiscMaterials` with law="soil".
        """
        weight = density if buoyant_density is None else buoyant_density
        strength = self.strength(radius)
        discs = soil_discs(name, self.stiffness, strength, density, weight, radius, void_ratio, allowed_overlap=OVERLAP)
        if not self.turns:
            return replace(discs, undrained_strength=float(self.required_strength[0]))
        return replace(discs, undisturbed_friction=self.undisturbed_friction)

    @property
    def undisturbed_friction(self) -> float:
        """Return the friction coefficient of contacts of undisturbed ground, see `dem.undisturbed_contacts`."""
        without_cohesion = max(1.0 - self.cohesion / (0.5 * self.stress) / EVEN_COHESION, 0.0)
        return self.friction * (1.0 - DILATION_SHARE * without_cohesion * max(self.friction, 0.0))


@dataclass(frozen=True)
class SoilLayer(SoilContacts):
    """Holds the required strength of a stratum, and the contacts with which random discs come closest to it.

    Attributes
    ----------
    stratum : the soil of the stratum
    is_rock : whether it is too strong to fail, as rock and concrete without friction are: it keeps its contacts, while
        clay takes pore pressure and bonds (`dem.search.undrained_clay`)
    """

    stratum: Stratum
    is_rock: bool = False

    def springs(self, radius: float, void_ratio: float) -> LayerSprings:
        """Return the constants of discs of a given mean radius (m) in a packing of a given void ratio."""
        s = self.stratum
        discs = self.discs(s.name, s.density_seismic, radius, void_ratio, buoyant_density=s.density_ordinary)
        return replace(discs, undrained_strength=0.0) if self.is_rock else discs


def rock_strength(section: Section) -> float:
    """Return the undrained strength above which no ground of a section can fail.

    Parameters
    ----------
    section : section with its strata

    Returns
    -------
    ``STRENGTH_MARGIN`` times the largest total overburden (Pa).
    """
    levels = section.layering.interfaces(middles(*section.extent, COLUMNS))
    weights = GRAVITY * np.array([max(s.density_seismic, s.density_ordinary) for s in section.strata])
    return STRENGTH_MARGIN * float(((levels[:, :-1] - levels[:, 1:]) @ weights).max())


def mohr_coulomb_strength(cohesion: float, friction_angle: float, pressure: np.ndarray) -> np.ndarray:
    """Return half the deviator stress at failure by Mohr-Coulomb (Pa), (p sin phi + c cos phi) / (1 - sin phi).

    Parameters
    ----------
    cohesion : cohesion c (Pa)
    friction_angle : friction angle phi (rad)
    pressure (n,) : confining pressures p (Pa)

    Returns
    -------
    Radius (n,) of the Mohr circle that touches the failure line and whose smaller principal stress is p.
    """
    sine, cosine = np.sin(friction_angle), np.cos(friction_angle)
    return np.asarray((pressure * sine + cohesion * cosine) / (1.0 - sine))


def soil_contacts(
    cohesion: float,
    friction_angle: float,
    stress: float,
    youngs_modulus: float | None = None,
) -> SoilContacts:
    """Find contacts with which random discs have the strength and stiffness of a soil.

    Parameters
    ----------
    cohesion
        Cohesion c, or undrained strength c_u with a friction angle of 0 (Pa).
    friction_angle
        Friction angle phi (rad).
    stress
        Vertical effective stress in the middle of the soil (Pa).
    youngs_modulus
        Young's modulus E (Pa); if None, kn is 800 times the stress, which is stiff enough that the strength does not
        depend on it.

    Returns
    -------
    SoilContacts
        The contacts; its notes name properties of the soil that discs cannot have.

    Raises
    ------
    ValueError
        If the stress or the modulus is not positive, or the soil has no strength.
    """
    if not stress > 0.0 or not (youngs_modulus is None or youngs_modulus > 0.0):
        raise ValueError(
            f"soil contacts: expected positive stress and modulus, not {stress} Pa and {youngs_modulus} Pa"
        )
    if not (cohesion >= 0.0 and 0.0 <= friction_angle < 0.5 * np.pi and cohesion + friction_angle > 0.0):
        raise ValueError(f"soil contacts: expected a strength, not c = {cohesion} Pa and phi = {friction_angle} rad")
    turns = friction_angle > 0.0
    table = strength_map(turns)
    pressures = np.array(SHARES) * stress
    required = mohr_coulomb_strength(cohesion, friction_angle, pressures)
    cohesive = cohesion > 0.0
    reach = 0.95 * table.strongest(cohesive) * pressures
    if youngs_modulus is not None:  # what is cohesive without being stiff would need contacts that open widely
        reach = np.minimum(reach, youngs_modulus / LEAST_RIGIDITY)
    aimed = np.minimum(required, reach)
    contacts = table.fit(aimed, pressures, cohesive)
    real = LARGEST_STIFFNESS * stress
    if youngs_modulus is not None:
        real = table.normal_stiffness(youngs_modulus, 0.5 * stress, contacts.friction, contacts.cohesion)
    stiffness = float(
        np.clip(real, SMALLEST_STIFFNESS * stress, max(LARGEST_STIFFNESS * stress, FIRM_STIFFNESS * float(aimed.max())))
    )
    gain = table.gained_by_softness(stiffness, pressures, contacts.cohesion)
    contacts = table.fit(aimed / gain, pressures, cohesive)
    contacts = replace(contacts, expected_strength=contacts.expected_strength * gain)
    notes = (*_on_strength(contacts, required, reach, pressures), *_on_stiffness(stiffness, real, stress))
    return SoilContacts(
        stress,
        pressures,
        required,
        contacts.expected_strength,
        contacts.friction,
        contacts.cohesion,
        stiffness,
        turns,
        notes,
    )


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
    field, stresses, most = section.cohesion_field, middle_stresses(section), rock_strength(section)
    typical = float(stresses[stresses > 0.0].min()) if (stresses > 0.0).any() else 1e4
    return [
        _fitted_layer(soil, float(stress) if stress > 0.0 else typical, np.inf if varies else most)
        for soil, stress, varies in zip(field.means(), stresses, field.varies, strict=True)
    ]


def _fitted_layer(stratum: Stratum, stress: float, most: float) -> SoilLayer:
    """Return the contacts of a stratum; stress: vertical effective stress (Pa); most: strength of rock (Pa)."""
    is_rock = stratum.friction_angle == 0.0 and stratum.cohesion >= most
    cohesion = most if is_rock else stratum.cohesion
    contacts = soil_contacts(cohesion, stratum.friction_angle, stress, stratum.youngs_modulus)
    return SoilLayer(**vars(contacts), stratum=stratum, is_rock=is_rock)


def _on_strength(
    contacts: ContactStrength, required: np.ndarray, reach: np.ndarray, pressures: np.ndarray
) -> list[str]:
    if (required > reach).any():
        return [
            f"discs cannot be as strong as this soil: the strength of the soil is {required[-1] / 1e3:.0f} kPa under "
            f"{pressures[-1] / 1e3:.3g} kPa, the largest strength of discs "
            f"{contacts.expected_strength[-1] / 1e3:.0f} kPa"
        ]
    miss = contacts.expected_strength / required - 1.0
    if np.abs(miss).max() <= STRENGTH_TOLERANCE:
        return []
    misses = ", ".join(f"{100.0 * m:+.0f} %" for m in miss)
    return [
        f"the strength of the discs differs by {misses} at a quarter, a half and all of the "
        "layer's stress: discs of clay keep some friction, and stiff discs are stronger at low stress"
    ]


def _on_stiffness(stiffness: float, real: float, stress: float) -> list[str]:
    if abs(stiffness / real - 1.0) <= 1e-9:
        return []
    comparison, limit = ("stiffer", "at least") if stiffness > real else ("softer", "at most")
    return [
        f"the discs are {comparison} than the soil, since their contact stiffness kn is {limit} "
        f"{stiffness / stress:.0f} times the vertical effective stress of the layer"
    ]
