"""Cholesky factors by CHOLMOD: right, of the same bits in two threads, and refused where there are none."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy import sparse

from fem.solvers import cholmod

pytestmark = pytest.mark.skipif(not cholmod.available(), reason="there is no CHOLMOD")


def lower_triangle(side: int) -> sparse.csc_matrix:
    """Of a membrane on a square of ``side`` points a side, on soft springs."""
    line = sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(side, side))
    item = sparse.identity(side)
    whole = sparse.kron(item, line) + sparse.kron(line, item) + 1e-3 * sparse.identity(side**2)
    lower = sparse.tril(whole, format="csc")
    lower.sort_indices()
    return lower


def solution(lower: sparse.csc_matrix, sides: np.ndarray, nested: bool) -> np.ndarray:
    factors = cholmod.Cholesky(lower, nested)
    factors.factorise(lower.data)
    return factors.solve(sides)


@pytest.mark.parametrize("nested", [True, False])
def test_solutions_are_right_and_do_not_depend_on_threads(nested: bool) -> None:
    """Two threads at once order, factorise and solve ten times each what one has done before."""
    lower = lower_triangle(70)
    sides = np.sin(np.arange(2.0 * lower.shape[0])).reshape(-1, 2)
    alone = solution(lower, sides, nested)
    whole = lower + sparse.triu(lower.T, 1)
    assert np.abs(whole @ alone - sides).max() < 1e-10
    with ThreadPoolExecutor(2) as threads:
        values = list(threads.map(lambda _: solution(lower, sides, nested), range(20)))
    assert all(np.array_equal(alone, item) for item in values)


def test_what_is_not_positive_definite_is_refused_and_the_next_matrix_is_not(capfd) -> None:
    lower = lower_triangle(10)
    factors = cholmod.Cholesky(lower)
    with pytest.raises(cholmod.NotPositiveDefiniteError):
        factors.factorise(-lower.data)
    factors.factorise(lower.data)
    ones = np.ones((lower.shape[0], 1))
    assert np.abs(lower @ factors.solve(ones) + sparse.triu(lower.T, 1) @ factors.solve(ones) - ones).max() < 1e-12
    assert capfd.readouterr().out == ""


def test_unknowns_are_grouped_by_their_neighbours() -> None:
    """Both components of three nodes in a row, of which the last is coupled with the first two by one component."""
    coupled = np.zeros((6, 6))
    coupled[:4, :4] = coupled[4:, 4:] = 1.0
    coupled[4, :4] = coupled[:4, 4] = 1.0
    numbers = cholmod._neighbourhoods(sparse.csc_matrix(np.tril(coupled)))
    assert len(set(numbers[:4].tolist())) == 1
    assert len(set(numbers.tolist())) == 3
