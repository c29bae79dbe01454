"""A section in other axes has the same ground, water, strengths and loads."""

import typing
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

from meshes.section.quantity import Coordinate
from meshes.section.section import Section
from meshes.section.translation import HORIZONTAL, VERTICAL, with_origin
from tests.support import SECTIONS

X, Z = -12.34567, 5.4321  # m: the new origin


@pytest.mark.parametrize("name", sorted(path.stem for path in SECTIONS.glob("*.toml")))
def test_shipped_sections_are_the_same_in_other_axes(name: str) -> None:
    section = Section.read(SECTIONS / f"{name}.toml")
    moved = with_origin(section, X, Z)
    assert moved.outline() == pytest.approx(section.outline() - [X, Z], abs=1e-6)
    assert moved.extent == pytest.approx(np.array(section.extent) - X, abs=1e-6)
    rng = np.random.default_rng(1)
    low, high = section.outline().min(axis=0), section.outline().max(axis=0)
    places = rng.uniform(low, high, (400, 2))
    stratum = section.stratum_at(*places.T)
    places, stratum = places[stratum >= 0], stratum[stratum >= 0]
    there = places - [X, Z]
    assert np.array_equal(moved.stratum_at(*there.T), stratum)
    for of in (
        lambda s, at: s.water_pressure.at_rest(at, at, stratum),
        lambda s, at: s.water_pressure.vertical_effective(at, at, stratum),
        lambda s, at: s.cohesion_field.at(at, at, stratum),
        lambda s, at: s.surface_loads.pressure(at[:, 0], at[:, 0]),
    ):
        assert of(moved, there) == pytest.approx(of(section, places), rel=1e-3, abs=10.0)


def test_all_parts_of_a_section_are_moved() -> None:
    """Every coordinate of every part stands in the lists of coordinates, or is part of a line."""
    kind = typing.get_args(Coordinate)[1]
    coordinates: dict[str, set[str]] = {}

    def look(model: type[BaseModel]) -> None:
        for key, field in model.model_fields.items():
            if any(each is kind for each in field.metadata):
                coordinates.setdefault(model.__name__, set()).add(key)
            for part in _models_of(field.annotation):
                look(part)

    look(Section)
    listed = {name: {*HORIZONTAL.get(name, ()), *VERTICAL.get(name, ())} for name in HORIZONTAL}
    assert coordinates == listed


def _models_of(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in typing.get_args(annotation) for model in _models_of(part)]


def test_loads_walls_and_structures_move_with_the_ground() -> None:
    soil = {
        "name": "sand", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": "1.8 t/m^3",
        "density_saturated": "2.0 t/m^3", "cohesion": 0.0, "friction_angle": "32 deg", "permeability": "1e-5 m/s",
        "liquefies_in": [1],
    }  # fmt: skip
    section = Section.parse({
        "name": "bank", "surface": [[0, 10], [20, 10], [30, 6], [50, 6]], "base": {"depth": [[0, 8], [50, 6]]},
        "strata": [soil], "surcharges": [{"from": 3, "to": 9, "pressure": "10 kPa"}],
        "water": {"table": [[0, 8], [50, 6]], "flow": True, "cutoffs": [{"x": 12, "bottom": 5}]},
        "structures": [{"name": "road", "from": 2, "to": 10}],
    })  # fmt: skip
    moved = with_origin(section, X, Z)
    assert moved.surcharges[0].start == pytest.approx(3 - X)
    assert moved.structures[0].end == pytest.approx(10 - X)
    assert moved.water is not None
    wall = moved.water.cutoffs[0]
    assert (wall.x, wall.bottom) == pytest.approx((12 - X, 5 - Z))
    assert moved.layering.interface(-1, np.array([-X])) == pytest.approx([2.0 - Z])
    before, after = (each.water_points() for each in (section, moved))
    assert before is not None
    assert after is not None
    at = np.linspace(0.0, 50.0, 21)
    assert np.interp(at - X, *after.T) == pytest.approx(np.interp(at, *before.T) - Z, abs=0.05)


def test_a_section_moves_alike_after_answers_were_computed_from_it() -> None:
    """What a section stores of its answers is no part of it, is not moved, and may contain the section itself."""
    section = Section.read(SECTIONS / "slope_2to1.toml")
    fresh = with_origin(section, X, Z)
    assert section.cut_at_films is section
    moved = with_origin(section, X, Z)
    assert moved == fresh
    assert moved.outline() == pytest.approx(section.outline() - [X, Z], abs=1e-6)
