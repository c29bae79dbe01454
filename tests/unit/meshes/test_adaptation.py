"""Meshes made anew for an indicator: small cells where it is large, about as many as asked for, conforming."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from meshes.adaptation import COARSER, FINER, GROWTH, Growth, adapted
from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.quad_mesh import BadMeshError, QuadMesh
from meshes.quality import areas
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import assert_conforming, sections, slope


def middles(mesh: QuadMesh) -> np.ndarray:
    return mesh.points[mesh.cells].mean(axis=1)


def near_a_line(mesh: QuadMesh) -> np.ndarray:
    """An indicator that is one within 1 m of the line z = 0.15 x from x = 30 to 60 m, and a millionth elsewhere."""
    x, z = middles(mesh).T
    return np.where((np.abs(z - 0.15 * x) < 1.0) & (x > 30.0) & (x < 60.0), 1.0, 1e-6)


@pytest.mark.parametrize("cells", [600, 1500])
def test_cells_go_where_the_indicator_is_large(cells: int) -> None:
    section = Section.parse(slope())
    first = generate(section, MeshSettings(method="free"))
    mesh = adapted(section, MeshSettings(method="free"), first, near_a_line(first), cells)
    assert_conforming(mesh, section)
    assert len(mesh.cells) == pytest.approx(cells, rel=0.25)
    size = np.sqrt(areas(mesh.points, mesh.cells))
    inside = near_a_line(mesh) == 1.0
    assert np.median(size[inside]) < 0.4 * np.quantile(size[~inside], 0.9)
    ordinary = MeshSettings().cell_size(section)
    assert size.max() < 1.5 * COARSER * ordinary
    assert size.min() > 0.3 * np.sqrt(areas(first.points, first.cells)).min() / FINER


def test_nothing_found_leaves_cells_alike() -> None:
    section = Section.parse(slope())
    first = generate(section, MeshSettings(method="free"))
    mesh = adapted(section, MeshSettings(method="free"), first, np.zeros(len(first.cells)), 500)
    size = np.sqrt(areas(mesh.points, mesh.cells))
    assert len(mesh.cells) == pytest.approx(500, rel=0.25)
    assert np.quantile(size, 0.9) < 2.0 * np.quantile(size, 0.1)


def test_periodic_sides_get_the_same_points() -> None:
    """Where only one side has small cells, too: elements tie the nodes of one side to those of the other."""
    section = Section.parse(slope() | {"base": {"depth": 15.0}})
    first = generate(section, MeshSettings(method="free"))
    near_left = np.where(middles(first)[:, 0] < 20.0, 1.0, 1e-6)
    mesh = adapted(section, MeshSettings(method="free"), first, near_left, 1500, repeats=True)
    left, right = (np.sort(mesh.points[np.unique(mesh.boundaries[side]), 1]) for side in ("left", "right"))
    assert len(left) > 17
    np.testing.assert_allclose(left - 10.0, right, atol=1e-6)


def test_sizes_of_the_settings_are_kept() -> None:
    section = Section.parse(slope())
    wanted = MeshSettings(sizes={"upper": 0.7})
    first = generate(section, wanted)
    mesh = adapted(section, wanted, first, near_a_line(first), 600)
    assert np.median(np.sqrt(areas(mesh.points, mesh.cells))[mesh.stratum == 0]) < 0.9


def test_sizes_grow_by_the_distance_from_the_smallest() -> None:
    """One small cell at the corner of a mapped mesh of squares: the size is its own plus growth times the way."""
    data = {**slope(), "surface": [[0.0, 10.0], [10.0, 10.0]], "strata": slope()["strata"][1:]}
    mesh = generate(Section.parse(data), MeshSettings(method="mapped", columns=10, rows=10))
    corner = int(np.argmin(middles(mesh).sum(axis=1)))
    sizes = np.full(len(mesh.cells), 100.0)
    sizes[corner] = 0.5
    at_points = Growth(mesh).limited(sizes)
    x, z = mesh.points.T
    from_corner = np.maximum(np.maximum(x, z) - 1.0, 0.0) + (np.sqrt(2.0) - 1.0) * np.maximum(np.minimum(x, z) - 1.0, 0)
    np.testing.assert_allclose(at_points, 0.5 + GROWTH * from_corner, atol=1e-9)


@pytest.mark.parametrize("wrong", [np.ones(3), -1.0, np.nan])
def test_an_indicator_that_does_not_fit_is_refused(wrong: np.ndarray | float) -> None:
    section = Section.parse(slope())
    first = generate(section)
    indicator = wrong if isinstance(wrong, np.ndarray) else np.full(len(first.cells), wrong)
    with pytest.raises(InputError, match="indicator"):
        adapted(section, MeshSettings(), first, indicator, 500)


@settings(deadline=None, max_examples=3)
@given(section=sections(), seed=st.integers(0, 1000))
def test_any_section_can_be_adapted_to_anything(section: Section, seed: int) -> None:
    try:
        first = generate(section, MeshSettings(method="free"))
    except BadMeshError:
        assume(False)
    indicator = np.random.default_rng(seed).random(len(first.cells)) ** 8
    mesh = adapted(section, MeshSettings(method="free"), first, indicator, max(len(first.cells), 200))
    assert_conforming(mesh, section, MeshSettings(method="free"))
