"""Steady seepage against closed forms, and what the rest of the program makes of it."""

import tomllib

import numpy as np
import pytest
from scipy.special import ellipk

from meshes.errors import InputError
from meshes.section.section import Section

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
    beside, near = np.array([[0.0, 9.0], [0.0, 9.0]]), np.array([[0.1, 9.0], [-0.1, 9.0]])
    behind, before = section.water_pressure.at_rest(beside, near, np.array([0, 0]))
    assert before > behind + 9.81e3 * 0.5  # the pressure jumps across the wall
    assert not [text for text in section.notices if "not level" in text]


def test_parallel_to_a_slope_the_head_is_that_across_the_flow() -> None:
    """An endless slope: u = γw d cos²β at a depth d below the line."""
    slope = flowing([[0, 15], [50, 5]], [[0, 14], [50, 4]], base=[[0, 10], [50, 0]], head="normal")
    points = np.array([[25.0, 6.0], [10.0, 11.0], [40.0, 2.5]])
    section = Section.parse(slope)
    found = section.water_pressure.at_rest(points, points, np.array([1, 1, 1]))
    assert found == pytest.approx(9806.65 * (14.0 - 0.2 * points[:, 0] - points[:, 1]) / 1.04, rel=1e-4)


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


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"table": None}, "flow = true without table"),
        ({"after_drawdown": 3.0}, "flow = true beside after_drawdown"),
        ({"flow": False, "cutoffs": [{"x": 3, "bottom": 1}]}, "cutoffs without flow = true"),
        ({"cutoffs": [{"x": 99, "bottom": 1}]}, "not between the sides"),
        ({"cutoffs": [{"x": 30, "bottom": 11}]}, "above the ground there"),
        ({"table": -5.0}, "expected water somewhere"),
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
    [("permeability", None, "permeability: missing"), ("piezometric_level", 5.0, "expected none beside flow = true")],
)
def test_a_stratum_that_does_not_fit_flowing_water_is_refused(key: str, value: object, sentence: str) -> None:
    data = flowing([[0, 5], [50, 5]], [[0, 4], [50, 3]])
    data["strata"] = [{k: v for k, v in {**data["strata"][0], key: value}.items() if v is not None}]
    with pytest.raises(InputError, match=sentence):
        Section.parse(data)


@pytest.mark.parametrize("toe", [40.0, 40.3])
def test_a_shore_between_two_points_of_the_grid_lifts_no_ground(toe: float) -> None:
    """The pond meets a bank of sand, through which little seeps: nothing blows out there, wherever it is."""
    ground = [[0, 6], [toe, 6], [toe + 8, 10], [140, 10]]
    section = Section.parse(flowing(ground, [[0, 8.5], [toe + 5, 8.5], [140, 9.5]], base=-10.0))
    assert section.uplift is None
