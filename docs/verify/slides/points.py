"""Predicts a known slide by material points, with the ground, strength and shaking of the prediction by discs."""

from functools import lru_cache

import numpy as np

from dem.settings import SlideSettings
from docs.verify.slides.case import Column, Ground, SlideCase, UniformSlope
from docs.verify.slides.point_columns import run_out_of_column
from docs.verify.slides.shaking import shaking_of_slope
from docs.verify.slides.sliding import Sliding, number_of
from fem.mpm import PointSlide, PointSlider, SlideProgramme, ground_of
from fem.mpm.slide import DECAY_RATES
from meshes.section.section import Section
from workflow.config import Config
from workflow.stages.mpm import PointRun, at_rest, slide_of_points

# Cells: at least, over the layer that liquefies and over its crust; along the slope; of firm ground below.
CELLS_ACROSS, CELLS_IN_CRUST, CELLS_ALONG, CELLS_BELOW = 6, 2, 4, 3
YOUNG = 1e9  # Pa: blocks are rigid, as far as the speed of waves allows
POISSON = 0.33
TIME_BEFORE_SHAKING = 5.0  # s from liquefaction to shaking: ground without a strain potential has come to rest
FOLLOWED_TIME = 60.0  # s after that, until which a slope is followed


def by_points(case: SlideCase) -> float | None:
    """Return the prediction of the measured number by material points; None for the front of a flow, and for a section
    that does not name material points among its methods."""
    config, wanted = case.config, case.known.problem
    if isinstance(wanted, Column):
        return round(run_out_of_column(wanted), 4)
    if isinstance(wanted, UniformSlope):
        return round(_along_uniform_slope(case, wanted), 4)
    if config is None or not isinstance(wanted, Ground) or "mpm" not in config.slide.methods or wanted.at == "front":
        return None
    slide = _computed_slide(Sliding(config), number_of(wanted.case, config.cases))
    if wanted.at == "crest":
        return round(float(slide.surface_before[:, 1].max() - slide.surface_after[:, 1].max()), 4)
    if wanted.at == "largest":
        return round(slide.slide_max, 4)
    return round(float(np.interp(wanted.at, slide.surface_before[:, 0], slide.slide[-1])), 4)


@lru_cache(maxsize=8)
def _computed_slide(sliding: Sliding, number: int) -> PointSlide:
    return governing_slide_of_points(sliding.config, number)


def governing_slide_of_points(config: Config, number: int) -> PointSlide:
    """Compute a slide by material points with the governing damping rate of unresolved velocities."""
    return slide_of_points(PointRun(config, at_rest(config)[0], number, DECAY_RATES[0]), lambda _: None)


def _along_uniform_slope(case: SlideCase, wanted: UniformSlope) -> float:
    """Return the slide of the crust (m) along a slope with periodic sides."""
    section = uniform_section(wanted)
    cells = CELLS_ALONG * round(float(section.layering.areas().sum()) / (CELLS_ALONG * cell_size(wanted) ** 2))
    slider = PointSlider(ground_of(section, cells, "periodic"), 1)
    slider.settle()
    time, acceleration = shaking_of_slope(wanted, case.folder)
    onset = SlideSettings().onset_of("soil")
    time, acceleration = np.append(0.0, onset + TIME_BEFORE_SHAKING + time), np.append(0.0, acceleration)
    last = float(time[-1])
    slide = slider.run(
        SlideProgramme(
            lambda t: np.interp(t, time, acceleration, right=0.0), {1: 0.0}, {1: wanted.left.remains_of(section, 1)},
            onset, last, last + FOLLOWED_TIME,
        )
    )  # fmt: skip
    return float(slide.slide[-1].mean() / np.cos(wanted.angle))


def cell_size(wanted: UniformSlope) -> float:
    """Return the size of the cells (m) for a uniform slope."""
    weak, crust = wanted.thickness
    return min(weak / CELLS_ACROSS, crust / CELLS_IN_CRUST)


def uniform_section(wanted: UniformSlope) -> Section:
    """Return a uniform slope as a section with periodic sides: the crust, the layer that liquefies, and firm ground,
    from the surface down."""
    cell, upright, fall = cell_size(wanted), 1.0 / np.cos(wanted.angle), np.tan(wanted.angle)
    weak, crust = (thickness * upright for thickness in wanted.thickness)
    width, top = CELLS_ALONG * cell, weak + crust + CELLS_BELOW * cell
    soil = {
        "density_ordinary": wanted.density,
        "density_seismic": wanted.density,
        "youngs_modulus": YOUNG,
        "poissons_ratio": POISSON,
        "cohesion": 1e3,
        "friction_angle": wanted.friction_angle,
    }
    data = {
        "name": "uniform_slope",
        "surface": [[0.0, top], [width, top - fall * width]],
        "base": {"depth": top},
        "strata": [
            soil | {"name": "crust", "bottom": {"depth": crust}},
            soil | {"name": "liquefies", "bottom": {"depth": crust + weak}, "liquefies_in": [1]},
            soil | {"name": "firm", "cohesion": 1e7},
        ],
    }
    if wanted.water is not None:
        depth = wanted.water * upright
        data["water"] = {"table": [[0.0, top - depth], [width, top - depth - fall * width]]}
    return Config.parse(data).section
