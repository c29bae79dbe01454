"""Writes the page of a study: the samples, the answers, and the numbers that the answers depend on, with the
pictures."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from meshes.section.sentences import counted
from workflow.config import Config
from workflow.estimates.estimate import flow_words
from workflow.report.captions import collect
from workflow.report.numbers import number
from workflow.report.templates import templates
from workflow.results.cases import Spread
from workflow.results.study import WORDS, Result, StudyAnswer
from workflow.run.store import Store
from workflow.uncertain.distribution import Distribution
from workflow.uncertain.settings import SamplingMethod

FILE = "study.html"
METHODS: Mapping[SamplingMethod, str] = {
    "sobol": "a scrambled Sobol' sequence",
    "latin": "a Latin hypercube",
    "saltelli": "Saltelli's design for Sobol' indices",
}
LEAST_MEDIAN = 5e-4  # a smaller median is 0 in the digits of a sentence
FEWEST_SAMPLES = 20  # samples from which on one of them is expected beyond 5 %
RANDOM_FIELDS = (
    "A stratum has one strength in every sample: fields of strength that vary at random within a stratum are not part "
    "of this program."
)


def write_page(config: Config, answer: StudyAnswer, store: Store) -> Path:
    """Write study.html, one file with all pictures in it.

    Parameters
    ----------
    config : section, and its uncertain numbers
    answer : statistics of the samples
    store : folder of the study, with its pictures

    Returns
    -------
    Path of study.html.
    """
    text = (
        templates()
        .get_template("study.html.jinja")
        .render(
            title=config.section.heading,
            config=config,
            answer=answer,
            sentences=list(sentences(config, answer)),
            numbers=[(path, in_words(distribution)) for path, distribution in config.uncertain.numbers.items()],
            results=[_row(result) for result in answer.results],
            heads=(
                "result",
                "samples with a result",
                "mean",
                "95 % interval of the mean",
                "median",
                "5 %",
                "95 %",
                "standard deviation",
            ),
            pictures=collect(store.matching(["figures/study_*.png"]), store.folder, config.figures.report_width),
            assumption=RANDOM_FIELDS,
        )
    )
    return store.write_text(FILE, text)


def sentences(config: Config, answer: StudyAnswer) -> Iterator[str]:
    """Yield the results of a study, a sentence each.

    Parameters
    ----------
    config : section, and its uncertain numbers
    answer : statistics of the samples

    Returns
    -------
    Sentences in English, in the order of the results.
    """
    drawn = f"{answer.samples} samples of {len(config.uncertain.numbers)} uncertain numbers by {METHODS[answer.method]}"
    without = (
        f"; {counted(answer.failed, 'sample has', 'samples have')} no answer or only a part of it"
        if answer.failed
        else ", all with an answer"
    )
    yield f"{drawn}, seed {answer.seed}{without}."
    if any(result.title == WORDS["kc"] for result in answer.results):
        flow = flow_words(config.section, config.fem.flow)
        yield f"The critical Kh, which is also the yield coefficient of the blocks, is {flow}."
    for result in answer.results:
        spread = result.spread
        if spread.median is None or result.is_detail:
            continue
        if result.title == WORDS["kc"] and spread.median <= 0.0:
            share = "All" if spread.spread == 0.0 else "Half or more of the"
            yield f"{share} samples fail under their own weight: the critical Kh is 0."
            continue
        title = result.title[:1].upper() + result.title[1:]
        yield f"{title}: {_spread_words(spread, result.samples)}{_strongest(result)}."
        for group in result.groups:
            if group.samples:
                phrase = _spread_words(group.spread, group.samples)
                yield f"{title} where {group.path} is {group.value} ({group.samples}): {phrase}."
    yield from (f"{line}." for reach in config.reach.values() for line in reach.notice.splitlines())
    for failure in answer.failures:
        yield f"{failure.samples} without an answer: {failure.reason}."


def _spread_words(spread: Spread, samples: int) -> str:
    if spread.median is not None and spread.median < LEAST_MEDIAN:
        return f"{'all' if spread.spread == 0.0 else 'half or more of the'} samples have 0"
    phrase = f"half of the samples are below {number(spread.median)}"
    if spread.low is not None and samples >= FEWEST_SAMPLES:
        phrase += f", 90 % of the samples between {number(spread.low)} and {number(spread.high)}"
    return phrase


def _strongest(result: Result) -> str:
    first = next((effect for effect in result.effects if effect.correlation is not None), None)
    if first is None or first.correlation is None:
        return ""
    if first.total_order is not None:
        return f"; it depends most on {first.path} (total Sobol' index {first.total_order:.2f})"
    if abs(first.correlation) <= result.by_chance:
        return "; the samples are too few to show on which numbers it depends"
    return f"; it depends most on {first.path} (correlation {first.correlation:+.2f})"


def in_words(distribution: Distribution) -> str:
    """Return a distribution in words."""
    values = ", ".join(str(value) for value in getattr(distribution, distribution.kind))
    phrase = f"{distribution.kind} {values}"
    if distribution.applied_as != "value":
        phrase += f", as a {distribution.applied_as}"
    limits = distribution.truncation
    return f"{phrase}, between {limits[0]} and {limits[1]}" if limits else phrase


def _row(result: Result) -> list[str]:
    s = result.spread
    interval = "–" if s.mean_ci95 is None else f"{s.mean_ci95[0]:.3f} to {s.mean_ci95[1]:.3f}"
    rest = (s.median, s.low, s.high, s.spread)
    return [result.title, str(result.samples), number(s.mean), interval, *(number(value) for value in rest)]
