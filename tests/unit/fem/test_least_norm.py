"""The shortest change that meets equations, of which some may depend on others."""

import numpy as np
import pytest
from scipy import sparse

from fem.limit.first_mesh import first_mesh
from fem.limit.limit_problem import limit_problem, units_of
from fem.limit.lower_bound import equations, independent_equations
from fem.limit.section_body import body_of
from fem.settings import FemSettings
from fem.solvers.least_norm import smallest_correction
from meshes.section.section import Section
from tests.support.sections import layer


def thin_layers(count):
    """Layers of clay under water, 12 m of slope above 12 m of ground."""
    bottoms = [12.0 - 24.0 / count * (k + 1) for k in range(count - 1)]
    strata = [
        layer(f"clay {k}", cohesion=f"{12 + 3 * k} kPa", friction_angle="0 deg") | {"bottom": {"elevation": bottom}}
        for k, bottom in enumerate(bottoms)
    ]
    strata.append(layer("clay", cohesion="60 kPa", friction_angle="0 deg"))
    surface = [[-40.0, 0.0], [0.0, 0.0], [24.0, 12.0], [80.0, 12.0]]
    data = {"name": "clay", "surface": surface, "base": {"elevation": -12.0}, "water": {"table": 15.0}}
    return Section.parse({**data, "strata": strata})


def test_it_is_the_least_norm_solution_where_equations_depend_on_each_other():
    draw = np.random.default_rng(1)
    matrix = draw.normal(size=(6, 15))
    matrix[5] = matrix[0] - 2.0 * matrix[1]
    right = matrix @ draw.normal(size=15)
    values = smallest_correction(sparse.csr_matrix(matrix), right)
    np.testing.assert_allclose(values, np.linalg.lstsq(matrix, right, rcond=None)[0], atol=1e-12)


def test_residuals_that_no_change_can_meet_and_no_numbers_end_it():
    matrix = sparse.csr_matrix([[1.0, 1.0], [2.0, 2.0]])
    assert np.isfinite(smallest_correction(matrix, np.array([1e-9, -1e-9]))).all()
    assert not smallest_correction(matrix, np.array([np.nan, 0.0])).any()


def test_equations_of_thin_layers_are_met_by_sparse_factors_alone(monkeypatch):
    """SuperLU took 30 s of processor time to order 40,000 equations, Clarabel takes twice as long as CHOLMOD's 1 s."""
    monkeypatch.setattr("fem.solvers.least_norm._shortest", lambda *_: pytest.fail("by Clarabel"))
    section = thin_layers(21)
    mesh = first_mesh(section, 40_000)
    body = body_of(section, mesh, FemSettings())
    problem = limit_problem(mesh, body, units_of(mesh, body))
    matrix, dead, _ = independent_equations(*equations(problem))
    assert matrix.shape[0] > 30_000
    values = smallest_correction(matrix, 1e-9 * dead)
    left = 1e-9 * dead - matrix @ values
    assert np.abs(left).max() < 1e-13 * np.abs(dead).max()
