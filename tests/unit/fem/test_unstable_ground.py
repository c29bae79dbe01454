"""Tests of the sentences on ground that fails without a seismic force."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from fem.errors import UnstableError
from fem.search.unstable_ground import with_factors
from fem.settings import FemSettings
from meshes.section.section import Section
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
