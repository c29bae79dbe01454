"""Defines the limits that the answers are compared with (the table [criteria] of the input file), and the verdict."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, Self

from pydantic import Field

from meshes.section.model import Model
from meshes.section.quantity import Coordinate, Height, Length

Preset = Literal["hynes_griffin_franklin_1984", "nchrp_611", "eurocode_8_5", "crest_above_water"]


@dataclass(frozen=True)
class PublishedCriterion:
    """Holds a published criterion: the required factor of safety under a share of the peak acceleration, the largest
    displacement of ground with this factor, and the freeboard that has to remain.

    Attributes
    ----------
    source : publication and range of validity as in its text (docs/how-to/levee_criteria.md); "" without publication
    factor : least factor of safety; None if the publication requires none
    factor_undrained : least factor of safety of ground with undrained strengths; None if it is the same
    share : Kh over the peak acceleration of the ground, both as multiples of g
    displacement : largest displacement (m) of ground with this factor; None if the publication states none
    freeboard : least height (m) of the crest above the water after the earthquake; None without this limit
    """

    source: str
    factor: float | None = None
    factor_undrained: float | None = None
    share: float = 0.5
    displacement: float | None = None
    freeboard: float | None = None


PRESETS: Mapping[Preset, PublishedCriterion] = {
    # Newmark's block in more than 350 records: dams with F > 1 at half of the peak slide by up to about 1 m (Kramer
    # 1996, 10.6.1). Strengths are 80 % of the static ones, so that F of the static strengths has to reach 1 / 0.8.
    "hynes_griffin_franklin_1984": PublishedCriterion(
        "M. E. Hynes-Griffin & A. G. Franklin, US Army Waterways Experiment Station, MP GL-84-13 (1984); earth dams "
        "that do not liquefy; factor 1.0 with 80 % of the strengths is factor 1.25 with the strengths of the input",
        factor=1.0 / 0.8, share=0.5, displacement=1.0,
    ),
    # Page 103: less than 1 to 2 inches with this C/D ratio, if the ground loses no strength. The report takes the peak
    # after a reduction for wave scattering, which depends on the height; without this reduction Kh is on the safe side.
    "nchrp_611": PublishedCriterion(
        "D. G. Anderson et al., NCHRP Report 611 (2008), chapter 8; slopes that do not liquefy, peak acceleration of "
        "the site, not reduced for wave scattering",
        factor=1.1, share=0.5, displacement=0.05,
    ),
    # F_H = 0.5 α S W, where α S is the peak acceleration of the ground over g. Strengths are divided by recommended
    # partial factors: 1.25 of tan φ' and c', 1.4 of c_u, which a country may change. Mixed ground needs between both.
    "eurocode_8_5": PublishedCriterion(
        "EN 1998-5:2004, 4.1.3.3, with the recommended partial factors of strength of EN 1997-1:2004, table A.4, set "
        "M2; F_V = 0.33 or 0.5 F_H either way is fem.vertical; without the factor of topography of annex A; soils that "
        "do not liquefy or soften",
        factor=1.25, factor_undrained=1.4, share=0.5,
    ),
    "crest_above_water": PublishedCriterion("", freeboard=0.0),  # of no publication whose text was checked
}  # fmt: skip


SOURCE = "source of the limit, such as the name of a guideline"


class FactorCriterion(Model):
    """Holds the smallest factor of safety allowed, the table [criteria.factor_of_safety] of the input file."""

    limit: float = Field(gt=0.0, le=100.0, description="the least factor of safety, such as 1.2")
    kh: float = Field(default=0.0, ge=0.0, le=2.0, description="Kh at which this factor of safety is required")
    source: str = Field(default="", description=SOURCE)


class KhCriterion(Model):
    """Holds the smallest critical Kh allowed, the table [criteria.critical_kh] of the input file."""

    limit: float = Field(gt=0.0, le=2.0, description="the least critical Kh, such as 0.15")
    source: str = Field(default="", description=SOURCE)


class LengthCriterion(Model):
    """Holds the largest displacement or settlement allowed, the table [criteria.displacement] or
    [criteria.crest_settlement]."""

    limit: Length = Field(description='the largest length allowed, such as "0.3 m"')
    source: str = Field(default="", description=SOURCE)


class FreeboardCriterion(Model):
    """Holds the smallest freeboard allowed after the earthquake, the table [criteria.freeboard] of the input file."""

    limit: Height = Field(description='the least height of the crest above the water, such as "0.5 m", or 0')
    water: Coordinate | None = Field(
        default=None,
        description="elevation of the water (m), such as 12.5; by default that of the water table beside the structure",
    )
    source: str = Field(default="", description=SOURCE)


class CriteriaSettings(Model):
    """Holds the limits of all criteria, each with its source. Quantities without a limit have no verdict."""

    preset: Preset | None = Field(
        default=None,
        description='a named criterion: "hynes_griffin_franklin_1984" (factor 1.25, which is 1 with 80 % of the '
        'strengths, at half of the peak acceleration, for up to 1 m), "nchrp_611" (factor 1.1 at half of it, for up to '
        '2 inches), "eurocode_8_5" (factor 1.25, or 1.4 with undrained strengths, at half of it) or '
        '"crest_above_water" (crest not below the water); limits given in addition take precedence',
    )
    factor_of_safety: FactorCriterion | None = Field(
        default=None, description="the least factor of safety, { limit = 1.2, kh = 0.1, source = ... }"
    )
    critical_kh: KhCriterion | None = Field(default=None, description="the least critical Kh, { limit = 0.15 }")
    displacement: LengthCriterion | None = Field(
        default=None, description='the largest displacement of a structure, { limit = "0.3 m" }'
    )
    crest_settlement: LengthCriterion | None = Field(
        default=None, description='the largest settlement of a crest, { limit = "0.5 m" }'
    )
    freeboard: FreeboardCriterion | None = Field(
        default=None, description='the least freeboard after the earthquake, { limit = "0.5 m", water = 12.5 }'
    )

    def resolved(self, peak: float | None, undrained: bool = False) -> Self:
        """Return the limits of the settings, completed by the limits of the preset. The factor of the preset applies to
        a ``peak`` acceleration of the ground (over gravity), and depends on whether strengths are ``undrained``."""
        if self.preset is None:
            return self
        preset, factor = PRESETS[self.preset], self.factor_of_safety
        limit = preset.factor_undrained or preset.factor if undrained else preset.factor
        displacement, height = self.displacement, self.freeboard
        if factor is None and limit is not None and peak is not None:
            factor = FactorCriterion(limit=limit, kh=round(preset.share * peak, 4), source=preset.source)
        if displacement is None and preset.displacement is not None:
            displacement = LengthCriterion(limit=preset.displacement, source=preset.source)
        if height is None and preset.freeboard is not None:
            height = FreeboardCriterion(limit=preset.freeboard, source=preset.source)
        return self.model_copy(update={"factor_of_safety": factor, "displacement": displacement, "freeboard": height})

    @property
    def lacks_peak(self) -> bool:
        """Return whether a preset could not be resolved because there is no peak acceleration."""
        needs_factor = self.preset is not None and PRESETS[self.preset].factor is not None
        return needs_factor and self.factor_of_safety is None


CriterionVerdict = Literal["satisfied", "not satisfied", "not decided"]


def judge(low: float | None, high: float | None, limit: float, at_least: bool) -> CriterionVerdict:
    """Compare the interval of a quantity with its limit.

    Parameters
    ----------
    low, high : ends of the interval in which the quantity lies; None if there is no answer
    limit : the limit in the unit of the quantity
    at_least : whether the limit is the smallest value allowed; otherwise it is the largest

    Returns
    -------
    The verdict; "not decided" without an answer, or if the limit lies inside the interval.
    """
    if low is None or high is None:
        return "not decided"
    keeps = [value >= limit if at_least else value <= limit for value in (low, high)]
    return "satisfied" if all(keeps) else "not decided" if any(keeps) else "not satisfied"


def common_verdict(verdicts: tuple[CriterionVerdict, ...]) -> CriterionVerdict:
    """Return the common verdict on several criteria, all of which must be satisfied.

    Parameters
    ----------
    verdicts : verdicts on the criteria

    Returns
    -------
    "not satisfied" if one is not satisfied; "not decided" if one is not decided, or without criteria.
    """
    if "not satisfied" in verdicts:
        return "not satisfied"
    return "satisfied" if verdicts and set(verdicts) == {"satisfied"} else "not decided"
