"""Spring constants: eqs. (5)-(13), the paper's Table 2, and the table by pair of layers."""

import csv
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from dem.kernels.contact import ALLOWED, BC, BETA, CN, KN, KPN, KS, MU, TAN
from dem.pair_table import PairTable, pair_table
from dem.springs import LayerSprings, from_stratum, table2, wave_speeds
from meshes.section.section import Stratum

# Table 1: E (tf/m2), nu, density ordinary and seismic (t/m3), cohesion (tf/m2), friction angle (deg)
TABLE1 = {
    1: (1560, 0.33, 1.80, 1.80, 0, 35), 2: (2440, 0.45, 0.65, 1.65, 10, 0), 3: (2960, 0.33, 1.80, 1.80, 0, 35),
    4: (3280, 0.33, 1.00, 2.00, 0, 35), 5: (3280, 0.33, 1.00, 2.00, 0, 35), 6: (5500, 0.33, 0.80, 1.80, 0, 35),
    7: (5600, 0.45, 0.68, 1.68, 10, 0), 8: (5500, 0.33, 0.80, 1.80, 0, 35), 9: (9760, 0.45, 0.65, 1.65, 0, 35),
    10: (9760, 0.45, 0.65, 1.65, 1000, 0),
}  # fmt: skip
TF = 9806.65  # Pa in a tf/m2

# where Table 2 as printed is not what the equations give, and why
EXCEPTIONS = {
    (7, "kn"): "printed 1.9e7, the equations give 1.84e7",
    (7, "kpn"): "a tenth of the printed 1.9e7",
    (9, "cohesion"): "7.1e4, though Table 1 has c = 0",
    (10, "cohesion"): "7.1e4, though Table 1 has c = 1000 tf/m2",
}


def from_table1(layer: int, **settings: float) -> LayerSprings:
    e, nu, ordinary, seismic, cohesion, friction = TABLE1[layer]
    stratum = Stratum.model_construct(
        name=str(layer), youngs_modulus=e * TF, poissons_ratio=nu, density_seismic=1000.0 * seismic,
        density_ordinary=1000.0 * ordinary, cohesion=cohesion * TF, friction_angle=np.radians(friction),
    )  # fmt: skip
    return from_stratum(stratum, 0.75, **settings)


CONSTANTS = ("kn", "ks", "cn", "ct", "kpn", "kps", "density", "effective_density", "friction", "cohesion")


@pytest.mark.parametrize("layer", TABLE1)
def test_equations_times_a_hundredth_are_table_2(layer: int) -> None:
    """To two digits: half a unit of the second digit is up to 5 %."""
    ours, printed = from_table1(layer), table2()[layer - 1]
    different = set()
    for name in CONSTANTS:
        value, text = getattr(ours, name), getattr(printed, name)
        if abs(value - text) > 0.052 * text:
            different.add((layer, name))
    assert different == {key for key in EXCEPTIONS if key[0] == layer}
    assert (ours.alpha, ours.beta) == (printed.alpha, printed.beta) == (1.2, 1.02)


@pytest.mark.parametrize("layer", TABLE1)
def test_table_2_is_the_equations_in_tonne_force_times_100(layer: int) -> None:
    """So the scale is 100 / 9806.65, of which 0.01 are the first digits; e = 0.11 as the table's densities have it."""
    ours = from_table1(layer, stiffness_scale=100.0 / TF, void_ratio=0.11)
    printed = table2()[layer - 1]
    for name in CONSTANTS[:6]:
        unit = 10.0 ** (np.floor(np.log10(getattr(printed, name))) - 1.0)
        assert abs(getattr(ours, name) - getattr(printed, name)) < unit, name
    assert ours.density == pytest.approx(printed.density, abs=0.51)
    assert ours.effective_density == pytest.approx(printed.effective_density, abs=0.51)


def test_exceptions_are_exceptions() -> None:
    assert from_table1(7, stiffness_scale=100.0 / TF).kn == pytest.approx(1.84e7, rel=5e-3)
    assert table2()[6].kn == 1.9e7
    assert from_table1(9).cohesion == 0.0
    assert from_table1(10).cohesion > 7e6
    for layer in (9, 10):
        assert table2()[layer - 1].cohesion == 7.1e4


def test_stiffness_scale_is_the_ratio_to_the_equations() -> None:
    e, nu, rho = 1560 * TF, 0.33, 1800.0
    vp, vs = wave_speeds(e, nu, rho)
    assert vp**2 * rho == pytest.approx((1.0 - nu) * e / ((1.0 - 2.0 * nu) * (1.0 + nu)))
    full = from_table1(1, stiffness_scale=1.0)
    # eqs. (9), (11): element and pore spring in series are the spring of the soil
    assert 1.0 / (1.0 / full.kn + 1.0 / full.kpn) == pytest.approx(np.pi / 4.0 * rho * vp**2)
    assert 1.0 / (1.0 / full.ks + 1.0 / full.kps) == pytest.approx(np.pi / 4.0 * rho * vs**2)
    assert full.kn == pytest.approx(100.0 * from_table1(1).kn)
    assert full.cn == pytest.approx(np.sqrt(np.pi * 0.75**2 * full.density * full.kn))


def test_liquefied_layers_are_the_cases_of_table_2() -> None:
    normal = table2()
    misprint = {(6, "case2")}  # its normal dashpot is printed 1.4e4 among 1.6e4
    for case, share in (("case1", 0.1), ("case2", 0.02), ("case3", 0.01)):
        printed = table2({4: case, 6: case})
        for layer in (4, 6):
            ours = normal[layer - 1].liquefied(share)
            names = ["kn", "ks", "ct", "kpn", "kps", "friction", "cohesion"]
            for name in names + ([] if (layer, case) in misprint else ["cn"]):
                assert getattr(ours, name) == pytest.approx(getattr(printed[layer - 1], name), rel=1e-9), (layer, name)
    assert table2({6: "case2"})[5].cn == 1.4e4


def test_packaged_table_is_complete() -> None:
    rows = list(csv.DictReader((files("dem") / "table2_dem.csv").open(encoding="utf-8")))
    assert len(rows) == 16
    with pytest.raises(KeyError, match="no layer and state"):
        table2({3: "case1"})


def constants(table: PairTable) -> np.ndarray:
    """Constants between discs (CONSTANTS, n + 1, n + 1)."""
    return table.pairs[:, : table.size**2].reshape(-1, table.size, table.size)


def test_means_between_layers_and_the_boundary() -> None:
    a, b = table2()[0], table2()[1]
    pairs = constants(pair_table([a, b]))
    assert np.array_equal(pairs, pairs.transpose(0, 2, 1))
    assert pairs[KN, 0, 1] == 0.5 * (a.kn + b.kn)
    assert pairs[MU, 0, 1] == pairs[TAN, 0, 1] == 0.35
    assert pairs[BC, 0, 1] == 0.5 * b.cohesion
    assert pairs[CN, 0, 0] == a.cn
    # a boundary disc takes its partner's values
    assert np.array_equal(pairs[:, 0, 2], pairs[:, 0, 0])
    assert np.array_equal(pairs[:, 1, 2], pairs[:, 1, 1])
    harmonic = constants(pair_table([a, b], "harmonic"))
    assert harmonic[KN, 0, 1] == pytest.approx(2.0 / (1.0 / a.kn + 1.0 / b.kn))
    assert harmonic[MU, 0, 1] == 0.0
    assert harmonic[BETA, 0, 1] == pytest.approx(1.02)
    assert np.array_equal(harmonic[:, 1, 1], pairs[:, 1, 1])


def test_rigid_lines_are_as_stiff_as_the_stiffest_layer() -> None:
    a, b = table2()[0], replace(table2()[8], allowed_overlap=0.7, pore_friction=0.1)
    table = pair_table([a, b])
    assert table.lines[KN, 0] == table.lines[KN, 1] == b.kn
    assert table.lines[KS, 0] == a.ks
    assert table.lines[CN, 0] / np.sqrt(table.lines[KN, 0]) == pytest.approx(a.cn / np.sqrt(a.kn))
    assert constants(table)[ALLOWED, 1, 1] == 0.35
    assert constants(table)[TAN, 1, 1] == 0.1
    assert constants(table)[KPN, 1, 1] == b.kpn


@pytest.mark.parametrize(("name", "value"), [("kn", 0.0), ("ks", -1.0), ("beta", 1.0), ("density", -2.0)])
def test_impossible_constants_are_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        replace(table2()[0], **{name: value})


def test_a_liquefied_layer_is_as_stiff_against_the_boundary_as_before() -> None:
    """S-13, case 3: discs of a hundredth of their stiffness were pressed whole into those of the walls."""
    sand, loose = table2()[0], table2()[3].liquefied(0.01)
    table = pair_table([sand, loose])
    normal = constants(table)[KN]
    assert normal[1, 1] == pytest.approx(0.01 * table2()[3].kn)
    assert normal[1, 2] == normal[2, 1] == table2()[3].kn
    assert normal[0, 2] == sand.kn
    assert loose.liquefied(0.5).boundary == table2()[3].kn
