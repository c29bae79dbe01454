"""Meshes: conforming, named, of the sizes asked for, and the same every time."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, event, given, settings

from meshes.blocks import blocks_of, share_out
from meshes.errors import InputError
from meshes.gmsh_model import generate, refuse_other_ground
from meshes.quad_mesh import BadMeshError, QuadMesh
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import SECTIONS, TOP
from tests.support.meshes import SHIPPED, free, grid, s13
from tests.support.sections import assert_conforming, layer, sections, slope


def edge_lengths(mesh: QuadMesh, cells: np.ndarray) -> np.ndarray:
    corners = mesh.points[mesh.cells[cells]]
    return np.hypot(*np.moveaxis(np.roll(corners, -1, axis=1) - corners, -1, 0))


def test_a_script_reads_a_section_without_gmsh() -> None:
    """gmsh loads libraries of a screen, which a machine that only reads sections need not have."""
    program = "import sys, meshes; meshes.Section, meshes.MeshSettings; print('gmsh' in sys.modules); meshes.generate"
    done = subprocess.run([sys.executable, "-c", program], cwd=TOP, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False"]


# --- S-13 ---------------------------------------------------------------------------------------------------------


def test_s13_is_47_columns_by_13_rows() -> None:
    section = s13()
    mesh = generate(section, grid())
    assert (len(mesh.cells), len(mesh.points)) == (611, 672)
    assert (len(mesh.boundaries["surface"]), len(mesh.boundaries["base"])) == (47, 47)
    assert (len(mesh.boundaries["left"]), len(mesh.boundaries["right"])) == (13, 13)
    assert len(np.unique(mesh.points[:, 0].round(9))) == 48
    assert_conforming(mesh, section)


def test_s13_areas_are_those_of_the_trapezoids() -> None:
    """By hand: thickness at both ends, m, times half the length of 200 m, or of 100 m for layers 2 and 3."""
    mesh = generate(s13(), grid())
    by_hand = [
        100 * (2.0 + 1.2),
        # the bottom of layer 1 lies 1.6 m deep at x = 100 m
        50 * ((4.5 - 1.6) + (4.0 - 1.2)),
        50 * ((5.0 - 2.0) + (4.5 - 1.6)),
        # layers 2 and 3 end at 5.0, 4.5 and 4.0 m
        100 * ((7.7 - 5.0) + (5.0 - 4.0)),
        100 * ((12.0 - 7.7) + (9.0 - 5.0)),
        100 * ((14.0 - 12.0) + (9.9 - 9.0)),
        100 * ((18.0 - 14.0) + (14.0 - 9.9)),
        100 * ((23.0 - 18.0) + (20.0 - 14.0)),
        100 * ((28.0 - 23.0) + (27.0 - 20.0)),
        100 * ((31.5 - 28.0) + (31.5 - 27.0)),
    ]
    np.testing.assert_allclose(mesh.stratum_areas(), by_hand, rtol=1e-9)
    assert sum(by_hand) == pytest.approx(200 * 31.5)


def test_s13_rows_follow_the_interfaces() -> None:
    """Every edge between two strata lies on an interface of the section, or on the contact of layers 2 and 3."""
    section = s13()
    mesh = generate(section, grid())
    owners: dict[tuple[int, int], list[int]] = {}
    for cell, stratum in zip(mesh.cells.tolist(), mesh.stratum.tolist(), strict=True):
        for a in range(4):
            first, second = cell[a], cell[(a + 1) % 4]
            owners.setdefault((min(first, second), max(first, second)), []).append(stratum)
    between = [(edge, strata) for edge, strata in owners.items() if len(set(strata)) == 2]
    contact = [edge for edge, strata in between if set(strata) == {1, 2}]
    assert [mesh.points[list(edge), 0].tolist() for edge in contact] == [[100.0, 100.0]]
    for edge, strata in between:
        x, z = mesh.points[list(edge)].T
        if set(strata) != {1, 2}:
            ground = 9.08 * (1.0 - x / 200.0)
            bottom = section.layering.interfaces(x)[:, min(strata) + 1]
            if min(strata) == 0:
                np.testing.assert_allclose(ground - z, 2.0 - 0.8 * x / 200.0, atol=1e-9)
            np.testing.assert_allclose(z, bottom, atol=1e-9)


def test_lateral_neighbours_share_their_rows() -> None:
    mesh = generate(s13(), grid(rows=26))
    at_contact = [
        {node for node in np.unique(mesh.cells[mesh.stratum == k]) if mesh.points[node, 0] == 100.0} for k in (1, 2)
    ]
    assert at_contact[0] == at_contact[1]
    assert len(at_contact[0]) == 3  # two rows


def test_ground_in_the_wrong_stratum_and_a_slit_are_refused() -> None:
    section = Section.read(SECTIONS / "natural_slope.toml")
    layers = free(section).meshed_layers(section)[0]
    mesh = generate(section, free(section))
    refuse_other_ground(mesh, layers)
    mistaken = np.where(np.arange(len(mesh.stratum)) == 0, mesh.stratum[0] + 1, mesh.stratum)
    with pytest.raises(BadMeshError, match="gmsh meshed"):
        refuse_other_ground(replace(mesh, stratum=mistaken), layers)
    slit = np.vstack([mesh.boundaries["base"], mesh.cells[:1, :2]])
    with pytest.raises(BadMeshError, match="a gap in the mesh"):
        refuse_other_ground(replace(mesh, boundaries=mesh.boundaries | {"base": slit}), layers)


def test_ground_on_both_sides_of_bare_rock_is_meshed() -> None:
    """Its outline goes twice along the rock: this ended as a slit in the ground."""
    ground = [[0.0, 6.0], [10.0, 6.0], [16.0, 0.0], [20.0, 0.0], [26.0, 3.0], [40.0, 3.0]]
    section = Section.parse({"name": "t", "surface": ground, "base": {"elevation": 0.0}, "strata": [layer("a")]})
    mesh = generate(section)
    np.testing.assert_allclose(mesh.stratum_areas(), [78.0 + 51.0], rtol=1e-9)


def test_layers_below_a_steep_face_are_apart_as_they_are_above_one_another() -> None:
    """5 cm below a face of 18 m in 2 m the bottom of a layer is 6 mm from it: it was taken for the face."""
    ground = [[0.0, 18.0], [30.0, 18.0], [32.0, 0.0], [60.0, 0.0]]
    strata = [layer("a", bottom={"depth": 0.05}), layer("b")]
    section = Section.parse({"name": "t", "surface": ground, "base": {"depth": 11.0}, "strata": strata})
    mesh = generate(section, free(section))
    np.testing.assert_allclose(mesh.stratum_areas(), [3.0, 657.0], rtol=1e-6)


def test_long_thin_ground_has_as_many_cells_as_are_allowed() -> None:
    """100 m of a cover 0.4 m thick had 40,000 cells, a twelfth of its height each."""
    ground = [[0.0, 40.0], [50.0, 40.0], [60.0, 35.0], [100.0, 15.0]]
    for bottoms in ([], [{"depth": [[20.0, 0.1], [60.0, 0.2]]}]):  # mapped, and free
        strata = [*(layer("s", bottom=bottom) for bottom in bottoms), layer("a")]
        section = Section.parse({"name": "t", "surface": ground, "base": {"depth": 0.4}, "strata": strata})
        for most in (500, 3000):
            settings = MeshSettings(max_cells=most)
            mesh = generate(section, settings)
            assert mesh.method == ("free" if bottoms else "mapped")
            assert len(mesh.cells) < 2 * most
            assert [line for line in settings.notices(section) if "250 times as long as it is high" in line]
        assert len(generate(section, MeshSettings(size=0.1)).cells) > 3000


def test_a_very_thin_seam_does_not_make_the_cells_beside_it_small() -> None:
    """2 cm of clay in 12 m had 10,930 cells in a free mesh, columns eight times as long as it is thick."""
    bottoms = [{"elevation": -2.0}, {"elevation": -2.02}]
    strata = [*(layer(f"{k}", bottom=bottom) for k, bottom in enumerate(bottoms)), layer("a")]
    ground = [[0.0, 12.0], [30.0, 12.0], [54.0, 0.0], [110.0, 0.0]]
    section = Section.parse({"name": "t", "surface": ground, "base": {"elevation": -6.0}, "strata": strata})
    assert len(generate(section, free(section)).cells) < 5000


# --- What every mesh must be --------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None, derandomize=True)
@given(section=sections())
def test_random_sections_mesh_freely(section: Section) -> None:
    mesh = generate(section, free(section))
    assert mesh.method == "free"
    assert_conforming(mesh, section, free(section))


@settings(max_examples=20, deadline=None, derandomize=True)
@given(section=sections())
def test_random_sections_are_mapped_wherever_possible(section: Section) -> None:
    assume(not isinstance(blocks_of(section), str))
    once, twice = generate(section, grid(60, 12)), generate(section, grid(60, 12, refine=2))
    assert len(once.cells) == 60 * 12
    assert len(twice.cells) == 4 * len(once.cells)
    assert_conforming(once, section)
    assert_conforming(twice, section)


@pytest.mark.slow
@settings(max_examples=3000, deadline=None)
@given(section=sections())
def test_many_random_sections_mesh_rightly_or_are_refused(section: Section) -> None:
    """gmsh has no mesh for some needles of ground between two faults; such a mesh must never be told as one."""
    try:
        mesh = generate(section, free(section))
    except BadMeshError as error:
        event(str(error).split(":")[0][:30])
        return
    assert_conforming(mesh, section, free(section))


@pytest.mark.parametrize("file", SHIPPED, ids=lambda path: path.stem)
@pytest.mark.parametrize("refine", [1, 2])
def test_shipped_sections_mesh_freely(file: Path, refine: int) -> None:
    section = Section.read(file)
    wanted = free(section, 600.0, refine=refine)
    assert_conforming(generate(section, wanted), section, wanted)


def test_refined_cells_divide_the_coarse_ones() -> None:
    """The coarse nodes are among the fine ones, so that results can be compared point by point."""
    section = s13()
    coarse, fine = generate(section, grid()), generate(section, grid(refine=3))
    assert len(fine.cells) == 9 * 611
    result = {tuple(point) for point in fine.points.round(6).tolist()}
    assert {tuple(point) for point in coarse.points.round(6).tolist()} <= result


def test_refining_a_free_mesh_halves_its_cells() -> None:
    section = Section.read(SECTIONS / "slope_2to1.toml")
    once, twice = generate(section, free(section, 600.0)), generate(section, free(section, 600.0, refine=2))
    ratio = np.median(edge_lengths(once, slice(None))) / np.median(edge_lengths(twice, slice(None)))
    assert 1.8 < ratio < 2.2
    assert 3.4 < len(twice.cells) / len(once.cells) < 4.6


@pytest.mark.parametrize("method", ["mapped", "free"])
def test_the_same_mesh_every_time(method: str, tmp_path: Path) -> None:
    section = s13()
    chosen = grid() if method == "mapped" else free(section)
    generate(section, chosen, tmp_path / "a.msh")
    generate(section, chosen, tmp_path / "b.msh")
    assert (tmp_path / "a.msh").read_bytes() == (tmp_path / "b.msh").read_bytes()


def test_far_from_the_origin() -> None:
    data = slope()
    data["surface"] = [[250_000.0, 20.0], [250_100.0, 10.0]]
    section = Section.parse(data)
    assert_conforming(generate(section, grid(30, 8)), section)
    assert_conforming(generate(section, free(section)), section, free(section))


# --- Sizes --------------------------------------------------------------------------------------------------------


def test_the_global_size_is_kept() -> None:
    mesh = generate(Section.parse(slope()), MeshSettings(method="free", size=0.8))
    assert 0.8 * 0.85 < np.median(edge_lengths(mesh, slice(None))) < 0.8 * 1.15


def test_a_stratum_of_its_own_size() -> None:
    mesh = generate(Section.parse(slope()), MeshSettings(method="free", size=2.0, sizes={"upper": "50 cm"}))
    assert 0.4 < np.median(edge_lengths(mesh, mesh.stratum == 0)) < 0.6
    deep = (mesh.stratum == 1) & (mesh.points[mesh.cells].mean(axis=1)[:, 1] < 3.0)
    assert np.median(edge_lengths(mesh, deep)) > 1.4


@pytest.mark.parametrize("name", ["surface", "upper", "base"])
def test_finer_towards_an_interface(name: str) -> None:
    section = Section.parse({**slope(), "surface": [[0.0, 60.0], [100.0, 60.0]]})
    line = {"surface": 60.0, "upper": 56.0, "base": 0.0}[name]
    mesh = generate(section, MeshSettings(method="free", size=3.0, towards={name: 0.4}))
    distance = np.abs(mesh.points[mesh.cells].mean(axis=1)[:, 1] - line)
    assert 0.3 < np.median(edge_lengths(mesh, distance < 0.4)) < 0.5
    assert np.median(edge_lengths(mesh, distance > 45.0)) > 2.2


def test_size_of_a_mapped_mesh() -> None:
    mesh = generate(Section.parse(slope()), MeshSettings(size=1.0))
    assert mesh.method == "mapped"
    assert len(mesh.cells) == 100 * 15  # 100 m by 15 m in the mean
    assert len(generate(Section.parse(slope()), MeshSettings(size=1.0, columns=40)).cells) == 40 * 15


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"sizes": {"uper": 1.0}}, 'mesh, sizes: there is no "uper"; expected one of upper, lower'),
        ({"towards": {"left": 1.0}}, 'mesh, towards: there is no "left"; expected one of upper, lower, surface, base'),
        ({"size": 1e-9}, "quadrilaterals; expected at most 5,000,000"),
        ({"size": 1e-3, "method": "free"}, "quadrilaterals; expected at most 5,000,000"),
        ({"sizes": {"upper": 1e-4}}, "quadrilaterals; expected at most 5,000,000"),
        ({"towards": {"upper": 1e-5}}, "quadrilaterals; expected at most 5,000,000"),
        ({"columns": 10**12}, "quadrilaterals; expected at most 5,000,000"),
        ({"columns": 1000, "rows": 100, "refine": 64}, "quadrilaterals; expected at most 5,000,000"),
        ({"size": 101.0}, "mesh, size = 101 m: expected at most the section's own size, 100 m"),
        ({"size": 1.0, "columns": 5, "rows": 5}, "expected either a size or both columns and rows"),
        ({"method": "free", "columns": 5}, 'mesh, columns and rows: expected none with method = "free"'),
        ({"method": "mapped", "sizes": {"upper": 1.0}}, "mesh, sizes and towards: expected none with columns and rows"),
        ({"rows": 9, "towards": {"upper": 1.0}}, "mesh, sizes and towards: expected none with columns and rows"),
        ({"rows": 1}, "mesh, rows = 1: expected at least 2, one for each layer"),
    ],
)
def test_settings_that_do_not_fit(values: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match="1 problem") as caught:
        generate(Section.parse(slope()), MeshSettings(**values))
    assert said in caught.value.problems[0]


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"size": 1.0},
        {"columns": 30, "rows": 9, "refine": 2},
        {"method": "free", "size": 0.7},
        {"size": 3.0, "sizes": {"upper": 0.3}},
        {"size": 2.0, "towards": {"upper": 0.1}},
        {"size": 2.0, "sizes": {"lower": 1.0}, "towards": {"base": 0.2}, "refine": 2},
    ],
)
def test_the_number_of_cells_is_known_beforehand(values: dict[str, Any]) -> None:
    """Well enough to refuse what no memory would hold."""
    section = Section.parse(slope())
    chosen = MeshSettings(**values)
    assert 0.5 < len(generate(section, chosen).cells) / chosen.expected_quadrilaterals(section) < 2.0


def test_sizes_ask_for_a_free_mesh() -> None:
    section = Section.parse(slope())
    assert MeshSettings().method_for(section) == "mapped"
    assert MeshSettings(sizes={"upper": 1.0}).method_for(section) == "free"
    assert MeshSettings(towards={"upper": 1.0}).method_for(section) == "free"


@pytest.mark.parametrize(
    ("bottom", "reason"),
    [
        ({"depth": [[0.0, 4.0], [60.0, 0.0]]}, 'stratum "upper" thins out to nothing at x = 60 m'),
        ({"depth": [[0.0, 4.0], [60.0, 4.0]]}, "the number of layers changes from 2 to 1 at x = 60 m"),
        ({"depth": [[0.0, 4.0], [60.0, 4.0], [60.0, 2.0], [100.0, 2.0]]}, "there is a vertical step at x = 60 m"),
    ],
)
def test_what_cannot_be_mapped_says_why_and_where(bottom: dict[str, Any], reason: str) -> None:
    section = Section.parse({**slope(), "strata": [layer("upper", bottom=bottom), layer("lower")]})
    with pytest.raises(InputError, match="not possible") as caught:
        generate(section, MeshSettings(method="mapped"))
    assert reason in caught.value.problems[0]
    assert generate(section).method == "free"


@pytest.mark.parametrize(
    ("total", "weights", "expected"),
    [(13, [1.0, 1.0], [7, 6]), (10, [8.0, 1.0, 1.0], [8, 1, 1]), (3, [100.0, 1.0, 1.0], [1, 1, 1]), (4, [5.0], [4])],
)
def test_rows_are_shared_out_by_thickness(total: int, weights: list[float], expected: list[int]) -> None:
    assert sorted(share_out(total, weights), reverse=True) == expected
    with pytest.raises(ValueError, match="cannot be divided"):
        share_out(len(weights) - 1, weights)
