"""Tests of the sentences on ground that fails without a seismic force."""

from types import SimpleNamespace
from typing import Any, cast

import pytest
from mpi4py import MPI

from fem.errors import UnstableError
from fem.search.assessment import assess
from fem.search.unstable_ground import with_factors
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.fem_problems import section as bench
from tests.support.fem_problems import soil
from tests.support.sections import slope


def section(ratio: float) -> Section:
    """Return a slope whose pore pressure rises by shaking by a share ``ratio`` of the effective stress."""
    data = slope()
    data["strata"][0] |= {"excess_pore_pressure_ratio": ratio, "dilation_angle": "0 deg"}
    return Section.parse(data)


@pytest.mark.parametrize(("ratio", "sides", "factor", "remedy"), [
    (0.6, "smooth", 1.2, "excess_pore_pressure_ratio"), (0.0, "free-field", 1.2, "make the section longer"),
    (0.0, "smooth", 0.9, 'with fem.flow = "associated" the ground stands'),
])  # fmt: skip
def test_another_flow_rule_is_no_remedy_where_pressure_or_sides_fail_the_ground(
    ratio: float, sides: Any, factor: float, remedy: str
) -> None:
    """Its factor of safety before shaking, and between held sides, is above 1 by every flow rule."""
    result = SimpleNamespace(factor=factor, by_other_flow=1.4, mechanism=None)
    error = with_factors(
        section(ratio), FemSettings(flow="davis", sides=sides), UnstableError("the section fails"),
        cast(Any, SimpleNamespace(result=result)), None, lambda: 1.4,
    )  # fmt: skip
    assert remedy in error.remedy


def test_an_open_cut_that_no_strength_by_davis_supports_is_reported_as_such() -> None:
    """With ψ = 0 Davis's strength has a largest value, tan φ of 1 and c / tan φ, however small the factor of safety is:
    gravel with c = 1 kPa, upright below 3.5 m of loess. The estimate was left out, without a word, after a minute."""
    gravel = soil("gravel", c=1e3, phi=38.0, psi=0.0, bottom={"elevation": 1.0})
    cut = bench(
        [[0.0, 7.0], [14.0, 7.0], [14.0, 0.0], [28.0, 0.0]], 12.0,
        soil("loess", c=30e3, phi=25.0, psi=0.0, bottom={"elevation": 3.5}), gravel, soil("marl", c=80e3, psi=0.0),
    )  # fmt: skip
    settings = FemSettings(flow="associated", sides="smooth", accuracy=0.0, direction="downhill")
    mesh = generate(cut, MeshSettings(method="free", size=1.5))
    with pytest.raises(
        UnstableError, match=r"factor of safety is 0\.\d+ with ψ = φ, and below 0\.05 by Davis's estimate"
    ):
        assess(cut, MeshSettings(), mesh, settings, MPI.COMM_SELF, lambda what, path: None)
