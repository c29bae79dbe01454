"""All answers for a section: what is looked for side by side is found as one after the other, to the last bit."""

import pickle
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from fem import kh_bounds
from fem.errors import NoEquilibriumError, UnstableError
from fem.limit_load.limit_load import critical_limit_load
from fem.search import assessment, critical
from fem.search.adaptive import AdaptiveSearch, path_start
from fem.search.assessment import assess
from fem.search.mesh_sequence import AdaptiveResult
from fem.settings import BoundsSettings, FemSettings
from meshes.executor import SERIAL
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import layer


def test_two_threads_find_the_same_bits_as_one(monkeypatch):
    surface = [[0.0, 10.0], [20.0, 10.0], [35.0, 4.0], [55.0, 4.0]]
    ground = Section.parse({"name": "a", "surface": surface, "base": {"elevation": 0.0}, "strata": [layer("only")]})
    settings = FemSettings(accuracy=0.1, max_cells=300, safety_factor_at=(0.0, 0.05))
    meshing = MeshSettings(size=3.0)
    results = []
    for alone in (False, True):
        if alone:
            monkeypatch.setattr(assessment, "one_more_thread", lambda neighbour: SERIAL)
        mesh = generate(ground, meshing)
        results.append(assess(ground, meshing, mesh, settings, MPI.COMM_SELF, lambda *_: None))
    item, other = results
    assert item.critical.kc == other.critical.kc
    assert item.critical.steps == other.critical.steps
    assert [each.result.factor for each in item.safety] == [each.result.factor for each in other.safety]
    assert item.davis.result.kc == other.davis.result.kc < item.critical.kc
    assert [each.result.by_other_flow for each in item.safety] == [each.result.by_other_flow for each in other.safety]
    assert item.associated is None
    assert len(item.safety) == 2
    np.testing.assert_array_equal(item.mesh.points, other.mesh.points)


def test_ground_that_fails_under_its_own_weight_is_told_with_the_place_where_it_slips():
    """A low bank before a levee, or the toe of a dam, is another matter than the levee: here the lower of two faces."""
    clay = layer("clay") | {"cohesion": "12 kPa", "friction_angle": "0 deg"}
    surface = [[0.0, 12.0], [30.0, 12.0], [36.0, 9.0], [60.0, 9.0], [63.0, 0.0], [85.0, 0.0]]
    bank = Section.parse({"name": "bank", "surface": surface, "base": {"elevation": -6.0}, "strata": [clay]})
    settings = FemSettings(direction="downhill", max_cells=500, sides="smooth")
    with pytest.raises(UnstableError, match=r"its factor of safety is 0\.\d\d") as error:
        assess(
            bank,
            MeshSettings(size=2.5),
            generate(bank, MeshSettings(size=2.5)),
            settings,
            MPI.COMM_SELF,
            lambda *_: None,
        )
    place = re.search(r"; the ground slips from x = (.*) to (.*) m, down to z = (.*) m$", error.value.reason)
    assert place is not None
    start, end, low = (float(number) for number in place.groups())
    assert 40.0 < start < 60.0
    assert 62.0 < end < 85.0
    assert -6.0 <= low < 1.0
    at_rest = error.value.at_rest
    assert at_rest is not None
    assert f"its factor of safety is {at_rest.factor:.2f}" in error.value.reason
    assert at_rest.slip_surface[0, 0] == pytest.approx(start, abs=0.06)
    again = pickle.loads(pickle.dumps(error.value))
    assert (again.reason, again.at_rest.factor) == (error.value.reason, at_rest.factor)


@pytest.mark.slow
def test_ground_whose_factor_of_safety_is_below_one_has_no_critical_kh():
    """A cut of 51 degrees in loam: coarse cells bear Kh = 0.005, finer ones have a factor of 0.99 (psi = 0)."""
    loam = layer("loam", bottom={"elevation": [[0.0, 19.0], [31.0, 19.0], [40.0, 26.0], [75.0, 27.0]]})
    loam |= {"cohesion": "12 kPa", "friction_angle": "28 deg", "dilation_angle": "0 deg"}
    loam |= {"density_ordinary": "1.9 t/m^3", "density_seismic": "1.9 t/m^3"}
    rock = layer("rock") | {"cohesion": "60 kPa", "friction_angle": "38 deg", "dilation_angle": "5 deg"}
    rock |= {"density_ordinary": "2.2 t/m^3", "density_seismic": "2.2 t/m^3"}
    surface = [[0.0, 20.0], [30.0, 20.0], [38.0, 30.0], [75.0, 31.0]]
    cut = Section.parse({"name": "cut", "surface": surface, "base": {"elevation": 8.0}, "strata": [loam, rock]})
    settings = FemSettings(direction="downhill", max_cells=3000)
    with pytest.raises(UnstableError, match=r"its factor of safety is 0\.9\d by Davis.*, and 1\.\d\d with ψ = φ"):
        assess(cut, MeshSettings(), generate(cut), settings, MPI.COMM_SELF, lambda *_: None)


@pytest.mark.slow
def test_a_bare_face_of_sand_above_which_the_slope_hardly_stands_has_a_critical_kh():
    """Strict bounds are 0.0051 to 0.0079: rest under the weight takes 255 descents, and 120 said that nothing stood."""
    gravel = layer("gravel", bottom={"elevation": [[0, 5], [60, 8]]}, cohesion="6 kPa", friction_angle="45 deg")
    seam = layer("seam", bottom={"elevation": [[0, 4.7], [60, 7.7]]}, cohesion="22 kPa", friction_angle="0 deg")
    sand = layer("sand", cohesion="0 kPa", friction_angle="45 deg")
    moist = {"gravel": (2.0, 2.1, 60, 0.3), "seam": (1.7, 1.7, 6, 0.45), "sand": (1.9, 2.0, 50, 0.3)}
    for soil in (gravel, seam, sand):
        density, saturated, stiffness, poisson = moist[soil["name"]]
        soil |= {"density_ordinary": f"{density} t/m^3", "density_seismic": f"{density} t/m^3"}
        soil |= {"density_saturated": f"{saturated} t/m^3"}
        soil |= {"youngs_modulus": f"{stiffness} MPa", "poissons_ratio": poisson}
    face = {"name": "face", "surface": [[0, 2], [20, 2], [27, 12], [60, 13]], "base": {"elevation": -6}}
    face |= {"water": {"table": [[0, 2], [20, 2], [60, 6]]}}
    section = Section.parse(face | {"strata": [gravel, seam, sand]})
    answer = assess(section, MeshSettings(), generate(section), FemSettings(), MPI.COMM_SELF, lambda *_: None)
    assert 0.005 < answer.critical.kc < 0.008
    assert answer.critical.lower == pytest.approx(answer.critical.kc, abs=0.002)


def test_what_limit_analysis_finds_standing_is_not_said_to_fail_where_the_iteration_does_not_converge(monkeypatch):
    def stuck(*_):
        raise UnstableError("the section fails under its own weight")

    monkeypatch.setattr(critical, "bring_to_rest", stuck)
    with pytest.raises(NoEquilibriumError, match=r"did not converge, although the ground stands .* up to Kh = 0\.\d+"):
        assessed(slope_with(cohesion="5 kPa", friction_angle="32 deg"))


def slope_with(**soil: object) -> Section:
    surface = [[0.0, 10.0], [12.0, 10.0], [24.0, 4.0], [36.0, 4.0]]
    return Section.parse({"name": "a", "surface": surface, "base": {"elevation": 0.0}, "strata": [layer("a") | soil]})


def assessed(section: Section, **settings: object) -> assessment.Assessment:
    wish = FemSettings(accuracy=0.0, direction="downhill", **settings)
    mesh = generate(section, MeshSettings(size=1.5))
    return assess(section, MeshSettings(size=1.5), mesh, wish, MPI.COMM_SELF, lambda *_: None)


def test_the_path_is_followed_on_an_earlier_mesh_of_the_sequence_to_the_critical_kh_of_the_last_one():
    """Its iterations take twice as long on twice as many cells, and its fields are drawn, not measured."""
    section, meshing = slope_with(cohesion="5 kPa", friction_angle="32 deg"), MeshSettings(size=1.5)
    wish = FemSettings(accuracy=1e-3, max_cells=1300, direction="downhill", safety_factor_at=())
    item = assess(section, meshing, generate(section, meshing), wish, MPI.COMM_SELF, lambda *_: None)
    assert item.adapted is not None
    assert len(item.adapted.rounds) >= 3
    assert len(item.path_mesh.cells) < 0.7 * len(item.mesh.cells)
    assert item.critical.kc == item.adapted.result.kc == item.adapted.rounds[-1].value
    assert item.critical.lower == pytest.approx(0.99 * item.critical.kc, rel=0.05)
    for state in item.critical.states:
        assert state.displacement.shape == item.path_mesh.points.shape
    assert item.critical.mechanism.displacement.shape == item.mesh.points.shape


@pytest.mark.parametrize("share", [0.5, 1.0 - 1e-9])
def test_a_requested_kh_between_the_limits_of_two_meshes_is_told_as_the_last_mesh_has_it(share: float) -> None:
    """It was told to be without equilibrium below the critical Kh, as the path of the earlier mesh ended before it."""
    section, meshing = slope_with(cohesion="5 kPa", friction_angle="32 deg"), MeshSettings(size=1.5)
    wish = FemSettings(accuracy=1e-3, max_cells=1300, direction="downhill", safety_factor_at=())
    mesh = generate(section, meshing)
    search = AdaptiveSearch(section, meshing, mesh, MPI.COMM_SELF, lambda *_: None, SERIAL)
    adapted = search.critical(wish)
    first, last = (each.result.ground for each in (adapted.earlier[0], adapted))
    assert first.limit.multiplier > last.limit.multiplier  # as it is with most meshes
    low, high = 0.9 * last.limit.multiplier, last.limit.multiplier
    weak = replace(first, limit=replace(first.limit, multiplier=low))
    earlier = replace(adapted.earlier[0], result=replace(adapted.earlier[0].result, ground=weak))
    reversed_order = replace(adapted, earlier=[earlier, *adapted.earlier[1:]])
    between = low + share * (high - low)
    assert path_start(reversed_order)[0] is earlier.mesh
    assert path_start(reversed_order, [0.5 * low, 1.1 * high])[0] is earlier.mesh
    assert path_start(reversed_order, [between])[0] is adapted.mesh


def test_states_of_a_requested_kh_agree_with_the_critical_kh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Davis's bracket may lower the limit load of the last mesh after the path has been followed to it."""
    section = slope_with(cohesion="5 kPa", friction_angle="32 deg")
    known = assessed(section, safety_factor_at=()).critical.kc
    wanted = 0.97 * known
    weaker = slope_with(cohesion="4.6 kPa", friction_angle="32 deg")

    def lowered(_: object, adapted: Any, settings: FemSettings) -> tuple[Any, None]:
        mesh = generate(section, MeshSettings(size=1.5))
        return AdaptiveResult(critical_limit_load(weaker, mesh, settings, MPI.COMM_SELF), mesh), None

    monkeypatch.setattr(assessment._Search, "limit_loads_by_both_rules", lowered)
    item = assessed(section, safety_factor_at=(), kh=(wanted,))
    assert item.critical.kc < wanted
    assert [state.past_equilibrium for state in item.critical.states if state.kh == wanted] == [True]


def test_a_path_without_failure_belongs_to_the_mesh_of_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its last state is the mechanism, which the warnings read on the mesh of the limit load by both flow rules."""
    section = slope_with(cohesion="5 kPa", friction_angle="32 deg")
    meshes = [generate(section, MeshSettings(size=size)) for size in (2.0, 1.5)]
    wish = FemSettings(kh_limit=0.02, accuracy=0.0, direction="downhill", safety_factor_at=())

    def on_another_mesh(_: object, adapted: Any, settings: FemSettings) -> tuple[Any, None]:
        return AdaptiveResult(critical_limit_load(section, meshes[1], settings, MPI.COMM_SELF), meshes[1]), None

    monkeypatch.setattr(assessment._Search, "limit_loads_by_both_rules", on_another_mesh)
    item = assess(section, MeshSettings(size=2.0), meshes[0], wish, MPI.COMM_SELF, lambda *_: None)
    assert item.critical.verdict == "no failure"
    assert item.mesh is item.path_mesh is meshes[1]
    assert item.critical.mechanism.displacement.shape == item.mesh.points.shape


def test_a_file_that_says_nothing_of_dilation_is_told_with_psi_equal_to_phi_and_davis_s_estimate_beside():
    """One that gives psi = 0 is told the other way round, in the same numbers; one with psi = phi has one number."""
    soil = {"cohesion": "5 kPa", "friction_angle": "32 deg"}
    silent, config = assessed(slope_with(**soil)), assessed(slope_with(**soil, dilation_angle="0 deg"))
    assert (silent.critical.flow, config.critical.flow) == ("associated", "davis")
    assert silent.davis.result.kc < silent.critical.kc
    assert config.critical.kc == pytest.approx(silent.davis.result.kc, rel=1e-3)
    assert config.associated.result.kc == pytest.approx(silent.critical.kc, rel=1e-3)
    (still,), (other) = silent.safety, config.safety
    assert still.result.by_other_flow == pytest.approx(other[0].result.factor, rel=2e-3)
    assert other[0].result.by_other_flow == pytest.approx(still.result.factor, rel=2e-3)
    # the closed form of form B for one soil without dilation, sqrt(F^2 - tan^2 phi)
    assert still.result.by_other_flow == pytest.approx(
        np.sqrt(still.result.factor**2 - np.tan(np.radians(32.0)) ** 2), rel=0.01
    )
    full = assessed(slope_with(**soil, dilation_angle="32 deg"))
    assert full.critical.kc == silent.critical.kc
    assert (full.associated, full.davis, full.safety[0].result.by_other_flow) == (None, None, None)


def test_ground_that_stands_only_as_it_dilates_has_a_critical_kh_and_an_estimate_of_zero():
    """Davis's factor of safety below 1 beside one above it: ground that fails by itself has no Kh of its own."""
    result = assessed(slope_with(cohesion="0.6 kPa", friction_angle="24 deg"))
    assert result.safety[0].result.by_other_flow < 1.0 < result.safety[0].result.factor
    assert result.critical.kc > 0.0
    assert result.davis.result.kc == 0.0
    assert "own weight" in result.davis.result.reason


def test_ground_that_only_its_free_field_sides_push_over_is_told_so():
    """A short cut with K0 = 0.96 on 6 m of clay: it failed "under its own weight; its factor of safety is 1.18"."""
    surface = [[0.0, 1.0], [1.0, 1.0], [6.0, 6.0], [8.0, 6.0]]
    clay = layer("clay") | {"cohesion": "22 kPa", "friction_angle": "0 deg", "poissons_ratio": 0.49}
    cut = Section.parse({"name": "cut", "surface": surface, "base": {"elevation": 0.0}, "strata": [clay]})
    with pytest.raises(
        UnstableError, match=r"stands with its sides held horizontally, with a factor of safety of 1\.\d\d"
    ):
        assessed(cut)
    assert assessed(cut, sides="smooth").critical.kc > 0.0


def test_ground_with_a_factor_below_1_fails_whatever_kh_a_coarser_mesh_has(monkeypatch):
    """A step of 1.5 m in moist sand with a factor of 0.84 was said to fail "on some meshes", as if others counted."""
    computed = AdaptiveSearch.safety

    def of_finer_meshes(search, *wish):
        coarse = computed(search, *wish)
        return replace(coarse, result=replace(coarse.result, factor=0.84))

    monkeypatch.setattr(AdaptiveSearch, "safety", of_finer_meshes)
    with pytest.raises(UnstableError) as error:
        assessed(slope_with(cohesion="5 kPa", friction_angle="32 deg"))
    assert error.value.reason.startswith("the section fails under its own weight; its factor of safety is 0.84")


def test_ground_that_excess_pore_pressure_lets_flow_is_told_so():
    """Sand whose excess pore pressure ratio is 1 has next to no strength left in shaking. It was told that the ground
    fails under its own weight, and that its factor of safety is above 1: the one before shaking."""
    sand = {"cohesion": "0.1 kPa", "friction_angle": "35 deg", "excess_pore_pressure_ratio": 1.0}
    loose = slope_with(**sand)
    with pytest.raises(UnstableError, match=r"without this pressure, with a factor of safety of 1\.\d\d") as error:
        assessed(loose)
    assert "excess_pore_pressure_ratio, which is 1 in" in str(error.value)
    with pytest.raises(UnstableError, match="excess pore pressure and its weight"):
        kh_bounds(loose, FemSettings(sides="fixed"), BoundsSettings(max_cells=400, davis=False))


@pytest.mark.parametrize("soil", [{}, {"dilation_angle": "0 deg"}])
def test_the_path_is_followed_once_where_both_flow_rules_have_one_mesh(soil, monkeypatch):
    """A second one would begin where the first one ended, and tell states below failure that were never there."""
    followed = []
    path = assessment.critical_coefficient
    monkeypatch.setattr(assessment, "critical_coefficient", lambda *o, **named: followed.append(1) or path(*o, **named))
    result = assessed(slope_with(cohesion="5 kPa", friction_angle="32 deg", **soil), kh=(0.2,))
    assert len(followed) == 1
    (state,) = (state for state in result.critical.states if state.kh == 0.2)
    assert np.any(state.failed)
