"""Predicts a known slide by discs: one number and one profile per packing."""

import time
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from dem.laboratory.soil_contacts import soil_contacts, soil_layers
from dem.model import DiscModel
from dem.search.deposit import deposit
from dem.slides.column import G, SoilColumn
from dem.slides.liquefaction import Slider
from dem.slides.runout import deposit_profile, loose_share, run_out
from dem.slides.slide import Slide
from dem.slides.until_rest import run_until_rest
from docs.verify.slides import uniform_slope
from docs.verify.slides.case import Column, Ground, SlideCase, UniformSlope
from docs.verify.slides.record import Line, SlideAnswer
from docs.verify.slides.shaking import shaking_of_slope
from docs.verify.slides.sliding import Sliding, number_of
from meshes.errors import InputError, NoAnswerError
from workflow.stages.discs_at_rest import sides_of_discs
from workflow.stages.shaking import shaking_of

STABLE_WEIGHT_RATIO = 3.0  # gamma H / s_u at which a slow loss of strength begins; columns stand below 3.83
GRAVITY_STEPS = 24  # of gravity in a slow loss of strength, each of a unit sqrt(H / g)
SPREADING_UNITS = 12.0  # of that, after it, at most
PROFILE_POINTS = 60  # of a profile that is kept

SlideNumbers = tuple[float, float, bool, Line, Line]  # value, loose share, at rest, surface before and after


def predict(case: SlideCase, seeds: int | None = None) -> SlideAnswer:
    """Predict a known slide by discs.

    Parameters
    ----------
    case : the known slide
    seeds : number of packings; None for the number in the case

    Returns
    -------
    The predictions; ``failure`` has the reason if there is none.
    """
    started = time.process_time()
    find = _FINDERS[type(case.known.problem)]
    predictions: list[SlideNumbers] = []
    failure = ""
    for seed in range(seeds or case.known.seeds):
        try:
            predictions.append(find(case, case.known.problem, seed))
        except (NoAnswerError, InputError, ValueError) as error:
            failure = f"packing {seed}: {error}"
            break
    seconds = round(time.process_time() - started, 1)
    if failure or not predictions:
        return SlideAnswer(case.name, seconds=seconds, failure=failure)
    values, loose, rested, before, after = zip(*predictions, strict=True)
    return SlideAnswer(
        case.name, tuple(round(float(v), 4) for v in values), tuple(round(float(v), 4) for v in loose), rested,
        before[0], after[0], seconds,
    )  # fmt: skip


def _thinned_points(points: np.ndarray) -> Line:
    """Return at most `PROFILE_POINTS` of the points, rounded to centimetres."""
    step = max(1, len(points) // PROFILE_POINTS)
    return tuple((round(float(x), 2), round(float(z), 2)) for x, z in points[::step])


def _column(case: SlideCase, wanted: Column, seed: int) -> SlideNumbers:
    """Return the run-out of a column over the width of sand or the height of clay."""
    weight = wanted.density * G * wanted.height
    clay = wanted.weight_over_strength > 0.0
    su = weight / wanted.weight_over_strength if clay else 0.0
    contacts = soil_contacts(su, wanted.friction_angle, 0.5 * weight, wanted.rigidity * su if clay else None)
    column = SoilColumn(
        wanted.width, wanted.height, wanted.radius,
        lambda voids: [contacts.discs(case.name, wanted.density, wanted.radius, voids)], seed=seed, reach=wanted.reach,
    )  # fmt: skip
    column.settle()
    before = deposit_profile(column.model)
    rested = _strength_is_lost_slowly(column, wanted) if wanted.slowly else column.release().rested
    out = run_out(column.model)
    ran = (out.front - wanted.width) / (wanted.height if clay else wanted.width)
    return ran, out.loose, rested, _thinned_points(before), _thinned_points(deposit_profile(column.model))


def _strength_is_lost_slowly(column: SoilColumn, wanted: Column) -> bool:
    """Increase gravity from a share at which the column stands to its full value, which is equivalent to a slow loss of
    strength."""
    model = column.model
    first, *others = np.geomspace(min(1.0, STABLE_WEIGHT_RATIO / wanted.weight_over_strength), 1.0, GRAVITY_STEPS)
    model.gravity = (0.0, -G * float(first))
    unit = column.unit / float(np.sqrt(first))
    run_until_rest(model, still=1e-3 * column.width, longest=SPREADING_UNITS * unit, every=0.5 * unit)
    column.release(longest=SPREADING_UNITS)
    for share in others:
        model.gravity = (0.0, -G * float(share))
        unit = column.unit / float(np.sqrt(share))
        run_until_rest(model, still=1e-9, longest=unit, every=unit)
    return run_until_rest(
        model, still=1e-3 * column.width, longest=SPREADING_UNITS * column.unit, every=0.5 * column.unit
    ).rested


def _uniform_slope(case: SlideCase, wanted: UniformSlope, seed: int) -> SlideNumbers:
    """Return the slide of the crust (m)."""
    stress = 0.5 * wanted.density * G * sum(wanted.thickness)
    sand = soil_contacts(0.0, wanted.friction_angle, stress)

    def layers(voids: float) -> list[Any]:
        return [sand.discs(name, wanted.density, wanted.radius, voids) for name in ("liquefies", "crust")]

    slope = uniform_slope.UniformSlope(
        wanted.angle, wanted.thickness, wanted.radius, layers, length=wanted.length, seed=seed, water=wanted.water
    )
    before = deposit_profile(slope.model)
    crust, start = slope.above(0), slope.model.x.copy()
    slope.liquefy([0], wanted.left)
    if not wanted.left.strain_potential:
        start = slope.model.x.copy()
    response = slope.shake(*shaking_of_slope(wanted, case.folder))
    after = deposit_profile(slope.model)
    slid = float((slope.model.x - start)[crust].mean())
    return slid, loose_share(slope.model), response.rest.rested, _thinned_points(before), _thinned_points(after)


def _section(case: SlideCase, wanted: Ground, seed: int) -> SlideNumbers:
    """Return the slide (m) at a place of the surface, by discs with the strengths of the section and without a fitted
    factor."""
    config = case.config
    if config is None:
        raise ValueError(f"{case.name}: a section is wanted")
    start, end, slide = _computed_slide(Sliding(config), number_of(wanted.case, config.cases), seed)
    value = _measured_quantity(wanted, np.array(slide.slide_along), slide.rows[-1].slide_max_m, start, end)
    before, after = np.array(slide.surface_before), np.array(slide.surface_after)
    return value, slide.loose_share, slide.settled, _thinned_points(before), _thinned_points(after)


@lru_cache(maxsize=8)
def _computed_slide(sliding: Sliding, number: int, seed: int) -> tuple[DiscModel, DiscModel, Slide]:
    """Return the discs at rest before and after the slide, and the slide."""
    config = sliding.config
    soil = soil_layers(config.section)
    settings = config.dem.changed(seed=seed)
    lies = deposit(config.section, settings, soil, periodic=sides_of_discs(config) == "periodic")
    strata = [k for k, stratum in enumerate(config.section.strata) if number in stratum.liquefies_in]
    if not strata:
        raise ValueError("nothing liquefies in it")
    shaking = shaking_of(config, strata)
    slider = Slider(
        lies.settled, lies.ground, strata, config.cases[number - 1], config.slide, shaking=shaking,
        free_sides=config.sides_of_slides == "free-field",
    )  # fmt: skip
    slide = slider.run()
    if not slide.rows or slide.reason.startswith("stopped"):
        raise ValueError(slide.reason)
    return slider.start, slider.model, slide


def _measured_quantity(wanted: Ground, along: np.ndarray, largest: float, start: DiscModel, end: DiscModel) -> float:
    """Return the number (m) that was measured in the field, from the slides and profiles of the discs."""
    if wanted.at == "largest":
        return largest
    if wanted.at == "crest":
        return float(deposit_profile(start)[:, 1].max() - deposit_profile(end)[:, 1].max())
    if wanted.at == "front":
        free = ~start.fixed
        moved = np.abs(end.x - start.x)[free & (np.abs(end.x - start.x) > start.radius)]
        return float(np.quantile(moved, 0.98)) if len(moved) else 0.0
    return float(np.interp(wanted.at, *along.T))


_FINDERS: dict[type, Callable[[SlideCase, Any, int], SlideNumbers]] = {
    Column: _column,
    UniformSlope: _uniform_slope,
    Ground: _section,
}
