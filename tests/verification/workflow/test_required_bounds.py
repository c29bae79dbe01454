"""Strict bounds of the strength that layers need for ground to just stand."""

from fem.limit.safety_bounds import safety_bounds
from fem.search.required_strength import with_multiple
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support.sections import slope
from workflow.stages.required_strength import bounds_of_multiple

FEM = FemSettings(flow="associated", accuracy=0.0, sides="smooth")
LEAST_OF_UPRIGHT = 3.7760  # γ H / c at which a vertical cut in undrained clay is at its limit: 3.7760 to 3.7776


def cut(cohesion: float) -> Section:
    """A vertical cut of 5 m in one clay (kPa), on a clay of ten times its strength."""
    data = slope() | {"surface": [[0.0, 5.0], [12.0, 5.0], [12.0, 0.0], [24.0, 0.0]], "base": {"elevation": -2.0}}
    for stratum, c in zip(data["strata"], (cohesion, 10.0 * cohesion), strict=True):
        for key in ("density_ordinary", "density_seismic", "liquefies_in"):
            stratum.pop(key, None)
        stratum |= {"cohesion": f"{c} kPa", "friction_angle": "0 deg", "density": "20 kN/m^3"}
    data["strata"][0]["bottom"] = {"elevation": -1.0}
    data.pop("water_table", None)
    return Section.parse(data)


def test_a_vertical_cut_needs_its_weight_over_the_stability_number() -> None:
    """γ H / 3.776 = 26.48 kPa (Pastor, Thai & Francescato 2000: 3.7760 to 3.7776), from 13 kPa."""
    section = cut(13.0)
    low, high = bounds_of_multiple(section, [0], FEM, BoundsSettings(), 13.0 / 26.48, 2.0)
    assert low is not None
    assert high is not None
    exact = 20.0 * 5.0 / LEAST_OF_UPRIGHT / 13.0
    assert low <= exact * 1.001
    assert high >= exact * 0.999
    assert high / low < 1.03
    assert safety_bounds(with_multiple(section, [0], high), FEM, BoundsSettings(gap=0.02), 0.0, 1.0, True).lower > 0.98
