"""Computes the consequences of liquefaction: residual strength, strain potential, and volumetric strain by drainage."""

import math
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from workflow.earthquake.triggering.assessment import (
    TestResult,
    TriggeringAssessment,
    fines_of,
    judged_in_stratum,
    normalised_counts,
)
from workflow.earthquake.triggering.blow_count import KPA
from workflow.earthquake.triggering.residual import RELATIONS, Penetration
from workflow.earthquake.triggering.settings import CaseName, TriggeringSettings

ISHIHARA_YOSHIMINE = (
    "K. Ishihara, M. Yoshimine, Soils and Foundations 32 (1992) 173-188, in the form of Idriss & Boulanger (2008)"
)
STRAIN_VALIDITY = "clean sand, and silty sand by (N1)60cs; level ground"
SEED = "H. B. Seed, P. P. Martin, J. Lysmer, J. Geotech. Eng. Div. 102 (1976) 323-346"
PRESSURE_VALIDITY = "clean sand, undrained; F_L from 1 to 2"
SAFE_FACTOR = 2.0  # F_L from which there is no strain
# b, the slope of cyclic strength against cycles, and α, how pore pressure rises with cycles (Seed et al. 1976).
CYCLIC_SLOPE, PRESSURE_POWER = 0.34, 0.7


def limiting_shear_strain(clean: float) -> float:
    """Return the limiting shear strain γ_lim = 1.859 (1.1 - √(N/46))³, from 0 to 0.5, N = (N1)60cs."""
    return min(0.5, max(0.0, 1.859 * (1.1 - math.sqrt(clean / 46.0)) ** 3))


def limiting_factor(clean: float) -> float:
    """Return F_α = 0.032 + 0.69 √N - 0.13 N, N = (N1)60cs of at least 7: the F_L at which γ_lim is reached."""
    n = max(7.0, clean)
    return 0.032 + 0.69 * math.sqrt(n) - 0.13 * n


def shear_strain(factor: float, clean: float) -> float:
    """Return the maximum shear strain γ_max = 0.035 (2 - F_L)(1 - F_α)/(F_L - F_α), at most γ_lim; γ_lim up to F_L =
    F_α, 0 from F_L = 2 on."""
    if factor >= SAFE_FACTOR:
        return 0.0
    limit, alpha = limiting_shear_strain(clean), limiting_factor(clean)
    if factor <= alpha:
        return limit
    return max(0.0, min(limit, 0.035 * (SAFE_FACTOR - factor) * (1.0 - alpha) / (factor - alpha)))


def volumetric_strain(factor: float, clean: float) -> float:
    """Return the volumetric strain by drainage after the earthquake: ε_v = 1.5 exp(-0.369 √N) min(0.08, γ_max)."""
    return 1.5 * math.exp(-0.369 * math.sqrt(clean)) * min(0.08, shear_strain(factor, clean))


def pore_pressure_ratio(factor: float) -> float:
    """Return the excess pore pressure over σ'v: r_u = (2/π) arcsin(F_L^(-1/(2 α b))), 1 if F_L is at most 1.

    The number of cycles of the earthquake over the number of cycles to liquefaction is F_L^(-1/b), with the slope b =
    0.34 of cyclic strength (Idriss & Boulanger 2008), and r_u rises with this ratio as found by Seed, Martin & Lysmer
    (1976), with α = 0.7.
    """
    if factor <= 1.0:
        return 1.0
    return 2.0 / math.pi * math.asin(factor ** (-1.0 / (2.0 * PRESSURE_POWER * CYCLIC_SLOPE)))


CHOICE: Mapping[CaseName, Callable[[Sequence[float]], float]] = {
    "median": statistics.median,
    "low strength": min,
    "high strength": max,
}


@dataclass(frozen=True)
class ResidualStrength:
    """Holds the residual strength of a stratum that liquefies, as means over the area of its tests with F_L below 1.

    Attributes
    ----------
    stratum : index of the stratum
    ratios, strengths : residual strength over σ'v, and in Pa, by the name of the relation; a test that is denser
        than the cases of a relation counts as the densest of these cases. A relation that holds for no test is left
        out if another relation holds for some tests.
    volumetric_strain : volumetric strain by drainage (-)
    strain_potential : shear strain before the stratum regains strength (-)
    """

    stratum: int
    ratios: dict[str, float]
    strengths: dict[str, float]
    volumetric_strain: float
    strain_potential: float

    def ratio(self, case: CaseName) -> float:
        """Return the residual strength over σ'v of a case by the name of the case."""
        return CHOICE[case](list(self.ratios.values()))

    def strength(self, case: CaseName) -> float:
        """Return the residual strength (Pa) of a case by the name of the case."""
        return CHOICE[case](list(self.strengths.values()))


def residual_strengths(assessment: TriggeringAssessment, settings: TriggeringSettings) -> tuple[ResidualStrength, ...]:
    """Return the residual strength of every stratum in which at least one test has F_L below 1.

    Parameters
    ----------
    assessment : tests with F_L
    settings : normalisation of blow counts, and whether water gathers below a layer of low permeability

    Returns
    -------
    Residual strength by three relations, and strains, of each of these strata in the order of the section.
    """
    strata = [k for k in range(len(assessment.strata)) if _liquefying(assessment, k)]
    return tuple(_of_stratum(k, assessment, settings) for k in strata)


def _liquefying(assessment: TriggeringAssessment, number: int) -> list[TestResult]:
    """Return the tests of a stratum with F_L below 1."""
    names = [stratum.name for stratum in assessment.strata]
    return [test for test in judged_in_stratum(names, number, assessment.tests) if test.liquefies]


def pore_pressures(assessment: TriggeringAssessment, strata: int) -> list[float]:
    """Return the excess pore pressure ratio of every stratum, the mean over the area of its tests.

    Parameters
    ----------
    assessment : tests with F_L
    strata : number of strata

    Returns
    -------
    Ratios (-) to the vertical effective stress, see `pore_pressure_ratio`, from 0 to 1; a test without F_L counts as 0,
    one with F_L up to 1 as 1, and a stratum without tests has 0.
    """
    ratios = []
    for k in range(strata):
        tests_in_stratum = judged_in_stratum([stratum.name for stratum in assessment.strata], k, assessment.tests)
        pressures = [0.0 if test.factor is None else pore_pressure_ratio(test.factor) for test in tests_in_stratum]
        ratios.append(mean_of_tests(tests_in_stratum, pressures))
    return ratios


def _of_stratum(number: int, assessment: TriggeringAssessment, settings: TriggeringSettings) -> ResidualStrength:
    tests = _liquefying(assessment, number)
    counts = [normalised_counts(test, settings) for test in tests]
    soils = [
        Penetration(n1, fines_of(test), test.overburden.effective / KPA, settings.water_gathers)
        for test, (n1, _) in zip(tests, counts, strict=True)
    ]
    ratios, strengths = {}, {}
    holding = [relation for relation in RELATIONS if any(relation.ratio(soil) is not None for soil in soils)]
    for relation in holding or RELATIONS:
        least = [relation.least_ratio(soil) for soil in soils]
        ratios[relation.title] = mean_of_tests(tests, least)
        residuals = [KPA * soil.effective * ratio for soil, ratio in zip(soils, least, strict=True)]
        strengths[relation.title] = mean_of_tests(tests, residuals)
    pairs = [(test.factor, clean) for test, (_, clean) in zip(tests, counts, strict=True)]
    drained, sheared = (
        mean_of_tests(tests, [0.0 if factor is None else strain(factor, clean) for factor, clean in pairs])
        for strain in (volumetric_strain, shear_strain)
    )
    return ResidualStrength(number, ratios, strengths, drained, sheared)


def mean_of_tests(tests: Sequence[TestResult], values: Sequence[float]) -> float:
    """Return the mean of a value over the area of ground that tests represent.

    Parameters
    ----------
    tests : n tests
    values : values (n,) at the tests

    Returns
    -------
    The mean in the unit of the values; 0 without tests.
    """
    total = sum(test.area for test in tests)
    return sum(test.area * value for test, value in zip(tests, values, strict=True)) / total if total > 0.0 else 0.0
