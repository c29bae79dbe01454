"""Water that reaches the toe of bare sand: shallow ground slips there before the slope, and the bounds say so."""

import pytest

from fem.continuum.shallow_failure import has_uncounted_water, shallow_failures
from fem.limit.bounds import kh_bounds
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support.water import soil

FIXED = FemSettings(sides="fixed")


def toe_of_sand(at_crest: float) -> Section:
    """A slope of loam on sand that comes out at its toe, where a water table comes up to the ground."""
    loam = soil("loam", bottom={"elevation": 2.5}, cohesion="20 kPa", friction_angle="30 deg")
    sand = soil("sand", bottom={"elevation": -2.0}, cohesion=0.0, friction_angle="37 deg")
    rock = soil("marl", cohesion="30 kPa", friction_angle="35 deg")
    surface = [[0.0, 8.0], [15.0, 8.0], [30.0, 0.0], [50.0, 0.0]]
    data = {"name": "toe", "surface": surface, "base": {"elevation": -7.0}, "strata": [loam, sand, rock]}
    water = {"table": [[0.0, at_crest], [15.0, at_crest], [30.0, 0.0], [50.0, 0.0]]}
    return Section.parse({**data, "water": water})


@pytest.mark.parametrize(("at_crest", "close"), [(5.0, True), (0.0, False)])
def test_water_that_is_too_short_below_a_face_to_count_is_found(at_crest: float, close: bool) -> None:
    section = toe_of_sand(at_crest)
    (face,) = (face for face in shallow_failures(section, FIXED) if face.stratum.startswith("sand"))
    assert not face.into_water
    assert has_uncounted_water(section, face, FIXED.least_depth) == close


@pytest.mark.slow
def test_a_slope_has_bounds_of_the_whole_where_water_reaches_the_toe_of_bare_sand() -> None:
    """Wedges at the toe slip first, the smaller the triangles the sooner: no lower bound, and upper ones that fell with
    each mesh, were told beside elements of the slope as a whole. Bounds of the toe as it is took three quarters of the
    work, although the rough bound already lies below those of the whole: 34.5 s, now 8.7 s."""
    section, few = toe_of_sand(5.0), BoundsSettings(gap=0.03, max_cells=8000, davis=False)
    bounds = kh_bounds(section, FIXED, few)
    assert bounds.work < 15.0
    assert bounds.shallow is not None
    assert bounds.shallow < bounds.lower
    factor = safety_bounds(section, FIXED, few, smooth_sides=True, known=bounds)
    assert 0.0 < bounds.gap <= 0.06
    assert 0.0 < factor.gap <= 0.04
