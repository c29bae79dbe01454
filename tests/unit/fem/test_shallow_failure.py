"""Grains that roll down a face without cohesion, and the ground below it that is kept from doing so."""

import math

import numpy as np
import pytest

from fem.continuum.face_reinforcement import strengthened, strip_bottom
from fem.continuum.liquefied_ground import liquefied_section
from fem.continuum.shallow_failure import faces_at, shallow_failures
from fem.limit.bounds import DirectionGround, kh_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.section.liquefies import RemainingStrength
from meshes.section.section import Section
from tests.support import SECTIONS
from tests.support.sections import layer
from tests.support.water import WATER, soil
from tests.support.water import section as water_section

FIXED = FemSettings(sides="fixed")


def bank(cohesion=0, **changes) -> Section:
    """A face of 1:2, 5 m high, of sand, over clay."""
    sand = layer("sand", cohesion=cohesion, friction_angle="35 deg", bottom={"elevation": -2.0}, **changes)
    surface = [[0.0, 5.0], [10.0, 5.0], [20.0, 0.0], [30.0, 0.0]]
    data = {"name": "bank", "surface": surface, "base": {"elevation": -4.0}}
    return Section.parse({**data, "strata": [sand, layer("clay", cohesion="60 kPa", friction_angle="0 deg")]})


def test_the_shallow_failure_is_an_infinite_slope():
    """Kh = (γ / γs - Kv) tan(φ - β), on the face alone; pushed uphill, there is none."""
    [face] = shallow_failures(bank(density_ordinary="1.0 t/m^3"), FemSettings(vertical=0.1))
    assert (face.stratum, face.start, face.end) == ("sand", 10.0, 20.0)
    assert face.kh == pytest.approx((1.0 / 1.9 - 0.1) * np.tan(np.radians(35.0) - np.arctan(0.5)))
    assert shallow_failures(bank(), FemSettings(direction="uphill")) == []
    assert shallow_failures(bank(cohesion="1 kPa"), FIXED) == []


def test_where_a_stratum_pinches_out_it_is_no_face() -> None:
    """The wedge of cover at the crest is 2.5 mm thick in its middle, less than points are told apart."""
    surface = [[0.0, 5.0], [10.0, 5.0], [10.01, 4.995], [20.0, 0.0], [30.0, 0.0]]
    line = {"elevation": [[0.0, 4.0], [9.9, 4.0], [10.0, 4.995], [10.01, 4.995], [20.0, 0.0], [30.0, 0.0]]}
    cover = layer("cover", cohesion=0, friction_angle="35 deg", bottom=line)
    sand = layer("sand", cohesion=0, friction_angle="35 deg", bottom={"elevation": -2.0})
    clay = layer("clay", cohesion="60 kPa", friction_angle="0 deg")
    data = {"name": "bank", "surface": surface, "base": {"elevation": -4.0}, "strata": [cover, sand, clay]}
    pinched = shallow_failures(Section.parse(data), FIXED)
    assert [face.stratum for face in pinched] == ["sand"]
    assert pinched[0].kh == pytest.approx(shallow_failures(bank(), FIXED)[0].kh)


def test_the_strengthened_strip_carries_what_level_ground_does():
    """The infinite slope: γ d sin β + Kh γ d cos β = c / cos β + tan φ (γ d cos β - Kh γ d sin β), d vertical."""
    section, settings = bank(), FemSettings(least_depth="0.8 m")
    [face] = shallow_failures(section, settings)
    strip = strengthened(section, [face], settings).strata[0]
    weight, tan = 1900.0 * 9.80665 * 0.8, np.tan(np.radians(35.0))
    sin, cos = np.sin(face.angle), np.cos(face.angle)
    drives = weight * sin + tan * weight * cos
    holds = strip.cohesion / cos + tan * (weight * cos - tan * weight * sin)
    assert drives == pytest.approx(holds)


def test_the_strip_follows_the_face_and_ends_with_its_stratum():
    section = Section.read(SECTIONS / "natural_slope.toml")
    sand = {**layer("sand", cohesion=0, friction_angle="33 deg"), "bottom": {"elevation": [[0, 10], [18, 6]]}}
    data = {"name": "thin", "surface": [[0, 12], [24, 4]], "base": {"elevation": 0}, "strata": [sand, layer("rest")]}
    thin = Section.parse(data)
    strong = strengthened(thin, shallow_failures(thin, FIXED), FIXED)
    x = np.linspace(0.1, 17.9, 50)
    before, after = (s.layering.interfaces(x) for s in (thin, strong))
    np.testing.assert_allclose(after[:, [0, 2, 3]], before, atol=1e-9)
    np.testing.assert_allclose(after[:, 0] - after[:, 1], np.minimum(0.5, before[:, 0] - before[:, 1]), atol=1e-6)
    assert strengthened(section, shallow_failures(section, FIXED), FIXED).layering.areas().sum() == pytest.approx(
        section.layering.areas().sum()
    )


def test_a_stratum_thinner_than_the_least_depth_is_strengthened_as_a_whole() -> None:
    """S-13's first sand is 2 m thick at most: below 3 m of it nothing is left that could have a thickness."""
    section = Section.read(SECTIONS / "s13.toml")
    deep = FemSettings(least_depth=3.0)
    [face] = shallow_failures(section, deep)
    strong = strengthened(section, [face], deep)
    assert len(strong.strata) == len(section.strata)
    assert strong.strata[0].name.startswith("1 Ts, strengthened face")
    assert strong.layering.areas() == pytest.approx(section.layering.areas())


@pytest.mark.parametrize("tilt", [1e-14, 3e-17, -1e-13, 1e-9])
def test_ground_level_to_rounding_is_level(tilt: float) -> None:
    """0.1 + 0.2 against 0.3 at the two ends of level sand: no face, no strip, and no factor of safety of 1e14."""
    surface = [[0.0, 0.1 + 0.2 + tilt], [30.0, 0.3], [60.0, 0.3 - tilt]]
    sand = layer("sand", cohesion=0, friction_angle="35 deg")
    level = Section.parse({"name": "level", "surface": surface, "base": {"elevation": -9.0}, "strata": [sand]})
    for direction in ("downhill", "uphill"):
        assert shallow_failures(level, FemSettings(direction=direction)) == []
    assert faces_at(level, FIXED, 0.0) == []


@pytest.mark.parametrize("fall", [0.03, 3e-3])
def test_what_a_gentle_face_is_strengthened_by_is_not_judged_as_input(fall: float) -> None:
    """A cohesion of 40 Pa, or 4 Pa, that nobody wrote: a person who writes one means another unit."""
    sand = layer("sand", cohesion=0, friction_angle="35 deg")
    gentle = {"name": "gentle", "surface": [[0.0, fall], [15.0, 0.0]], "base": {"elevation": -9.0}, "strata": [sand]}
    section = Section.parse(gentle)
    [face] = shallow_failures(section, FIXED)
    strip = strengthened(section, [face], FIXED).strata[0]
    assert 0.0 < strip.cohesion < 50.0
    assert strip.cohesion == pytest.approx(
        1900.0 * 9.80665 * 0.5 * fall / 15.0 / math.cos(math.radians(35)) ** 2, rel=1e-4
    )


def test_liquefied_ground_is_not_judged_as_input() -> None:
    """A residual strength of 10 Pa, in a layer below a face that is strengthened."""
    section = bank()
    loose = section.strata[1].model_copy(update={"friction_angle": math.radians(30.0)})
    section = section.with_strata([section.strata[0], loose])
    weak = liquefied_section(section, {1: RemainingStrength(cohesion=0.0, friction=0.1, residual=1e-4)})
    assert 0.0 < weak.cohesion_field.means()[1].cohesion < 20.0
    strong = strengthened(weak, shallow_failures(weak, FIXED), FIXED)
    assert [s.name for s in strong.strata] == ["sand, strengthened face at x = 10 m", "sand", "clay"]
    assert strong.strata[2].strength_ratio == weak.strata[1].strength_ratio == 1e-4


def test_the_shallow_failure_governs_a_bank_of_sand_and_not_a_gentle_slope():
    [face] = DirectionGround.of(bank(), FIXED, 1500).shallow_failures
    whole = kh_bounds(strengthened(bank(), [face], FIXED), FIXED, BoundsSettings(gap=0.2, max_cells=1500))
    assert face.kh == pytest.approx(0.1482, abs=1e-4)
    assert whole.upper > face.kh
    assert DirectionGround.of(Section.read(SECTIONS / "s13.toml"), FIXED, 1500).shallow_failures == ()


@pytest.mark.parametrize(("head", "share"), [("vertical", 1.0), ("normal", 0.9)])
def test_water_that_seeps_out_along_a_face_takes_its_part(head: str, share: float) -> None:
    """(γ cos² - u/h) tan φ - γ sin cos over γ (cos² + sin cos tan φ), the infinite slope; cos² is 0.9 at 1:3."""
    face = {"surface": [[0.0, 20.0], [60.0, 0.0]], "base": {"depth": 8.0}}
    sand = soil("Sand", cohesion=0.0, friction_angle="38 deg")
    config = water_section(sand, **face, water={"table": {"depth": 0.0}, "head": head})
    [result] = shallow_failures(config, FemSettings())
    friction = math.tan(math.radians(38.0))
    up = (20e3 * 0.9 - share * WATER) * friction - 20e3 * 0.3
    assert result.kh == pytest.approx(up / (20e3 * (0.9 + 0.3 * friction)), rel=1e-6)


def test_a_face_under_still_water_fails_as_buoyant_sand() -> None:
    sand = soil("Sand", cohesion=0.0, friction_angle="38 deg")
    [result] = shallow_failures(water_section(sand, water={"table": 12.0}), FemSettings())
    ratio = (20e3 - WATER) / 20e3
    assert result.kh == pytest.approx(ratio * math.tan(math.radians(38.0) - math.atan(0.4)), rel=1e-6)


def test_a_face_under_a_load_has_no_shallow_failure() -> None:
    sand = soil("Sand", cohesion=0.0, friction_angle="38 deg")
    load = {"from": 18, "to": 42, "pressure": "20 kPa"}
    assert shallow_failures(water_section(sand, surcharges=[load]), FemSettings()) == []


@pytest.mark.parametrize(("start", "end"), [(36.65, 120.79), (10.0, 20.0)])
def test_the_bottom_of_a_strip_goes_from_left_to_right_to_rounding(start: float, end: float) -> None:
    """36.65 + 1.0 (120.79 - 36.65) is 120.79000000000002: the shell of a dam ended in "point 4 stands after"."""
    data = {"name": "shell", "surface": [[0.0, 30.0], [start, 30.0], [end, 3.0], [end + 30.0, 0.0]]}
    sand = layer("sand", cohesion=0.0, friction_angle="35 deg", bottom={"elevation": -2.0})
    section = Section.parse({**data, "base": {"elevation": -4.0}, "strata": [sand, layer("clay")]})
    x, z = np.array(strip_bottom(section.layering, start, end + 30.0, 0, 0.5)).T
    assert (np.diff(x) > 0.0).all()
    assert x[[0, -1]].tolist() == [start, end + 30.0]
    assert z == pytest.approx(np.interp(x, *section.ground.T) - 0.5)
