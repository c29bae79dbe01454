"""Discs do not depend on the axes of coordinates: wherever a section lies on them, its discs have the same bits."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dem import DemSettings, DiscModel, critical_kh, deposit
from dem.case import Case
from dem.search.deposit import ground_at_rest
from dem.settings import SlideSettings
from dem.slides.liquefaction import Slider
from meshes import Section
from meshes.files import read_checkpoint, write_checkpoint

FEW = DemSettings(elements=120)
SHIFTS = ((103.3721, 0.4517), (-1103.17, -320.0417))  # m


def _bank(dx: float, dz: float) -> Section:
    """Return a bank with a layer that liquefies, clay with a strength that grows with depth, water and a load."""

    def line(*points: tuple[float, float]) -> list[list[float]]:
        return [[x + dx, z + dz] for x, z in points]

    soil: dict[str, Any] = {
        "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3",
        "cohesion": "2 kPa", "friction_angle": "32 deg",
    }  # fmt: skip
    clay = soil | {
        "cohesion": "15 kPa", "cohesion_increase": "2 kPa/m", "cohesion_from": {"elevation": 4.0 + dz},
        "friction_angle": "0 deg",
    }  # fmt: skip
    return Section.parse({
        "name": "bank",
        "surface": line((0.0, 10.0), (14.0, 10.0), (24.0, 6.0), (40.0, 6.0)),
        "base": {"elevation": dz},
        "strata": [
            soil | {"name": "fill", "bottom": {"elevation": line((0.0, 6.5), (40.0, 5.5))}},
            soil | {"name": "loose", "bottom": {"elevation": line((0.0, 4.2), (40.0, 3.4))}, "liquefies_in": [1]},
            clay | {"name": "clay"},
        ],
        "water": {"table": line((0.0, 7.0), (24.0, 6.0), (40.0, 6.0))},
        "surcharges": [{"from": 3.0 + dx, "to": 8.0 + dx, "pressure": "10 kPa"}],
    })  # fmt: skip


def _slid(section: Section) -> tuple[DiscModel, np.ndarray, float]:
    """Return the discs at rest, the slide of the surface over x, and the critical Kh."""
    lies = deposit(section, FEW)
    settings = SlideSettings(kh=0.1, kh_seconds=1.0, onset=1.0, duration=5.0)
    slider = Slider(lies.settled, lies.ground, [1], Case(residual=0.1), settings, free_sides=True)
    return lies.settled, np.array(slider.run().slide_along), critical_kh(lies.settled, lies.ground, FEW).kc or 0.0


def test_discs_do_not_depend_on_the_place_of_the_section() -> None:
    """Rounding errors of coordinates led to another packing, and discs slid as differently as packings do."""
    settled, slide, kc = _slid(_bank(0.0, 0.0))
    assert np.abs(slide[:, 1]).max() > 0.1
    for dx, dz in SHIFTS:
        other, slide_there, kc_there = _slid(_bank(dx, dz))
        assert np.array_equal(other.x, settled.x)
        assert np.array_equal(other.pore_acceleration_z, settled.pore_acceleration_z)
        assert kc_there == kc
        assert slide_there == pytest.approx(slide + np.array([dx, 0.0]), abs=1e-9)


def test_discs_that_were_stored_in_the_axes_of_their_section_are_read(tmp_path: Path) -> None:
    """Discs of runs of earlier versions have no ``place``."""
    section, file = _bank(*SHIFTS[0]), tmp_path / "discs.npz"
    lies = deposit(section, FEW)
    lies.settled.save(file)
    assert DiscModel.load(file).place == lies.settled.place == pytest.approx(SHIFTS[0])
    arrays, plain = read_checkpoint(file)
    del plain["place"]
    write_checkpoint(file, arrays, plain)
    ground = ground_at_rest(section, FEW, DiscModel.load(file))
    assert ground.section is not None
    assert ground.section.surface == section.surface
    assert ground.to_section(np.zeros(1), np.zeros(1)) == (0.0, 0.0)
