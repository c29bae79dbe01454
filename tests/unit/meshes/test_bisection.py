"""Triangles of a section and their bisection: conforming, nothing lost, boundaries and strata kept."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshes.bisection import bisect, fan_out, split_at_middle
from meshes.quality import corner_angles
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate
from tests.support.sections import sections, slope

SLOPE = Section.parse(slope())


def assert_conforming(mesh: TriMesh, section: Section) -> None:
    """Strata with their areas, no folded cell, and boundaries that cover the outline once: so no hanging node."""
    assert mesh.areas.min() > 0.0
    areas = np.bincount(mesh.stratum, weights=mesh.areas, minlength=len(section.strata))
    np.testing.assert_allclose(areas, section.layering.areas(), rtol=1e-9)
    outer = np.flatnonzero(mesh.edge_cells[:, 1] < 0)
    named = np.concatenate([mesh.edge_numbers(ends) for ends in mesh.boundaries.values()])
    assert np.array_equal(np.sort(named), outer)
    outline = section.outline()
    ends = mesh.points[mesh.edges[outer]]
    perimeter = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()
    assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() == pytest.approx(perimeter, rel=1e-9)


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(sections(), st.integers(0, 2**32 - 1))
def test_any_section_stays_conforming_wherever_it_is_bisected(section, seed):
    random = np.random.default_rng(seed)
    mesh = triangulate(section, 6.0)
    assert_conforming(mesh, section)
    for _ in range(3):
        before = mesh
        sides = random.normal(size=(len(mesh.cells), 2, 2))
        metric = sides @ sides.transpose(0, 2, 1) + 0.1 * np.eye(2) if random.random() < 0.5 else None
        mesh, parent = bisect(mesh, random.random(len(mesh.cells)) < 0.2, metric)
        assert_conforming(mesh, section)
        np.testing.assert_allclose(np.bincount(parent, weights=mesh.areas), before.areas, rtol=1e-9)


def test_marked_cells_are_divided_and_angles_stay():
    """Rosenberg & Stenger (1975): no angle below half of the smallest one, however often."""
    mesh = triangulate(SLOPE, 5.0)
    smallest = corner_angles(mesh.points, mesh.cells).min()
    for _ in range(8):
        near = np.hypot(*(mesh.points[mesh.cells].mean(axis=1) - [50.0, 11.0]).T).argsort()[:5]
        mesh, parent = bisect(mesh, near)
        assert np.all(np.bincount(parent)[near] >= 2)
    assert corner_angles(mesh.points, mesh.cells).min() >= 0.5 * smallest
    assert len(mesh.cells) < 1000


def test_a_fan_halves_the_angles_at_its_point_and_nowhere_else():
    mesh = triangulate(SLOPE, 5.0)
    at = np.zeros(len(mesh.points), dtype=bool)
    at[np.argmin(np.hypot(*(mesh.points - [50.0, 11.0]).T))] = True
    fan, _ = fan_out(mesh, at, 0.1)
    assert_conforming(fan, SLOPE)
    point = int(np.flatnonzero(at)[0])
    assert np.count_nonzero(fan.cells == point) == 2 * np.count_nonzero(mesh.cells == point)
    round_it = [corner_angles(m.points, m.cells)[m.cells == point].sum() for m in (fan, mesh)]
    assert round_it[0] == pytest.approx(round_it[1])
    assert len(fan_out(mesh, at, 4.0)[0].cells) == len(mesh.cells), "no angle is wider than that"


def test_cells_are_divided_at_their_middle():
    mesh = triangulate(SLOPE, 5.0)
    marked = np.zeros(len(mesh.cells), dtype=bool)
    assert split_at_middle(mesh, marked) is mesh
    marked[:3] = True
    divided = split_at_middle(mesh, marked)
    assert len(divided.cells) == len(mesh.cells) + 6
    assert_conforming(divided, SLOPE)
