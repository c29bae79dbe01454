"""Defines method and borings of the triggering analysis (the table [triggering] of the input file), and the free face
of lateral spreads."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal, get_args

import numpy as np
from pydantic import Field, StrictBool

from meshes.borings.boring import Boring
from meshes.borings.plausible import implausible_tests
from meshes.section.liquefies import TRIGGERED
from meshes.section.plausibility import Range, is_within, sentence
from meshes.section.polyline import points_at
from meshes.section.quantity import Coordinate, Length
from meshes.section.section import Model, Section
from workflow.earthquake.settings import EarthquakeSettings
from workflow.earthquake.triggering.highway_code import MotionType

TriggeringMethod = Literal[
    "idriss_boulanger_2008", "boulanger_idriss_2014", "highway_1990", "highway_2012", "highway_2017"
]

CaseName = Literal["median", "low strength", "high strength"]
CASE_NAMES: tuple[CaseName, ...] = get_args(CaseName)
Residual = Literal["strength", "ratio"]
# From a fault that breaks the ground to the deepest earthquake; from beside a fault to where nothing is felt; rods that
# a rig can carry; from mud to hard rock.
DEPTH = Range(0.5, 750.0, "km", 1e3, ((1e3, "km"), (1e-3, "m")))
DISTANCE = Range(0.1, 1500.0, "km", 1e3, ((1e3, "km"), (1e-3, "m")))
RODS = Range(0.0, 30.0, "m", 1.0, ((1e-2, "cm"), (1e-3, "mm")))
VS30 = Range(50.0, 3000.0, "m/s", 1.0, ())


class TriggeringSettings(Model):
    """Holds the settings of the triggering analysis: the relation, the energy of the hammer, and the borings."""

    method: TriggeringMethod = Field(
        default="idriss_boulanger_2008",
        description=(
            'method of the triggering analysis: "idriss_boulanger_2008"; a form of the Japanese highway '
            'code, "highway_1990" (used in the paper), "highway_2012" or "highway_2017"; or '
            '"boulanger_idriss_2014" for cone penetration tests'
        ),
    )
    energy_ratio: float = Field(
        default=60.0,
        ge=20.0,
        le=120.0,
        description=(
            "energy of the hammer in percent of that of its free fall, from 20 to 120, for borings that "
            "do not give it; it is used by Idriss & Boulanger only"
        ),
    )
    rods_above: Length = Field(
        default=1.5,
        description='length of the rods above the ground, such as "1.5 m"; it is used by Idriss & Boulanger only',
    )
    motion: MotionType = Field(
        default="I",
        description=(
            'type of ground motion in the highway code from 2012 on: "I" of earthquakes at plate '
            'boundaries, "II" of inland earthquakes'
        ),
    )
    share: float = Field(
        default=0.5,
        gt=0.0,
        le=1.0,
        description="share of a stratum in which F_L has to be below 1, so that the stratum counts as liquefied",
    )
    cases: tuple[CaseName, ...] = Field(
        default=(),
        description=(
            'cases of the slides that follow from borings: "median", "low strength" and "high '
            'strength", by the residual strengths of three relations. They are added to the cases that '
            "[slide] gives, and replace its default cases. By default all three are computed if [slide] "
            "gives no cases and borings determine all strata that liquefy"
        ),
    )
    residual: Residual = Field(
        default="strength",
        description=(
            'residual strength in these cases: "strength" is that at the tests, in kPa and constant over '
            "the stratum, since liquefied soil fails undrained with a strength that depends on its "
            'density; "ratio" is a share of the vertical effective stress at each place'
        ),
    )
    water_gathers: StrictBool = Field(
        default=True,
        description=(
            "true if a layer of low permeability lies on the liquefied layer, so that water gathers below "
            "it and loosens the sand; if false, Idriss & Boulanger (2008) give a larger residual strength"
        ),
    )
    pore_pressure: StrictBool = Field(
        default=False,
        description=(
            "true if strata that do not liquefy get the mean excess pore pressure ratio of their tests "
            "(F_L from 1 to 2), unless they have an excess_pore_pressure_ratio"
        ),
    )
    borings: tuple[Boring, ...] = Field(default=(), description="borings, one table [[triggering.borings]] for each")


def left_to_borings(data: Mapping[str, Any]) -> bool:
    """Return whether borings determine all liquefying strata of a section file.

    Parameters
    ----------
    data : the tables of the file as read, which may contain anything

    Returns
    -------
    True if [triggering] has borings and names no cases, at least one stratum or zone liquefies, and all that do have
    `liquefies_in = "triggered"`.
    """
    settings = data.get("triggering")
    if not isinstance(settings, Mapping) or "cases" in settings or not settings.get("borings"):
        return False
    lists = [data.get("strata"), data.get("zones")]
    soils = [soil for soils in lists if isinstance(soils, list | tuple) for soil in soils if isinstance(soil, Mapping)]
    liquefy = [soil["liquefies_in"] for soil in soils if soil.get("liquefies_in")]
    return bool(liquefy) and all(isinstance(cases, str) and cases == TRIGGERED for cases in liquefy)


class FreeFaceSettings(Model):
    """Holds toe and top of a free face, and the place behind it for which the displacement is required."""

    crest: Coordinate | None = Field(default=None, description="x of the upper edge of the free face")
    toe: Coordinate | None = Field(default=None, description="x of the foot of the free face")
    at: Coordinate | None = Field(
        default=None,
        description="x behind the crest at which the displacement is computed; by default that of the crest",
    )

    def problems(self, ground: np.ndarray) -> list[str]:
        """Return problems of the free face on this ground, points (n, 2) in m, one sentence each."""
        if self.crest is None and self.toe is None and self.at is None:
            return []
        problems = [f"free_face, {key}: missing; expected both crest and toe" for key in ("crest", "toe")
                if getattr(self, key) is None]  # fmt: skip
        for key in ("crest", "toe", "at"):
            value = getattr(self, key)
            if value is not None and not ground[0, 0] <= value <= ground[-1, 0]:
                problems.append(f"free_face, {key} = {value:g}: off the section, which goes from {ground[0, 0]:g} to "
                            f"{ground[-1, 0]:g} m")  # fmt: skip
        if self.crest is None or self.toe is None or problems:
            return problems
        distance, height = self.distance_and_height(ground)
        if distance <= 0.0:
            problems.append("free_face, at: expected a place behind the toe, where the displacement is computed")
        if height <= 0.0:
            problems.append(f"free_face: the ground at the crest, x = {self.crest:g} m, is not above that at the toe")
        if self.at is not None and (self.at - self.crest) * (self.toe - self.crest) > 0.0:
            problems.append(
                f"free_face, at = {self.at:g}: lies on the side of the toe; expected a place behind the crest"
            )
        return problems

    def distance_and_height(self, ground: np.ndarray) -> tuple[float, float]:
        """Return the distance L (m) from the toe to the required place, and the height H (m) of the free face."""
        if self.crest is None or self.toe is None:
            raise ValueError("the section has no free face")
        upper, lower = points_at(ground, self.crest)[:, 1].max(), points_at(ground, self.toe)[:, 1].min()
        place = self.crest if self.at is None else self.at
        return abs(float(place) - float(self.toe)), float(upper - lower)

    def __bool__(self) -> bool:
        return self.toe is not None


def implausible_triggering(
    section: Section, earthquake: EarthquakeSettings, triggering: TriggeringSettings
) -> list[str]:
    """Return one sentence on each implausible number of the earthquake, the rods and the tests.

    Parameters
    ----------
    section : the section, whose settings may declare unusual numbers
    earthquake, triggering : tables of the input

    Returns
    -------
    The sentences; none if unusual numbers are declared as such.
    """
    if section.unusual:
        return []
    return [*_of_the_earthquake(earthquake), *_of_the_rods(triggering), *implausible_tests(triggering.borings)]


def _of_the_earthquake(earthquake: EarthquakeSettings) -> Iterator[str]:
    for key, limits in (("depth", DEPTH), ("distance", DISTANCE), ("vs30", VS30)):
        value = getattr(earthquake, key)
        if value is not None and not is_within(value, limits):
            yield sentence(f"earthquake, {key}", value, limits)


def _of_the_rods(triggering: TriggeringSettings) -> Iterator[str]:
    if not is_within(triggering.rods_above, RODS):
        yield sentence("triggering, rods_above", triggering.rods_above, RODS)
