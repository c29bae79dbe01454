"""Cells far from balance are solved by themselves: nothing around it moves, and the answer is the same, only sooner."""

from dataclasses import dataclass

import numpy as np
import pytest
from mpi4py import MPI

from fem.continuum.plane_strain import PlaneStrain
from fem.limit_load.limit_load import critical_limit_load
from fem.path import newton as continuation
from fem.path.gravity import FIXED_UNDER_GRAVITY, at_the_sides, bring_to_rest
from fem.path.newton import ProportionalLoad, residual_of
from fem.path.nonlinear_elimination import FINAL_FORCE_RATIO, LocalSubproblem
from fem.search.adaptive import next_mesh
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import RIVER_BANK
from tests.support.fem_problems import BANK_OF_SAND

SETTINGS = FemSettings(flow="davis", direction="downhill")


@pytest.fixture(scope="module")
def mesh():
    return generate(BANK_OF_SAND, MeshSettings(method="free", size=0.8))


@dataclass(frozen=True)
class StartedProblem:
    """A bank after one elastic displacement under its weight, (dofs,) in m, and its unbalanced force, in N/m."""

    problem: PlaneStrain
    load: ProportionalLoad
    moved: np.ndarray
    unbalanced: np.ndarray


@pytest.fixture
def started(mesh) -> StartedProblem:
    problem, weight, _ = at_the_sides(BANK_OF_SAND, mesh, SETTINGS, MPI.COMM_SELF)
    problem.hold(FIXED_UNDER_GRAVITY)
    load = ProportionalLoad(np.zeros_like(weight), weight)
    problem.use_elastic_tangent()
    problem.factorise()
    moved = problem.solve(weight)
    return StartedProblem(problem, load, moved, residual_of(problem, load, moved, 1.0, 1.0)[0])


def test_a_pocket_comes_to_rest_and_nothing_around_it_moves(started) -> None:
    subproblem = LocalSubproblem(started.problem, started.unbalanced)
    after = subproblem.at_rest(started.moved, started.unbalanced)
    outside = np.setdiff1d(np.arange(len(after)), subproblem.components)
    assert len(subproblem.components) > 0
    assert len(outside) > 0
    assert np.array_equal(after[outside], started.moved[outside])
    left = np.abs(residual_of(started.problem, started.load, after, 1.0, 1.0)[0])
    before = np.abs(started.unbalanced)
    assert (
        left[subproblem.components].max()
        <= 1.01 * FINAL_FORCE_RATIO * before[outside].max()
        < before[subproblem.components].max()
    )


def test_what_is_held_stays_where_it_is(started) -> None:
    subproblem = LocalSubproblem(started.problem, started.unbalanced)
    assert np.all(started.problem.free[subproblem.components])


@pytest.mark.slow
def test_a_river_bank_of_bare_sand_comes_to_the_same_rest_with_fewer_corrections(monkeypatch) -> None:
    """Fine cells at a toe under water, where sand bears next to nothing."""
    bank = Section.read(RIVER_BANK)
    first = generate(bank, MeshSettings(method="free", size=2.0))
    limit_load_result = critical_limit_load(bank, first, SETTINGS, MPI.COMM_SELF)
    assert limit_load_result.mechanism is not None
    fine = next_mesh(bank, MeshSettings(method="free"), first, limit_load_result.mechanism.plastic_shear_strain, 2000)

    def settled() -> tuple[int, np.ndarray]:
        problem, weight, constant = at_the_sides(bank, fine, SETTINGS, MPI.COMM_SELF, limit_load_result.ground.faces)
        path = bring_to_rest(problem, weight, constant, SETTINGS)
        return path.solves, problem.stress

    corrections, stress = settled()
    monkeypatch.setattr(continuation, "ELIMINATION_STEP", 0.0)
    more, same = settled()
    assert corrections < 0.9 * more  # 10 of 12
    assert np.abs(stress - same).max() < 3e-5 * np.abs(same).max()  # measured: 1.1e-5, 2.5 Pa
