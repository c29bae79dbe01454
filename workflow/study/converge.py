"""Studies convergence: the same slides with smaller discs, and with smaller time steps."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from meshes.errors import NoAnswerError
from workflow.config import Config
from workflow.results.answer import SectionLabel
from workflow.results.study import ConvergenceAnswer, Series
from workflow.run.store import Store
from workflow.stages.liquefaction import refuse_unless_liquefying
from workflow.study.ensemble import Ensemble, OnRow, TaskOutcome
from workflow.study.parts import PARTS
from workflow.study.study import task_of
from workflow.study.task import Numbers

RADIUS_RATIO = math.sqrt(2.0)  # of one radius to the next
RADII = (1.0, 1.0 / RADIUS_RATIO, 0.5)  # over the requested radius
STEPS = (1.0, 1.0 / RADIUS_RATIO, 0.5)  # over the requested time step
ORDERS = (0.5, 3.0)  # that a fit is believed to have


@dataclass(frozen=True)
class Fit:
    """Holds the extrapolation of a number to size zero.

    Attributes
    ----------
    limit : limit of the number at size zero
    order : order of convergence in the size; None if three values show none, so that a straight line is fitted
    remaining_error : relative error of the value of the smallest size, including the half width of its 95 % interval if
        the value is a mean over packings
    scatter : half width of the 95 % interval alone, as a share of the limit
    """

    limit: float
    order: float | None
    remaining_error: float
    scatter: float

    def converged(self, within: float) -> bool:
        """Return whether the remaining error is at most ``within``."""
        return self.remaining_error <= within

    def verdict(self, within: float) -> str:
        """Return the verdict on convergence in words."""
        if self.converged(within):
            return f"converged within {100.0 * self.remaining_error:.2g} %"
        message = f"not converged: the remaining error may be {100.0 * self.remaining_error:.2g} %"
        return f"{message}, {100.0 * self.scatter:.2g} % by the scatter of packings" if self.scatter > 0.0 else message


def fit(sizes: Sequence[float], values: Sequence[float], error: float = 0.0, least: float = 0.0) -> Fit:
    """Extrapolate values over three sizes, largest first, with a constant ratio.

    Richardson's extrapolation with the order of the three values (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413). If
    the three values scatter, or the order is not plausible, a straight line is fitted by least squares, and the error
    is at least the largest distance of a value from this line. ``error``: half width of the 95 % interval of the last
    value. ``least``: smallest number to which relative errors refer.
    """

    def share(value: float, whole: float) -> float:
        most = max(abs(whole), least)
        return value / most if most > 0.0 else math.inf if value > 0.0 else 0.0

    first, second, last = values
    ratio, early, late = sizes[0] / sizes[1], values[0] - values[1], values[1] - values[2]
    if first == second == last:
        return Fit(last, None, share(error, last), share(error, last))
    order = math.log(early / late) / math.log(ratio) if early * late > 0.0 else None
    if order is not None and ORDERS[0] <= order <= ORDERS[1]:
        limit = last - late / (ratio**order - 1.0)
        return Fit(limit, order, share(abs(last - limit) + error, limit), share(error, limit))
    slope, limit = np.polyfit(sizes, values, 1)
    off = float(np.abs(np.polyval((slope, limit), sizes) - values).max())
    away = max(abs(last - float(limit)), off)
    return Fit(float(limit), None, share(away + error, float(limit)), share(error, float(limit)))


SMALL_SLIDE = 0.1  # of the largest slide of its case: where a number is less, shares are taken of that
SLIDES = next(part for part in PARTS if part.name == "slide")


def run(
    config: Config, store: Store, within: float, ensemble: Ensemble, on_row: OnRow | None = None
) -> ConvergenceAnswer:
    """Compute slides with smaller discs and smaller time steps, and write section.toml and converge.json.

    Stored results are not computed again.

    Parameters
    ----------
    config : section and settings, with the largest radius and time step
    store : folder of the results
    within : largest remaining error of a converged number, as a share of its limit (-)
    ensemble : computes the runs
    on_row : function that is called after each run

    Returns
    -------
    Every number of the slides over the radius of the discs and over the time step, with its limit and verdict.

    Raises
    ------
    InputError : No stratum liquefies.
    NoAnswerError : No number has a value for all three radii, nor for all three time steps.
    """
    refuse_unless_liquefying(config.section)
    store.write_text("section.toml", config.to_toml())
    radius, step = config.dem.mean_radius(config.section), config.slide.step_of(config.dem.model)
    finer = [config.with_settings("dem", radius=radius * share).with_settings("slide", step=step) for share in RADII]
    at_radius = config.with_settings("dem", radius=radius)
    slower = [at_radius.with_settings("slide", step=step * share) for share in STEPS]
    rows = ensemble.rows([task_of(part, SLIDES, store) for part in (*finer, *slower)], on_row)
    over_radius = [radius * share for share in RADII], rows[: len(finer)]
    over_step = [step * share for share in STEPS], rows[len(finer) :]
    series = [*_series("radius", *over_radius, within), *_series("step", *over_step, within)]
    missing = tuple(dict.fromkeys(row.reason for row in rows if row.answer is None))
    if not series:
        raise NoAnswerError("; ".join(missing), "run this section once to see the reasons: noshiro run")
    answer = ConvergenceAnswer(
        section=SectionLabel.of(config.section),
        tolerance=within,
        converged=not missing and all(part.converged for part in series),
        missing=missing,
        series=tuple(series),
    )
    answer.write(store)
    return answer


def _series(over: str, sizes: Sequence[float], rows: Sequence[TaskOutcome[Numbers]], within: float) -> Iterator[Series]:
    """Yield every result of the slides as a series over the sizes of discs or time steps; nothing if a run has no
    answer."""
    answers = [row.answer for row in rows if row.answer is not None]
    if len(answers) < len(rows):
        return
    for name in answers[0].numbers:
        values = [numbers.numbers.get(name) for numbers in answers]
        known = [value for value in values if value is not None]
        if len(known) < len(values):
            continue
        halves = [numbers.errors.get(name) for numbers in answers]
        largest = answers[-1].numbers.get(f"{name.split('_')[0]}_slide_max_m") or 0.0
        fitted = fit(sizes, known, halves[-1] or 0.0, SMALL_SLIDE * abs(largest))
        yield Series(
            name=name, refined="radius" if over == "radius" else "step", sizes=tuple(sizes), values=tuple(known),
            half_ci95=tuple(halves), limit=fitted.limit, order=fitted.order, remaining_error=fitted.remaining_error,
            converged=fitted.converged(within), verdict=fitted.verdict(within),
        )  # fmt: skip
