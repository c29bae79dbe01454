"""Which contacts make discs the soil of each stratum: stiffness, friction and cohesion from the map of strengths.

A stratum is looked at as a sample from its middle, confined at a quarter, a half and all of its vertical effective
stress. Wanted at a confining pressure p is half the deviator at failure of Mohr and Coulomb,
(p sin phi + c cos phi) / (1 - sin phi): c_u for a clay without friction, p sin phi / (1 - sin phi) for a sand.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dem.laboratory.element_table import SHARES, middle_stresses
from dem.laboratory.strength_map import StrengthMap, strength_map
from dem.springs import LayerSprings, Strength, soil_discs
from meshes.section.growth import evened
from meshes.section.section import Section, Stratum

SOFTEST, STIFFEST = 200.0, 5000.0  # kn over the stress of the layer: below, strength falls; above, time is all it costs
LEAST_RIGIDITY = 50.0  # E over strength; of clays some 150 to 1000
NEAR = 0.07  # of the strength wanted
OVERLAP = 0.5  # of a radius, that soil discs may reach whatever softens


@dataclass(frozen=True)
class SoilLayer:
    """What a stratum asks for, and the contacts with which random discs come closest to it.

    Attributes
    ----------
    stratum : Stratum
        The soil.
    stress : float
        Vertical effective stress in its middle (Pa).
    pressures : (3,)
        Confining pressures at which strength is compared (Pa).
    wanted : (3,)
        Half the deviator at failure that the soil has there (Pa).
    expected : (3,)
        That of the discs, by the map (Pa).
    friction : float
        mu of the contacts.
    cohesion : float
        C of the contacts over the mean diameter (Pa).
    stiffness : float
        kn of the contacts (N/m).
    notes : tuple of str
        What could not be had, in sentences.
    """

    stratum: Stratum
    stress: float
    pressures: np.ndarray
    wanted: np.ndarray
    expected: np.ndarray
    friction: float
    cohesion: float
    stiffness: float
    notes: tuple[str, ...]

    def springs(self, radius: float, void_ratio: float) -> LayerSprings:
        """The constants of discs of this mean radius (m) in a packing of this void ratio."""
        s = self.stratum
        strength = Strength(self.friction, self.cohesion * 2.0 * radius)
        discs = soil_discs(
            s.name, self.stiffness, strength, s.density_seismic, s.density_ordinary, radius, void_ratio,
            allowed_overlap=OVERLAP,
        )  # fmt: skip
        return replace(discs, undrained=s.friction_angle == 0.0)


def failure_strength(stratum: Stratum, pressure: np.ndarray) -> np.ndarray:
    """Half the deviator at failure of a stratum at confining pressures (Pa), by Mohr and Coulomb."""
    sine, cosine = np.sin(stratum.friction_angle), np.cos(stratum.friction_angle)
    return np.asarray((pressure * sine + stratum.cohesion * cosine) / (1.0 - sine))


def soil_layers(section: Section, known: StrengthMap | None = None) -> list[SoilLayer]:
    """All strata of a section, from the top down; one cohesion each, where it grows with depth that of the middle."""
    strata = evened(section.strata, section.layering)
    table = known or strength_map()
    stresses = middle_stresses(section)
    typical = float(stresses[stresses > 0.0].min()) if (stresses > 0.0).any() else 1e4
    return [_fitted(s, float(v) if v > 0.0 else typical, table) for s, v in zip(strata, stresses, strict=True)]


def _fitted(stratum: Stratum, stress: float, table: StrengthMap) -> SoilLayer:
    pressures = np.array(SHARES) * stress
    wanted = failure_strength(stratum, pressures)
    cohesive = stratum.cohesion > 0.0
    # what is cohesive without being stiff would need contacts that open by several per cent before they part
    reach = np.minimum(0.95 * table.strongest(cohesive) * pressures, stratum.youngs_modulus / LEAST_RIGIDITY)
    aimed = np.minimum(wanted, reach)
    found = table.fit(aimed, pressures, cohesive)
    real = table.normal_stiffness(stratum.youngs_modulus, 0.5 * stress, found.friction, found.cohesion)
    stiffness = float(np.clip(real, SOFTEST * stress, STIFFEST * stress))
    gain = table.gained_by_softness(stiffness, pressures, found.cohesion)
    found = table.fit(aimed / gain, pressures, cohesive)
    found = replace(found, expected=found.expected * gain)
    notes = []
    if (wanted > reach).any():
        notes.append(
            f"no discs are as strong as this soil: it has {wanted[-1] / 1e3:.0f} kPa at {stress / 1e3:.3g} kPa, they "
            f"can have {found.expected[-1] / 1e3:.0f} kPa; that is what they get"
        )
    elif np.abs(found.expected / wanted - 1.0).max() > NEAR:
        miss = 100.0 * (found.expected / wanted - 1.0)
        told = ", ".join(f"{m:+.0f} %" for m in miss)
        notes.append(
            f"discs keep some friction where the soil has none: their strength is off by {told} at a quarter, a half "
            "and all of the layer's stress"
        )
    if abs(stiffness / real - 1.0) > 1e-9:
        what = "stiffer" if stiffness > real else "softer"
        notes.append(
            f"{what} than the soil: kn is {stiffness / real:.2f} times what its E asks for, {stiffness / stress:.0f} "
            "times the stress of the layer"
        )
    return SoilLayer(
        stratum, stress, pressures, wanted, found.expected, found.friction, found.cohesion, stiffness, tuple(notes)
    )


def refusals(layers: Sequence[SoilLayer]) -> list[str]:
    """One sentence for each thing that discs cannot have, with the name of the stratum."""
    return [f'stratum "{layer.stratum.name}": {note}' for layer in layers for note in layer.notes]
