"""The study of convergence: the same slides with smaller discs, and with smaller steps of time."""

from collections.abc import Iterator, Sequence

from meshes.errors import InputError, NoAnswerError
from workflow.config import Config
from workflow.results.answer import SectionLabel
from workflow.results.convergence import ConvergenceAnswer, Series
from workflow.run.store import Store
from workflow.study.convergence import RADII, STEPS, fit
from workflow.study.ensemble import Ensemble, OnRow, Row
from workflow.study.parts import PARTS
from workflow.study.sample import Numbers
from workflow.study.study import task_of

SMALL = 0.1  # of the largest slide of its case: where a number is less, shares are taken of that
SLIDES = next(part for part in PARTS if part.name == "slide")


def run(
    config: Config, store: Store, within: float, ensemble: Ensemble, on_row: OnRow | None = None
) -> ConvergenceAnswer:
    """Compute what is missing, and leave section.toml and converge.json.

    Raises InputError where nothing liquefies, NoAnswerError where fewer runs than three of a kind have an answer.
    """
    if not config.section.liquefies:
        raise InputError(
            config.section.name, ["no stratum liquefies in any case; expected liquefies_in in one at least"]
        )
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
        raise NoAnswerError("; ".join(missing), "look at one run of this section first: noshiro run")
    answer = ConvergenceAnswer(
        section=SectionLabel.of(config.section),
        within=within,
        converged=not missing and all(part.converged for part in series),
        missing=missing,
        series=tuple(series),
    )
    answer.write(store)
    return answer


def _series(over: str, sizes: Sequence[float], rows: Sequence[Row[Numbers]], within: float) -> Iterator[Series]:
    """Every number of the slides over some sizes; none where a run has no answer."""
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
        fitted = fit(sizes, known, halves[-1] or 0.0, SMALL * abs(largest))
        yield Series(
            name=name, over="radius" if over == "radius" else "step", sizes=tuple(sizes), values=tuple(known),
            half_ci95=tuple(halves), limit=fitted.limit, order=fitted.order, left=fitted.left,
            converged=fitted.converged(within), verdict=fitted.verdict(within),
        )  # fmt: skip
