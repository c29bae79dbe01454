"""Computes the peak acceleration from magnitude and distance, by two Japanese relations.

Accelerations in m/s², distances and depths in m, magnitudes without a unit; σ is the standard deviation of log10.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from meshes.errors import InputError

GAL = 0.01  # m/s²
Mechanism = Literal["crustal", "interplate", "intraplate"]
Site = Literal["rock", "average", "soft"]

SI_MIDORIKAWA = "H. Si, S. Midorikawa, J. Struct. Constr. Eng., AIJ 523 (1999) 63-70"
FUKUSHIMA_TANAKA = "Y. Fukushima, T. Tanaka, Bull. Seism. Soc. Am. 80 (1990) 757-783"

OF_EVENT: Mapping[Mechanism, float] = {"crustal": 0.0, "interplate": 0.01, "intraplate": 0.22}  # Si & Midorikawa's d
ON_GROUND: Mapping[Site, float] = {"rock": 0.6, "average": 1.0, "soft": 1.4}  # Fukushima & Tanaka, over average ground


@dataclass(frozen=True)
class ValidRange:
    """Holds the range of validity of a relation: ``low`` to ``high`` of the quantity ``name``, in ``unit``."""

    name: str
    low: float
    high: float
    unit: str = ""

    def problem(self, value: float, relation: str) -> str:
        """Return the reason why a value cannot be used; empty if it can."""
        if self.low <= value <= self.high:
            return ""
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"{self.name} = {value:g}{unit}: outside the range of {relation}, from {self.low:g} to {self.high:g}{unit}"
        )


@dataclass(frozen=True)
class PeakMotion:
    """Holds a peak acceleration with its scatter and its source.

    Attributes
    ----------
    median : median of the peak (m/s²), or the peak itself if it is given or recorded
    sigma : standard deviation of its log10; 0 if the peak is given or recorded
    relation : name of the relation, in words
    source : publication of the relation
    validity : range of the relation, in words
    """

    median: float
    sigma: float
    relation: str
    source: str
    validity: str

    @property
    def high(self) -> float:
        """Return the median times ten to the standard deviation: 84 % of earthquakes stay below (m/s²)."""
        return self.median * 10.0**self.sigma

    @property
    def low(self) -> float:
        """Return the median over ten to the standard deviation: 16 % of earthquakes stay below (m/s²)."""
        return self.median / 10.0**self.sigma


def si_midorikawa(magnitude: float, distance: float, depth: float, mechanism: Mechanism) -> PeakMotion:
    """Return the peak acceleration by Si & Midorikawa (1999): log A = b - log(X + c) - 0.003 X, A in gal, X in km.

    b = 0.50 Mw + 0.0043 D + d + 0.61, c = 0.0055 10^(0.50 Mw), d = 0.00, 0.01, 0.22 for crustal, interplate and
    intraplate earthquakes; σ = 0.27. ``magnitude`` is the moment magnitude, ``distance`` X the shortest distance to the
    fault plane, ``depth`` D the depth of the middle of the fault plane. A is the larger of both horizontal components.
    Raises InputError outside Mw 5.8-8.3, X up to 300 km, D up to 120 km. ``mechanism``: crustal, interplate or
    intraplate.
    """
    kilometres, deep = distance / 1000.0, depth / 1000.0
    relation = "Si & Midorikawa (1999)"
    check_range(
        relation,
        (ValidRange("magnitude", 5.8, 8.3), magnitude),
        (ValidRange("distance", 0.0, 300.0, "km"), kilometres),
        (ValidRange("depth", 0.0, 120.0, "km"), deep),
    )
    b = 0.50 * magnitude + 0.0043 * deep + OF_EVENT[mechanism] + 0.61
    c = 0.0055 * 10.0 ** (0.50 * magnitude)
    median = GAL * 10.0 ** (b - math.log10(kilometres + c) - 0.003 * kilometres)
    validity = "Mw 5.8-8.3, 0-300 km from the fault plane, down to 120 km; firm ground; larger component"
    return PeakMotion(median, 0.27, f"{relation}, {mechanism}", SI_MIDORIKAWA, validity)


def fukushima_tanaka(magnitude: float, distance: float, site: Site) -> PeakMotion:
    """Return the peak acceleration by Fukushima & Tanaka (1990): log A = 0.41 M - log(R + 0.032 10^(0.41 M)) - 0.0034 R
    + 1.30, A in gal, R in km.

    σ = 0.21. ``distance`` R is the shortest distance to the fault. The relation is for average ground; the authors say
    that the peak is 40 % smaller on rock and 40 % larger on soft soil. The peak is the mean of both horizontal
    components. Raises InputError outside M 4.6-8.2, R up to 300 km.
    """
    kilometres = distance / 1000.0
    relation = "Fukushima & Tanaka (1990)"
    check_range(
        relation, (ValidRange("magnitude", 4.6, 8.2), magnitude), (ValidRange("distance", 0.0, 300.0, "km"), kilometres)
    )
    near = kilometres + 0.032 * 10.0 ** (0.41 * magnitude)
    logarithm = 0.41 * magnitude - math.log10(near) - 0.0034 * kilometres + 1.30
    median = GAL * 10.0**logarithm * ON_GROUND[site]
    validity = "M 4.6-8.2, 0-300 km from the fault, shallow earthquakes of Japan; mean of both components"
    return PeakMotion(median, 0.21, f"{relation}, {site} ground", FUKUSHIMA_TANAKA, validity)


def check_range(relation: str, *values: tuple[ValidRange, float]) -> None:
    """Raise InputError with all values outside the range of a relation."""
    problems = [problem for limits, value in values if (problem := limits.problem(value, relation))]
    if problems:
        raise InputError("earthquake", problems)
