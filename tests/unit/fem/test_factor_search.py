"""The search for the factor of safety between trials that say nothing on one of the bounds."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import pytest

from fem.limit.bracket import LEAST_CELL_RATIO, BoundSide
from fem.limit.factor_search import FactorSearch
from fem.limit.factor_trial import FactorWork, TrialStart, root_of
from fem.limit.first_mesh import first_mesh
from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from fem.solvers.cone_program import Warm
from meshes.section.section import Section
from tests.support.sections import layer, slope

if TYPE_CHECKING:
    from fem.solvers.convergence import Place
    from fem.solvers.corner_matrix import CornerMatrix
    from fem.solvers.interior_point import Standard


@pytest.mark.parametrize(("side", "begins_there"), [("lower", True), ("upper", False)])
def test_a_stress_field_is_a_starting_point_for_other_strength_and_a_mechanism_is_none(
    side: BoundSide, begins_there: bool
) -> None:
    """The limit of the flow rule turns with φ, and from a mechanism at this limit the solver took twice the iterations,
    or broke down: the levee had 1.335 to 1.422 for 1.354 to 1.371. The order of elimination stays."""
    section = Section.parse(slope())
    fem, settings = FemSettings(sides="smooth"), BoundsSettings(max_cells=400)
    mesh, start = first_mesh(section, 400, "smooth"), TrialStart(0.0, 1.0, False)
    search = FactorSearch(section, mesh, fem, settings, 1, start, FactorWork(60.0))
    before = Warm(cast("Place", "iterate"), cast("CornerMatrix", "matrix"), cast("Standard", "form"))
    search.starting_points[side] = 1.0, before
    place = search.starting_point(side, 1.1)
    assert place is not None
    assert (place.place is not None) == begins_there
    assert (place.matrix, place.form) == (before.matrix, before.form)
    assert search.starting_point(side, 1.5) is None


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
    assert trial.no_equilibrium
    assert search.lower == 0.0
    search.prove("lower", -1.0)
    assert 0.65 * factor.lower < search.lower <= factor.upper
    other = FactorSearch(section, mesh, fem, settings, 1, TrialStart(0.0, 2.0 * factor.upper, False), FactorWork(60.0))
    assert other.measure(2.0 * factor.upper, upper=False).no_equilibrium  # with no trial of both bounds before it


def test_the_share_of_loads_decides_where_the_solver_finds_no_bound_of_kh() -> None:
    """An embankment on soft clay has a factor of 0.58. No Kh holds it at 0.79, and a mechanism that does not move in
    the direction of Kh has none: the solver failed twice, and the answer was "FS <= 1.000"."""
    clay = layer("clay", cohesion="20 kPa", friction_angle="0 deg")
    ground = [[0, 0], [10, 0], [15, 5], [20, 5], [25, 0], [35, 0]]
    section = Section.parse({"name": "bank", "surface": ground, "base": {"elevation": -4}, "strata": [clay]})
    fem, settings = FemSettings(sides="smooth"), BoundsSettings(max_cells=800)
    mesh = first_mesh(section, 800, "smooth")
    search = FactorSearch(section, mesh, fem, settings, 1, TrialStart(0.0, 2.0, True), FactorWork(60.0))
    trial = search.measure(2.0)
    assert trial.no_equilibrium
    search.failures["upper"] = 2
    loaded = search.with_deciding_multiplier(replace(trial, upper=None))
    assert loaded.multiplier_kind == "loads"
    assert loaded.lower is not None
    assert loaded.upper is not None
    assert 0.3 < loaded.lower < loaded.upper < 1.0
    assert not search.solver_fails


def test_secants_that_cross_ask_for_the_fewest_triangles(monkeypatch: pytest.MonkeyPatch) -> None:
    """The secant of the lower bound seemed to meet the given Kh at a larger factor than that of the upper bound: the
    number of triangles became a complex number, and `noshiro bounds` ended in a TypeError."""
    section, fem, settings = Section.parse(slope()), FemSettings(sides="smooth"), BoundsSettings(max_cells=400)
    mesh = first_mesh(section, 400, "smooth")
    search = FactorSearch(section, mesh, fem, settings, 1, TrialStart(0.0, 1.0, False), FactorWork(60.0))
    search.measure(1.5)
    monkeypatch.setattr(search, "root", {"lower": 1.6, "upper": 1.5}.get)
    monkeypatch.setattr(FactorSearch, "gap_exponent", 1.5)
    assert search.open_here < 0.0
    assert search.needed_growth == 0.0
    assert search.growth() == pytest.approx(LEAST_CELL_RATIO)


def test_a_good_guess_leaves_few_trials_within_a_wide_gap() -> None:
    """Near the factor of the elements a second upper bound, further proofs on triangles that are refined, and a third
    trial of both bounds decided nothing: 13 trials of S-13 after liquefaction are now 8."""
    section, fem = Section.parse(slope()), FemSettings(sides="smooth")
    factor = safety_bounds(section, fem, BoundsSettings(max_cells=1500, gap=0.08), guess=6.17)  # bounds: 6.10 to 6.24
    assert factor.gap <= 0.08
    assert factor.lower < 6.2 < factor.upper
    assert len(factor.trials) <= 5


def test_two_trials_of_one_factor_have_no_secant() -> None:
    """A dam whose shell liquefies was tried twice at one factor, and its run ended in a ZeroDivisionError."""
    twice = [(0.2, 1e-4), (0.2, -1e-4)]
    assert root_of(twice, -0.5, 1.0) == pytest.approx(math.exp(0.2), rel=1e-3)
    assert math.isnan(root_of(twice, None, 1.0))
    assert root_of([(0.1, 0.3), *twice], -0.5, 1.0) == pytest.approx(math.exp(0.2), rel=1e-3)
    assert root_of([(0.2, 0.1), (0.4, -0.1)], None, 1.0) == pytest.approx(math.exp(0.3))
