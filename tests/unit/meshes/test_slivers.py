"""Where water or the ground nearly touches another line, no cell has a corner below 15 degrees."""

from typing import Any

import numpy as np
import pytest

from meshes.gmsh_model import generate
from meshes.quality import corner_angles
from meshes.section.section import Section
from meshes.triangles import triangulate
from workflow.config import Config

SOIL = {"density": "18 kN/m^3", "density_saturated": "20 kN/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3,
        "cohesion": "10 kPa", "friction_angle": "30 deg"}  # fmt: skip
BANK = [[0, 12], [40, 12], [60, 4], [100, 4]]
DIP = [[0, 12], [40, 12], [52, 2.04], [54, 2.04], [60, 4], [100, 4]]


def bank(bottom: Any, table: Any, surface: Any = BANK) -> Config:
    strata = [{"name": "Sand", "bottom": {"elevation": bottom}, **SOIL}, {"name": "Clay", **SOIL}]
    return Config.parse({"name": "bank", "surface": surface, "base": {"elevation": -6.0}, "strata": strata,
                        "water": {"table": table}})  # fmt: skip


@pytest.mark.parametrize(
    ("bottom", "table", "surface"),
    [
        (
            2.0,
            [[0, 9], [59, 4.2], [100, 4.0]],
            BANK,
        ),  # 5.7 degrees before: a bend of the water half a metre in the bank
        (2.0, [[0, 8], [50, 7.9], [100, 7.9]], BANK),  # 2.7: the same of a pond
        ([[0, 0.84], [50, 1.21], [100, 0.14]], [[0, 7.77], [33.5, 1.01], [100, 1.56]], BANK),  # 1.7: 7 cm of clay dry
        ([[0, 4.5], [50, 1.0], [100, 1.37]], [[0, 2.2], [37, 4.5], [100, 2.76]], BANK),  # 4.4: 14 cm at the toe
        (2.0, 1.0, DIP),  # 4 cm of sand below a dip of the ground
    ],
)
def test_no_cell_is_a_sliver(bottom: Any, table: Any, surface: Any) -> None:
    ground = bank(bottom, table, surface)
    mesh = generate(ground.section, ground.mesh)
    angles = corner_angles(mesh.points, mesh.cells)
    assert np.abs(angles - 90.0).max() < 75.0


def test_pockets_that_water_cuts_off_are_of_the_other_half_and_weigh_next_to_nothing() -> None:
    """7 cm of dry clay over 19 m; the water table, and with it every pore pressure, stays where it was."""
    ground = bank([[0, 0.84], [50, 1.21], [100, 0.14]], [[0, 7.77], [33.5, 1.01], [100, 1.56]])
    assert [stratum.name for stratum in ground.section.strata] == ["Sand", "Sand, below water", "Clay"]
    assert ground.section.strata[2].density_seismic == pytest.approx(20e3 / 9.80665)
    assert ground.section.water_points()[1].tolist() == [33.5, 1.01]
    thin = bank([[0, 2.0], [100, 2.0]], [[0, 11.85], [40, 11.85], [60, 3.85], [100, 3.85]])  # 15 cm all over stay dry
    assert [stratum.name for stratum in thin.section.strata][:2] == ["Sand", "Sand, below water"]


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("contact", [3.5, 5.0, 5.5, 5.9])
def test_what_a_sliver_at_a_steep_face_leaves_is_ground(contact: float, mirrored: bool) -> None:
    """A face of 3 m leans by 1 cm, so that a contact comes out of it a few millimetres before the crest: the rest of
    the face was taken for base, where it is held, and a cut of γH/c = 3.83 stood at 4.2."""
    surface = [[0.0, 3.0], [6.0, 3.0], [6.01, 6.0], [12.0, 6.0]]
    if mirrored:
        surface = [[12.0 - x, z] for x, z in reversed(surface)]
    soil = {key: value for key, value in SOIL.items() if key != "density_saturated"}
    strata = [{"name": "Sand", "bottom": {"elevation": contact}, **soil}, {"name": "Clay", **soil}]
    section = Section.parse({"name": "cut", "surface": surface, "base": {"elevation": 0.0}, "strata": strata})
    mesh = triangulate(section, 1.0)
    assert np.all(mesh.points[np.unique(mesh.boundaries["base"]), 1] < 1e-6)
    assert np.all(mesh.points[np.unique(mesh.boundaries["surface"]), 1] > 2.99)
