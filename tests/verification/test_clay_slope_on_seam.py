"""A slope of clay slides on a seam that has lost its strength: discs beside material points, and the slope after it."""

from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from dem.laboratory.soil_contacts import soil_layers
from dem.search.deposit import deposit
from dem.slides.liquefaction import Slider
from dem.slides.slide import Slide
from fem.mpm.slide import DECAY_RATES
from fem.search.strength_reduction import limit_load_safety_factor
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from workflow.config import Config
from workflow.stages.mpm import PointRun, at_rest, slide_of_points

SOIL = {"density": "1.9 t/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.33, "friction_angle": 0}
SURFACE = [[0.0, 12.0], [40.0, 12.0], [64.0, 0.0], [110.0, 0.0]]
PACKINGS = range(4)
SEAM, CLAY = "24.7 kPa", "40 kPa"  # a factor of safety of 0.91 by finite elements


def slope(surface: list[list[float]], seam: dict[str, object]) -> dict[str, object]:
    """The slope of 12 m, 1:2, whose seam lies 2 to 5 m below its toe."""
    strata = [
        SOIL | {"name": "Clay", "cohesion": CLAY, "bottom": {"elevation": -2.0}},
        SOIL | {"name": "Seam", "bottom": {"elevation": -5.0}} | seam,
        SOIL | {"name": "Firm", "cohesion": "80 kPa", "friction_angle": "38 deg"},
    ]
    return {"name": "slope", "surface": surface, "base": {"elevation": -8.0}, "strata": strata}


@cache
def config() -> Config:
    liquefies = {"cohesion": 0, "friction_angle": "30 deg", "liquefies_in": [1]}
    case = {"name": "weak", "residual_strength": SEAM}
    by_weight = {"kh": 0.0, "duration": 20.0, "seeds": [], "cases": [case]}
    return Config.parse(slope(SURFACE, liquefies) | {"slide": by_weight})


def safety_factor(surface: list[list[float]]) -> float:
    section = Section.parse(slope(surface, {"cohesion": SEAM}))
    settings = FemSettings(flow="associated", accuracy=0.0, sides="smooth")
    return limit_load_safety_factor(
        section, generate(section, MeshSettings(size=1.0)), settings, 0.0, MPI.COMM_SELF
    ).factor


@cache
def slid(seed: int) -> tuple[Slider, Slide]:
    """The slide of a packing of discs, at its end."""
    section = config().section
    lies = deposit(section, config().dem.changed(seed=seed), soil_layers(section))
    slider = Slider(lies.settled, lies.ground, [1], config().cases[0], config().slide)
    return slider, slider.run()


@pytest.mark.slow
def test_packings_of_discs_slide_equally_far_in_the_mean() -> None:
    """Four packings: 1.36, 1.57, 2.15 and 1.55 m."""
    slides = [slid(seed)[1].rows[-1].slide_max_m for seed in PACKINGS]
    assert np.mean(slides) == pytest.approx(1.75, rel=0.1)
    assert np.std(slides, ddof=1) < 0.25 * np.mean(slides)


@pytest.mark.slow
@pytest.mark.parametrize("seed", PACKINGS)
def test_discs_slide_as_far_as_a_slope_without_equilibrium_has_to(seed: int) -> None:
    """From a factor of safety of 0.91 to one of 1.0 to 1.1: a block that loses no energy but by its strength comes to
    rest as far above 1 as it began below. The wedge behind the crest falls by half of the slide of the slope."""
    slider, slide = slid(seed)
    assert slide.settled
    start, free = slider.start, ~slider.start.fixed
    x, z = slider.ground.to_section(start.x, start.z)
    sunk = (start.z - slider.model.z)[free & (z > 10.0) & (x > 28.0) & (x < 38.0)]
    assert sunk.mean() > 0.4 * slide.rows[-1].slide_max_m
    at = np.arange(0.0, 110.1, 2.5)
    before, after = (np.interp(at, *np.array(line).T) for line in (slide.surface_before, slide.surface_after))
    moved = np.interp(at, *np.array(SURFACE).T) + after - before
    assert safety_factor(SURFACE) == pytest.approx(0.91, abs=0.01)
    assert 0.99 < safety_factor([[float(x), round(float(z), 2)] for x, z in zip(at, moved, strict=True)]) < 1.13


@pytest.mark.slow
def test_material_points_slide_as_far_as_discs_within_a_third() -> None:
    """2.3 m in cells of 0.39 m, and 2.0 m by 11,000 discs: finer models of both kinds come closer to each other."""
    coarse = config().changed(slide=config().slide.changed(mpm_cells=10_000))
    slide = slide_of_points(PointRun(coarse, at_rest(coarse)[0], 1, DECAY_RATES[0]), lambda *_: None)
    assert slide.slide_max == pytest.approx(2.03, rel=0.33)
