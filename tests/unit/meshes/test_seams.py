"""Thin layers of free meshes get rows of cells between their lines, whatever ends they have."""

import numpy as np
import pytest

from meshes.gmsh_model import generate
from meshes.quality import corner_angles
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.random_sections import random_section

SOIL = {
    "youngs_modulus": "40 MPa",
    "poissons_ratio": 0.3,
    "density": "1.9 t/m^3",
    "density_saturated": "2.0 t/m^3",
    "cohesion": "5 kPa",
    "friction_angle": "30 deg",
}


def with_seam(thickness: float, bottom: list[list[float]]) -> Section:
    """Ground 18 m high with a face of 45 degrees, and a seam above ``bottom``."""
    top = [[x, z + thickness] for x, z in bottom]
    strata = [
        {"name": "above", "bottom": {"elevation": top}, **SOIL},
        {"name": "seam", "bottom": {"elevation": bottom}, **SOIL},
        {"name": "below", **SOIL},
    ]
    surface = [[0.0, 4.0], [20.0, 4.0], [30.0, 14.0], [60.0, 14.0]]
    return Section.parse({"name": "s", "surface": surface, "base": {"elevation": -4.0}, "strata": strata})


BELOW_THE_TOE = [[0.0, 2.0], [22.0, 2.0], [60.0, 5.2]]
OUT_OF_THE_FACE = [[0.0, -1.0], [15.0, -1.0], [60.0, 5.2]]


@pytest.mark.parametrize("thickness", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("bottom", [BELOW_THE_TOE, [[0.0, 9.0], [60.0, 9.0]], OUT_OF_THE_FACE])
def test_cells_of_a_seam_are_upright_and_as_thick_as_it_says(thickness: float, bottom: list[list[float]]) -> None:
    section = with_seam(thickness, bottom)
    mesh = generate(section, MeshSettings(method="free"))
    cells = mesh.cells[mesh.stratum == 1]
    assert mesh.stratum_areas() == pytest.approx(section.layering.areas(), rel=1e-9)
    assert corner_angles(mesh.points, cells).min() > 40.0  # the face is at 45 degrees to it
    assert np.median(corner_angles(mesh.points, cells).min(axis=1)) > 80.0
    heights = np.ptp(mesh.points[cells][..., 1], axis=1)
    assert len(cells) % 2 == 0
    assert np.median(heights) < 0.75 * thickness + 0.1  # two rows of it at least; lines that dip are higher


def test_a_kink_in_one_line_alone_is_a_point_of_both() -> None:
    """Their columns stand on corners of the line below: no cell has its angle in the middle of an edge."""
    section = with_seam(0.2, [[0.0, 2.0], [21.7, 2.0], [60.0, 5.2]])
    mesh = generate(section, MeshSettings(method="free"))
    points = mesh.points[np.unique(mesh.cells[mesh.stratum == 1])]
    above_kink = points[np.abs(points[:, 0] - 21.7) < 1e-9, 1]
    assert sorted(above_kink) == pytest.approx([2.0, 2.1, 2.2])


@pytest.mark.parametrize("number", [1, 20, 44])
def test_random_sections_with_seams_lost_their_narrow_cells(number: int) -> None:
    """Their smallest angles were 10.5, 8.4 and 8.0 degrees with seams meshed like any layer."""
    mesh = generate(random_section(number), MeshSettings(method="free"))
    assert corner_angles(mesh.points, mesh.cells).min() > 20.0
