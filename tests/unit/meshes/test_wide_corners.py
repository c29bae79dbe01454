"""Narrow corners of free meshes are made wider by moving nodes inside their stratum."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.gmsh_model import WIDENED_ANGLE, generate
from meshes.quad_mesh import QuadMesh, read
from meshes.quality import corner_angles
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.wide_corners import corner_widths, with_wider_corners
from tests.unit.meshes.test_stacked_layers import LEVEE

COLUMNS, ROWS = 6, 4


def grid(shift: np.ndarray | None = None) -> QuadMesh:
    """Return six by four unit squares in two strata, the inner nodes shifted."""
    x, z = np.meshgrid(np.arange(COLUMNS + 1.0), np.arange(ROWS + 1.0), indexing="ij")
    points = np.column_stack([x.ravel(), z.ravel()])
    number = np.arange(len(points)).reshape(COLUMNS + 1, ROWS + 1)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    stratum = np.where(np.arange(len(cells)) % ROWS < ROWS // 2, 1, 0)
    if shift is not None:
        inner = (points > 0.0).all(axis=1) & (points[:, 0] < COLUMNS) & (points[:, 1] < ROWS)
        inner &= points[:, 1] != ROWS // 2
        points[inner] += shift.reshape(-1, 2)[: inner.sum()]
    lines = {"left": number[0], "right": number[-1], "base": number[:, 0], "surface": number[:, -1]}
    edges = {name: np.column_stack([line[:-1], line[1:]]) for name, line in lines.items()}
    return QuadMesh(points, cells, stratum, ("upper", "lower"), edges, "free")


def test_a_node_that_is_far_off_goes_where_its_corners_are_wide() -> None:
    shift = np.zeros((COLUMNS - 1) * (ROWS - 2) * 2)
    shift[:2] = 0.45, 0.45
    mesh = grid(shift)
    assert corner_widths(mesh.points, mesh.cells).min() < 12.0
    wider = with_wider_corners(mesh, 20.0)
    assert corner_widths(wider.points, wider.cells).min() > 45.0


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-0.45, 0.45), min_size=20, max_size=20))
def test_no_corner_is_narrower_than_the_narrowest_and_strata_keep_their_areas(shift: list[float]) -> None:
    mesh = grid(np.array(shift))
    wider = with_wider_corners(mesh, 30.0)
    before, after = (corner_widths(m.points, m.cells).min() for m in (mesh, wider))
    assert after >= min(before, 30.0) - 1e-9
    assert wider.stratum_areas() == pytest.approx(mesh.stratum_areas())
    fixed = (mesh.points[:, 1] == ROWS // 2) | (mesh.points == 0.0).any(axis=1)
    assert (wider.points[fixed] == mesh.points[fixed]).all()


def test_a_mesh_of_wide_corners_stays_as_it_is() -> None:
    assert (with_wider_corners(grid(), 20.0).points == grid().points).all()


def test_the_file_holds_the_nodes_that_have_moved(tmp_path: Path) -> None:
    """The levee had corners of 13.3 degrees where its water table meets the crust, with the soils as they are."""
    section = Section.read(LEVEE)
    mesh = generate(section, MeshSettings(method="free"), tmp_path / "levee.msh")
    assert 15.0 < corner_angles(mesh.points, mesh.cells).min() < WIDENED_ANGLE
    stored = read(tmp_path / "levee.msh")
    assert corner_angles(stored.points, stored.cells).min() == corner_angles(mesh.points, mesh.cells).min()
