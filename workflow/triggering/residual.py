"""What strength liquefied ground keeps, over the vertical effective stress before the earthquake, by three relations.

They rest on slides of the past that were computed back. Stresses in kPa; `None` where a relation says nothing.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

from workflow.triggering.blow_count import ATMOSPHERE

# Fines (%) and by how much they raise (N1)60 where the residual strength is meant (Seed 1987).
FINES = ((10.0, 1.0), (25.0, 2.0), (50.0, 4.0), (75.0, 5.0))
# Blow counts up to which there are cases behind each relation.
IDRISS_BOULANGER_TO, OLSON_STARK_TO, KRAMER_WANG_TO = 16.0, 12.0, 16.0


@dataclass(frozen=True)
class Penetration:
    """(N1)60 of a test, fines (%), and the vertical effective stress (kPa)."""

    n1: float
    fines: float
    effective: float


@dataclass(frozen=True)
class Strength:
    """A relation: its name, where it was published, and what it holds for; ``ratio`` finds Sr/σ'v."""

    title: str
    source: str
    validity: str
    ratio: Callable[[Penetration], float | None]


def fines_addition(fines: float) -> float:
    """Δ(N1)60 for the residual strength: 1, 2, 4, 5 at 10, 25, 50, 75 % of fines, linear between, 0 at 0 %."""
    points = ((0.0, 0.0), *FINES)
    for (low, below), (high, above) in pairwise(points):
        if fines <= high:
            return below + (above - below) * (fines - low) / (high - low)
    return FINES[-1][1]


def idriss_boulanger(soil: Penetration) -> float | None:
    """Sr/σ'v = exp(N/16 + ((N - 16)/21.2)³ - 3), N = (N1)60 + Δ: where water may gather below a tighter layer.

    The lower of the two curves of Idriss & Boulanger (2008). None beyond N = 16, where no case is.
    """
    n = soil.n1 + fines_addition(soil.fines)
    return math.exp(n / 16.0 + ((n - 16.0) / 21.2) ** 3 - 3.0) if n <= IDRISS_BOULANGER_TO else None


def olson_stark(soil: Penetration) -> float | None:
    """su(LIQ)/σ'v = 0.03 + 0.0075 (N1)60, ± 0.03, for (N1)60 up to 12; fines do not count."""
    return 0.03 + 0.0075 * soil.n1 if soil.n1 <= OLSON_STARK_TO else None


def kramer_wang(soil: Penetration) -> float | None:
    """Sr = exp(-8.444 + 0.109 (N1)60 + 5.379 σ'v^0.1), stresses in atmospheres; the mean. None beyond (N1)60 = 16."""
    if soil.n1 > KRAMER_WANG_TO:
        return None
    stress = soil.effective / ATMOSPHERE
    return math.exp(-8.444 + 0.109 * soil.n1 + 5.379 * stress**0.1) / stress


RELATIONS = (
    Strength(
        "Idriss & Boulanger (2008)",
        "I. M. Idriss, R. W. Boulanger, Soil Liquefaction during Earthquakes, EERI MNO-12 (2008)",
        "(N1)60 with fines up to 16; the curve for water that gathers below a tighter layer",
        idriss_boulanger,
    ),
    Strength(
        "Olson & Stark (2002)",
        "S. M. Olson, T. D. Stark, Can. Geotech. J. 39 (2002) 629-647",
        "(N1)60 up to 12; ± 0.03",
        olson_stark,
    ),
    Strength(
        "Kramer & Wang (2015)",
        "S. L. Kramer, C.-H. Wang, J. Geotech. Geoenviron. Eng. 141 (2015) 04015038",
        "(N1)60 up to 16; the mean",
        kramer_wang,
    ),
)
