"""The ground once strata have liquefied."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fem.continuum.liquefied_ground import LEAST_STRENGTH_RATIO, liquefied_section
from fem.limit_load.limit_load import weight_borne
from fem.settings import FemSettings
from meshes import generate
from meshes.section.liquefies import RemainingStrength
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support import SECTIONS
from tests.support.borings import bored
from tests.support.sections import analysed, layer
from workflow.config import Config


def test_what_is_left_of_a_stratum() -> None:
    """Loose sand from 0 to 6 m, water at 1 m: at its middle 1.9 t/m³ over 3 m less 2 m of water, 36.28 kPa. What is
    left in a place is a share of the stress there; gravity acts on 0.9 t/m³, 26.48 kPa in the middle."""
    section = analysed(bored())
    stress = section.section.cohesion_field.mean_effective_stress(0)
    assert stress == pytest.approx(GRAVITY * 3.0 * 900.0)
    residual = liquefied_section(section.section, {0: RemainingStrength(0.0, 0.0, 0.1)})
    strata = residual.strata[0]
    assert (strata.cohesion, strata.strength_ratio, strata.friction_angle, strata.poissons_ratio) == (
        0.0,
        0.1,
        0.0,
        0.49,
    )
    assert residual.cohesion_field.means()[0].cohesion == pytest.approx(0.1 * GRAVITY * 3.0 * 900.0)
    top, middle = np.array([[50.0, -1.0], [50.0, -3.0]]), np.array([0, 0])
    assert residual.cohesion_field.at(top, top, middle) == pytest.approx([90.0 * GRAVITY, 270.0 * GRAVITY])
    half = liquefied_section(section.section, {0: RemainingStrength(1.0, 0.5, 0.0)}).strata[0]
    assert math.tan(half.friction_angle) == pytest.approx(0.5 * math.tan(math.radians(32.0)))
    nothing = liquefied_section(section.section, {0: RemainingStrength(0.0, 0.0, 0.0)}).strata
    assert nothing[0].cohesion == pytest.approx(LEAST_STRENGTH_RATIO * stress)
    assert nothing[1] == section.section.strata[1]


def test_what_is_borne_does_not_hang_on_rounding() -> None:
    """S-13 without any strength in its liquefied layers, next to rock: some factorisations break down, whichever."""
    config = Config.load(SECTIONS / "s13.toml")
    gone = {k: RemainingStrength(0.0, 0.0, 0.0) for k, s in enumerate(config.section.strata) if s.liquefies_in}
    ground = liquefied_section(config.section, gone)
    mesh, rng = generate(ground, config.mesh), np.random.default_rng(0)
    seismic = [mesh.points * (1.0 + 1e-13 * size * rng.standard_normal(mesh.points.shape)) for size in (0.0, 1.0, 1.0)]
    borne = [weight_borne(ground, replace(mesh, points=points), config.fem) for points in seismic]
    assert borne == pytest.approx([borne[0]] * 3, rel=5e-3)
    assert 0.09 < borne[0] < 0.13


def test_a_cohesionless_face_that_is_too_steep_is_no_ground_that_bears_nothing() -> None:
    """Sand of φ = 22° below 15° stands but for a short face of 37° at its crest, which bears no share of its weight."""
    sand = layer("sand", cohesion="0 kPa", friction_angle="22 deg")
    surface = [[0, 12], [20, 12], [22, 10.5], [61, 0], [80, 0]]
    section = Section.parse({"name": "face", "surface": surface, "base": {"elevation": -6}, "strata": [sand]})
    fem = FemSettings(sides="smooth")
    assert weight_borne(section, generate(section, MeshSettings(size=3.0)), fem) >= 1.0
    steep = Section.parse({"name": "all", "surface": [[0, 12], [20, 12], [40, 0], [60, 0]],
                           "base": {"elevation": -6}, "strata": [sand]})  # fmt: skip
    assert weight_borne(steep, generate(steep, MeshSettings(size=3.0)), fem) < 1.0
