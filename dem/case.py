"""Defines the cases of the slides, each a table [[slide.cases]]: stiffness, strength and volume of liquefied layers."""

from typing import Annotated, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from meshes.section.cutting import value_of_stratum, whole_soil
from meshes.section.liquefies import RemainingStrength
from meshes.section.quantity import Quantity, Strength
from meshes.section.section import Model, Section

Share = Annotated[float, Field(ge=0.0, le=1.0)]
RESIDUAL_STRENGTH_RANGE = (50.0, 1e6)  # Pa: from a slurry to dense ground


def _of_liquefied_soil(strength: Quantity) -> Quantity:
    """Check a residual strength (Pa). Raises ValueError with a suggestion for values that no soil has."""
    least, most = RESIDUAL_STRENGTH_RANGE
    if strength == 0.0 or least <= strength <= most:
        return strength
    number = str(strength.written).split()[0]
    units = [unit for unit, size in (("kPa", 1e3), ("Pa", 1.0)) if least <= size * float(number) <= most]
    meant = f' (did you mean "{number} {units[0]}"?)' if units else ""
    raise ValueError(
        f"{strength / 1e3:.6g} kPa is no residual strength of soil{meant}; expected 0, or {least / 1e3:g} to "
        f"{most / 1e3:g} kPa"
    )


ResidualStrength = Annotated[Strength, AfterValidator(_of_liquefied_soil)]


class Case(Model):
    """Holds the stiffness, strength and volume of liquefied layers that name this case in `liquefies_in`."""

    name: str = Field(default="", description="name of the case, such as low strength")
    stiffness: float = Field(
        default=1.0,
        gt=0.0,
        le=1.0,
        description="factor on the contact springs, such as 0.02; for soil discs the factor on the shear "
        "modulus, so that residual strength is reached at a shear strain of 0.8 to 4 %",
    )
    damping: float | None = Field(
        default=None,
        ge=0.0,
        le=1.0,
        description="factor on the dashpots; by default the square root of stiffness, so that the damping "
        "ratio is unchanged",
    )
    friction: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0,
        description="factor on the friction of the contacts of the paper's discs; on tan phi of other discs "
        "and of the continuum",
    )
    cohesion: float = Field(default=0.0, ge=0.0, le=1.0, description="remaining share of the cohesion")
    residual: Share | dict[str, Share] = Field(
        default=0.0,
        description=(
            "residual strength over the vertical effective stress before shaking; one value for all strata, or one for "
            "each stratum by name. If shares of friction and cohesion give a larger strength, that strength counts"
        ),
    )
    residual_strength: ResidualStrength | dict[str, ResidualStrength] = Field(
        default=0.0,
        description=(
            'residual strength as a stress, constant within a stratum, such as "4 kPa"; one value for all '
            "strata, or one for each stratum by name; it replaces residual"
        ),
    )
    strain_potential: Share | dict[str, Share] = Field(
        default=0.0,
        description=(
            "shear strain that liquefied ground undergoes with hardly any stiffness before it regains "
            "strength, such as 0.4; one value for all strata, or one for each stratum by name"
        ),
    )
    volumetric_strain: float = Field(
        default=0.0,
        ge=0.0,
        le=0.2,
        description="volumetric strain by drainage while the layers liquefy, such as 0.03",
    )

    @property
    def damping_left(self) -> float:
        """Return `damping`, or by default the square root of `stiffness`, since dashpots are proportional to sqrt(m K)
        and liquefaction reduces K.
        """
        return float(np.sqrt(self.stiffness)) if self.damping is None else self.damping

    def residual_of(self, stratum: str) -> float:
        """Return the ratio of residual strength to vertical effective stress of a stratum with this name."""
        return value_of_stratum(self.residual, stratum) or 0.0 if isinstance(self.residual, dict) else self.residual

    def strength_of(self, stratum: str) -> float:
        """Return the residual strength (Pa) of a stratum by its name, if the strength is given as a stress."""
        strengths = self.residual_strength
        return value_of_stratum(strengths, stratum) or 0.0 if isinstance(strengths, dict) else strengths

    def strain_potential_of(self, stratum: str) -> float:
        """Return the strain potential of a stratum by its name: the shear strain that it undergoes before it regains
        strength."""
        potential = self.strain_potential
        return value_of_stratum(potential, stratum) or 0.0 if isinstance(potential, dict) else potential

    def residual_remains(self, stratum: str) -> RemainingStrength:
        """Return the strength that a stratum retains after liquefaction, from its residual strength alone."""
        remains = self.residual_of(stratum), self.strength_of(stratum), self.strain_potential_of(stratum)
        return RemainingStrength(0.0, 0.0, *remains)

    def remains_of(self, section: Section, number: int) -> RemainingStrength:
        """Return the strength of a stratum after liquefaction: its residual strength, or shares of cohesion and
        friction if the strength that these shares leave is larger. The two strengths are not added, since residual
        strengths that were back-calculated from failures are the whole strength of liquefied soil.
        """
        stratum, field = section.strata[number], section.cohesion_field
        residual = self.residual_remains(stratum.name)
        shares = RemainingStrength(self.cohesion, self.friction, 0.0)
        if not (self.cohesion or self.friction):
            return residual
        stress, cohesion = field.mean_effective_stress(number), field.means()[number].cohesion
        strength = self.cohesion * cohesion + self.friction * np.tan(stratum.friction_angle) * stress
        return shares if strength > residual.residual * stress + residual.strength else residual

    @model_validator(mode="after")
    def _one_residual(self) -> Self:
        if self.residual and self.residual_strength:
            raise ValueError("residual and residual_strength: expected only one of them")
        return self


# Clean sand of (N1)60 = 8, and of 3 and 12, the ends of their cases: 0.03 + 0.0075 (N1)60 of Olson & Stark (2002), and
# the limiting shear strain of the same sand, 1.859 (1.1 - √(N/46))³, at most 0.5 (Idriss & Boulanger 2008).
LOOSE_SAND = (
    Case(name="median", residual=0.09, strain_potential=0.5),
    Case(name="low strength", residual=0.0525, strain_potential=0.5),
    Case(name="high strength", residual=0.12, strain_potential=0.38),
)
PAPER_CASES = (Case(stiffness=0.1), Case(stiffness=0.02), Case(stiffness=0.01))  # of the paper


def cases_of_loose_sand(section: Section) -> tuple[Case, ...]:
    """Return the cases of slides by residual strengths of loose sand (`LOOSE_SAND`), for a section file without cases.

    The residual strength is constant within a soil, since a strength in proportion to the local stress would be zero at
    the face of a bank. The parts of a soil above and below the water table have the same strength.

    Parameters
    ----------
    section : the ground; its liquefying strata name the numbers of the cases

    Returns
    -------
    Cases whose residual strength is the ratio in `LOOSE_SAND` times the mean vertical effective stress of each
    liquefying soil (Pa), at least the smallest of `RESIDUAL_STRENGTH_RANGE`.
    """
    areas, parts = section.layering.areas(), dict[str, list[int]]()
    for k, stratum in enumerate(section.strata):
        if stratum.liquefies_in and areas[k] > 0.0:
            parts.setdefault(whole_soil(stratum.name), []).append(k)
    stress = section.cohesion_field.mean_effective_stress
    means = {soil: float(np.average([stress(k) for k in ks], weights=areas[ks])) for soil, ks in parts.items()}
    least = RESIDUAL_STRENGTH_RANGE[0]
    return tuple(
        case.changed(
            residual=0.0,
            residual_strength={soil: max(least, round(case.residual_of(soil) * mean)) for soil, mean in means.items()},
        )
        for case in LOOSE_SAND
    )
