"""Layers that thin out end in a step where they are as thick as asked for; nothing else changes."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from meshes.thinning import stepped
from tests.support.sections import assert_conforming, layer, sections


def ground(base: Any, *bottoms: Any) -> Section:
    """A level ground at 20 m, 100 m long."""
    strata = [layer(f"layer {k}", bottom=bottom) if bottom else layer(f"layer {k}") for k, bottom in enumerate(bottoms)]
    return Section.parse({"name": "test", "surface": [[0, 20], [100, 20]], "base": base, "strata": strata})


def cut(section: Section, least: float) -> tuple[Any, list[str]]:
    return stepped(section.layering, least, [stratum.name for stratum in section.strata])


def test_a_wedge_on_the_ground_ends_in_a_step_and_the_layer_below_takes_its_tip() -> None:
    """4 m thick at x = 0, nothing at 60 m: half a metre at 52.5 m; the tip has 7.5 x 0.5 / 2 m²."""
    layers, notices = cut(ground({"elevation": 0}, {"depth": [[0, 4], [60, 0]]}, None), 0.5)
    np.testing.assert_allclose(layers.x, [0.0, 52.5, 60.0, 100.0])
    np.testing.assert_allclose(layers.areas(), [120.0 - 1.875, 1880.0 + 1.875])
    assert notices == [
        'mesh: stratum "layer 0" thins out to nothing at x = 60 m; in the mesh it ends in a step of 0.5 m at '
        "x = 52.5 m, without the last 1.9 m²"
    ]


@pytest.mark.parametrize(("thick", "step", "end"), [(0.6, 0.25, 35.0), (0.3, 0.125, 35.0)])
def test_a_thin_wedge_ends_in_a_smaller_step_rather_than_lose_most_of_itself(
    thick: float, step: float, end: float
) -> None:
    layers, notices = cut(ground({"elevation": 0}, {"depth": [[0, thick], [60, 0]]}, None), 0.5)
    assert layers.x[1] == pytest.approx(end)
    assert f"a step of {step:.2g} m at x = {end:.4g} m" in notices[0]


def test_a_long_tip_behind_a_jump_ends_at_the_jump_though_the_layer_thins_out_beyond() -> None:
    """6 cm thick at x = 30 m, where it jumps to 34 cm and thins out to the left: with the tip of half a centimetre for
    each metre gmsh made no mesh at all."""
    above = {"depth": [[0, 4], [30, 4], [30, 4.28], [100, 4.28]]}
    layers, notices = cut(ground({"elevation": 0}, above, {"depth": [[0, 4.1], [30, 4.34], [60, 4.28]]}, None), 0.25)
    assert layers.areas()[1] == pytest.approx(30.0 * 0.5 * (0.1 + 0.34))
    assert len(notices) == 1
    assert notices[0].startswith('mesh: stratum "layer 1" thins out to nothing at x = 60 m')
    assert notices[0].endswith("x = 30 m, without the last 0.9 m²")


def test_a_lens_loses_both_tips_and_one_sentence_says_so() -> None:
    lens = {"depth": [[20, 4], [40, 7], [60, 4]]}
    layers, notices = cut(ground({"elevation": 0}, {"depth": 4}, lens, None), 0.6)
    assert notices == [
        'mesh: stratum "layer 1" thins out to nothing at 2 tips, x = 20, 60 m; in the mesh the tips end in steps of '
        "0.6 m and lose 2.4 m²"
    ]
    np.testing.assert_allclose(layers.areas(), [400.0, 60.0 - 2 * 0.5 * 4 * 0.6, 1540.0 + 2 * 0.5 * 4 * 0.6])


@pytest.mark.parametrize(("seam", "thickened"), [((0.0, 0.2), True), ((90e3, 0.2), False)])
def test_a_weak_seam_that_comes_out_of_the_ground_keeps_its_tip(seam: tuple[float, float], thickened: bool) -> None:
    """The rock below got the soil of the tip, and a wedge on the seam had to shear through it."""
    section = ground({"elevation": 0}, {"depth": [[0, 10], [60, 0]]}, {"depth": [[0, 10.5], [60, 0.5], [63, 0]]}, None)
    strengths = np.array([(500e3, 0.6), seam, (50e3, 0.6)])
    layers, notices = stepped(section.layering, 0.5, [stratum.name for stratum in section.strata], strengths)
    change = layers.areas() - section.layering.areas()
    assert change.sum() == pytest.approx(0.0, abs=1e-9)
    assert change[0] == pytest.approx(-0.5 * 3.0 * 0.5)  # the wedge of the uppermost layer, which the seam gets
    tip = 0.5 * 3.0 * 0.5  # of the seam
    assert change[1] == pytest.approx(-change[0] + (tip if thickened else -tip), abs=1e-6)
    assert ("it ends there in a step of 0.5 m, with 0.75 m² more" in notices[-1]) == thickened


def test_the_part_above_water_takes_the_tip_of_the_same_seam_below_water() -> None:
    """Water leaves a seam by its bottom at x = 60 m: the rock below got the soil of its wet tip."""
    section = ground(
        {"elevation": 0}, {"depth": 10}, {"depth": [[0, 10], [60, 10.5], [100, 10.5]]}, {"depth": 10.5}, None
    )
    layers, notices = stepped(section.layering, 0.2, ["fill", "seam", "seam, below water", "rock"], None)
    np.testing.assert_allclose(layers.areas()[[0, 3]], section.layering.areas()[[0, 3]])
    assert len(notices) == 1, "both parts are one seam"


def test_the_part_above_water_takes_the_tip_of_a_thick_soil_below_water() -> None:
    """The clay below a drained sand took 0.4 m² of it at the water table: Kh 0.0447, with a strict lower bound of
    0.0458, and 0.0463 since the sand keeps its tip."""
    section = ground({"elevation": 0}, {"depth": [[0, 5], [60, 8], [100, 8]]}, {"depth": 8}, None)
    layers, notices = stepped(section.layering, 0.5, ["sand", "sand, below water", "clay"], None)
    np.testing.assert_allclose(layers.areas()[2], section.layering.areas()[2])
    assert len(notices) == 1


def test_a_seam_that_water_crosses_and_that_comes_out_of_the_ground_twice_is_whole() -> None:
    """A wedge on the seam had to shear through mudstone: Kh upslope 0.209, with a strict upper bound of 0.122."""
    soil = {"youngs_modulus": "50 MPa", "poissons_ratio": 0.3, "density": "20 kN/m^3", "density_saturated": "21 kN/m^3"}
    soils = {"sandstone": ("12 kPa", "32 deg"), "seam": ("0 kPa", "14 deg"), "mudstone": ("50 kPa", "30 deg")}
    strata = [{"name": name, "cohesion": c, "friction_angle": phi, **soil} for name, (c, phi) in soils.items()]
    strata[0]["bottom"], strata[1]["bottom"] = ({"elevation": [[0, z], [90, z - 8.0]]} for z in (10.0, 9.7))
    data: dict[str, Any] = {"name": "seam", "base": {"elevation": -4}, "strata": strata}
    data["surface"] = [[0, 18], [25, 18], [60, 4], [90, 4]]
    data["water"] = {"table": [[0, 12], [30, 10], [60, 4], [90, 4]]}
    section = Section.parse(data)
    layers, notices = MeshSettings(method="free").meshed_layers(section)
    assert len([text for text in notices if '"seam"' in text and "thins out" in text]) <= 1, "eight sentences on it"
    names = [stratum.name for stratum in section.strata]
    x = np.concatenate([np.linspace(0.5, 57.8, 100), np.linspace(64.2, 89.5, 100)])
    lines = layers.interfaces(x)
    thick = sum(lines[:, k] - lines[:, k + 1] for k, name in enumerate(names) if name.startswith("seam"))
    assert thick.min() > 0.25


def test_the_layer_above_takes_the_tip_of_the_lowest() -> None:
    layers, _ = cut(ground({"elevation": [[0, 0], [100, 10]]}, {"elevation": 10}, None), 1.0)
    np.testing.assert_allclose(layers.areas(), [1000.0 + 5.0, 500.0 - 5.0])


def test_where_the_base_comes_out_of_the_ground_the_section_ends() -> None:
    """20 m of ground at x = 0, nothing at 100 m, in two layers that meet there: one metre is left at x = 95 m."""
    layers, notices = cut(ground({"elevation": [[0, 0], [100, 20]]}, {"elevation": [[0, 10], [100, 20]]}, None), 1.0)
    assert layers.x[-1] == pytest.approx(95.0)
    assert layers.areas().sum() == pytest.approx(1000.0 - 2.5)
    assert notices[0].startswith("mesh: the section thins out to nothing at x = 100 m; in the mesh it ends in a step")


@pytest.mark.parametrize(
    "bottom",
    [
        {"depth": [[0, 4], [5, 0]]},  # 39 deg at its tip
        {"depth": [[0, 0.1], [60, 0]]},  # nowhere a quarter of half a metre thick
        {"depth": [[0, 4], [60, 3], [60, 0], [100, 0]]},  # a step already
    ],
)
def test_what_needs_no_step_stays(bottom: Any) -> None:
    section = ground({"elevation": 0}, bottom, None)
    layers, notices = cut(section, 0.5)
    assert notices == []
    np.testing.assert_array_equal(layers.left, section.layering.left)


@settings(deadline=None)
@given(section=sections(), least=st.floats(0.05, 2.0))
def test_no_ground_is_lost_and_no_layer(section: Section, least: float) -> None:
    layers, notices = cut(section, least)
    assert layers.areas().sum() == pytest.approx(section.layering.areas().sum(), rel=1e-12)
    assert (layers.areas() > 0.0).all()
    assert (layers.thickness()[0] >= 0.0).all()
    before = section.layering
    same = all(np.array_equal(*pair) for pair in ((layers.left, before.left), (layers.right, before.right)))
    assert bool(notices) != same


def test_cells_at_a_tip_of_three_degrees_are_no_slivers() -> None:
    section = ground({"elevation": 0}, {"depth": [[0, 4], [80, 0]]}, None)
    wanted = MeshSettings(method="free", size=1.5)
    mesh = generate(section, wanted)
    assert_conforming(mesh, section, wanted)
    quality = mesh.quality()
    assert quality.smallest_scaled_jacobian > 0.3
    assert quality.smallest_angle > 25.0
    assert quality.largest_angle < 160.0


def test_the_step_of_a_tip_on_rock_is_ground_in_the_open() -> None:
    """Rock reaches the ground at the right end: the mesh ends ahead of it in a step, which is no side."""
    section = ground({"elevation": [[0, 0], [100, 20]]}, None)
    wanted = MeshSettings(method="free", size=1.0)
    mesh = generate(section, wanted)
    assert_conforming(mesh, section, wanted)
    assert {name for name, edges in mesh.boundaries.items() if not len(edges)} == {"right"}
    x = mesh.points[mesh.boundaries["surface"], 0]
    step = x[(x == mesh.points[:, 0].max()).all(axis=1)]
    assert len(step) >= 1
    assert step.max() < 100.0
