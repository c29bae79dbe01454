"""Stores F_L at every blow count, the strata that liquefy, and P_L of every boring in triggering.json."""

# ruff: noqa: N815 (units are written as they are)

from typing import ClassVar, Self

from pydantic import Field

from meshes.borings.boring import Cone, Sample
from workflow.config import Config
from workflow.earthquake.attenuation import GAL
from workflow.earthquake.triggering.assessment import TestResult, TriggeringAssessment
from workflow.earthquake.triggering.consequences import (
    ISHIHARA_YOSHIMINE,
    PRESSURE_VALIDITY,
    SEED,
    STRAIN_VALIDITY,
    pore_pressures,
    residual_strengths,
)
from workflow.earthquake.triggering.potential import SOURCE, risk
from workflow.earthquake.triggering.residual import RELATIONS
from workflow.results.answer import Answer, Known, Part, SectionLabel


class MotionPart(Part):
    """Holds the peak acceleration from which F_L follows: median, and one standard deviation above and below."""

    median_gal: float = Field(
        description="median of the peak acceleration, or the peak itself if it is given or recorded"
    )
    low_gal: float = Field(description="one standard deviation below the median")
    high_gal: float = Field(description="one standard deviation above the median")
    sigma: float = Field(
        description=(
            "standard deviation of the common logarithm of the peak acceleration; 0 if the acceleration is given"
        )
    )
    relation: str = Field(description="name of the ground motion relation")
    source: str = Field(description="publication of the relation")
    validity: str = Field(description="range of validity of the relation")


class TestPart(Part):
    """Holds one test with its place, stresses, and F_L. F_L is None, with the reason, if the test was not assessed."""

    __test__ = False  # no test of pytest's

    boring: str = Field(description="name of the boring")
    x_m: float = Field(description="x of the boring")
    depth_m: float = Field(description="depth of the test below the ground surface")
    top_m: float = Field(description="upper end of the range of depth that the test represents")
    bottom_m: float = Field(description="lower end of the range of depth that the test represents")
    stratum: str = Field(description="name of the stratum")
    N: float | None = Field(description="blow count; None for a cone test")
    qc_Pa: float | None = Field(default=None, description="cone resistance; None for a blow count")
    fines_percent: float | None = Field(
        description="fines content; None if it is not known, which counts as clean sand"
    )
    total_Pa: float = Field(description="total vertical stress of the ground, without water that stands on it")
    effective_Pa: float = Field(description="vertical effective stress")
    normalised: Known = Field(description="normalised resistance: (N1)60, N1 or qc1N")
    corrected: Known = Field(description="normalised resistance with correction for fines: (N1)60cs, Na or qc1Ncs")
    load: Known = Field(description="cyclic stress ratio of the earthquake")
    resistance: Known = Field(
        description="cyclic resistance ratio of the soil; None if it is beyond the range of the method"
    )
    factor: Known = Field(description="factor against liquefaction F_L, at most 2")
    reason: str = Field(description="reason why the test was not assessed")

    @classmethod
    def of(cls, test: TestResult, stratum: str) -> Self:
        """Return the place, stresses and F_L of one penetration test in the stratum with this name."""
        stresses = (
            vars(test.outcome) if test.outcome else dict.fromkeys(("normalised", "corrected", "load", "resistance"))
        )
        return cls.taken(
            test,
            x_m=test.x,
            depth_m=test.sample.depth,
            top_m=test.top,
            bottom_m=test.bottom,
            stratum=stratum,
            N=test.sample.N if isinstance(test.sample, Sample) else None,
            qc_Pa=test.sample.qc if isinstance(test.sample, Cone) else None,
            fines_percent=test.sample.fines,
            total_Pa=test.overburden.total,
            effective_Pa=test.overburden.effective,
            **stresses,
        )


class StratumPart(Part):
    """Holds the share of a stratum that liquefies."""

    name: str = Field(description="name of the stratum")
    tests: int = Field(description="number of tests in the stratum")
    assessed: int = Field(description="number of the tests that have an F_L")
    share: float | None = Field(
        description="share of the stratum in which F_L is below 1; null without any test in the stratum"
    )
    lowest_factor: float | None = Field(description="smallest F_L; null if no test was assessed")
    liquefies: bool = Field(description="whether the share reaches that from which a stratum counts as liquefied")
    reason: str = Field(description="reason why the stratum, or some of its tests, were not assessed")
    pore_pressure: float = Field(description="mean excess pore pressure over the vertical effective stress")

    @property
    def description(self) -> str:
        """Return whether the stratum liquefies, as text for tables."""
        if not self.assessed:
            return f"not assessed: {self.reason}"
        rest = f" ({self.assessed} of {self.tests} tests assessed)" if self.assessed < self.tests else ""
        return f"{'yes' if self.liquefies else 'no'}{rest}"


class BoringPart(Part):
    """Holds the liquefaction potential of a boring (Iwasaki et al. 1978), and the risk in words (1982)."""

    name: str = Field(description="name of the boring")
    potential: float = Field(description="liquefaction potential P_L, from 0 to 100")
    risk: str = Field(description="risk in words")


class ResidualPart(Part):
    """Holds the residual strength of a stratum from its blow counts with F_L below 1."""

    stratum: str = Field(description="name of the stratum")
    residual: dict[str, float] = Field(description="residual strength over the vertical effective stress, by relation")
    strength_Pa: dict[str, float] = Field(description="residual strength at the places of the tests, by relation")
    volumetric_strain: float = Field(description="volumetric strain by drainage after the earthquake")
    strain_potential: float = Field(
        default=0.0, description="shear strain that the soil undergoes before it regains strength"
    )


class RelationPart(Part):
    """Holds a relation that was used: name, publication, and range of validity."""

    title: str = Field(description="name of the relation")
    source: str = Field(description="publication of the relation")
    validity: str = Field(description="range of validity of the relation")


class TriggeringAnswer(Answer):
    """Holds the results of the triggering analysis at the borings."""

    FILE: ClassVar[str] = "triggering.json"

    section: SectionLabel = Field(description="section of the borings")
    motion: MotionPart = Field(description="peak acceleration at the ground surface")
    magnitude: float | None = Field(description="moment magnitude; null if the input has none")
    method: str = Field(description="method of F_L")
    source: str = Field(description="publication of the method")
    validity: str = Field(description="range of validity of the method")
    potential_source: str = Field(default=SOURCE, description="publication of the liquefaction potential P_L")
    share: float = Field(description="share of a stratum with F_L below 1 from which the stratum counts as liquefied")
    strata: tuple[StratumPart, ...] = Field(description="strata in the order of the section")
    borings: tuple[BoringPart, ...] = Field(description="liquefaction potential of every boring")
    tests: tuple[TestPart, ...] = Field(description="all tests, boring by boring")
    residual_strengths: tuple[ResidualPart, ...] = Field(
        description="strata with an F_L below 1, with their residual strengths and strains"
    )
    relations: tuple[RelationPart, ...] = Field(
        description="relations used for residual strength, volumetric strain and pore pressure"
    )

    @classmethod
    def of(cls, config: Config, assessment: TriggeringAssessment) -> Self:
        """Return the results of a triggering analysis, with the section and the sources of the relations used."""
        pressures = pore_pressures(assessment, len(config.section.strata))
        motion, relation = assessment.motion, assessment.relation
        gal = {f"{name}_gal": getattr(motion, name) / GAL for name in ("median", "low", "high")}
        return cls(
            section=SectionLabel.of(config.section),
            motion=MotionPart.taken(motion, **gal),
            magnitude=assessment.magnitude,
            method=relation.title,
            source=relation.source,
            validity=relation.validity,
            share=config.triggering.share,
            strata=tuple(
                StratumPart.taken(stratum, lowest_factor=stratum.lowest, pore_pressure=pressure)
                for stratum, pressure in zip(assessment.strata, pressures, strict=True)
            ),
            borings=tuple(
                BoringPart(name=name, potential=value, risk=risk(value))
                for name, value in assessment.potentials.items()
            ),
            tests=tuple(
                TestPart.of(test, config.section.strata[test.overburden.stratum].name) for test in assessment.tests
            ),
            residual_strengths=tuple(
                ResidualPart(
                    stratum=config.section.strata[layer.stratum].name,
                    residual=layer.ratios,
                    strength_Pa=layer.strengths,
                    volumetric_strain=layer.volumetric_strain,
                    strain_potential=layer.strain_potential,
                )
                for layer in residual_strengths(assessment, config.triggering)
            ),
            relations=(
                *(RelationPart.model_validate(relation) for relation in RELATIONS),
                RelationPart(title="Ishihara & Yoshimine (1992)", source=ISHIHARA_YOSHIMINE, validity=STRAIN_VALIDITY),
                RelationPart(title="pore pressure, Seed et al. (1976)", source=SEED, validity=PRESSURE_VALIDITY),
            ),
        )
