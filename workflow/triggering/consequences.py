"""Consequences of liquefaction: residual strength, volumetric strain by drainage, and cases made of both."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from workflow.triggering.assessment import Assessment, Judged, fines_of, normalised_counts
from workflow.triggering.blow_count import KPA
from workflow.triggering.residual import RELATIONS, Penetration
from workflow.triggering.settings import CaseName, TriggeringSettings
from workflow.triggering.strains import pore_pressure_ratio, volumetric_strain

CHOICE: Mapping[CaseName, Callable[[Sequence[float]], float]] = {
    "median": statistics.median,
    "low strength": min,
    "high strength": max,
}


@dataclass(frozen=True)
class Left:
    """What is left of a stratum that liquefies; means over what its tests with F_L below 1 stand for.

    Attributes
    ----------
    stratum : index of the stratum
    ratios, strengths : residual strength over σ'v, and in Pa, by relation; a relation that holds for none of the tests
        is left out, tests that are denser than its cases count as dense as these
    volumetric_strain : what drains away, without a unit
    """

    stratum: int
    ratios: dict[str, float]
    strengths: dict[str, float]
    volumetric_strain: float

    def ratio(self, case: CaseName) -> float:
        """The residual strength over σ'v of a case by name; ValueError where no relation holds."""
        return self._of(self.ratios, case)

    def strength(self, case: CaseName) -> float:
        """The residual strength (Pa) of a case by name; ValueError where no relation holds."""
        return self._of(self.strengths, case)

    def _of(self, values: Mapping[str, float], case: CaseName) -> float:
        if not values:
            raise ValueError("none of the relations of residual strength holds for blow counts as high as these")
        return CHOICE[case](list(values.values()))


def left(assessment: Assessment, settings: TriggeringSettings) -> tuple[Left, ...]:
    """Residual strength of every stratum in which some test liquefies."""
    strata = sorted({test.where.stratum for test in assessment.tests if test.liquefies})
    return tuple(_of_stratum(k, assessment, settings) for k in strata)


def pore_pressures(assessment: Assessment, strata: int) -> list[float]:
    """Mean excess pore pressure ratio of every stratum, over what its tests stand for: 1 where F_L is at most 1."""
    ratios = []
    for k in range(strata):
        here = [test for test in assessment.tests if test.where.stratum == k]
        pressures = [0.0 if test.factor is None else pore_pressure_ratio(test.factor) for test in here]
        ratios.append(_mean(here, pressures))
    return ratios


def _of_stratum(number: int, assessment: Assessment, settings: TriggeringSettings) -> Left:
    tests = [test for test in assessment.tests if test.liquefies and test.where.stratum == number]
    counts = [normalised_counts(test, settings) for test in tests]
    soils = [
        Penetration(n1, fines_of(test), test.where.effective / KPA, settings.water_gathers)
        for test, (n1, _) in zip(tests, counts, strict=True)
    ]
    ratios, strengths = {}, {}
    for relation in RELATIONS:
        if all(relation.ratio(soil) is None for soil in soils):
            continue
        least = [relation.least_ratio(soil) for soil in soils]
        ratios[relation.title] = _mean(tests, least)
        kept = [KPA * soil.effective * ratio for soil, ratio in zip(soils, least, strict=True)]
        strengths[relation.title] = _mean(tests, kept)
    strains = [
        volumetric_strain(test.factor, clean) if test.factor is not None else 0.0
        for test, (_, clean) in zip(tests, counts, strict=True)
    ]
    return Left(number, ratios, strengths, _mean(tests, strains))


def _mean(tests: Sequence[Judged], values: Sequence[float]) -> float:
    """The mean over the area that tests represent; 0 without any."""
    total = sum(test.area for test in tests)
    return sum(test.area * value for test, value in zip(tests, values, strict=True)) / total if total > 0.0 else 0.0
