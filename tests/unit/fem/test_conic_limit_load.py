"""Limit loads at once: what is told where the solver has no answer."""

from dataclasses import replace

import pytest
from mpi4py import MPI

from fem.errors import UnstableError
from fem.limit_load.limit_load import critical_limit_load, in_order, with_other_flow
from fem.settings import FemSettings
from fem.solvers import cone_program
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.fem_problems import section, soil

MUD = section([[0.0, 6.0], [12.0, 6.0], [13.5, 0.0], [24.0, 0.0]], 4.0, soil(c=5e3, phi=0.0))


def limit(size=2.0):
    mesh = generate(MUD, MeshSettings(method="free", size=size))
    return critical_limit_load(MUD, mesh, FemSettings(direction="downhill"), MPI.COMM_SELF)


def test_ground_whose_weight_no_stress_balances_is_said_to_fail():
    with pytest.raises(UnstableError, match="no stress balances it"):
        limit()


def test_velocities_prove_that_no_stress_balances_the_weight(monkeypatch):
    """Clarabel was called twice for each direction of the force, after the built-in method had broken down."""

    def refuse(*_):
        raise AssertionError("a second solver is called")

    monkeypatch.setattr(cone_program, "_by_clarabel", refuse)
    with pytest.raises(UnstableError, match="no stress balances it"):
        limit(size=0.5)


def test_what_the_solver_proves_only_almost_is_no_verdict(monkeypatch):
    monkeypatch.setattr(cone_program, "_poorness", lambda result: 2)
    with pytest.raises(NoAnswerError, match="limit load by finite elements was not found") as caught:
        limit()
    assert not isinstance(caught.value, UnstableError)


def test_brackets_of_one_mesh_end_where_the_other_does() -> None:
    """Davis's estimate stops between 0.26731 and 0.26746, ψ = φ between 0.26725 and 0.26741: on random slope 21 the
    middle of the first was above that of the second, where clay alone fails and both have the same limit load."""
    ground = section([[0.0, 3.0], [12.0, 3.0], [18.0, 0.0], [24.0, 0.0]], 4.0, soil(c=15e3, phi=25.0))
    mesh, davis = (
        generate(ground, MeshSettings(method="free", size=2.0)),
        FemSettings(direction="downhill", flow="davis"),
    )
    weak = critical_limit_load(ground, mesh, davis, MPI.COMM_SELF)
    strong = with_other_flow(weak, ground, mesh, davis.changed(flow="associated"))
    assert in_order(weak, strong) == (weak, strong)  # brackets that do not meet stay
    low, high = (
        replace(result, kc=sum(bracket) / 2, ground=replace(result.ground, limit=replace(limit, bracket=bracket)))
        for result, bracket in ((weak, (0.26731, 0.26746)), (strong, (0.26725, 0.26741)))
        if (limit := result.ground.limit) is not None
    )
    assert low.kc > high.kc
    below, above = in_order(low, high)
    assert below.kc == above.kc == pytest.approx(0.26736, abs=1e-9)
    assert above.ground.limit is not None
    assert above.ground.limit.multiplier == above.kc
