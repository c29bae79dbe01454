"""Moss Landing 1989: what the relations say beside what the inclinometers measured."""

import numpy as np
import pytest

from tests.support import SECTIONS
from tests.support.sections import assessment
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.estimates.empirical import empirical
from workflow.estimates.lateral_spread import Spreading, why_not_youd, youd, zhang_free_face

CONFIG = config_after_triggering(Config.load(SECTIONS / "moss_landing.toml"))

# Depth (m) and F_L as LiquePy (github LiquePy/LiquePy, zhang2004_lateral_spread_analysis.xls) has them for this boring.
# Its C_N is that of 2004, ours solves for (N1)60cs. It assesses the count at the water table, 1.8 m, too.
FACTORS = [(1.8, 0.769), (2.6, 0.566), (3.4, 0.598), (4.1, 0.645), (4.9, 0.688), (6.4, 1.223), (7.9, 1.218),
           (9.4, 1.251), (10.2, 0.702), (11.0, 0.631)]  # fmt: skip


def test_what_liquefied_is_found_to_liquefy() -> None:
    """The clean sand under the water spread, as the inclinometers say; the dense sand below it does not liquefy."""
    values = {test.sample.depth: test.factor for test in assessment(CONFIG).tests}
    for depth, factor in FACTORS:
        assert values[depth] == pytest.approx(factor, rel=0.05)
    assert values[5.6] > 1.8  # LiquePy: 2.0 here and at 7.2 m
    assert values[7.2] == 2.0
    liquefies = {item.name: item.liquefies for item in assessment(CONFIG).strata if item.tests}
    assert liquefies == {
        "Loose sand": False, "Loose sand, below water": True, "Dense sand": False, "Silty sand": True,
    }  # fmt: skip


def test_what_the_sand_keeps() -> None:
    """In kPa where it was tested, by hand from (N1)60 and σ'v of the five tests that liquefy: Olson & Stark, whose
    cases end at 12, Idriss & Boulanger without a tighter layer above, Kramer & Wang.

    The continuum just stands with 8.2 kPa in it, F from 0.98 to 1.01 by strict bounds; 700 discs slide 0.33, 0.19 and
    0.14 m where 0.26 m were measured."""
    n1, effective, thick = np.array(
        [(8.5, 34.2, 0.4), (7.0, 42.4, 0.8), (9.3, 50.5, 0.75), (11.4, 57.6, 0.75), (13.3, 65.8, 0.75)]
    ).T
    fine = n1 + np.array([0.2, 0.2, 0.1, 0.1, 0.1])  # 2 and 1 % of fines
    stress = effective / 101.325
    by_hand = [
        (0.03 + 0.0075 * np.minimum(n1, 12.0)) * effective,
        np.exp(fine / 16.0 + ((fine - 16.0) / 21.2) ** 3 - 3.0) * (1.0 + np.exp(fine / 2.4 - 6.6)) * effective,
        np.exp(-8.444 + 0.109 * n1 + 5.379 * stress**0.1) * 101.325,
    ]
    assert [case.name for case in CONFIG.cases] == ["low strength", "median", "high strength"]
    for case, strengths in zip(CONFIG.cases, by_hand, strict=True):
        result = case.strength_of("Loose sand, below water") / 1e3
        assert result == pytest.approx(float(np.average(strengths, weights=thick)), rel=0.01)


# M, R (km), W (%), T15 (m), F15 (%), D50 (mm) of Youd et al. (2002), and what was measured (m).
INCLINOMETERS = [
    (Spreading(7.0, 27.2, 29.73, 3.4, 1.0, 0.6, True), 0.26),
    (Spreading(7.0, 27.2, 33.54, 2.7, 2.0, 0.8, True), 0.29),
]


def test_predicted_beside_observed() -> None:
    """By Youd et al. 0.48 m beside 0.26 m, and 0.36 m beside 0.29 m: within a factor of two, although the bank is
    steeper than they recommend. Strains added up by Zhang et al. come to 4.8 m, 18 times what was measured; the place
    is nearer to the bank than they recommend, too. A user of the section is given neither number, but the reason."""
    assert [youd(site) for site, _ in INCLINOMETERS] == pytest.approx([0.478, 0.358], abs=0.002)
    assert all(0.5 < youd(site) / observed < 2.0 for site, observed in INCLINOMETERS)
    assert all(why_not_youd(site).endswith("is not within 1-20 %") for site, _ in INCLINOMETERS)
    distance, height = CONFIG.free_face.distance_and_height(CONFIG.section.ground)
    assert 100.0 * height / distance == pytest.approx(29.73, abs=0.05)
    spread = {item.method: item for item in empirical(CONFIG.section, CONFIG, 0.1, np.zeros((0, 2)))}
    zhang = spread["Zhang, Robertson & Brachman (2004)"]
    assert "LDI = 2.10 m" in zhang.description
    assert "L/H = 3.36 is not within 4-40" in zhang.description
    assert zhang_free_face(2.10, distance, height) == pytest.approx(4.78, abs=0.02)
    assert "free-face ratio 29.7 % is not within 1-20 %" in spread["Youd, Hansen & Bartlett (2002)"].description
    assert all(spread[name].displacement_m is None for name in (zhang.method, "Youd, Hansen & Bartlett (2002)"))
    assert [entry.displacement for entry in CONFIG.report.observed] == [site[1] for site in INCLINOMETERS]
