"""Describes a layer of one soil: its name, its bottom, its parameters, and its pore water."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Annotated, Any, Self

from pydantic import (
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    StrictBool,
    model_serializer,
    model_validator,
)

from meshes.section.liquefies import LIQUEFIES_IN, CaseNumbers, Cases
from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine, Line
from meshes.section.quantity import (
    Angle,
    Density,
    Gradient,
    Permeability,
    PoissonsRatio,
    Quantity,
    Ratio,
    Stiffness,
    Strength,
)  # fmt: skip
from meshes.section.strength_table import StrengthTable
from meshes.section.vertical_flow import VerticalFlow

# A line of text without quotes or control characters, which gmsh could not read back, and no space at either end.
NAME_PATTERN = r'^[^"\s\p{Cc}](?:[^"\p{Cc}]*[^"\s\p{Cc}])?$'
PAPER_DENSITIES = ("density_ordinary", "density_seismic")

# No density: stands until ``density``, or a complaint, takes its place.
MISSING = -1.0
MISSING_DENSITY = (
    'density: missing; expected a density or unit weight such as "1.8 t/m^3" (and density_saturated, if water stands '
    "in the stratum)"
)


# Ladd & Foott (1974): m is 0.75 to 0.85 for clays.
OCR_EXPONENT = 0.8
# The keys whose values are proportional to the cohesion.
AMOUNTS = ("cohesion", "cohesion_increase", "cohesion_minimum", "strength_ratio")
# The keys that give the pore pressure of a stratum apart from the water table.
PORE_PRESSURES = ("pore_pressure_ratio", "piezometric_level", "vertical_flow")
# The keys by which a cohesion varies, beside cohesion_increase.
OF_COHESION = (
    "cohesion_from", "cohesion_minimum", "strength_ratio", "strength_table", "ocr", "ocr_exponent",
    "pre_overburden_pressure", "consolidated_below",
)  # fmt: skip


class Stratum(Model):
    """Holds a layer of one soil, with its parameters in SI units.

    The weight of a stratum is given either as ``density``, with ``density_saturated`` below water, or as the two
    densities of the paper on S-13: ``density_ordinary``, on which gravity acts, buoyant below water, and
    ``density_seismic``, on which the horizontal acceleration acts. If a stratum has ``density``, both are equal to this
    density, which is all of its mass; buoyancy is then in the pore pressure.
    """

    name: str = Field(
        description=(
            "name of the stratum, which no other stratum has, such as '4 Asd', without quotation marks or line breaks"
        ),
        pattern=NAME_PATTERN,
    )
    description: str = Field(default="", description="the soil in words; the source of its parameters in the report")
    bottom: Line | None = Field(
        default=None,
        description=(
            "lower boundary, a line { depth = ... } or { elevation = ... }; only the lowest stratum may omit it"
        ),
    )
    youngs_modulus: Stiffness = Field(description='a stiffness such as "1560 tf/m^2"')
    poissons_ratio: PoissonsRatio = Field(description="a Poisson's ratio from 0 to below 0.5")
    density: Density | None = Field(
        default=None, description='the density or unit weight above water, such as "1.8 t/m^3"', exclude=True
    )
    density_saturated: Density | None = Field(
        default=None,
        description=(
            'the density or unit weight below water, such as "20 kN/m^3"; one of the two densities suffices '
            "if the whole stratum lies on one side of the water"
        ),
    )
    density_ordinary: Density = Field(
        default=MISSING, description='the density that gravity acts on, buoyant below water, such as "1.0 t/m^3"'
    )
    density_seismic: Density = Field(
        default=MISSING, description='the density that the horizontal acceleration acts on, such as "2.0 t/m^3"'
    )
    cohesion: Strength = Field(description='a cohesion such as "10 tf/m^2"')
    cohesion_increase: Gradient = Field(
        default=0.0, description='the increase of cohesion per depth below cohesion_from, such as "2 kPa/m"'
    )
    cohesion_from: ElevationOrLine | None = Field(
        default=None,
        description=(
            "elevation at which cohesion_increase begins: an elevation (m), a line, or { depth = 0 } for "
            "the ground surface"
        ),
    )
    cohesion_minimum: Strength | None = Field(
        default=None, description='least value of a cohesion that varies, such as "5 kPa"'
    )
    strength_ratio: Ratio | None = Field(
        default=None,
        description="S of a cohesion S σ'v OCR^m, with the vertical effective stress before shaking, such as 0.22; "
        "it is added to cohesion, which may then be left out",
    )
    strength_table: StrengthTable | None = Field(
        default=None,
        description=(
            'undrained strength over the vertical effective stress before shaking, [["0 kPa", "20 kPa"], ...], linear '
            "between the pairs; it is added to cohesion, which may then be left out"
        ),
    )
    ocr: Ratio | None = Field(default=None, description="overconsolidation ratio OCR in strength_ratio; by default 1")
    ocr_exponent: Ratio | None = Field(default=None, description="exponent m of OCR, 0 to 1; by default 0.8")
    pre_overburden_pressure: Strength | None = Field(
        default=None, description="difference of preconsolidation stress and σ'v, which replaces ocr"
    )
    consolidated_below: ElevationOrLine | None = Field(
        default=None,
        description=(
            "line, elevation (m) or { depth = ... } that separates consolidated ground from new soil above it, such "
            "as a new embankment; the weight of the new soil does not count in the σ'v of strength_ratio or "
            "strength_table"
        ),
    )
    friction_angle: Angle = Field(description='a friction angle such as "35 deg"')
    tension: Strength | None = Field(
        default=None,
        description='the largest tensile stress, such as "0 kPa" (a tension cut-off); by default c / tan φ',
    )
    dilation_angle: Angle | None = Field(
        default=None,
        description='a dilation angle ψ such as "5 deg"; fem.flow determines the flow of strata without one',
    )
    residual_cohesion: Strength | None = Field(
        default=None,
        description='cohesion after large shear strains, such as "0 kPa"; given together with residual_friction_angle',
    )
    residual_friction_angle: Angle | None = Field(
        default=None,
        description=(
            'friction angle after large shear strains, such as "12 deg"; `noshiro residual` computes the '
            "stability with it"
        ),
    )
    liquefies_in: CaseNumbers = Field(default=Cases(), description=LIQUEFIES_IN)
    piezometric_level: ElevationOrLine | None = Field(
        default=None, description="the piezometric level of the stratum, if it is not the water table"
    )
    vertical_flow: VerticalFlow | None = Field(
        default=None,
        description=(
            "table of the vertical flow through the stratum, such as { lower_level = 12.5 } in a clay over an aquifer "
            "with that piezometric level: the level varies linearly with elevation, from the water table at the top"
        ),
    )
    pore_pressure_ratio: Ratio | None = Field(
        default=None,
        description="pore pressure over the weight of the soil above, such as 0.25, which replaces a water level",
    )
    excess_pore_pressure_ratio: Annotated[Ratio, Field(le=1.0)] = Field(
        default=0.0,
        description="pore pressure that shaking adds below water, over the vertical effective stress, from 0 to 1",
    )
    permeability: Permeability | None = Field(
        default=None,
        description=(
            'permeability, the flow velocity under a gradient of 1, such as "1e-5 m/s"; it is needed if '
            "water flows ([water], flow)"
        ),
    )
    permeability_vertical: Permeability | None = Field(
        default=None,
        description="permeability to vertical flow, if it differs from that to horizontal flow",
    )
    drains: StrictBool = Field(
        default=False,
        description=(
            "true if the pore pressure in the stratum follows a drawdown at once (drained ground); false "
            "if it falls only by the load of the removed water"
        ),
    )

    _file_table: str = PrivateAttr(
        default=""
    )  # the table of its file, such as "zones 2", if it is not given by the number of the stratum

    def in_table(self, table: str) -> Self:
        """Return a copy with its ``table`` in the file, such as "zones 2"."""
        copy = self.model_copy()
        copy._file_table = table
        return copy

    @property
    def file_table(self) -> str:
        """Return the table of the file from which the stratum comes, if it is not the table with the number of the
        stratum; else nothing."""
        return self._file_table

    @property
    def dilation(self) -> float:
        """Return the dilation angle ψ (rad), 0 if none is given."""
        return self.dilation_angle or 0.0

    @property
    def liquefiable(self) -> bool:
        """Return whether the stratum liquefies in any case."""
        return bool(self.liquefies_in)

    @property
    def cohesion_varies(self) -> bool:
        """Return whether the cohesion varies within the stratum."""
        return bool(self.cohesion_increase or self.by_stress)

    @property
    def by_stress(self) -> bool:
        """Return whether the cohesion follows from the vertical effective stress."""
        return bool(self.strength_ratio) or self.strength_table is not None

    @property
    def has_cohesion(self) -> bool:
        """Return whether the stratum has a cohesion at any place."""
        return self.cohesion > 0.0 or self.cohesion_varies

    @property
    def confined(self) -> bool:
        """Return whether the stratum has a piezometric level, or a vertical flow, apart from the water table."""
        return self.piezometric_level is not None or self.vertical_flow is not None

    @property
    def exponent(self) -> float:
        """Return the exponent m of OCR."""
        return OCR_EXPONENT if self.ocr_exponent is None else self.ocr_exponent

    def with_multiple_of_cohesion(self, multiple: float) -> Self:
        """Return a copy with a multiple of the cohesion at every place."""
        amounts = {key: getattr(self, key) for key in AMOUNTS}
        change: dict[str, Any] = {key: multiple * value for key, value in amounts.items() if value is not None}
        if self.strength_table is not None:
            change["strength_table"] = tuple(
                (stress, Quantity(multiple * strength)) for stress, strength in self.strength_table
            )
        return self.model_copy(update=change)

    def with_cohesion(self, cohesion: float) -> Self:
        """Return a copy with one cohesion (Pa) everywhere."""
        return self.model_copy(update={**dict.fromkeys(OF_COHESION), "cohesion": cohesion, "cohesion_increase": 0.0})

    @property
    def softens(self) -> bool:
        """Return whether soil that has been sheared far has another strength."""
        return self.residual_cohesion is not None

    def softened(self) -> Self:
        """Return a copy with the strength of soil that has been sheared far, at its critical state, so that it does not
        dilate."""
        if self.residual_cohesion is None or self.residual_friction_angle is None:
            return self
        dilation = None if self.dilation_angle is None else 0.0
        change = {"friction_angle": self.residual_friction_angle, "dilation_angle": dilation}
        return self.with_cohesion(self.residual_cohesion).model_copy(update=change)

    @property
    def buoyant(self) -> bool:
        """Return whether the ordinary density is already reduced by the buoyancy of water."""
        return self.density_ordinary < self.density_seismic

    @model_validator(mode="before")
    @classmethod
    def _strength_ratio_alone(cls, data: Any) -> Any:
        """Return the data with a cohesion of zero where the undrained strength is a share of the stress alone."""
        ratios = isinstance(data, Mapping) and any(
            data.get(key) is not None for key in ("strength_ratio", "strength_table")
        )
        alone = ratios and "cohesion" not in data
        return {**data, "cohesion": 0.0} if alone else data

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        problems = self._weigh()
        if self.dilation > self.friction_angle:
            problems.append("dilation_angle above friction_angle: expected at most the friction angle")
        if len(set(self.liquefies_in)) < len(self.liquefies_in):
            problems.append(f"liquefies_in = {list(self.liquefies_in)}: expected every case once")
        problems += self._cohesion_problems()
        problems += self._residual_problems()
        pressures = [key for key in PORE_PRESSURES if getattr(self, key) is not None]
        if len(pressures) > 1:
            problems.append(f"{' and '.join(pressures)}: expected one of them")
        if problems:
            raise ValueError("\n".join(problems))
        return self

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return the keys of a stratum. A stratum below water that contains films of moist ground has both densities of
        the original stratum.
        """
        data: dict[str, Any] = handler(self)
        if self.density in (None, self.density_ordinary):
            return data
        return {key: value for key, value in data.items() if key not in PAPER_DENSITIES} | {"density": self.density}

    def _cohesion_problems(self) -> Iterator[str]:
        """Yield one sentence for each problem of the keys of a cohesion that varies."""
        if self.cohesion_increase > 0.0 and self.cohesion_from is None:
            yield "cohesion_increase without cohesion_from: expected the elevation or the line from which it grows"
        if not self.strength_ratio:
            of_ratio = ("ocr", "ocr_exponent", "pre_overburden_pressure")
            for key in (*of_ratio, *(() if self.by_stress else ("consolidated_below",))):
                if getattr(self, key) is not None:
                    yield f"{key} without strength_ratio: expected the ratio of strength to stress that it belongs to"
        if self.cohesion_minimum is not None and not self.cohesion_varies:
            yield (
                "cohesion_minimum with a constant cohesion: expected cohesion_increase, strength_ratio or "
                "strength_table"
            )
        if self.strength_ratio and self.strength_table is not None:
            yield "strength_ratio and strength_table: expected one of them"
        if self.ocr is not None and self.ocr < 1.0:
            yield f"ocr = {self.ocr:g}: expected a ratio of 1 or more"
        if self.ocr is not None and self.pre_overburden_pressure is not None:
            yield "ocr and pre_overburden_pressure: expected one of them"
        if self.exponent > 1.0:
            yield f"ocr_exponent = {self.exponent:g}: expected an exponent from 0 to 1"

    def _residual_problems(self) -> Iterator[str]:
        """Yield one sentence for each problem of the strength of soil that has been sheared far."""
        cohesion, friction = self.residual_cohesion, self.residual_friction_angle
        if (cohesion is None) != (friction is None):
            yield "residual_cohesion and residual_friction_angle: expected both of them, or none"
        if friction is not None and friction > self.friction_angle:
            yield "residual_friction_angle above friction_angle: expected at most the friction angle"
        if cohesion == 0.0 and friction == 0.0:
            yield "residual_cohesion and residual_friction_angle are both 0: expected a strength"
        if cohesion is not None and cohesion > self.cohesion and not self.cohesion_varies:
            yield "residual_cohesion above cohesion: expected at most the cohesion"

    def _weigh(self) -> list[str]:
        """Set both densities to the given density, if there is one, and return a sentence for each problem of the
        densities."""
        pair = {name: getattr(self, name) for name in PAPER_DENSITIES}
        missing = [name for name, value in pair.items() if value == MISSING]
        whole = self.density_saturated if self.density is None and len(missing) == 2 else self.density
        if whole is not None:
            if any(value not in (MISSING, whole) for value in pair.values()):
                return ["density with density_ordinary and density_seismic: expected density, or the other two"]
            self.__dict__.update(dict.fromkeys(pair, whole))  # the model is frozen from here on
        elif len(missing) == 2:
            return [MISSING_DENSITY]
        elif missing:
            return [f'{missing[0]}: missing; expected a density such as "1.8 t/m^3", or density alone']
        if self.density_seismic < self.density_ordinary:
            return ["density_seismic below density_ordinary: expected the saturated density to be the larger one"]
        if self.density_saturated is not None and self.buoyant:
            return ["density_saturated with a buoyant density_ordinary: expected density and density_saturated"]
        if self.density_saturated is not None and self.density_saturated < self.density_seismic:
            return ["density_saturated below density: expected the saturated density to be the larger one"]
        return []


def liquefying_strata(strata: Sequence[Stratum], case: int) -> list[int]:
    """Return the strata that liquefy in a case.

    Parameters
    ----------
    strata : strata from the top down
    case : number of the case, from 1

    Returns
    -------
    Numbers of the strata, from 0.
    """
    return [k for k, stratum in enumerate(strata) if case in stratum.liquefies_in]


def cases_of(strata: Iterable[Stratum]) -> list[int]:
    """Return the cases in which any of some strata liquefies.

    Parameters
    ----------
    strata : the strata

    Returns
    -------
    Numbers of the cases, rising.
    """
    return sorted({case for stratum in strata for case in stratum.liquefies_in})
