"""Ground with strong zones: the failure of one face of two, by symmetry."""

import numpy as np
import pytest
from mpi4py import MPI

from fem.continuum.strength import with_davis_strength
from fem.search.strength_reduction import limit_load_safety_factor
from fem.search.strong_zones import StrongZone, with_strong_zones
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings


def ridge(left: float) -> Section:
    """A ridge 8 m high with faces of 1:1 to the right and 1 : ``left`` to the left."""
    foot = 40.0 - 8.0 * left
    return Section.parse(
        {
            "name": "ridge",
            "surface": [[0, 0], [foot, 0], [40, 8], [52, 8], [60, 0], [100, 0]],
            "base": {"elevation": -6},
            "strata": [
                {
                    "name": "Clay", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": "2 t/m^3",
                    "cohesion": "20 kPa", "friction_angle": "15 deg",
                }
            ],
        }
    )  # fmt: skip


def factor(section: Section) -> float:
    settings = FemSettings(flow="associated", sides="smooth")
    mesh = generate(section, MeshSettings(size=1.2))
    return limit_load_safety_factor(section, mesh, settings, 0.0, MPI.COMM_SELF, 1.0).factor


def test_with_one_of_two_like_faces_strengthened_the_other_one_fails_at_the_same_factor() -> None:
    """The faces do not touch each other's mechanism: the crest is 12 m wide."""
    both = ridge(1.0)
    strengthened = with_strong_zones(both, [StrongZone(0.0, 40.0)])
    assert factor(strengthened) == pytest.approx(factor(both), rel=0.02)


def test_with_the_steep_face_strengthened_the_flat_one_fails() -> None:
    """The flat face of 1:2 stands with a larger factor, the same as between two flat faces."""
    unlike, steep = ridge(2.0), ridge(1.0)
    flat = factor(with_strong_zones(unlike, [StrongZone(52.0, 100.0)]))
    assert flat > 1.15 * factor(steep)
    assert factor(unlike) == pytest.approx(factor(steep), rel=0.02)


def test_a_strong_zone_keeps_its_weight_and_its_water() -> None:
    section = ridge(1.0)
    strengthened = with_strong_zones(section, [StrongZone(10.0, 30.0, 2.0)])
    mass = [
        float(np.dot(each.layering.areas(), [stratum.density_ordinary for stratum in each.strata]))
        for each in (section, strengthened)
    ]
    assert mass[1] == pytest.approx(mass[0])
    assert strengthened.layering.areas()[0] == pytest.approx(40.0, rel=0.01)  # 20 m x 2 m


def test_davis_strength_without_dilation() -> None:
    """With ψ = 0, Davis's factor is cos φ: c cos φ, and sin φ for tan φ."""
    phi = np.radians(15.0)
    (soil,) = with_davis_strength(ridge(1.0)).strata
    assert soil.cohesion == pytest.approx(20e3 * np.cos(phi))
    assert np.tan(soil.friction_angle) == pytest.approx(np.sin(phi))
