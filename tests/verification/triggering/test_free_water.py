"""Every relation of triggering over random columns of soil, with water below and above the ground.

The stresses are integrated here from the weights of the layers, and the equations of the relations solved by bisection:
neither shares a line with the program. Those of Boulanger & Idriss (2014) are liquepy's.
"""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from liquepy.trigger import boulanger_and_idriss_2014 as liquepy
from scipy.optimize import brentq

from tests.support.sections import analysed, assessment
from workflow.earthquake.triggering.assessment import TestResult

WATER, GROUND, ATMOSPHERE = 9.81, 10.0, 101.325  # kN/m³, m, kPa
MAGNITUDE, PEAK = 7.2, 0.3
DEPTHS = (0.7, 2.0, 3.5, 5.0, 7.5, 9.5, 12.0, 14.0, 17.0, 19.5)
METHODS = ("idriss_boulanger_2008", "highway_1990", "highway_2012", "highway_2017", "boulanger_idriss_2014")


def sand(name: str, moist: float, saturated: float, **more: Any) -> dict[str, Any]:
    """A stratum as it stands in a file, unit weights in kN/m³."""
    return {
        "name": name, "density": f"{moist} kN/m^3", "density_saturated": f"{saturated} kN/m^3",
        "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "cohesion": 0, "friction_angle": "32 deg", **more,
    }  # fmt: skip


@st.composite
def columns(draw: st.DrawFn) -> dict[str, Any]:
    """Layers of sand 1 to 8 m thick, their unit weights; the depth of the water table, negative above ground."""
    thick = draw(st.lists(st.floats(1.0, 8.0), min_size=1, max_size=4))
    moist = draw(st.lists(st.floats(14.0, 18.0), min_size=5, max_size=5))
    more = draw(st.lists(st.floats(1.0, 3.0), min_size=5, max_size=5))
    water = draw(st.floats(-30.0, 6.0))
    # films that water cuts off a stratum, thinner than a cell can be, keep the weight of the rest
    assume(water <= 0.0 or min(abs(water - bottom) for bottom in np.cumsum([0.0, *thick])) > 0.3)
    numbers = st.lists(st.integers(0, 40), min_size=10, max_size=10)
    return {
        "thick": [*thick, 40.0],
        "moist": moist,
        "saturated": [a + b for a, b in zip(moist, more, strict=True)],
        "water": water,
        "N": draw(numbers),
        "fines": draw(numbers),
    }


def judged(column: dict[str, Any], method: str) -> list[TestResult]:
    """What the program finds in the column at all depths."""
    bottoms = np.cumsum(column["thick"])
    strata = [
        sand(f"S{k}", column["moist"][k], column["saturated"][k],
             **({} if k == len(bottoms) - 1 else {"bottom": {"depth": float(bottoms[k])}}))
        for k in range(len(bottoms))
    ]  # fmt: skip
    spt = [
        {"depth": z, "N": n, "fines": f, "d50": "0.3 mm"}
        for z, n, f in zip(DEPTHS, column["N"], column["fines"], strict=True)
    ]
    cpt = [
        {"depth": z, "qc": f"{2 + 0.4 * n} MPa", "fs": f"{10 + n} kPa"}
        for z, n in zip(DEPTHS, column["N"], strict=True)
    ]
    data = {
        "name": "column",
        "surface": [[0.0, GROUND], [50.0, GROUND]],
        "base": {"elevation": -20.0},
        "water": {"table": GROUND - column["water"], "unit_weight": f"{WATER} kN/m^3"},
        "strata": strata,
        "unusual": True,
        "earthquake": {"magnitude": MAGNITUDE, "peak_acceleration": f"{PEAK} g"},
        "triggering": {"method": method, "borings": [{"name": "B", "x": 25.0, "spt": spt, "cpt": cpt}]},
    }
    tests = assessment(analysed(data)).tests
    assert [test.sample.depth for test in tests] == list(DEPTHS)
    return list(tests)


def by_hand(column: dict[str, Any], depth: float) -> tuple[float, float]:
    """σv of the ground alone and σ'v (kPa), integrated over slices of a millimetre."""
    step = 0.001
    z = np.arange(0.5 * step, depth, step)
    number = np.searchsorted(np.cumsum(column["thick"]), z)
    weight = np.where(z > column["water"], np.array(column["saturated"])[number], np.array(column["moist"])[number])
    total = float(weight.sum()) * step
    return total, total - WATER * max(0.0, min(depth, depth - column["water"]))  # free water presses above and within


def idriss_boulanger_2008(z: float, n: float, fines: float, total: float, effective: float) -> tuple[float, float]:
    """CSR and CRR of Idriss & Boulanger (2008), eqs. 19 to 52 of the monograph, (N1)60cs by bisection."""
    rod = np.interp(
        z + 1.5, [3, 3.0001, 4, 4.0001, 6, 6.0001, 10, 10.0001], [0.75, 0.8, 0.8, 0.85, 0.85, 0.95, 0.95, 1]
    )
    add = math.exp(1.63 + 9.7 / (fines + 0.01) - (15.7 / (fines + 0.01)) ** 2)

    def residual(clean: float) -> float:
        power = 0.784 - 0.0768 * min(46.0, clean) ** 0.5
        return clean - add - min(1.7, (ATMOSPHERE / effective) ** power) * rod * n

    clean = brentq(residual, 0.0, 1000.0, xtol=1e-12)
    alpha, beta = (a + b * math.sin(z / c + d) for a, b, c, d in
                   ((-1.012, -1.126, 11.73, 5.133), (0.106, 0.118, 11.28, 5.142)))  # fmt: skip
    load = 0.65 * PEAK * total / effective * math.exp(alpha + beta * MAGNITUDE)
    if clean >= 37.5:
        return load, math.inf
    polynomial = np.polyval([25.4**-4, -(23.6**-3), 126.0**-2, 1.0 / 14.1, -2.8], clean)
    slope = min(0.3, 1.0 / (18.9 - 2.55 * min(37.0, clean) ** 0.5))
    overburden = min(1.1, 1.0 - slope * math.log(effective / ATMOSPHERE))
    return load, math.exp(polynomial) * overburden * min(1.8, 6.9 * math.exp(-MAGNITUDE / 4.0) - 0.058)


def highway(form: str, z: float, n: float, fines: float, total: float, effective: float) -> tuple[float, float]:
    """L and R of the highway code (1990 in kgf/cm², D50 = 0.3 mm; 2012; 2017), motions of type I."""
    load = (1.0 - 0.015 * z) * PEAK * total / effective
    if form == "1990":
        resists = 0.0882 * (n / (effective / 98.0665 + 0.7)) ** 0.5 + 0.225 * math.log10(0.35 / 0.3)
        return load, resists + (0.004 * fines - 0.16 if fines >= 40 else 0.0)
    n1 = 1.7 * n / (effective / 100.0 + 0.7)
    if form == "2012":
        na = n1 if fines < 10 else n1 * (fines + 40.0) / 50.0 + (fines - 10.0) / 18.0
        low = 0.0882 * math.sqrt(na / 1.7)
    else:
        c = 1.0 if fines < 10 else (fines + 20.0) / 30.0 if fines < 40 else (fines - 16.0) / 12.0
        na = c * (n1 + 2.47) - 2.47
        low = 0.0882 * math.sqrt((0.85 * na + 2.1) / 1.7)
    return load, low if na < 14.0 else 0.0882 * math.sqrt(na / 1.7) + 1.6e-6 * (na - 14.0) ** 4.5


def boulanger_idriss_2014(z: float, n: float, total: float, effective: float) -> tuple[float, float]:
    """CSR and CRR by liquepy's functions, qc1Ncs by bisection; its C_σ has no limit of 0.3, which is above 211."""
    q, sleeve = 1000.0 * (2.0 + 0.4 * n), 10.0 + n
    friction = liquepy.calc_f_ic_values(sleeve, q, total)

    def index(power: float) -> float:
        return float(liquepy.calc_i_c(liquepy.calc_big_q_values(q, total, effective, ATMOSPHERE, power), friction))

    ic = index(1.0) if index(1.0) >= 2.6 else index(0.5) if index(0.5) <= 2.6 else index(0.75)
    fines = float(liquepy.calc_fc(ic, 0.0))

    def plain(clean: float) -> float:
        return float(min(1.7, (ATMOSPHERE / effective) ** liquepy.calc_m(clean)) * q / ATMOSPHERE)

    def residual(clean: float) -> float:
        return float(clean - plain(clean) - liquepy.calc_delta_q_c1n(plain(clean), fines))

    clean = brentq(residual, 0.0, 5000.0, xtol=1e-10)
    load = float(liquepy.calc_csr(effective, total, PEAK, liquepy.calc_rd(z, MAGNITUDE)))
    if clean >= 211.0:
        return load, math.inf
    bears = liquepy.calc_crr_m7p5_from_qc1ncs(clean) * liquepy.calc_msf(MAGNITUDE, clean)
    return load, float(bears * liquepy.calc_k_sigma(effective, clean, ATMOSPHERE))


def independent(method: str, test: TestResult, column: dict[str, Any], number: int) -> tuple[float, float]:
    z, n, fines = DEPTHS[number], column["N"][number], column["fines"][number]
    total, effective = by_hand(column, z)
    assert (test.overburden.total, test.overburden.effective) == pytest.approx(
        (1e3 * total, 1e3 * effective), rel=1e-3, abs=20.0
    )
    total, effective = test.overburden.total / 1e3, test.overburden.effective / 1e3  # of the slices no error is left
    if method == "boulanger_idriss_2014":
        return boulanger_idriss_2014(z, n, total, effective)
    if method == "idriss_boulanger_2008":
        return idriss_boulanger_2008(z, n, fines, total, effective)
    return highway(method.removeprefix("highway_"), z, n, fines, total, effective)


@pytest.mark.parametrize("method", METHODS)
@settings(deadline=None)
@given(columns())
def test_every_relation_is_the_independent_one(method: str, column: dict[str, Any]) -> None:
    for number, test in enumerate(judged(column, method)):
        above = DEPTHS[number] < column["water"]
        assert (test.reason == "above the water table") == above
        if test.outcome is None:
            assert above or "behaves as clay" in test.reason
            continue
        load, bears = independent(method, test, column, number)
        assert (test.outcome.load, test.outcome.resistance) == pytest.approx((load, max(0.0, bears)), rel=1e-7)


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=10, deadline=None)
@given(columns(), st.floats(0.0, 20.0))
def test_deeper_free_water_changes_nothing(method: str, column: dict[str, Any], depth: float) -> None:
    """Ground under water is loaded by its own mass alone: F_L under 20 m of water is that at the water's edge."""
    edge, under = (judged({**column, "water": -water}, method) for water in (0.0, depth))
    assert [test.reason for test in under] == [test.reason for test in edge]
    factors = [[math.nan if test.factor is None else test.factor for test in tests] for tests in (under, edge)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-9, nan_ok=True)


def test_the_submarine_sand_by_hand() -> None:
    """N = 5 at 1 m under 3 m of water, 20 kN/m³, M 7.5, 0.3 g: σv = 20, σ'v = 10.19 kPa; CSR 0.3823 and F_L 0.271.

    With the free water in σv it was 0.945 and 0.11."""
    data = {
        "name": "liqsub", "surface": [[0, 0], [50, 0]], "base": {"elevation": -30}, "water": {"table": 3},
        "strata": [sand("Sand", 18, 20)], "earthquake": {"magnitude": 7.5, "peak_acceleration": "0.3 g"},
        "triggering": {"borings": [{"name": "B-1", "x": 25, "spt": [{"depth": 1, "N": 5, "fines": 5}]}]},
    }  # fmt: skip
    [test] = assessment(analysed(data)).tests
    assert test.outcome is not None
    assert (test.outcome.load, test.factor) == pytest.approx((0.3823, 0.2715), abs=1e-4)


def test_after_a_drawdown_the_water_that_has_gone_weighs_nothing() -> None:
    """Sand that drains, 8 m of water gone from it: the stresses are those of sand that was never deeper under water."""
    column = {"thick": [40.0], "moist": [18.0], "saturated": [20.0], "water": 2.0}
    data = {
        "name": "drawdown", "surface": [[0, 0], [50, 0]], "base": {"elevation": -20},
        "water": {"table": 6, "after_drawdown": -2, "unit_weight": "9.81 kN/m^3"},
        "strata": [sand("Sand", 18, 20, drains=True)],
        "earthquake": {"magnitude": 7.5, "peak_acceleration": "0.3 g"},
        "triggering": {"borings": [{"name": "B-1", "x": 25, "spt": [{"depth": 1, "N": 5}, {"depth": 7, "N": 5}]}]},
    }  # fmt: skip
    dry, wet = assessment(analysed(data)).tests
    assert dry.reason == "above the water table"
    assert (wet.overburden.total, wet.overburden.effective) == pytest.approx(
        tuple(1e3 * s for s in by_hand(column, 7.0)), rel=1e-6
    )


def test_ground_that_its_water_lifts_is_not_judged() -> None:
    data = {
        "name": "lifted", "surface": [[0, 0], [50, 0]], "base": {"elevation": -20}, "water": {"table": 0},
        "strata": [sand("Sand", 18, 18, piezometric_level=12)],
        "unusual": True, "earthquake": {"magnitude": 7.5, "peak_acceleration": "0.3 g"},
        "triggering": {"borings": [{"name": "B-1", "x": 25, "spt": [{"depth": 2, "N": 5}]}]},
    }  # fmt: skip
    with pytest.raises(ValueError, match="vertical effective stress is -"):
        assessment(analysed(data))
