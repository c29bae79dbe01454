"""Checks of an answer: what each must find and what it must let pass; and the slip surface."""

from dataclasses import replace

import numpy as np
import pytest

from fem.continuum.fields import FieldState, is_mechanism, touched_sides
from fem.search.checks import of_cells, of_dilation, of_verdict, touches_base, warnings_of
from fem.search.critical import CriticalResult
from fem.search.result_warnings import ComparedKh, contradict_answer, of_bounds, of_others
from fem.search.slip_surface import slip_surface
from meshes.quality import corner_angles
from tests.support.fem_problems import grid

MESH = grid(np.linspace(0.0, 20.0, 21), np.linspace(0.0, 10.0, 11))
MIDDLE = MESH.points[MESH.cells].mean(axis=1)


def arc(x):
    """A slip surface that daylights at x = 4 and x = 16 m, 5 m deep in the middle."""
    return 10.0 - 5.0 * (1.0 - ((x - 10.0) / 6.0) ** 2)


def failing(band=0.7, displacement=None):
    """A state whose plastic shear strain is concentrated on the arc, above which the ground moves."""
    x, z = MIDDLE.T
    strain = 0.5 * np.exp(-(((z - arc(x)) / band) ** 2)) * (np.abs(x - 10.0) < 6.0)
    above = (np.abs(MESH.points[:, 0] - 10.0) < 5.0) & (MESH.points[:, 1] > arc(MESH.points[:, 0]))
    moved = np.outer(above, [1.0, -0.5]) if displacement is None else displacement
    cells = len(MESH.cells)
    return FieldState("plateau", 0.3, moved, np.zeros((cells, 4)), strain + 1e-3, strain, np.ones(cells))


def result(kc=0.3, direction="downhill", state=None, **more):
    values = {
        "kc": kc, "lower": kc, "upper": kc, "verdict": "plateau", "element": "reduced", "flow": "davis",
        "direction": direction, "sign": 1, "reason": "", "remedy": "", "steps": [], "states": [state or failing()],
        "solves": 0, "gravity_iterations": 1, "gravity_plastic_share": 0.0, "shallow_failures": [],
    }  # fmt: skip
    return CriticalResult(**{**values, **more})


def test_a_sound_answer_is_not_doubted():
    assert warnings_of(result(), MESH, result(0.32)) == []


def test_undecided_path_is_doubtful_and_says_why():
    (warning,) = of_verdict("undecided", "no step", "refine")
    assert "no step" in warning.observation
    assert warning.remedy == "refine"
    assert contradict_answer([warning])


def test_less_dilation_cannot_bear_more():
    (warning,) = of_dilation(result(0.167), result(0.145))
    assert "0.167" in warning.observation
    assert "0.145" in warning.remedy
    assert list(of_dilation(result(0.145), result(0.145))) == []
    assert list(of_dilation(result(0.167), result(0.145, direction="uphill"))) == []


def test_strict_bounds_judge_answers_of_their_own_flow_and_every_smaller_dilation():
    assert "19.3 %" in next(of_bounds(0.167, 0.123, 0.140, same_flow=False)).observation
    assert list(of_bounds(0.100, 0.123, 0.140, same_flow=False)) == [], (
        "less dilation may bear less than the lower bound"
    )
    assert "lower bound" in next(of_bounds(0.100, 0.123, 0.140, same_flow=True)).observation
    assert list(of_bounds(0.141, 0.123, 0.140, same_flow=True)) == []
    assert list(of_bounds(0.141, None, None, same_flow=True)) == []


def test_changes_by_more_than_3_percent_are_told():
    values = list(of_others(0.299, [ComparedKh("cells of half the size", 0.267), ComparedKh("another step", 0.298)]))
    assert len(values) == 1
    assert "-11 %" in values[0].observation


def test_a_change_on_another_mesh_is_held_against_that_mesh():
    other = ComparedKh("quadratic element, on the first mesh of 1041 cells", 0.1242, decisive=False, kc_without=0.1139)
    (computed,) = of_others(0.1096, [other])
    assert "0.124 instead of 0.114, +9 %" in computed.observation


@pytest.mark.parametrize(("side", "column"), [("left", 0.0), ("right", 20.0)])
def test_a_mechanism_at_a_side_touches_it_and_contradicts_nothing(side, column):
    moved = np.outer(np.abs(MESH.points[:, 0] - column) < 5.0, [1.0, 0.0])
    state = failing(displacement=moved)
    assert touched_sides(MESH, state) == (side,)
    assert warnings_of(result(state=state), MESH) == []


def test_mechanism_along_the_base_is_told():
    strain = np.where(MIDDLE[:, 1] < 1.0, 0.5, 0.0)
    state = replace(failing(), shear_strain=strain + 1e-3, plastic_shear_strain=strain)
    assert touches_base(MESH, state)
    assert not touches_base(MESH, failing())


def test_narrow_cells_are_told_with_their_place():
    flat = grid(np.array([0.0, 1.0]), np.array([0.0, 1.0]), move=lambda x, y: (x + 5.0 * y, y))
    assert corner_angles(flat.points, flat.cells).min() == pytest.approx(np.degrees(np.arctan(1.0 / 5.0)))
    (warning,) = of_cells(flat)
    assert "1 of 1 cells" in warning.observation
    assert "11.3°" in warning.observation
    for method, recommended in (("mapped", True), ("free", False)):
        (warning,) = of_cells(replace(flat, method=method))
        assert ('mesh.method = "free"' in warning.remedy) == recommended
    assert list(of_cells(MESH)) == []


def test_slip_surface_lies_in_the_band_of_strain_and_ends_with_what_moves():
    line = slip_surface(MESH, failing())
    inside = np.abs(line[:, 0] - 10.0) < 5.0
    assert np.abs(line[inside, 1] - arc(line[inside, 0])).max() < 1.0, "within a cell"
    assert 5.0 < line[0, 0] < 6.0
    assert 14.0 < line[-1, 0] < 15.0


def test_a_small_failure_has_a_slip_surface_and_not_a_point():
    """The toe of a dam of 130 m slipped from "x = 92 to 92 m"."""
    x = np.concatenate([[0.0, 50.0], np.linspace(98.0, 104.0, 13), [150.0, 200.0]])
    mesh = grid(x, np.linspace(0.0, 10.0, 21))
    above = (np.abs(mesh.points[:, 0] - 101.0) < 1.2) & (mesh.points[:, 1] > 8.9)
    cells = len(mesh.cells)
    state = replace(
        failing(), displacement=np.outer(above, [1.0, -0.5]), shear_strain=np.full(cells, 0.5),
        plastic_shear_strain=np.full(cells, 0.499),
    )  # fmt: skip
    line = slip_surface(mesh, state)
    assert len(line) > 10
    assert 99.0 < line[0, 0] < 100.5
    assert 101.5 < line[-1, 0] < 103.0
    assert np.abs(line[:, 1] - 8.7).max() < 0.5


def test_without_a_mechanism_there_is_no_slip_surface():
    state = failing()
    faint = replace(state, plastic_shear_strain=0.01 * state.plastic_shear_strain, shear_strain=np.full(200, 6e-3))
    assert is_mechanism(state)
    assert not is_mechanism(faint)
    assert len(slip_surface(MESH, faint)) == 0


def test_a_repeated_slope_ends_at_no_side():
    state = failing(displacement=np.full(MESH.points.shape, 1.0))
    assert touched_sides(MESH, state) == ("left", "right")
    assert touched_sides(MESH, replace(state, repeats=True)) == ()
    assert warnings_of(result(state=replace(state, repeats=True)), MESH) == []
