"""Method and borings of the triggering analysis: a table [triggering]."""

from collections.abc import Mapping
from typing import Any, Literal, get_args

from pydantic import Field, StrictBool

from meshes.borings.boring import Boring
from meshes.section.liquefies import TRIGGERED
from meshes.section.quantity import Length
from meshes.section.section import Model
from workflow.earthquake.triggering.highway_code import MotionType

Method = Literal["idriss_boulanger_2008", "boulanger_idriss_2014", "highway_1990", "highway_2012", "highway_2017"]

CaseName = Literal["median", "low strength", "high strength"]
CASE_NAMES: tuple[CaseName, ...] = get_args(CaseName)
Residual = Literal["strength", "ratio"]


class TriggeringSettings(Model):
    """Relation, energy of the hammer, and borings of the triggering analysis."""

    method: Method = Field(
        default="idriss_boulanger_2008",
        description='"idriss_boulanger_2008", or a form of the Japanese highway code: "highway_1990" (that behind the '
        'paper), "highway_2012", "highway_2017"; "boulanger_idriss_2014" for cone penetration tests',
    )
    energy_ratio: float = Field(
        default=60.0,
        ge=20.0,
        le=120.0,
        description="energy of the hammer in percent of its free fall, from 20 to 120, where a blow count has "
        "none of its own; for Idriss & Boulanger alone",
    )
    rods_above: Length = Field(
        default=1.5, description='length of the rods above the ground, such as "1.5 m"; for Idriss & Boulanger'
    )
    motion: MotionType = Field(
        default="I", description='type of motion of the highway code from 2012 on: "I" plate boundary, "II" inland'
    )
    share: float = Field(
        default=0.5, gt=0.0, le=1.0, description="share of a stratum in which F_L is below 1 so that it liquefies"
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
    """Whether blow counts determine all liquefying strata of a section file, and its [triggering] names no cases.

    ``data``: the tables of the file as they were read, which may hold anything.
    """
    settings = data.get("triggering")
    if not isinstance(settings, Mapping) or "cases" in settings or not settings.get("borings"):
        return False
    lists = [data.get("strata"), data.get("zones")]
    soils = [soil for soils in lists if isinstance(soils, list | tuple) for soil in soils if isinstance(soil, Mapping)]
    liquefy = [soil["liquefies_in"] for soil in soils if soil.get("liquefies_in")]
    return bool(liquefy) and all(isinstance(cases, str) and cases == TRIGGERED for cases in liquefy)
