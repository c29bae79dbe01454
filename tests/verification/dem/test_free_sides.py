"""Sides beside ground that continues: a gentle slope between them slides as an endless one does."""

import numpy as np
import pytest

from dem.engine.engine import Engine
from dem.ground import Ground
from dem.laboratory.soil_contacts import soil_layers
from dem.model import DiscModel
from dem.search.deposit import deposit
from dem.settings import DemSettings
from dem.slides.free_sides import FreeSides
from dem.slides.liquefaction import Slider
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from tests.support.ground_with_a_step import ground_with_a_step
from workflow.config import Config

WIDTH, FALL = 60.0, 0.03  # m, -
DENSITY = 1900.0  # kg/m³


def crust_slide(sides: str, elements: int, seed: int = 0) -> float:
    """Mean slide (m) of the crust of a slope of 3 % on 2.5 m of sand that strains by 30 %, without shaking."""
    soil = {
        "density": "1.9 t/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.33, "cohesion": "2 kPa",
        "friction_angle": "33 deg",
    }  # fmt: skip
    config = Config.parse({
        "name": "gentle",
        "surface": [[0.0, 0.0], [WIDTH, -FALL * WIDTH]],
        "base": {"depth": 7.0},
        "strata": [
            soil | {"name": "crust", "bottom": {"depth": 2.0}},
            soil | {"name": "loose", "bottom": {"depth": 4.5}, "liquefies_in": [1]},
            soil | {"name": "firm"},
        ],
        "fem": {"sides": sides},
        "dem": {"elements": elements, "seed": seed},
        "slide": {"kh": 0.0, "duration": 90.0, "cases": [{"residual_strength": "6 kPa", "strain_potential": 0.3}]},
    })  # fmt: skip
    at_rest = deposit(config.section, config.dem, soil_layers(config.section), periodic=sides == "periodic")
    slider = Slider(
        at_rest.settled, at_rest.ground, [1], config.cases[0], config.slide, free_sides=sides == "free-field"
    )
    assert slider.run().settled
    crust = (slider.model.layer == 0) & ~slider.model.fixed
    return float((slider.model.x - slider.start.x)[crust].mean())


def slide_at_a_step(width: float) -> np.ndarray:
    """Slides (m) at the crest and at the toe of a step in gentle ground of some width (m) on both sides of it."""
    config = ground_with_a_step(width, dem={"elements": round(7.0 * (2.0 * width + 4.0))})
    at_rest = deposit(config.section, config.dem, soil_layers(config.section))
    slider = Slider(at_rest.settled, at_rest.ground, [1], config.cases[0], config.slide, free_sides=True)
    along = np.array(slider.run().slide_along)
    return np.interp([-3.0, 7.0], *along.T)


def test_a_slide_does_not_depend_on_how_far_the_section_reaches() -> None:
    """3.23 and 3.05 m with 15 m of ground on both sides of a step, 3.10 and 2.95 m with 90 m; with walls that hold all
    motion back 1.18 and 0.99 m with 15 m."""
    assert slide_at_a_step(15.0) == pytest.approx(slide_at_a_step(90.0), rel=0.15)


def test_a_slide_that_moves_a_wall_as_far_as_it_can_ends_there() -> None:
    """Under Kh = 0.5 the ground would pile up at the right side, and flow back."""
    config = ground_with_a_step(15.0, dem={"elements": 240})
    config = config.changed(slide=config.slide.changed(kh=0.5, kh_seconds=6.0))
    at_rest = deposit(config.section, config.dem, soil_layers(config.section))
    slide = Slider(at_rest.settled, at_rest.ground, [1], config.cases[0], config.slide, free_sides=True).run()
    assert slide.stopped_by == "right"
    assert "right side" in slide.reason
    assert not slide.settled
    assert slide.rows[-1].slide_max_m > 5.0
    assert np.min(slide.slide) > -1.0


@pytest.mark.slow
def test_ground_between_free_sides_slides_as_an_endless_slope() -> None:
    """0.91, 0.74 m in two packings, and 0.91, 0.95 m of an endless slope; 0.32, 0.54 m in a box."""
    free, endless, box = (
        [crust_slide(sides, 500, seed) for seed in (0, 1)] for sides in ("free-field", "periodic", "fixed")
    )
    assert np.mean(free) == pytest.approx(np.mean(endless), rel=0.15)
    assert np.mean(box) < 0.6 * np.mean(endless)


@pytest.mark.slow
def test_level_ground_between_free_sides_does_not_drift() -> None:
    """0.15 m, and 0.43 m in another packing; 0.6 and 1.0 m under the pressure of the discs nearest to each side."""
    soil = {"density": "1.9 t/m^3", "youngs_modulus": "17 MPa", "poissons_ratio": 0.33, "friction_angle": "33 deg"}
    config = Config.parse({
        "name": "level",
        "surface": [[0.0, 0.0], [60.0, 0.0]],
        "base": {"depth": 13.0},
        "strata": [
            soil | {"name": "crust", "cohesion": "2 kPa", "bottom": {"depth": 2.0}},
            soil | {"name": "loose", "cohesion": 0, "bottom": {"depth": 11.0}, "liquefies_in": [1]},
            soil | {"name": "firm", "cohesion": 0},
        ],
        "fem": {"sides": "free-field"},
        "dem": {"elements": 600},
        "slide": {
            "kh": 0.3, "kh_cycles": 8.0, "kh_period": 0.6, "duration": 25.0,
            "cases": [{"residual_strength": "8 kPa", "strain_potential": 0.45}],
        },
    })  # fmt: skip
    at_rest = deposit(config.section, config.dem, soil_layers(config.section))
    slider = Slider(at_rest.settled, at_rest.ground, [1], config.cases[0], config.slide, free_sides=True)
    slider.run()
    crust = (slider.model.layer == 0) & ~slider.model.fixed
    drift = float((slider.model.x - slider.start.x)[crust].mean())
    assert abs(drift) < 0.3


@pytest.fixture(scope="module")
def level() -> tuple[DiscModel, Ground]:
    """Level ground 6 m deep, of which the upper 4 m liquefy."""
    soil = {
        "density": f"{DENSITY} kg/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "cohesion": "2 kPa",
        "friction_angle": "33 deg",
    }  # fmt: skip
    section = Section.parse({
        "name": "level", "surface": [[0.0, 0.0], [12.0, 0.0]], "base": {"depth": 6.0},
        "strata": [
            soil | {"name": "loose", "bottom": {"depth": 4.0}, "liquefies_in": [1]},
            soil | {"name": "firm"},
        ],
    })  # fmt: skip
    at_rest = deposit(section, DemSettings(elements=150), soil_layers(section))
    return at_rest.settled, at_rest.ground


def test_sides_carry_the_pressure_at_rest_down_to_the_lowest_stratum_that_liquefies(
    level: tuple[DiscModel, Ground],
) -> None:
    """γ z²/2 of ground that liquefies, before and after, and K_0 γ z²/2, K_0 = ν / (1 - ν), of ground that does not."""
    sides, dry = FreeSides(*level, [0]), FreeSides(*level, [0], None)
    weight = sides.heavier * DENSITY * GRAVITY * 4.0**2 / 2.0
    assert sides.heavier == pytest.approx(1.0, abs=0.06)
    for name in ("left", "right"):
        wet, strips = ([strip for strip in s.strips if strip.side == name] for s in (sides, dry))
        assert sum(strip.at_rest for strip in strips) == pytest.approx(0.3 / 0.7 * weight, rel=1e-6)
        assert sum(strip.at_rest for strip in wet) == pytest.approx(weight, rel=1e-6)
        assert sum(strip.liquefied for strip in wet) == pytest.approx(weight, rel=1e-6)
    left, right = ([strip.liquefied for strip in sides.strips if strip.side == name] for name in ("left", "right"))
    assert left == pytest.approx(right, rel=1e-6)  # whatever discs lie there: under a difference level ground drifts


def test_a_side_where_nothing_liquefies_stays_a_wall(level: tuple[DiscModel, Ground]) -> None:
    sides = FreeSides(*level, [])
    assert sides.strips == []
    assert sides.stopped(level[0]) == {"left", "right"}


def test_walls_relieve_the_ground_of_more_than_the_pressure_at_rest(level: tuple[DiscModel, Ground]) -> None:
    """The packing presses harder against its box; released, it does not any more, and hardly moves."""
    model, ground = level
    sides = FreeSides(model, ground, [0])
    released = sides.release(model)
    assert sides.stopped(released) == set()
    moved = np.abs(released.x - model.x)[~model.fixed].max()
    assert moved < 0.1 * 2.0 * ground.radius
    before = released.x.copy()
    Engine(energies=False).run(released, 0.5)
    assert np.abs(released.x - before).max() < 0.02 * 2.0 * ground.radius
