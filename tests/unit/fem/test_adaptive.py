"""The sequence of meshes: when it ends, what it says of the answer, on a solver whose error is known."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fem.continuum.face_reinforcement import strengthened
from fem.continuum.shallow_failure import shallow_failures
from fem.errors import UnstableError
from fem.search.adaptive import next_mesh
from fem.search.mesh_sequence import (
    FEWEST_CELLS,
    LEAST_ERROR_CELLS,
    AdaptiveResult,
    MeshRound,
    MeshSequence,
    RefinementCriteria,
)
from fem.settings import FemSettings
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from meshes.quad_mesh import QuadMesh, divided
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import slope

EXACT = 0.2


@dataclass
class Solver:
    """kc = EXACT + error / cells, with a mechanism along z = 0.15 x; fails from ``breaks_at`` cells on."""

    error: float
    breaks_at: int = 10**9
    fails: bool = True
    seen: list[int] = field(default_factory=list)

    def __call__(self, mesh: QuadMesh) -> Any:
        self.seen.append(len(mesh.cells))
        if len(mesh.cells) >= self.breaks_at:
            raise UnstableError("the section fails under its own weight")
        x, z = mesh.points[mesh.cells].mean(axis=1).T
        shear = np.exp(-np.abs(z - 0.15 * x))
        mechanism = SimpleNamespace(plastic_shear_strain=shear) if self.fails else None
        return SimpleNamespace(value=EXACT + self.error / len(mesh.cells), reason="it is told", mechanism=mechanism)


def solve_adaptively(
    first: QuadMesh, remade: Callable[..., QuadMesh], solve: Callable[[QuadMesh], Any], wish: RefinementCriteria
) -> AdaptiveResult:
    sequence: MeshSequence[Any] = MeshSequence(first, wish)
    while sequence.mesh is not None:
        try:
            answer = solve(sequence.mesh)
        except NoAnswerError as error:
            answer = error
        sequence.take(answer, remade)
    return sequence.result


def solved(
    solver: Solver, accuracy: float = 0.01, max_cells: int = 5000, other: float = float("inf")
) -> AdaptiveResult:
    section, wanted = Section.parse(slope()), MeshSettings(method="free")
    remade = partial(next_mesh, section, wanted)
    return solve_adaptively(
        generate(section, wanted), remade, solver, RefinementCriteria(accuracy, max_cells, lambda: other)
    )


@pytest.mark.parametrize(("fits", "times"), [(True, 1.25), (False, 1.0)])
def test_a_first_mesh_that_fits_the_mechanism_is_refined_at_once(fits: bool, times: float) -> None:
    """So the factor of safety begins on the mesh of the critical Kh: two meshes instead of three."""
    section, wanted = Section.parse(slope()), MeshSettings(method="free", size=1.5)
    first, cells_requested = generate(section, wanted), []
    sequence: MeshSequence[Any] = MeshSequence(first, RefinementCriteria(0.001, 5000), lambda _: fits)
    sequence.take(Solver(error=5.0)(first), lambda mesh, strain, cells: cells_requested.append(cells) or mesh)
    assert len(first.cells) > FEWEST_CELLS
    assert cells_requested == [math.ceil(times * len(first.cells))]
    sequence.take(Solver(error=5.0)(first), lambda mesh, strain, cells: mesh)
    assert len(sequence.result.earlier) == fits


def test_meshes_that_agree_by_chance_have_the_error_that_is_expected() -> None:
    """An endless slope had 1.8233 on 689 cells and 1.8231 on 904; a third mesh of 1816 had 1.8157."""
    section, wanted = Section.parse(slope()), MeshSettings(method="free", size=1.5)
    first = generate(section, wanted)
    for expected, ended in ((0.02, False), (0.001, True)):
        sequence: MeshSequence[Any] = MeshSequence(
            first,
            RefinementCriteria(0.01, 5000, least_error_cells=0.0),
            lambda _: True,
            lambda value, error=expected: error * value / 0.2,
        )
        for _ in range(2):
            strain = np.ones(len(first.cells))
            answer = SimpleNamespace(value=0.2, reason="", mechanism=SimpleNamespace(plastic_shear_strain=strain))
            sequence.take(cast(Any, answer), lambda mesh, strain, cells: mesh)
        assert (sequence.mesh is None) == ended == sequence.result.converged
        assert sequence.result.rounds[-1].remaining_error == pytest.approx(expected)


def sequence_of(values: list[float], first_fits: bool = False) -> AdaptiveResult[Any]:
    """The sequence of meshes for answers, each mesh with twice the cells of the one before, but the first two alike."""
    first = generate(Section.parse(slope()), MeshSettings(method="free", size=1.0))
    sequence: MeshSequence[Any] = MeshSequence(
        first, RefinementCriteria(0.01, 9000), (lambda _: True) if first_fits else None
    )
    for value in values:
        if sequence.mesh is None:
            break
        strain = np.ones(len(sequence.mesh.cells))
        answer = SimpleNamespace(value=value, reason="", mechanism=SimpleNamespace(plastic_shear_strain=strain))
        sequence.take(cast(Any, answer), lambda mesh, _, cells: divided(mesh) if cells > len(mesh.cells) else mesh)
    return sequence.result


def test_a_mesh_that_follows_no_mechanism_says_nothing_of_the_error() -> None:
    """A weak seam: 0.2398 on 874 cells, not adapted, and on 1151 adapted ones, told with an error of 0.1 %; strict
    bounds are 0.2347 and 0.2353."""
    coarse = sequence_of([0.2398, 0.2398])
    assert not coarse.converged
    finer = sequence_of([0.2398, 0.2398, 0.2398])
    assert finer.converged
    assert len(finer.rounds) == 3
    assert sequence_of([0.2398, 0.2398], first_fits=True).converged  # two adapted meshes


def test_answers_that_agree_have_the_least_error_of_their_cells() -> None:
    alike = sequence_of([0.24, 0.24, 0.24])
    cells = alike.rounds[-1].cells
    assert alike.rounds[-1].remaining_error == pytest.approx(LEAST_ERROR_CELLS / cells)
    assert alike.limit == pytest.approx(0.24 * (1.0 - LEAST_ERROR_CELLS / cells))


def test_it_goes_on_until_the_answer_no_longer_changes() -> None:
    solution = solved(Solver(error=5.0))
    assert solution.converged
    assert [item.cells for item in solution.rounds] == sorted({item.cells for item in solution.rounds})
    assert solution.rounds[0].change == float("inf")
    assert solution.rounds[-1].remaining_error <= 0.01 < solution.rounds[-2].remaining_error
    assert solution.rounds[-1].cells == len(solution.mesh.cells)
    assert solution.result.value == solution.rounds[-1].value
    assert solution.limit == pytest.approx(EXACT, rel=1e-9)  # the error is what the limit supposes


def test_a_finer_mesh_that_bears_more_is_trusted_less() -> None:
    fallen, risen = (solved(Solver(error=error), accuracy=0.02).rounds for error in (5.0, -5.0))
    assert risen[1].remaining_error == pytest.approx(3.0 * fallen[1].remaining_error, rel=0.1)
    assert len(risen) > len(fallen)


def test_a_rise_on_about_as_many_cells_tells_no_error() -> None:
    """Endless clay under water: 0.0898 on 768 cells, 0.0899 on 870, where the sequence ended; 0.0875 in closed form."""
    section, wanted = Section.parse(slope()), MeshSettings(method="free", size=0.8)
    values = iter([0.0898, 0.0899, 0.0885, 0.0883])

    def solve(mesh: QuadMesh) -> Any:
        mechanism = SimpleNamespace(plastic_shear_strain=np.ones(len(mesh.cells)))
        return SimpleNamespace(value=next(values), reason="", mechanism=mechanism)

    adaptive_result = solve_adaptively(
        generate(section, wanted), partial(next_mesh, section, wanted), solve, RefinementCriteria(0.02, 9000)
    )
    assert adaptive_result.rounds[1].cells < 1.25 * adaptive_result.rounds[0].cells
    assert [item.meaningful for item in adaptive_result.rounds[:3]] == [True, False, True]
    assert adaptive_result.converged
    assert adaptive_result.result.value < 0.0886


@pytest.mark.parametrize(
    ("values", "converged"), [([1.1210, 1.1237, 1.1245, 1.12449], False), ([1.1210, 1.1237, 1.1120, 1.1115], True)]
)
def test_an_answer_that_rose_and_stays_above_earlier_ones_keeps_its_error(values: list[float], converged: bool) -> None:
    """Inclined soft band (Zolfaghari et al.): 1.1245 on two meshes of 1742 and 1843 cells, told with an error of 0.0 %,
    above the strict upper bound of 1.113."""
    section, wanted = Section.parse(slope()), MeshSettings(method="free", size=0.8)
    sequence: MeshSequence[Any] = MeshSequence(
        generate(section, wanted), RefinementCriteria(0.005, 9000, least_error_cells=0.0)
    )
    for value in values:
        assert sequence.mesh is not None
        strain = np.ones(len(sequence.mesh.cells))
        answer = SimpleNamespace(value=value, reason="", mechanism=SimpleNamespace(plastic_shear_strain=strain))
        sequence.take(cast(Any, answer), lambda mesh, _, cells: mesh)  # as many cells each time
    assert sequence.result.converged == converged


def test_no_more_than_two_meshes_have_the_largest_number_of_cells() -> None:
    mesh = generate(Section.parse(slope()), MeshSettings(method="free", size=0.8))
    values = iter(0.3 - 0.01 * step for step in range(20))

    def solve(mesh: QuadMesh) -> Any:
        mechanism = SimpleNamespace(plastic_shear_strain=np.ones(len(mesh.cells)))
        return SimpleNamespace(value=next(values), reason="", mechanism=mechanism)

    most = 2 * len(mesh.cells) - 1
    solution = solve_adaptively(mesh, lambda last, *_: last, solve, RefinementCriteria(0.001, most))
    assert len(solution.rounds) == 4, "the first, the first adapted one, two of the largest number"
    assert not solution.converged
    assert f"{most} are allowed" in solution.reason


def test_it_ends_at_the_limit_of_cells_and_says_so() -> None:
    solver = Solver(error=100.0)
    solution = solved(solver, max_cells=2000)
    assert not solution.converged
    assert "2000 are allowed" in solution.reason
    assert max(solver.seen) < 2500


def test_the_last_answer_counts_where_the_next_mesh_has_none() -> None:
    solution = solved(Solver(error=100.0, breaks_at=1500))
    assert not solution.converged
    assert solution.reason == "there is no answer on the next mesh: the section fails under its own weight"
    assert solution.rounds[-1].cells == len(solution.mesh.cells) < 1500


def test_without_a_mechanism_there_is_nothing_to_refine() -> None:
    solution = solved(Solver(error=100.0, fails=False))
    assert (len(solution.rounds), solution.converged) == (1, False)
    assert solution.reason == "there is no mechanism to refine: it is told"
    assert np.isnan(solution.limit)


def test_a_direction_that_cannot_govern_is_not_refined() -> None:
    solution = solved(Solver(error=100.0), other=0.6 * EXACT)
    assert (len(solution.rounds), solution.reason) == (1, "the other direction governs")


def test_a_direction_is_refined_until_what_is_left_of_its_error_no_longer_matters() -> None:
    solution = solved(Solver(error=20.0), accuracy=1e-4, other=0.9 * EXACT)
    assert (len(solution.rounds), solution.reason) == (2, "the other direction governs")
    assert solution.result.value * (1.0 - 2.0 * solution.rounds[-1].remaining_error) > 0.9 * EXACT


def test_no_answer_on_the_first_mesh_is_raised() -> None:
    with pytest.raises(UnstableError):
        solved(Solver(error=1.0, breaks_at=0))


def test_meshes_that_are_all_but_alike_tell_no_limit_far_away() -> None:
    rounds = [MeshRound(1000, 0.201, float("inf"), float("inf")), MeshRound(1010, 0.2, 0.005, 0.02)]
    assert AdaptiveResult(None, None, rounds).limit == pytest.approx(0.196)  # type: ignore[arg-type]


def test_cells_follow_the_strip_below_a_cohesionless_face() -> None:
    """No cell has ground of the strip and of the sand below it; in the mesh both are one stratum."""
    data = slope()
    data["strata"][0]["cohesion"] = 0
    section = Section.parse(data)
    settings, meshing = FemSettings(direction="downhill", flow="associated"), MeshSettings(method="free")
    strong = strengthened(section, shallow_failures(section, settings), settings)
    assert strong is not None
    first = generate(section, meshing)
    cut = next_mesh(section, meshing, first, np.ones(len(first.cells)), 800)
    made = next_mesh(section, meshing, first, np.ones(len(first.cells)), 800, strong)
    assert made.strata == tuple(stratum.name for stratum in section.strata)
    assert cells_cut(strong, cut) > 0
    assert cells_cut(strong, made) == 0


def cells_cut(section: Section, mesh: QuadMesh) -> int:
    """How many cells have points of several strata, a little inside of their corners."""
    corners = mesh.points[mesh.cells]
    inside = 0.95 * corners + 0.05 * corners.mean(axis=1, keepdims=True)
    strata = section.stratum_at(inside[..., 0].ravel(), inside[..., 1].ravel()).reshape(-1, 4)
    return int((strata != strata[:, :1]).any(axis=1).sum())
