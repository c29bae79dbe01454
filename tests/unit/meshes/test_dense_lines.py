"""Ground that was scanned every two centimetres: what of it a mesh can use, and that lines keep their places."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.section.dense_lines import thinned_lines
from meshes.section.section import Section
from tests.support.sections import layer
from workflow.config import Config

SOIL = {"density": "18 kN/m^3", "density_saturated": "20 kN/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3,
        "cohesion": "10 kPa", "friction_angle": "30 deg"}  # fmt: skip


def scanned(noise: float, count: int = 5001, **more: Any) -> dict[str, Any]:
    """A bank of 8 m, 2.5:1, scanned with noise (m) every 2 cm."""
    x = np.linspace(0.0, 100.0, count)
    z = np.interp(x, [0, 40, 60, 100], [12, 12, 4, 4]) + np.random.default_rng(1).normal(0.0, noise, count)
    strata = [{"name": "Sand", "bottom": {"elevation": 2.0}, **SOIL}, {"name": "Clay", **SOIL}]
    return {"name": "scan", "surface": np.column_stack([x, z]).tolist(), "base": {"elevation": -6.0}, "strata": strata,
            **more}  # fmt: skip


@pytest.mark.parametrize("noise", [*(pytest.param(noise, marks=pytest.mark.slow) for noise in (0.0, 0.03)), 0.1])
def test_a_scanned_ground_has_the_cells_of_a_drawn_one(noise: float) -> None:
    """23,867 cells with corners of 1.2 degrees before; 8 m by 20 m keep their area within the noise."""
    made = Config.parse(scanned(noise, water={"table": [[0, 6], [100, 3]]}))
    assert len(made.section.surface) < 20
    assert made.section.layering.areas().sum() == pytest.approx(1400.0, abs=3.0)
    assert f"{len(made.section.surface)} of 5001 points of the ground" in made.notices[0]
    quality = generate(made.section, made.mesh).quality()
    assert quality.quadrilaterals < 2000
    assert quality.smallest_angle > 15.0
    assert quality.largest_angle < 165.0


def test_the_ground_as_thinned_is_thinned_no_more() -> None:
    once = Section.parse(scanned(0.02))
    again = Section.parse({"name": "again", "surface": once.surface, "base": {"elevation": -6.0},
                           "strata": scanned(0.0)["strata"]})  # fmt: skip
    assert again.surface == once.surface
    assert not any("more points than" in notice for notice in again.notices)


def test_a_wall_stands_where_it_was() -> None:
    data = scanned(0.0)
    data["surface"] = [[x, 12.0 if x <= 50.0 else 9.0] for x, _ in data["surface"]]
    made = Section.parse(data)
    assert len(made.surface) == 4
    assert made.surface[1:3] == ((pytest.approx(50.01), 12.0), (pytest.approx(50.01), 9.0))


@pytest.mark.parametrize("aside", [*(pytest.param(aside, marks=pytest.mark.slow) for aside in (0.0, 0.02)), 0.05])
def test_terraces_whose_walls_were_scanned_have_vertical_steps(aside: float) -> None:
    """Walls with a point every 4 cm, and points that stand up to 0.2 m left of the one before: were refused."""
    rng = np.random.default_rng(5)
    walls, heights = [30.0, 35.0, 45.0], [4.0, 5.0, 6.5, 8.5]
    points: list[tuple[float, float]] = []
    for x in np.linspace(0.0, 100.0, 5001):
        floor = heights[int(np.searchsorted(walls, x))]
        if points and floor - points[-1][1] > 0.5:
            points += [(x, z) for z in np.arange(points[-1][1], floor, 0.04)]
        points.append((x, floor))
    surface = np.array(points) + np.column_stack([rng.normal(0.0, aside, len(points)), np.zeros(len(points))])
    surface[[0, -1], 0] = 0.0, 100.0
    made = Config.parse({**scanned(0.0), "surface": surface.tolist()})
    ground = np.array(made.section.surface)
    assert len(ground) < 16
    steps = ground[1:][np.diff(ground[:, 0]) == 0.0]
    np.testing.assert_allclose(steps[:, 0], walls, atol=0.05)
    np.testing.assert_allclose(steps[:, 1], heights[1:], atol=0.05)
    assert made.section.layering.areas().sum() == pytest.approx(30 * 4 + 5 * 5 + 10 * 6.5 + 55 * 8.5 + 600, rel=2e-3)
    assert any("stood left of the point before" in notice for notice in made.notices) == (aside > 0.0)
    assert generate(made.section, made.mesh).quality().smallest_angle > 15.0


def test_a_point_every_four_millimetres_is_no_chain_that_closes_up() -> None:
    """Each lay within a centimetre of its neighbour: the whole ground was one point."""
    data = scanned(0.002)
    data["surface"] = [[0.2 * x, z] for x, z in data["surface"]]
    made = Section.as_written(data)
    assert made.layering.areas().sum() == pytest.approx(280.0, abs=0.6)
    assert made.thinned().layering.areas().sum() == pytest.approx(280.0, abs=0.6)


def test_a_low_bench_stays() -> None:
    """0.4 m high, cells of 1.2 m: all lines were let go by 0.38 m for the foot of its steps."""
    data = scanned(0.01)
    data["surface"] = [[x, z + 0.4 * (70.0 < x < 85.0)] for x, z in data["surface"]]
    ground = np.array(Section.parse(data).surface)
    np.testing.assert_allclose(np.interp([65.0, 77.0, 95.0], *ground.T), [4.0, 4.4, 4.0], atol=0.06)


def test_points_on_a_wall_and_points_given_twice_are_one_step() -> None:
    ground = [[0, 12], [0, 12], [20, 12], [20, 12], [20, 12], [50, 12], [50, 11], [50, 10], [50, 9], [100, 9], [100, 9]]
    made = Section.parse({**scanned(0.0), "surface": ground})
    assert made.surface == ((0, 12), (20, 12), (50, 12), (50, 9), (100, 9))
    assert made.notices == []


@pytest.mark.parametrize("ground", [
    [[0, 12], [50, 12], [50, 30], [50, 12], [100, 12]],
    [[0, 12], [50, 12], [48, 15], [100, 15]],
])  # fmt: skip
def test_a_spike_and_an_overhang_are_refused(ground: list[list[float]]) -> None:
    with pytest.raises(InputError, match=r"expected (at most two|points from left to right)"):
        Section.parse({**scanned(0.0), "surface": ground})


@given(
    count=st.integers(400, 2000), noise=st.floats(0.0, 0.05), seed=st.integers(0, 1000), cell=st.floats(0.8, 2.0),
    depth=st.floats(0.0, 3.0),
)  # fmt: skip
@settings(max_examples=25, deadline=None)
def test_lines_move_no_more_than_is_told_and_do_not_cross(
    count: int, noise: float, seed: int, cell: float, depth: float
) -> None:
    """Beside a line of the same points that lies on the ground in part and deeper elsewhere."""
    rng = np.random.default_rng(seed)
    x = np.linspace(0.0, 50.0, count)
    ground = 3.0 * np.sin(x / rng.uniform(4.0, 9.0)) + rng.normal(0.0, noise, count)
    below = ground - np.clip(depth * np.sin(x / 5.0), 0.0, None)
    lines = {("surface",): np.column_stack([x, ground]), ("below",): np.column_stack([x, below])}
    result, tolerance = thinned_lines(lines, cell)
    at = np.linspace(0.0, 50.0, 3001)
    top, bottom = (np.interp(at, *result[place].T) for place in lines)
    assert np.all(top - bottom >= -1e-9)
    if tolerance == 0.0:
        return
    assert len(result[("surface",)]) < count
    smooth = max(4.5 * noise + 0.5 * (0.125 * cell / 4.0) ** 2 * 3.0, 0.02)  # what the running median takes off
    assert np.abs(top - np.interp(at, x, ground)).max() <= tolerance + smooth + 0.05


def test_a_section_drawn_from_right_to_left_is_turned_round_and_told() -> None:
    """As sections of right banks are drawn; every point of every line was refused on its own."""
    lines = {
        "surface": [[0.0, 8.0], [25.0, 8.0], [40.0, 0.0], [60.0, 0.0]],
        "base": [[0.0, -4.0], [60.0, -5.0]],
        "bottom": [[0.0, 2.0], [60.0, -1.0]],
        "table": [[0.0, 5.0], [40.0, 0.0], [60.0, 0.0]],
        "earlier": [[0.0, 3.0], [60.0, 0.0]],
    }
    there, back = (
        {
            "name": "bank",
            "surface": lines["surface"][::way],
            "base": {"elevation": lines["base"][::way]},
            "water": {"table": lines["table"][::way]},
            "consolidation": {"table": lines["earlier"][::way]},
            "strata": [
                layer("a", bottom={"elevation": lines["bottom"][::way]}),
                layer(
                    "b",
                    cohesion_increase="1 kPa/m",
                    cohesion_from=lines["bottom"][::way],
                    strength_ratio=0.2,
                    consolidated_below=lines["surface"][::way],
                ),
            ],
        }
        for way in (1, -1)
    )
    ground, other = Section.parse(there), Section.parse(back)
    assert (ground.surface, ground.base, ground.water, ground.strata, ground.consolidation) == (
        other.surface,
        other.base,
        other.water,
        other.strata,
        other.consolidation,
    )
    (messages,) = [text for text in other.notices if "were reversed" in text]
    assert "surface; base, elevation; strata, 1, bottom, elevation; strata, 2, cohesion_from; strata, 2, " in messages
    assert "consolidated_below; water, table; consolidation, table" in messages
    assert not [text for text in ground.notices if "were reversed" in text]


def test_a_film_that_thinning_removes_is_left_out_and_told() -> None:
    """It ended in a traceback of pydantic. What comes below it keeps its number in the file."""
    x = np.linspace(0.0, 40.0, 1601)
    ground = np.column_stack([x, 5.0 - 0.1 * x + 0.005 * np.random.default_rng(3).standard_normal(len(x))])
    film = ground - np.where(abs(x - 20.0) < 0.04, 0.015, 0.0)[:, None] * [0.0, 1.0]
    strata = [{"name": "Film", "bottom": {"elevation": film.tolist()}, **SOIL}, {"name": "Clay", **SOIL}]
    thinned = Section.parse({"name": "scan", "surface": ground.tolist(), "base": {"elevation": -8}, "strata": strata})
    assert [stratum.name for stratum in thinned.strata] == ["Clay"]
    assert thinned.strata[0].file_table == "strata 2"
    assert any('"Film" is thinner than these lines are exact, and is left out' in text for text in thinned.notices)
