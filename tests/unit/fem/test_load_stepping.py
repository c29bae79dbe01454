"""The path to a known limit load: every level in equilibrium, also in sand without cohesion."""

import numpy as np
import pytest
from mpi4py import MPI

from fem.search.critical import critical_coefficient
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.settings import MeshSettings
from tests.support.fem_problems import BANK_OF_SAND, section, soil


@pytest.fixture(scope="module")
def bank():
    """The critical Kh of a bank whose bed is sand without cohesion, with two Kh asked for."""
    mesh = generate(BANK_OF_SAND, MeshSettings(method="free", size=0.8))
    wish = FemSettings(flow="davis", direction="downhill", kh=(0.03, 0.06))
    return critical_coefficient(BANK_OF_SAND, mesh, wish, MPI.COMM_SELF)


def test_every_level_of_a_bank_of_bare_sand_is_in_equilibrium(bank) -> None:
    """A path of small steps crept here: at the toe the sand bears no stress, and its grains move first."""
    assert bank.verdict == "plateau"
    assert 0.94 * bank.kc < bank.lower <= bank.kc
    assert all(step.residual < 1e-6 for step in bank.steps)
    assert [state.kh for state in bank.states[:2]] == [0.03, 0.06]
    assert np.all(np.diff([step.factor for step in bank.steps]) > 0.0)


def test_the_ground_softens_towards_its_limit_load(bank) -> None:
    """Kh over displacement of associated flow is concave: each metre adds no more Kh than the one before."""
    rise = np.diff([0.0, *(step.factor for step in bank.steps)]) / np.diff([0.0, *(s.displacement for s in bank.steps)])
    assert np.all(np.diff(rise) < 1e-3 * rise[0])


def test_a_limit_below_the_limit_load_is_no_failure() -> None:
    mesh = generate(BANK_OF_SAND, MeshSettings(method="free", size=1.5))
    wish = FemSettings(flow="davis", direction="downhill", kh_limit=0.05)
    critical_result = critical_coefficient(BANK_OF_SAND, mesh, wish, MPI.COMM_SELF)
    assert (critical_result.verdict, critical_result.kc, critical_result.lower) == ("no failure", 0.05, 0.05)


def test_ground_that_goes_on_as_before_needs_no_iteration() -> None:
    """Clay of 1 MPa stays elastic: the second level is the first one, lengthened."""
    hard = section([[0.0, 4.0], [10.0, 4.0], [22.0, 0.0], [36.0, 0.0]], 6.0, soil("clay", c=1e6, phi=0.0))
    wish = FemSettings(flow="davis", direction="downhill", kh_limit=0.2, kh=(0.1, 0.2))
    critical_result = critical_coefficient(
        hard, generate(hard, MeshSettings(method="free", size=1.5)), wish, MPI.COMM_SELF
    )
    assert [step.factor for step in critical_result.steps[-2:]] == [0.1, 0.2]
    assert critical_result.steps[-1].iterations == 0
