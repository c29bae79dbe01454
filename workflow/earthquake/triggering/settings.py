"""Defines method and borings of the triggering analysis (the table [triggering] of the input file), and the free face
of lateral spreads."""

from collections.abc import Mapping
from typing import Any, Literal, get_args

import numpy as np
from pydantic import Field, StrictBool

from meshes.borings.boring import Boring
from meshes.section.liquefies import TRIGGERED
from meshes.section.quantity import Coordinate, Length
from meshes.section.section import Model
from workflow.earthquake.triggering.highway_code import MotionType

TriggeringMethod = Literal[
    "idriss_boulanger_2008", "boulanger_idriss_2014", "highway_1990", "highway_2012", "highway_2017"
]

CaseName = Literal["median", "low strength", "high strength"]
CASE_NAMES: tuple[CaseName, ...] = get_args(CaseName)
Residual = Literal["strength", "ratio"]


class TriggeringSettings(Model):
    """Holds the settings of the triggering analysis: the relation, the energy of the hammer, and the borings."""

    method: TriggeringMethod = Field(
        default="idriss_boulanger_2008",
        description='"idriss_boulanger_2008", or a form of the Japanese highway code: "highway_1990" (that behind the '
        'paper), "highway_2012", "highway_2017"; "boulanger_idriss_2014" for cone penetration tests',
    )
    energy_ratio: float = Field(
        default=60.0,
        ge=20.0,
        le=120.0,
        description="energy of the hammer in percent of its free fall, from 20 to 120, for "
        "borings that give none; only for Idriss & Boulanger",
    )
    rods_above: Length = Field(
        default=1.5, description='length of the rods above the ground, such as "1.5 m"; for Idriss & Boulanger'
    )
    motion: MotionType = Field(
        default="I", description='type of motion of the highway code from 2012 on: "I" plate boundary, "II" inland'
    )
    share: float = Field(
        default=0.5,
        gt=0.0,
        le=1.0,
        description="share of a stratum in which F_L has to be below 1 for the stratum to liquefy",
    )
    cases: tuple[CaseName, ...] = Field(
        default=(),
        description="cases of the slide that follow from the blow counts, after those that [slide] gives, in place of "
        'its default ones: "median", "low strength", "high strength", by the residual strengths of three relations; '
        "all three where [slide] has no cases and whatever liquefies is triggered",
    )
    residual: Residual = Field(
        default="strength",
        description='what these cases keep: "strength", that of the soil where it was tested, in kPa and all over the '
        "stratum, since it fails undrained and depends on its density, and not on what lies above; "
        'or "ratio", a share of the vertical effective stress of each place',
    )
    water_gathers: StrictBool = Field(
        default=True,
        description="whether water gathers below a layer of low permeability on top of the liquefied one; false "
        "where there is no such layer: Idriss & Boulanger (2008) then give a larger residual strength",
    )
    pore_pressure: StrictBool = Field(
        default=False,
        description="true if strata that do not liquefy, and have no excess_pore_pressure_ratio, get the mean one of "
        "their tests (F_L from 1 to 2)",
    )
    borings: tuple[Boring, ...] = Field(default=(), description="one table [[triggering.borings]] for each boring")


def left_to_blow_counts(data: Mapping[str, Any]) -> bool:
    """Return whether blow counts determine all liquefying strata of a section file: [triggering] has borings and names
    no cases.

    ``data``: the tables of the file as read, which may contain anything.
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

    crest: Coordinate | None = Field(default=None, description="the x of its upper edge")
    toe: Coordinate | None = Field(default=None, description="the x of its foot")
    at: Coordinate | None = Field(
        default=None, description="the x, behind the crest, where the displacement is computed; by default the crest"
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
        if self.distance_and_height(ground)[1] <= 0.0:
            problems.append(f"free_face: the ground at the crest, x = {self.crest:g} m, is not above that at the toe")
        if self.at is not None and (self.at - self.crest) * (self.toe - self.crest) > 0.0:
            problems.append(f"free_face, at = {self.at:g}: lies before the crest; expected a place behind it")
        return problems

    def distance_and_height(self, ground: np.ndarray) -> tuple[float, float]:
        """Return the distance L (m) from the toe to the required place, and the height H (m) of the free face."""
        if self.crest is None or self.toe is None:
            raise ValueError("the section has no free face")
        upper, lower = np.interp([self.crest, self.toe], *ground.T)
        place = self.crest if self.at is None else self.at
        return abs(float(place) - float(self.toe)), float(upper - lower)

    def __bool__(self) -> bool:
        return self.toe is not None
