"""Columns and rows of a mapped mesh: which there are, and that finer ones leave ground and boundaries as they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.gmsh_model import generate
from meshes.quality import areas
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.strips import strips_of, with_finer_strips
from tests.support.sections import slope

GROUND = Section.parse(slope())
MESH = generate(GROUND, MeshSettings(columns=12, rows=6))


def test_a_mapped_mesh_has_a_strip_for_every_column_and_row():
    assert strips_of(MESH).of_edge.max() + 1 == 12 + 6


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 71), st.floats(1.05, 4.0))
def test_finer_strips_keep_areas_of_strata_and_lengths_of_boundaries(where, more):
    indicator = np.zeros(len(MESH.cells))
    indicator[where] = 1.0
    finer = with_finer_strips(MESH, indicator, int(more * len(MESH.cells)))
    assert len(finer.cells) >= more * len(MESH.cells) - 1
    assert np.all(areas(finer.points, finer.cells) > 0.0)
    np.testing.assert_allclose(finer.stratum_areas(), MESH.stratum_areas(), rtol=1e-12)
    for name, edges in finer.boundaries.items():
        before = MESH.boundaries[name]
        assert length(finer, edges) == pytest.approx(length(MESH, before), rel=1e-12)
    assert len(np.unique(finer.cells)) == len(finer.points), "no point is left over, none is double"


def test_only_the_strip_of_the_mechanism_is_cut():
    cell = 30
    indicator = np.zeros(len(MESH.cells))
    indicator[cell] = 1.0
    finer, strips = with_finer_strips(MESH, indicator, len(MESH.cells) + 1), strips_of(MESH)
    new = finer.points[len(MESH.points) :]
    of_cell = {int(strip) for strip in strips.of_edge[strips.of_cell[cell]]}
    middles = MESH.points[strips.edges].mean(axis=1)
    cut = {int(strips.of_edge[np.argmin(np.hypot(*(middles - point).T))]) for point in new}
    assert len(cut) == 1
    assert cut <= of_cell


def length(mesh, edges):
    return float(np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T).sum())
