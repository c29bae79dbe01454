"""Steady seepage against closed forms, and what the rest of the program makes of it."""

import tomllib

import numpy as np
import pytest
from scipy.special import ellipk

from meshes.errors import InputError
from meshes.section.section import Section
from tests.support import TOP

K = 1e-5  # m/s


def flowing(surface, table, strata=None, base=0.0, **water) -> dict:
    soil = {
        "name": "a", "youngs_modulus": "10 MPa", "poissons_ratio": 0.3, "density": "1.8 t/m^3",
        "density_saturated": "2 t/m^3", "cohesion": "5 kPa", "friction_angle": "30 deg", "permeability": K,
    }  # fmt: skip
    return {
        "name": "t", "surface": surface, "base": {"elevation": base}, "water": {"table": table, "flow": True, **water},
        "strata": strata or [soil],
    }  # fmt: skip


def dam(upper: float, lower: float, length: float, height: float) -> dict:
    """A block between two vertical faces on an impermeable base."""
    ground = [[-1, 0], [0, 0], [0, height], [length, height], [length, 0], [length + 1, 0]]
    return flowing(ground, [[-1, upper], [0, upper], [length, lower], [length + 1, lower]])


@pytest.mark.parametrize(("upper", "lower", "length"), [(10.0, 2.0, 10.0), (6.0, 1.0, 4.0)])
def test_a_rectangular_dam_has_dupuits_discharge_and_a_seepage_face(upper: float, lower: float, length: float) -> None:
    """Exact whatever the seepage face (Charny 1951; Polubarinova-Kochina 1962): k (h1² - h2²) / 2 L."""
    flow = Section.parse(dam(upper, lower, length, upper + 2.0)).water_pressure.flow
    assert flow is not None
    assert flow.discharge == pytest.approx(K * (upper**2 - lower**2) / (2.0 * length), rel=1e-3)
    assert flow.inflow.sum() == pytest.approx(0.0, abs=1e-9 * flow.discharge)
    leaves = flow.water_line[flow.water_line[:, 0] == length][0, 1]
    assert leaves > lower + 1.0  # Dupuit's parabola would come out at the lower water


@pytest.mark.parametrize("depth", [0.5, 0.75])
def test_below_a_sheet_pile_the_discharge_is_that_of_the_conformal_map(depth: float) -> None:
    """A pile driven to a share s / T of a layer: q / (k h) = K' / 2 K of the modulus sin(π s / 2 T) (Harr 1962)."""
    wall = {"x": 0.0, "bottom": 10.0 * (1.0 - depth)}
    table = [[-40, 12], [0, 12], [0, 10], [40, 10]]
    section = Section.parse(flowing([[-40, 10], [40, 10]], table, cutoffs=[wall]))
    flow = section.water_pressure.flow
    assert flow is not None
    m = np.sin(0.5 * np.pi * depth) ** 2
    # Triangles are from above, and the foot of the pile is a singularity: 2.2 and 2.6 % measured.
    assert flow.discharge / (2.0 * K) == pytest.approx(ellipk(1.0 - m) / (2.0 * ellipk(m)), rel=0.03)
    neighbour, near = np.array([[0.0, 9.0], [0.0, 9.0]]), np.array([[0.1, 9.0], [-0.1, 9.0]])
    behind, before = section.water_pressure.at_rest(neighbour, near, np.array([0, 0]))
    assert before > behind + 9.81e3 * 0.5  # the pressure jumps across the wall
    assert not [text for text in section.notices if "not level" in text]


def test_parallel_to_a_slope_the_head_is_that_across_the_flow() -> None:
    """An endless slope: u = γw d cos²β at a depth d below the line.

    A triangle as high as t that the line crosses is wet up to one of its points, which changes the mean of the squared
    depth d by (t / 2 d)² of it at most: 0.0016 here, 2 mm of head.
    """
    slope = flowing([[0, 15], [50, 5]], [[0, 14], [50, 4]], base=[[0, 10], [50, 0]], head="normal")
    points = np.array([[25.0, 6.0], [10.0, 11.0], [40.0, 2.5]])
    section = Section.parse(slope)
    ground = section.water_pressure.at_rest(points, points, np.array([1, 1, 1]))
    assert ground == pytest.approx(9806.65 * (14.0 - 0.2 * points[:, 0] - points[:, 1]) / 1.04, abs=20.0)


def test_still_water_stays_still_and_a_file_written_reads_as_the_same() -> None:
    ground = [[0, 2], [20, 2], [36, 10], [40, 10], [56, 2], [76, 2]]
    level = Section.parse(flowing(ground, [[0, 6], [76, 6]]))
    points = np.array([[38.0, 3.0], [30.0, 1.0], [5.0, 1.5]])
    assert level.water_pressure.at_rest(points, points, np.array([1, 1, 1])) == pytest.approx(
        9806.65 * (6.0 - points[:, 1]), rel=1e-6
    )
    section = Section.parse(flowing(ground, [[0, 8], [32, 8], [56, 2], [76, 2]]))
    again = Section.parse(tomllib.loads(section.to_toml()))
    assert again.to_toml() == section.to_toml()
    assert np.array_equal(again.water_pressure.flow.head, section.water_pressure.flow.head)
    ((start, end),) = section.water_pressure.flow.seepage_faces
    assert start == pytest.approx(54.0, abs=0.6)
    assert end == pytest.approx(56.0)


def test_heads_from_which_nothing_flows_and_walls_down_to_the_base_are_told() -> None:
    """Level water, and a wall that closes the section: no flow at all, and a sentence."""
    ground = [[0, 2], [20, 2], [36, 10], [40, 10], [56, 2], [76, 2]]
    level = Section.parse(flowing(ground, [[0, 5], [76, 5]]))
    assert level.water_pressure.flow.discharge == 0.0
    (notice,) = (text for text in level.notices if "no water flows" in text)
    assert "because the water table has one level, 5 m; expected levels that differ" in notice
    base = float(level.outline()[:, 1].min())
    walled = flowing(ground, [[0, 8], [32, 8], [56, 2], [76, 2]], cutoffs=[{"x": 38, "bottom": base}])
    closed = Section.parse(walled)
    of_a_block = K * (8.0**2 - 2.0**2) / (2.0 * 56.0)  # Dupuit's, from one pond to the other
    assert closed.water_pressure.flow.discharge < 1e-6 * of_a_block
    assert any("a wall closes the section" in text for text in closed.notices)


def test_ground_that_carries_free_water_in_the_place_of_a_wall_is_reported() -> None:
    """A cofferdam in sand failed beside its wall with a factor of 0.4, as the wall has no strength, without a word."""
    wall = {"x": 30.0, "bottom": 0.0}
    water = [[0, 8], [30, 8], [30, 6], [60, 6]]
    section = Section.parse(flowing([[0, 5], [60, 5]], water, cutoffs=[wall]))
    (notice,) = (text for text in section.notices if "cutoffs" in text)
    assert "free water stands at 8 m left of the wall at x = 30 m and at 6 m right of it" in notice
    assert f"carries {2.0 * section.water_pressure.unit_weight / 1e3:.3g} kPa at its surface" in notice
    for table in ([[0, 4], [30, 4], [30, 2], [60, 2]], [[0, 8], [60, 6]]):  # in the ground; no step at the wall
        quiet = Section.parse(flowing([[0, 5], [60, 5]], table, cutoffs=[wall]))
        assert not any("cutoffs" in text for text in quiet.notices)


@pytest.mark.parametrize(
    ("table", "at"),
    [
        ([[0, 8.5], [45, 8.5], [56, 9.8], [61, 14], [66, 11], [86, 9.5], [140, 9.5]], "x = 61 m"),
        ([[0, 8.5], [30, 9.5], [56, 9.8], [66, 11], [86, 9.5], [140, 9.5]], "x = 0 m"),
        ([[0, 8.5], [45, 8.5], [56, 9.8], [66, 11], [86, 10.02], [140, 9.5]], ""),  # 2 cm of a line that bends too late
        ([[0, 8.5], [45, 8.5], [56, 9.8], [66, 11], [86, 9.5], [140, 9.5]], ""),
    ],
)
def test_a_water_table_above_inclined_ground_is_told(table: list, at: str) -> None:
    """Water above the ground is a pond, and a pond is level."""
    data = tomllib.loads((TOP / "tests/support/levee/levee.toml").read_text(encoding="utf-8"))
    data["water"] = {"table": table}
    notices = [text for text in Section.parse(data).notices if "its surface is not level there" in text]
    assert len(notices) == bool(at)
    assert all(f"stands on the ground at {at}" in text for text in notices)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"table": None}, "flow = true without table"),
        ({"after_drawdown": 3.0}, "flow = true and after_drawdown"),
        ({"flow": False, "cutoffs": [{"x": 3, "bottom": 1}]}, "cutoffs without flow = true"),
        ({"cutoffs": [{"x": 99, "bottom": 1}]}, "not between the sides"),
        ({"cutoffs": [{"x": 30, "bottom": 11}]}, "above the ground there"),
        ({"cutoffs": [{"x": 30, "bottom": -9}]}, "below the base there"),
        ({"table": -5.0}, "expected water at one side at least"),
        ({"table": [[0, 8], [30, 8], [30, 2], [76, 2]]}, "a wall of [[water.cutoffs]] there"),
    ],
)
def test_heads_that_make_no_seepage_are_refused_in_one_sentence(change: dict, sentence: str) -> None:
    data = flowing([[0, 2], [20, 2], [36, 10], [40, 10], [56, 2], [76, 2]], 3.0)
    data["water"] = {key: value for key, value in {**data["water"], **change}.items() if value is not None}
    with pytest.raises(InputError) as caught:
        Section.parse(data)
    (problem,) = caught.value.problems
    assert sentence in problem


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [("permeability", None, "permeability: missing"), ("piezometric_level", 5.0, "expected none with flow = true")],
)
def test_a_stratum_that_does_not_fit_flowing_water_is_refused(key: str, value: object, sentence: str) -> None:
    data = flowing([[0, 5], [50, 5]], [[0, 4], [50, 3]])
    data["strata"] = [{k: v for k, v in {**data["strata"][0], key: value}.items() if v is not None}]
    with pytest.raises(InputError, match=sentence):
        Section.parse(data)


@pytest.mark.parametrize("toe", [pytest.param(40.0, marks=pytest.mark.slow), 40.3])
def test_a_shore_between_two_points_of_the_grid_lifts_no_ground(toe: float) -> None:
    """The pond meets a bank of sand, through which little seeps: nothing blows out there, wherever it is."""
    ground = [[0, 6], [toe, 6], [toe + 8, 10], [140, 10]]
    section = Section.parse(flowing(ground, [[0, 8.5], [toe + 5, 8.5], [140, 9.5]], base=-10.0))
    assert section.uplift is None


def test_pore_pressure_at_the_bed_of_a_pond_is_that_of_the_pond_beside_every_line_of_the_grid() -> None:
    """Beside a line of the grid, by less than the tolerance, pressure was taken from below the ground. 6 Pa too much
    left cracked clay without any effective stress in equilibrium."""
    data = flowing(
        [[0.0, 4.0], [30.0, 4.0], [48.0, 13.0], [74.0, 4.0], [110.0, 4.0]],
        [[0.0, 10.0], [42.0, 10.0], [74.0, 4.0], [110.0, 4.0]],
    )
    section = Section.parse(data)
    flow, water = section.water_pressure.flow, section.water_pressure
    assert flow is not None
    lines = flow.grid.x[(flow.grid.x > 0.5) & (flow.grid.x < 29.0)]
    for share in (-0.9, -0.5, 0.5, 0.9):
        bed = np.column_stack([lines + share * flow.tolerance, np.full(len(lines), 4.0)])
        for side in (-0.3, 0.3):
            within = bed + np.array([side, -0.2])
            pressure = water.at_rest(bed, within, np.zeros(len(bed), dtype=int))
            assert pressure == pytest.approx(water.on_ground(bed, within), rel=1e-12)


def zoned(zones: dict, k: float = K) -> dict:
    """A rectangular dam 10 m wide between waters of 10 and 2 m, with vertical zones {(from, to): permeability}."""
    data = dam(10.0, 2.0, 10.0, 12.0)
    soil = data["strata"][0] | {"permeability": k}
    data["base"] = {"elevation": -0.5}
    data["strata"] = [soil | {"bottom": {"elevation": 0.0}}, soil | {"name": "rock", "permeability": 1e-16}]
    data["zones"] = [
        soil | {"name": f"zone {x:g}", "permeability": of, "points": [[x, 0], [end, 0], [end, 12], [x, 12]]}
        for (x, end), of in zones.items()
    ]
    return data


@pytest.mark.parametrize("contrast", [1e-2, 1e-4, 1e-6, 1e2])
def test_vertical_zones_have_dupuits_discharge_and_a_core_keeps_the_shell_behind_it_dry(contrast: float) -> None:
    """Exact for vertical zones, too: (h1² - h2²) / 2 Σ(width / k). All of the head is lost in a tight core: water is at
    the upper level before it and at the lower one behind it."""
    flow = Section.parse(zoned({(4.0, 6.0): contrast * K})).water_pressure.flow
    resistance = 8.0 / K + 2.0 / (contrast * K)
    assert flow.discharge == pytest.approx((10.0**2 - 2.0**2) / (2.0 * resistance), rel=1e-5)
    if contrast < 1.0:
        before, behind = np.interp([3.5, 8.0], *flow.water_line.T)
        assert before == pytest.approx(10.0, abs=0.16 * contrast * 100.0 + 0.02)
        assert behind == pytest.approx(2.0, abs=2.0 if contrast > 1e-3 else 0.02)


@pytest.mark.parametrize("contrast", [1e-5, 1e-2])
def test_water_behind_a_core_that_leans_stands_no_higher_than_the_pond(contrast: float) -> None:
    """Heads have no maximum inside the ground; where the water met a core they had one of 35.3 m of 35."""
    ground = [[0, 0], [20, 0], [92, 40], [100, 40], [172, 0], [200, 0]]
    data = flowing(ground, [[0, 35], [83, 35], [172, 0], [200, 0]], base=-10.0)
    core = data["strata"][0] | {"name": "core", "permeability": contrast * K}
    data["zones"] = [core | {"points": [[78, 0], [94, 38], [98, 38], [114, 0]]}]
    flow = Section.parse(data).water_pressure.flow
    z = flow.grid.points[:, 1]
    assert np.maximum(flow.head, z)[flow.head > z].max() <= 35.0 + 1e-9
    assert flow.water_line[:, 1].max() == pytest.approx(35.0, abs=1e-6)


def test_a_dam_on_a_horizontal_drain_is_kozenys() -> None:
    """The upper face is the equipotential of Kozeny's parabolas (1931): q = k y0, z² = y0² - 2 y0 x at the top."""
    height, focal = 10.0, 4.0
    share = np.linspace(0.0, 1.0, 11)
    face = np.column_stack([(focal**2 * share**2 - height**2) / (2.0 * focal), height * share])
    ground = [[-20, 0], *face.tolist(), [face[-1, 0] + 0.3, 11.5], [6, 11.5], [6.01, 0], [9, 0]]
    table = [[-20, 10], [face[-1, 0], 10], [6, -0.59], [9, -0.59]]
    data = flowing(ground, table, base=-0.6)
    soil = data["strata"][0]
    data["strata"] = [soil | {"bottom": {"elevation": 0.0}}, soil | {"name": "rock", "permeability": 1e-14}]
    data["zones"] = [soil | {"name": "drain", "permeability": 1.0, "points": [[0, -0.6], [9, -0.6], [9, 0], [0, 0]]}]
    flow = Section.parse(data).water_pressure.flow
    assert flow.discharge == pytest.approx(K * focal, rel=0.01)
    x = np.array([-8.0, -4.0, -2.0, -1.0])
    assert np.interp(x, *flow.water_line.T) == pytest.approx(np.sqrt(focal**2 - 2.0 * focal * x), abs=0.06)


def test_the_seepage_face_of_a_rectangular_dam_is_as_high_as_published() -> None:
    """24 m of water before 16 m of soil, 4 m behind: it comes out at 12.79 m (Aitchison 1972). Cells are 0.36 m."""
    line = Section.parse(dam(24.0, 4.0, 16.0, 26.0)).water_pressure.flow.water_line
    assert line[line[:, 0] == 16.0][0, 1] == pytest.approx(12.79, abs=0.2)


def test_ground_that_conducts_better_along_x_has_dupuits_discharge() -> None:
    data = dam(10.0, 2.0, 10.0, 12.0)
    data["strata"][0]["permeability_vertical"] = 0.1 * K
    assert Section.parse(data).water_pressure.flow.discharge == pytest.approx(K * 96.0 / 20.0, rel=1e-6)


def test_still_water_in_layers_on_a_sloping_base_is_hydrostatic() -> None:
    """u = γw (level - z) below the level and 0 above, whatever the permeabilities; no water flows."""
    ground = [[0.0, 0.0], [3.86, 0.0], [3.86, 5.67], [17.01, 5.67]]
    soil = flowing(ground, -0.18)["strata"][0]
    strata = [{**soil, "name": "b", "permeability": 1e-8, "bottom": {"elevation": [[0.0, 5.464], [7.65, 5.464]]}}, soil]
    data = flowing(ground, -0.18, strata, base=[[0.0, -2.44], [17.01, -5.27]])
    flow = Section.parse(data).water_pressure.flow
    assert flow is not None
    assert flow.discharge == 0.0
    z = flow.grid.points[:, 1]
    result = np.maximum(flow.head - z, 0.0)
    assert result == pytest.approx(np.maximum(-0.18 - z, 0.0), abs=1e-6)
