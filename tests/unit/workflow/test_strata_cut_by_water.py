"""Strata that water cuts in two: settings for them by name hold for both parts, and messages name them as the file."""

from typing import Any

import pytest

from dem.case import Case
from meshes.errors import InputError
from meshes.section.cutting import key_in_file, shown_name, soil_numbers, value_of_stratum
from tests.support.sections import layer
from workflow.config import Config
from workflow.earthquake.column import _layers
from workflow.report.summary_text import _cases_are


def cut(cases: tuple[int, ...] = (1,), **settings: Any) -> Config:
    """Sand to -6 m, with water at -2 m, on clay: cut into "sand" and "sand, below water"."""
    soil = {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    strata = [
        layer("sand", bottom={"elevation": -6.0}, liquefies_in=list(cases), **soil),
        layer("clay", **soil),
    ]
    for stratum in strata:
        del stratum["density_ordinary"], stratum["density_seismic"]
    return Config.parse({
        "name": "cut", "surface": [[0.0, 0.0], [40.0, 0.0]], "base": {"elevation": -12.0},
        "water": {"table": {"elevation": -2.0}}, "strata": strata, **settings,
    })  # fmt: skip


def test_how_strata_are_called() -> None:
    strata = cut().section.strata
    assert [stratum.name for stratum in strata] == ["sand", "sand, below water", "clay"]
    assert [key_in_file(strata, k) for k in range(3)] == [
        'strata 1 "sand"',
        'strata 1 "sand" below water',
        'strata 2 "clay"',
    ]
    assert shown_name("sand, below water", quoted=False) == "sand below water"
    assert shown_name("sand, part 2, below water") == '"sand" below water'
    assert shown_name("sand, part 3") == '"sand"'
    assert value_of_stratum({"sand": 1, "sand, below water": 2}, "sand, below water") == 2


def test_a_part_of_a_soil_wholly_below_water_is_shown_as_what_water_cut_off() -> None:
    """A lens at -4 to -5 m parts the sand below the water at -2 m."""
    lens = {**layer("lens"), "points": [[5.0, -4.0], [5.0, -5.0], [35.0, -5.0], [35.0, -4.0]]}
    section = cut(zones=[lens]).section
    names = [stratum.name for stratum in section.strata]
    assert names == ["sand", "sand, below water", "lens", "sand, part 2, below water", "clay"]
    assert soil_numbers(names) == [0, 1, 2, 1, 3]
    assert [key_in_file(section.strata, k) for k in (1, 3)] == ['strata 1 "sand" below water'] * 2


@pytest.mark.parametrize("key", ["residual", "residual_strength"])
def test_what_a_case_leaves_of_a_stratum_holds_below_water(key: str) -> None:
    stored = {"residual": 0.1, "residual_strength": "4 kPa"}[key]
    (case,) = cut(slide={"cases": [{key: {"sand": stored}}]}).slide.cases
    result = Case.residual_of if key == "residual" else Case.strength_of
    assert result(case, "sand, below water") == {"residual": 0.1, "residual_strength": 4000.0}[key]
    with pytest.raises(InputError, match=f'slide, cases 1, {key}: there is no "sadn"; expected one of sand, clay'):
        cut(slide={"cases": [{key: {"sadn": stored}}]})


def test_sizes_of_cells_hold_on_both_sides_of_the_water() -> None:
    packing = cut(mesh={"size": 3.0, "sizes": {"sand": 1.0}, "towards": {"sand": 0.5}})
    assert packing.mesh.sizes_in(packing.section) == {"sand": 1.0, "sand, below water": 1.0}
    assert packing.mesh.towards_in(packing.section) == {
        "sand, below water": 0.5
    }  # the water table is no interface of the soil


def test_measured_velocities_hold_below_water() -> None:
    packing = cut(site_response={"velocities": {"sand": 150.0, "clay": 200.0}, "plasticity": {"sand": 10.0}})
    layers, strata = _layers(packing.section, packing.site_response, 20.0)
    result = {(name, layer.velocity, layer.plasticity) for name, layer in zip(strata, layers, strict=True)}
    assert result == {("sand", 150.0, 10.0), ("sand, below water", 150.0, 10.0), ("clay", 200.0, 0.0)}


def test_notices_name_strata_as_the_file_does() -> None:
    soil = {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3", "cohesion_increase": "1 kPa/m"}
    strata = [
        layer("sand", bottom={"elevation": [[0.0, 0.0], [40.0, -6.0]]}, **soil, cohesion_from=0.0),
        layer("clay", **soil, cohesion_from=0.0),
    ]
    for stratum in strata:
        del stratum["density_ordinary"], stratum["density_seismic"]
    config = Config.parse({
        "name": "cut", "surface": [[0.0, 0.0], [40.0, 0.0]], "base": {"elevation": -12.0}, "mesh": {"method": "free"},
        "water": {"table": {"elevation": -2.0}}, "strata": strata,
    })  # fmt: skip
    assert len(config.section.strata) == 4
    text = " ".join(config.notices)
    assert 'strata 2 "clay" below water: the cohesion varies' in text
    assert 'mesh: stratum "sand" thins out to nothing at 2 tips, x = 0, 13.33 m; in the mesh the tips end' in text
    assert 'stratum "clay" above water thins out' in text
    assert ", below water" not in text
    assert "strata 3" not in text


def test_cases_are_told_by_what_they_change() -> None:
    """A stiffness that stays and dashpots that follow it are no news, and no case leaves "None of its damping"."""
    (messages,) = _cases_are(cut(slide={"cases": [{"residual_strength": {"sand": "4 kPa"}}]}))
    assert messages == (
        "In case 1 liquefaction leaves sand below water with a residual strength of 4 kPa, and none of its friction "
        "and cohesion."
    )
    both = cut(slide={"cases": [{"residual": 0.12}, {"residual_strength": {"sand": "4 kPa"}}]}, cases=(1, 2))
    first, second = _cases_are(
        both
    )  # were one: "a residual strength of 0.12 and 0 of ..., a residual strength of 0 and"
    assert "In case 1 liquefaction leaves sand below water with a residual strength of 0.12 of the vertical" in first
    assert "In case 2 liquefaction leaves sand below water with a residual strength of 4 kPa" in second
    (messages,) = _cases_are(cut(slide={"cases": [{"stiffness": 0.25}]}))
    assert "0.25 of its stiffness and 0.5 of its damping" in messages


def test_the_part_of_a_stratum_above_water_is_named_so() -> None:
    """The sand goes on below the water where its part above it ends."""
    soil = {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    strata = [layer("sand", bottom={"elevation": -8.0}, **soil), layer("clay", **soil)]
    for stratum in strata:
        del stratum["density_ordinary"], stratum["density_seismic"]
    config = Config.parse({
        "name": "cut", "surface": [[0.0, 4.0], [40.0, 0.0]], "base": {"elevation": -12.0}, "mesh": {"method": "free"},
        "water": {"table": {"elevation": 2.0}}, "strata": strata,
    })  # fmt: skip
    [messages] = [text for text in config.notices if "thins out" in text]
    assert messages.startswith('mesh: stratum "sand" above water thins out to nothing at x = 20 m')
