"""Limit loads at once: what is told where the solver has no answer."""

import pytest
from mpi4py import MPI

from fem.errors import UnstableError
from fem.limit_load.limit_load import critical_limit_load
from fem.settings import FemSettings
from fem.solvers import cone_program
from meshes.errors import NoAnswerError
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.fem_problems import section, soil

MUD = section([[0.0, 6.0], [12.0, 6.0], [13.5, 0.0], [24.0, 0.0]], 4.0, soil(c=5e3, phi=0.0))


def limit():
    mesh = generate(MUD, MeshSettings(method="free", size=2.0))
    return critical_limit_load(MUD, mesh, FemSettings(direction="downhill"), MPI.COMM_SELF)


def test_ground_whose_weight_no_stress_balances_is_said_to_fail():
    with pytest.raises(UnstableError, match="no stress balances it"):
        limit()


def test_what_the_solver_proves_only_almost_is_no_verdict(monkeypatch):
    monkeypatch.setattr(cone_program, "_poorness", lambda found: 2)
    with pytest.raises(NoAnswerError, match="limit load of the elements was not found") as caught:
        limit()
    assert not isinstance(caught.value, UnstableError)
