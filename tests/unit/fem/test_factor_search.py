"""The search for the factor of safety between trials that say nothing on one of the bounds."""

from fem.limit.factor_search import FactorSearch
from fem.limit.factor_trial import FactorWork, TrialStart
from fem.limit.first_mesh import first_mesh
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support.sections import layer


def test_a_lower_bound_is_looked_for_below_a_factor_at_which_no_stress_balances_the_weight() -> None:
    """A bank of clay falls to both sides, and no Kh holds it at twice its factor. A dam with seepage had no lower
    bound: the search knew neither a proven factor nor a secant there, and tried no smaller one."""
    clay = layer("clay", cohesion="20 kPa", friction_angle="0 deg")
    ground = [[0, 0], [10, 0], [15, 5], [20, 5], [25, 0], [35, 0]]
    section = Section.parse({"name": "bank", "surface": ground, "base": {"elevation": -4}, "strata": [clay]})
    fem, settings = FemSettings(sides="smooth"), BoundsSettings(max_cells=800, gap=0.1)
    factor = safety_bounds(section, fem, settings)
    mesh = first_mesh(section, 800, "smooth")
    search = FactorSearch(section, mesh, fem, settings, 1, TrialStart(0.0, 2.0 * factor.upper, False), FactorWork(60.0))
    trial = search.measure(2.0 * factor.upper)
    assert trial.unborne
    assert search.lower == 0.0
    search.prove("lower", -1.0)
    assert 0.65 * factor.lower < search.lower <= factor.upper
    other = FactorSearch(section, mesh, fem, settings, 1, TrialStart(0.0, 2.0 * factor.upper, False), FactorWork(60.0))
    assert other.measure(2.0 * factor.upper, upper=False).unborne  # with no trial of both bounds before it
