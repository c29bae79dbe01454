"""Computes the residual strength of liquefied ground over the vertical effective stress before the earthquake, by three
relations.

The relations are fitted to back-analysed failures. Stresses are in kPa. Outside the range of a relation the result is
`None`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from workflow.earthquake.triggering.blow_count import ATMOSPHERE

# Fines (%) and by how much they raise (N1)60 where the residual strength is meant (Seed 1987).
FINES = ((10.0, 1.0), (25.0, 2.0), (50.0, 4.0), (75.0, 5.0))


@dataclass(frozen=True)
class Penetration:
    """Holds (N1)60 of a test, fines (%), the vertical effective stress (kPa), and whether water ``gathers`` below a
    less permeable layer and loosens the sand there.
    """

    n1: float
    fines: float
    effective: float
    gathers: bool = True


@dataclass(frozen=True)
class ResidualRelation:
    """Holds a relation of residual strength: its name, its publication, and the soils for which it is valid.

    ``count`` returns the blow count of the relation, ``largest_count`` is the largest blow count of its case histories,
    ``curve`` returns Sr/σ'v for a blow count.
    """

    title: str
    source: str
    validity: str
    largest_count: float
    count: Callable[[Penetration], float]
    curve: Callable[[float, Penetration], float]

    def ratio(self, soil: Penetration) -> float | None:
        """Return Sr/σ'v (-); None if the soil is denser than the case histories of the relation."""
        count = self.count(soil)
        return self.curve(count, soil) if count <= self.largest_count else None

    def least_ratio(self, soil: Penetration) -> float:
        """Return Sr/σ'v (-). For soil denser than the case histories of the relation, return the value at the end of
        their range, which is less than the soil has."""
        return self.curve(min(self.count(soil), self.largest_count), soil)


def fines_addition(fines: float) -> float:
    """Return Δ(N1)60 for the residual strength: 1, 2, 4, 5 at 10, 25, 50, 75 % of fines, linear between, 0 at 0 %."""
    points = ((0.0, 0.0), *FINES)
    for (low, below), (high, above) in pairwise(points):
        if fines <= high:
            return below + (above - below) * (fines - low) / (high - low)
    return FINES[-1][1]


def _with_fines(soil: Penetration) -> float:
    return soil.n1 + fines_addition(soil.fines)


def _plain(soil: Penetration) -> float:
    return soil.n1


def idriss_boulanger(n: float, soil: Penetration) -> float:
    """Return Sr/σ'v = exp(N/16 + ((N - 16)/21.2)³ - 3), N = (N1)60 + Δ, for sand in which water may gather below a less
    permeable layer.

    The ratio is multiplied by 1 + exp(N/2.4 - 6.6) if water can drain upwards: the two curves of Idriss & Boulanger
    (2008).
    """
    gathered = math.exp(n / 16.0 + ((n - 16.0) / 21.2) ** 3 - 3.0)
    return gathered if soil.gathers else gathered * (1.0 + math.exp(n / 2.4 - 6.6))


def olson_stark(n: float, soil: Penetration) -> float:
    """Return su(LIQ)/σ'v = 0.03 + 0.0075 (N1)60, ± 0.03; fines do not count (Olson & Stark)."""
    return 0.03 + 0.0075 * n


def kramer_wang(n: float, soil: Penetration) -> float:
    """Return Sr = exp(-8.444 + 0.109 (N1)60 + 5.379 σ'v^0.1), stresses in atmospheres; the mean (Kramer & Wang)."""
    stress = soil.effective / ATMOSPHERE
    return math.exp(-8.444 + 0.109 * n + 5.379 * stress**0.1) / stress


IDRISS_BOULANGER = ResidualRelation(
    "Idriss & Boulanger (2008)",
    "I. M. Idriss, R. W. Boulanger, Soil Liquefaction during Earthquakes, EERI MNO-12 (2008)",
    "(N1)60 with fines up to 16",
    16.0,
    _with_fines,
    idriss_boulanger,
)
OLSON_STARK = ResidualRelation(
    "Olson & Stark (2002)",
    "S. M. Olson, T. D. Stark, Can. Geotech. J. 39 (2002) 629-647; of lateral spreads, too: S. M. Olson, C. I. "
    "Johnson, J. Geotech. Geoenviron. Eng. 134 (2008) 1035-1049",
    "(N1)60 up to 12; ± 0.03",
    12.0,
    _plain,
    olson_stark,
)
KRAMER_WANG = ResidualRelation(
    "Kramer & Wang (2015)",
    "S. L. Kramer, C.-H. Wang, J. Geotech. Geoenviron. Eng. 141 (2015) 04015038",
    "(N1)60 up to 16; the mean",
    16.0,
    _plain,
    kramer_wang,
)
RELATIONS = (IDRISS_BOULANGER, OLSON_STARK, KRAMER_WANG)
