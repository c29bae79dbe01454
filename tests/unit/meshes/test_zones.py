"""Zones: any polygon is ground, in the place of the strata that lie there."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem.limit.safety_bounds import safety_bounds
from fem.settings import BoundsSettings, FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import SOIL, assert_conforming, layer, problems, slope
from workflow.config import Config

LENS = [[30.0, 6.0], [50.0, 8.0], [70.0, 6.0], [50.0, 4.0]]


def zone(name: str = "lens", points: Any = LENS, **soil: Any) -> dict[str, Any]:
    return {"name": name, "points": points, **(soil if "material" in soil else SOIL | soil)}


def with_zones(*zones: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The slope of two layers, from (0, 20) to (100, 10), with zones."""
    return {**slope(), "zones": list(zones), **changes}


def test_a_lens_parts_the_stratum_that_it_lies_in() -> None:
    """A rhombus of 40 by 4 m in the lower layer, of 1100 m²: 80 m² less, above and below it."""
    section = Section.parse(with_zones(zone(cohesion="3 kPa")))
    areas = dict(zip([item.name for item in section.strata], section.layering.areas(), strict=True))
    assert list(areas) == ["upper", "lower", "lens", "lower, part 2"]
    assert areas["upper"] == pytest.approx(400.0)
    assert areas["lens"] == pytest.approx(80.0)
    assert areas["lower"] + areas["lower, part 2"] == pytest.approx(1020.0)
    at = section.stratum_at(np.full(5, 50.0), np.array([14.0, 7.9, 4.1, 3.9, 8.1]))
    assert [section.strata[k].cohesion for k in at] == [15e3, 3e3, 3e3, 15e3, 15e3]
    assert any('of "lower" there are 2 parts' in text for text in section.notices)


def test_outlines_with_overhangs_and_holes_in_between() -> None:
    """A C that is open to the right, 20 by 9 m with a slot of 15 by 3 m: 135 m²; a core in it of 10 by 1 m."""
    c = [[20.0, 2.0], [40.0, 2.0], [40.0, 5.0], [25.0, 5.0], [25.0, 8.0], [40.0, 8.0], [40.0, 11.0], [20.0, 11.0]]
    core = [[27.0, 6.0], [37.0, 6.0], [37.0, 7.0], [27.0, 7.0]]
    section = Section.parse(with_zones(zone("C", c), zone("core", core, cohesion="1 kPa")))
    areas = section.layering.areas()
    area_of_soil = sum(area for area, item in zip(areas, section.strata, strict=True) if item.name.split(",")[0] == "C")
    assert area_of_soil == pytest.approx(135.0)
    assert areas[[entry.name for entry in section.strata].index("core")] == pytest.approx(10.0)
    assert areas.sum() == pytest.approx(1500.0)
    assert_conforming(generate(section, settings := MeshSettings(method="free", size=2.0)), section, settings)


def test_a_zone_may_have_the_soil_of_another_zone() -> None:
    """Two raises of one soil: the second names the first, whichever of them stands first in the file."""
    raises = [zone("raise 2", material="raise 1"),
              zone("raise 1", [[5.0, 1.0], [15.0, 1.0], [10.0, 4.0]], cohesion="7 kPa")]  # fmt: skip
    section = Section.parse(with_zones(*raises))
    at = section.stratum_at(np.array([50.0, 10.0]), np.array([6.0, 2.0]))
    assert [section.strata[k].cohesion for k in at] == [7e3, 7e3]


def test_a_core_between_shells_parts_nothing() -> None:
    core = [[45.0, 0.0], [55.0, 0.0], [52.0, 14.0], [48.0, 14.0]]
    assert [s.name for s in Section.parse(with_zones(zone("core", core))).strata] == ["upper", "lower", "core"]


def test_a_zone_of_the_soil_around_it_changes_nothing() -> None:
    """With the name of its stratum as its material it is that stratum."""
    plain = Section.parse(slope())
    section = Section.parse(with_zones(zone(material="lower")))
    assert [item.name for item in section.strata] == ["upper", "lower"]
    assert section.layering.areas() == pytest.approx(plain.layering.areas())


def test_a_berm_raises_the_ground_and_leaves_depths_where_they_were() -> None:
    """The base 20 m below the ground, water at 2 m depth: both stay, where a berm of 3 m stands on the ground, and so
    does the depth from which the cohesion of the ground below it grows."""
    berm = [[39.0, 16.1], [40.0, 19.0], [50.0, 19.0], [61.0, 13.9]]
    data = with_zones(zone("berm", berm), base={"depth": 20.0}, water={"table": {"depth": 2.0}})
    for item in data["strata"]:
        item["density_saturated"] = "2.1 t/m^3"
        item |= {"cohesion_increase": "2 kPa/m", "cohesion_from": {"depth": 0}}
    section = Section.parse(data)
    before = Section.parse({key: value for key, value in data.items() if key != "zones"})
    x = np.array([20.0, 40.0, 45.0, 80.0])
    np.testing.assert_allclose(section.layering.interfaces(x)[:, -1], before.layering.interfaces(x)[:, -1], atol=1e-3)
    np.testing.assert_allclose(np.interp(x, *section.ground.T), [18.0, 19.0, 19.0, 12.0], atol=1e-3)
    points, was = section.water_points(), before.water_points()
    assert points is not None
    assert was is not None
    np.testing.assert_allclose(np.interp(x, *points.T), np.interp(x, *was.T))
    below = np.array([[45.0, 8.0]])
    result, known = (entry.cohesion_field.at(below, below, entry.stratum_at(*below.T)) for entry in (section, before))
    np.testing.assert_allclose(result, known)
    assert any("raise the ground, by up to 4 m" in text for text in section.notices)


def test_settings_by_name_hold_for_every_part_and_paths_lead_into_zones(tmp_path: Path) -> None:
    data = with_zones(
        zone(liquefies_in=[1]), mesh={"sizes": {"lower": 0.7}}, slide={"cases": [{"residual": {"lens": 0.1}}]}
    )
    config = Config.parse(data | {"uncertain": {"zones.lens.cohesion": {"lognormal": ["10 kPa", "2 kPa"]}}})
    assert config.mesh.sizes_in(config.section) == {"lower": 0.7, "lower, part 2": 0.7}
    drawn = config.with_drawn({"zones.lens.cohesion": 4.0})
    assert {s.cohesion for s in drawn.section.strata} == {15e3, 4e3}
    (tmp_path / "used.toml").write_text(config.section.to_toml())
    assert Section.read(tmp_path / "used.toml").to_toml() == config.section.to_toml()


def test_a_cut_in_a_zone_that_holds_the_whole_mechanism() -> None:
    """γH/c = 3.7752 to 3.7776 (Kammoun et al. 2010) for a vertical cut in clay; here the clay is a zone in rock."""
    outline = [[-12.0, 1.0], [-12.0, -6.0], [14.0, -6.0], [14.0, 5.0], [0.0, 5.0], [0.0, 1.0]]
    clay = zone("clay", outline, cohesion="10 kPa", friction_angle="0 deg", density_ordinary="1 t/m^3",
                density_seismic="1 t/m^3")  # fmt: skip
    rock = layer("rock", cohesion="5 MPa", friction_angle="0 deg")
    data = {"name": "cut", "surface": [[-30.0, 0.0], [0.0, 0.0], [0.0, 4.0], [30.0, 4.0]], "base": {"elevation": -8.0}}
    section = Section.parse({**data, "strata": [rock], "zones": [clay]})
    assert section.ground[:, 1].max() == 5.0
    bounds = safety_bounds(section, FemSettings(sides="fixed"), BoundsSettings(gap=0.1, max_cells=2000))
    exact = 3.7764 * 10e3 / (1000.0 * 9.80665 * 4.0)
    assert 0.9 * exact < bounds.lower <= 1.001 * exact
    assert 0.999 * exact <= bounds.upper < 1.1 * exact


BAD = {
    "overlap": (
        [zone("a"), zone("b", [[50.0, 7.0], [90.0, 4.0], [50.0, 4.0]])],
        'zones 1 "a" and zones 2 "b" overlap by',
    ),
    "outside": ([zone("a", [[0.0, 30.0], [5.0, 30.0], [5.0, 35.0]])], "hangs up to"),
    "off": ([zone("a", [[110.0, 3.0], [120.0, 3.0], [120.0, 5.0]])], 'zones 1 "a": lies outside the section'),
    "below": ([zone("a", [[10.0, -3.0], [20.0, -3.0], [20.0, -1.0]])], 'zones 1 "a": lies outside the section'),
    "bow": ([zone("a", [[10.0, 3.0], [20.0, 8.0], [20.0, 3.0], [10.0, 8.0]])], "outline meet at x = 15, z = 5.5 m"),
    "line": ([zone("a", [[10.0, 3.0], [20.0, 3.0], [30.0, 3.0]])], "zones 1 \"a\", points"),
    "two points": ([zone("a", [[10.0, 3.0], [20.0, 3.0]])], "expected three or more points"),
    "no point": ([zone("a", [[10.0, 3.0], [20.0, 3.0], [20.0, "x"]])], "point 3, z = 'x'"),
    "no such material": ([zone("a", material="sand")], 'zones 1 "a", material = \'sand\': expected the name of'),
    "both": ([{**zone("a", cohesion="1 kPa"), "material": "lower"}], "the name of a stratum or zone, or keys"),
    "a name twice": ([zone("lower")], '2 strata are called "lower"'),
    "a bottom": ([zone("a", bottom={"depth": 3.0})], "bottom"),
    "no soil": ([{"name": "a", "points": LENS}], 'zones 1 "a", youngs_modulus: missing'),
    "no such soil": ([zone("a", youngs_modulus="90 TPa")], 'zones 1 "a", youngs_modulus'),
}  # fmt: skip


@pytest.mark.parametrize("fault", BAD)
def test_bad_zones(fault: str) -> None:
    zones, messages = BAD[fault]
    result = problems(with_zones(*zones))
    assert len([text for text in result if messages in text]) == 1
    assert fault == "no soil" or len(result) == 1


def test_what_lies_past_the_sides_is_left_out_and_told() -> None:
    section = Section.parse(with_zones(zone("a", [[-10.0, 3.0], [10.0, 3.0], [10.0, 5.0], [-10.0, 5.0]])))
    assert section.layering.areas()[[s.name for s in section.strata].index("a")] == pytest.approx(20.0)
    assert any('zones 1 "a": 50 % of it lies past the sides' in text for text in section.notices)


@pytest.mark.parametrize("toe", [[0.0, 10.0, 20.0], [0.0, 35.0, 40.0]])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_zone_on_ground_that_the_base_comes_out_of(toe: list[float], mirrored: bool) -> None:
    """Ahead of the toe the base is the ground, and no stratum lies there; the lens lies under the crest."""
    start, end, beyond = toe
    surface = [[start, 0.0], [beyond, 0.0], [60.0, 10.0], [90.0, 10.0]]
    base = [[start, 0.0], [end, 0.0], [beyond, -1.0], [90.0, -4.0]]
    lens = [[62.0, 1.0], [75.0, 1.0], [75.0, 3.0], [62.0, 3.0]]

    def placed(points: list[list[float]]) -> list[list[float]]:
        return [[90.0 - x, z] for x, z in reversed(points)] if mirrored else points

    data = {
        "name": "toe",
        "surface": placed(surface),
        "base": {"elevation": placed(base)},
        "strata": [layer("clay", **SOIL)],
    }
    whole = Section.parse(data)
    section = Section.parse(data | {"zones": [zone(points=placed(lens))]})
    assert section.layering.areas().sum() == pytest.approx(whole.layering.areas().sum(), rel=1e-6)
    areas = dict(zip([stratum.name for stratum in section.strata], section.layering.areas(), strict=True))
    assert areas["lens"] == pytest.approx(26.0)
    assert section.ground == pytest.approx(whole.ground)
