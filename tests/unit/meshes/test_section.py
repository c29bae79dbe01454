"""Sections: what is refused and in which words; S-13 as shipped; files written and read again."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

from meshes.errors import InputError
from meshes.section.section import Section
from meshes.section.toml_file import read_toml
from tests.support import SECTIONS
from tests.support.sections import layer, problems, sections, slope, spoiled

SHIPPED = sorted(SECTIONS.glob("*.toml"))

Change = Callable[[dict[str, Any]], object]


def upper(**values: Any) -> Change:
    return lambda data: data["strata"][0].update(values)


def whole(**values: Any) -> Change:
    return lambda data: data.update(values)


# The change, and what must be said: key and value, then what was expected.
REFUSED: dict[str, tuple[Change, str, str]] = {
    "poisson's ratio of one half": (upper(poissons_ratio=0.5), "poissons_ratio = 0.5", "below 0.5"),
    "poisson's ratio above": (upper(poissons_ratio=0.7), "poissons_ratio = 0.7", "from 0 to below 0.5"),
    "negative stiffness": (upper(youngs_modulus="-3 MPa"), "youngs_modulus = '-3 MPa'", "a stiffness above 0"),
    "no stiffness": (upper(youngs_modulus=0), "youngs_modulus = 0", "a stiffness above 0"),
    "negative strength": (upper(cohesion=-1.0), "cohesion = -1.0", "a stress of 0 or more"),
    "negative density": (upper(density_ordinary="-1 t/m^3"), "density_ordinary = '-1 t/m^3'", "0 or more"),
    "friction of 90 degrees": (upper(friction_angle="90 deg"), "friction_angle = '90 deg'", "below 90 deg"),
    "degrees as a plain number": (upper(friction_angle=35), "friction_angle = 35", 'did you mean "35 deg"?'),
    "not a number": (upper(youngs_modulus=math.nan), "youngs_modulus = nan", "a stiffness above 0"),
    "infinite": (upper(cohesion=math.inf), "cohesion = inf", "a stress of 0 or more"),
    "wrong dimension": (upper(youngs_modulus="30 deg"), "youngs_modulus = '30 deg'", "wrong dimension (degree)"),
    "no unit": (upper(youngs_modulus="30"), "youngs_modulus = '30'", "or a plain number in Pa"),
    "truth value": (upper(poissons_ratio=True), "poissons_ratio = true", "expected a Poisson's ratio"),
    "list for a quantity": (upper(cohesion=[1.0]), "cohesion", "expected a stress"),
    "text for a list": (upper(liquefies_in="all"), "liquefies_in = 'all'", "such as [1, 2, 3]"),
    "truth value in a list": (upper(liquefies_in=[True]), "liquefies_in: True among the cases", "whole numbers from 1"),
    "case nought": (upper(liquefies_in=[0]), "liquefies_in: 0 among the cases", "whole numbers from 1"),
    "half a case": (upper(liquefies_in=[1.5]), "liquefies_in: 1.5 among the cases", "whole numbers from 1"),
    "case twice": (upper(liquefies_in=[1, 1]), "liquefies_in = [1, 1]", "every case once"),
    "unknown key of a stratum": (upper(frction_angle=0.5), "frction_angle", 'did you mean "friction_angle"?'),
    "unknown key of a line": (upper(bottom={"dept": 3.0}), "bottom, dept", 'did you mean "depth"?'),
    "unknown key": (whole(sureface=[]), "sureface", 'did you mean "surface"?'),
    "key of the head in a stratum": (
        upper(beyond="20 m"),
        "beyond: unknown key here",
        "expected at the head of the file",
    ),
    "tables in a stratum": (upper(surcharges=[]), "surcharges: unknown key here", "expected tables [[surcharges]]"),
    "key of another table": (upper(westergaard=True), "westergaard: unknown key here", "expected in [water]"),
    "no points": (whole(surface=[]), "surface", "two or more points"),
    "no points of a table": (whole(water={"table": []}), "water, table", "two or more points"),
    "no points of a drawdown": (
        whole(water={"table": 3, "after_drawdown": []}),
        "after_drawdown",
        "two or more points",
    ),
    "no points of a depth": (upper(bottom={"depth": []}), "bottom", "two or more points"),
    "inertia of no water": (whole(water={"westergaard": True}), "westergaard = true without table", "the free water"),
    "key like no other": (whole(xyz=1), "xyz: unknown key", "expected one of name, title"),
    "dilation above friction": (upper(dilation_angle="26 deg"), "dilation_angle above friction_angle", "at most"),
    "densities swapped": (upper(density_ordinary="2 t/m^3"), "density_seismic below density_ordinary", "the larger"),
    "missing key": (lambda data: data["strata"][0].pop("cohesion"), "cohesion: missing", 'such as "10 tf/m^2"'),
    "missing bottom": (lambda data: data["strata"][0].pop("bottom"), "strata 1, bottom: missing", "only the lowest"),
    "missing name": (lambda data: data.pop("name"), "name: missing", "such as s13"),
    "a parameter of Hoek and Brown": (upper(gsi=50), "gsi: unknown key", "fitted to the Hoek-Brown envelope"),
    "a seismic coefficient": (whole(kh=0.15), "kh: unknown key; expected fem", "safety_factor_at = [0, 0.15]"),
    "walls": (whole(walls=[{"x": 20}]), "walls: unknown key; expected zones", "geotextiles are not computed"),
    "missing surface": (lambda data: data.pop("surface"), "surface: missing", "the ground surface"),
    "missing base": (lambda data: data.pop("base"), "base: missing", "expected lower boundary of the section"),
    "missing strata": (lambda data: data.pop("strata"), "strata: missing", "one [[strata]] table"),
    "no strata": (whole(strata=[]), "strata", "one [[strata]] table"),
    "one stratum as a table": (whole(strata=layer("one")), "strata", "one [[strata]] table"),
    "strata as text": (whole(strata="clay"), "strata = 'clay'", "one [[strata]] table"),
    "a stratum as a number": (lambda data: data["strata"].append(3), "strata 3 = 3", "a table"),
    "surface as text": (whole(surface="flat"), "surface = 'flat'", "two or more points"),
    "points out of order": (whole(surface=[[0, 1], [9, 1], [5, 1]]), "surface: point 3 at x = 5 m", "left to right"),
    "no width": (whole(surface=[[0, 1], [0, 1]]), "surface: all points at x = 0 m", "left to right"),
    "hardly any width": (whole(surface=[[0, 1], [1e-7, 1]]), "surface: the section is 1e-07 m wide", "at least 0.001"),
    "base as a number": (whole(base=0.0), "base = 0.0", "{ elevation = ... }"),
    "base as both": (whole(base={"elevation": 0.0, "depth": 3.0}), "base", "either elevation or depth"),
    "name of a folder elsewhere": (whole(name="../a"), "name = '../a'", "letters, digits"),
    "name as a number": (whole(name=3), "name = 3", "letters, digits"),
    "name that is too long": (whole(name="a" * 81), "name = 'aaaa", "up to 80"),
    "stratum's name with a quote": (upper(name='a"b'), "name = 'a\"b'", "without quotation marks"),
    "stratum's name of spaces": (
        upper(name=" "),
        "name = ' '",
        "expected name of the stratum, which no other stratum has",
    ),
    "stratum's name with a null": (upper(name="a\0"), "name = 'a\\x00'", "without quotation marks"),
    "same name twice": (upper(name="lower"), '2 strata are called "lower"', "different names"),
    "a boundary's name": (upper(name="base"), 'the name "base"', "the name of a boundary"),
    "reconstruction without a note": (whole(reconstruction=True), "reconstruction_note", "expected a sentence"),
    "reconstruction of text": (whole(reconstruction="yes"), "reconstruction = 'yes'", "true or false"),
    "outside the section": (
        upper(bottom={"depth": [[0, 4], [110, 4]]}),
        "strata 1, bottom: the point at x = 110 m lies outside",
        "from 0 to 100 m",
    ),
    "water table not across": (
        whole(water_table={"elevation": [[10, 5], [100, 5]]}),
        "water_table",
        "across the whole section, from x = 0 to 100 m",
    ),
    "base not across": (whole(base={"elevation": [[0, 0], [90, 0]]}), "base", "across the whole section"),
    "water table above ground": (whole(water_table={"elevation": 15.0}), "the water table rises above", "x = 100 m"),
    "base above ground": (
        whole(base={"elevation": 12.0}, strata=[layer("one")]),
        "the base rises above the ground surface by up to 2 m",
        "100 m",
    ),
    "ground that steps past the base": (
        whole(surface=[[0, 20], [50, 20], [50, 10], [100, 10]], base={"depth": 8.0}),
        "the section falls apart at x = 50 m",
        "the two sides to touch",
    ),
    "base on the ground": (
        whole(base={"depth": 0.0}, strata=[layer("one")]),
        "the section has no height anywhere",
        "geometry",
    ),
    "interfaces that cross": (
        lambda data: data["strata"].insert(1, layer("middle", bottom={"depth": [[0, 2], [100, 6]]})),
        'the bottom of stratum "middle" rises above its top by up to 2 m, at x = 0 m',
        "wrong between x = 0 and 50 m",
    ),
    "interface below the base": (
        upper(bottom={"depth": 15.0}),
        'bottom of stratum "upper" lies below the base',
        "by up to 5 m",
    ),
    "lowest stratum short of the base": (
        lambda data: data["strata"][1].update(bottom={"elevation": 1.0}),
        "the lowest stratum does not reach the base by up to 1 m",
        "x = 0 m",
    ),
    "stratum without thickness": (upper(bottom={"depth": 0.0}), 'stratum "upper" has no thickness anywhere', "10 mm"),
    "slip of the pen": (
        whole(surface=[[0, 2e4], [10, 2e4]]),
        "10 m wide and 20000 m high",
        "no more than 1000 times",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_in_words(case: str) -> None:
    change, key_and_value, expected = REFUSED[case]
    messages = problems(spoiled(change))
    assert len(messages) == 1, messages
    assert key_and_value in messages[0]
    assert expected in messages[0]


def test_the_stratum_is_named_by_number_and_name() -> None:
    assert problems(spoiled(upper(cohesion=-1.0)))[0].startswith('strata 1 "upper", cohesion = -1.0: out of range')


def test_everything_is_told_at_once() -> None:
    def change(data: dict[str, Any]) -> None:
        data["strata"][0].update(poissons_ratio=0.6, cohesion="7 m", frction=1, bottom={"depth": 15.0})
        data["strata"][1].update(youngs_modulus=math.nan, name="upper")
        data["sureface"] = 1

    messages = problems(spoiled(change))
    for part in ("poissons_ratio", "cohesion", "frction", "youngs_modulus", "sureface", "2 strata", "below the base"):
        assert sum(part in text for text in messages) == 1, (part, messages)
    assert len(messages) == 7


def test_a_stratums_own_contradictions_are_told_together() -> None:
    messages = problems(spoiled(upper(dilation_angle="30 deg", density_ordinary="2 t/m^3", liquefies_in=[2, 2])))
    assert len(messages) == 3
    assert all('strata 1 "upper"' in text for text in messages)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file"),
        (b"name = ", "is not TOML: Invalid value (at end of document)"),
        (b'name = "a"\nname = "b"\n', "is not TOML: Cannot overwrite a value (at line 2"),
        (bytes(range(256)), "cannot be read: it is not UTF-8 text"),
        ('name = "é"'.encode("utf-16"), "cannot be read: it is not UTF-8 text"),
        (b"x = " + b"[" * 5000 + b"]" * 5000, "too many brackets"),
    ],
)
def test_a_file_that_cannot_be_read(tmp_path: Path, content: bytes | None, said: str) -> None:
    path = tmp_path / "a.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match="1 problem") as caught:
        Section.read(path)
    assert caught.value.source == str(path)
    assert said in caught.value.problems[0]


def test_a_folder_is_no_section(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: it is a folder"):
        Section.read(tmp_path)


def test_a_file_from_windows(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + Section.parse(slope()).to_toml().replace("\n", "\r\n").encode())
    assert Section.read(path) == Section.parse(slope())


def test_the_defaults() -> None:
    section = Section.parse(slope())
    assert (section.strata[0].dilation_angle, section.strata[0].dilation) == (None, 0.0)
    assert section.strata[0].liquefies_in == ()
    assert not section.reconstruction
    assert section.water_table is None
    assert "dilation_angle" not in section.to_toml()  # its file says nothing of it, when it is read again, too


def test_a_cohesion_may_be_left_out_beside_a_strength_ratio() -> None:
    data = slope()
    del data["strata"][0]["cohesion"]
    with pytest.raises(InputError, match="cohesion: missing"):
        Section.parse(data)
    data["strata"][0]["strength_ratio"] = 0.22
    stratum = Section.parse(data).strata[0]
    assert (stratum.cohesion, stratum.strength_ratio) == (0.0, 0.22)
    data["strata"][0]["cohesion"] = "5 kPa"
    assert Section.parse(data).strata[0].cohesion == 5e3


def test_sections_can_be_compared_after_their_layers_were_used() -> None:
    item, same, other = (Section.parse(data) for data in (slope(), slope(), spoiled(whole(title="other"))))
    assert all(section.layering.areas().sum() == 1500.0 for section in (item, same, other))
    assert item == same
    assert item != other


def test_settings_of_others_are_let_through() -> None:
    assert Section.parse({**slope(), "fem": {"anything": 1}}) == Section.parse(slope())


def assert_round_trip(section: Section, path: Path) -> None:
    text = section.to_toml()
    path.write_text(text, encoding="utf-8")
    again = Section.read(path)
    assert again == section
    assert again.to_toml() == text
    assert again.sha256() == section.sha256()


def test_quantities_are_written_back_as_they_were_written() -> None:
    data = {**slope(), "surface": [["0 ft", "66 ft"], ["100 m", "10 m"]], "base": {"elevation": "-2 ft"}}
    text = Section.parse(data).to_toml()
    for written in ('"30 MPa"', '"1.9 t/m^3"', '"25 deg"', '"66 ft"', '"100 m"', 'elevation = "-2 ft"'):
        assert written in text


@pytest.mark.parametrize("file", SHIPPED, ids=lambda path: path.stem)
def test_round_trip_of_shipped_sections(file: Path, tmp_path: Path) -> None:
    section = Section.read(file)
    assert_round_trip(section, tmp_path / "again.toml")


@settings(deadline=None, derandomize=True)
@given(section=sections())
def test_round_trip_of_random_sections(section: Section, tmp_path_factory: pytest.TempPathFactory) -> None:
    assert_round_trip(section, tmp_path_factory.mktemp("section") / "again.toml")


@settings(deadline=None, derandomize=True)
@given(section=sections())
def test_areas_of_random_sections_are_those_of_their_polygons(section: Section) -> None:
    def area(polygon: np.ndarray) -> float:
        x, z = (polygon - polygon[0]).T
        return float(0.5 * (x * np.roll(z, -1) - np.roll(x, -1) * z).sum())

    pieces = [sum(map(area, section.layering.polygons(k))) for k in range(len(section.strata))]
    np.testing.assert_allclose(pieces, section.layering.areas(), rtol=1e-9)
    assert sum(pieces) == pytest.approx(area(section.outline()), rel=1e-9)


# Table 1 of the paper on S-13: E (tf/m²), Poisson's ratio, ordinary and seismic density (t/m³), cohesion (tf/m²),
# friction (deg).
TABLE_1 = {
    "1 Ts": (1560, 0.33, 1.80, 1.80, 0, 35),
    "2 Ac1": (2440, 0.45, 0.65, 1.65, 10, 0),
    "3 Asd": (2960, 0.33, 1.80, 1.80, 0, 35),
    "4 Asd": (3280, 0.33, 1.00, 2.00, 0, 35),
    "5 Asd": (3280, 0.33, 1.00, 2.00, 0, 35),
    "6 As1": (5500, 0.33, 0.80, 1.80, 0, 35),
    "7 Ac2": (5600, 0.45, 0.68, 1.68, 10, 0),
    "8 As1": (5500, 0.33, 0.80, 1.80, 0, 35),
    "9 Ac3": (9760, 0.45, 0.65, 1.65, 0, 35),
    "10 Base": (9760, 0.45, 0.65, 1.65, 1000, 0),
}
TONNE_FORCE = 9806.65  # N


@pytest.fixture(scope="module")
def s13() -> Section:
    return Section.read(next(path for path in SHIPPED if path.stem == "s13"))


def test_s13_has_the_parameters_of_table_1(s13: Section) -> None:
    assert [stratum.name for stratum in s13.strata] == list(TABLE_1)
    for stratum, (stiffness, ratio, ordinary, seismic, cohesion, friction) in zip(
        s13.strata, TABLE_1.values(), strict=True
    ):
        assert stratum.youngs_modulus == pytest.approx(stiffness * TONNE_FORCE, rel=1e-12)
        assert stratum.poissons_ratio == ratio
        assert stratum.density_ordinary == pytest.approx(1e3 * ordinary, rel=1e-12)
        assert stratum.density_seismic == pytest.approx(1e3 * seismic, rel=1e-12)
        assert stratum.cohesion == pytest.approx(cohesion * TONNE_FORCE, rel=1e-12)
        assert stratum.friction_angle == pytest.approx(math.radians(friction), rel=1e-12)
        assert stratum.dilation == 0.0


def test_s13_is_what_the_paper_says_of_it(s13: Section) -> None:
    """200 m long, 2.6 degrees, 31.5 m deep, layers 4 and 6 liquefied and more than twice as thick uphill or nearly."""
    assert s13.reconstruction
    assert "inferred" in s13.reconstruction_note
    (left, top), (right, bottom) = s13.surface
    assert right - left == 200.0
    assert math.degrees(math.atan((top - bottom) / (right - left))) == pytest.approx(2.6, abs=0.005)
    assert s13.layering.left[0, 0] - s13.layering.left[0, -1] == pytest.approx(31.5)
    assert [k + 1 for k, stratum in enumerate(s13.strata) if stratum.liquefiable] == [4, 6]
    at_left, at_right = s13.layering.thickness()
    liquefied = [3, 5]
    assert at_left[0, liquefied].sum() > 2.0 * at_right[-1, liquefied].sum()


def test_s13_layers_2_and_3_are_lateral_neighbours(s13: Section) -> None:
    present = s13.layering.present()
    assert not (present[:, 1] & present[:, 2]).any()
    assert (present[:, 1] | present[:, 2]).all()


def test_reading_toml_gives_what_the_file_holds(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("a = 1\n[b]\nc = 'd'\n")
    assert read_toml(path) == {"a": 1, "b": {"c": "d"}}


def test_a_table_of_a_section_that_is_misspelt_is_refused() -> None:
    """Tables of settings are passed over; a misspelt [water] would leave a dry slope."""
    assert Section.parse({**slope(), "fem": {"sides": "fixed"}}).water is None
    with pytest.raises(InputError, match='watr: unknown key; did you mean "water"'):
        Section.parse({**slope(), "watr": {"table": {"elevation": 3.0}}})


@pytest.mark.parametrize(
    ("strength", "key"),
    [({"strength_ratio": 0.25}, "strength_ratio"), ({"strength_table": [[0, 5e3], [4e4, 1.2e4]]}, "strength_table")],
)
def test_undrained_strength_by_stress_beside_a_friction_angle_is_reported(strength: dict[str, Any], key: str) -> None:
    """Clay of φ = 25° and 0.25 σ'v had the strength of both, and nothing was reported."""
    both = f"its friction angle of 25 deg adds drained strength to the undrained strength of its {key}"
    for angle, count in (("25 deg", 1), ("0 deg", 0)):
        data = slope()
        data["strata"][0] |= {**strength, "friction_angle": angle}
        assert sum(both in text for text in Section.parse(data).notices) == count
