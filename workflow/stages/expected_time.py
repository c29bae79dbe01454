"""Estimates the duration of a run roughly, which is printed before the run begins."""

import os
from collections.abc import Callable, Mapping, Sequence

from workflow.config import Config
from workflow.estimates.structures import structures_of
from workflow.run.plan import Decision
from workflow.stages.liquefaction import liquefying
from workflow.stages.mpm import alike_by_strength

LEAST = 30.0  # s: a run of less is not announced
# Stages one of which has to be in a run whose time is announced. What finite elements and bounds take depends on the
# mechanism, and from section to section it is a third to three times of what is known before.
PREDICTABLE = {"mpm", "calibrate", "slide"}
SHARE = 0.1  # of the whole: stages that take more are named
DISCS, CELLS = 2500, 3000  # to which the seconds of discs and material points belong
POWER = 1.5  # by which these rise with the number: smaller ones need shorter steps as well


def _cases(config: Config) -> int:
    """Return the number of cases of liquefaction that have to be computed. Cases with equal strength count once."""
    return len(set(alike_by_strength(config, list(liquefying(config))).values()))


def _discs(config: Config) -> float:
    area = float(config.section.layering.areas().sum())
    discs = area / (12.0**0.5 * config.dem.mean_radius(config.section) ** 2)
    return float((discs / DISCS) ** POWER)


def _packings(config: Config) -> int:
    return 1 + len(config.slide.packings(config.dem.model))


# Seconds of one processor by stage: S-13, the river bank and the sections of `python -m tests.benchmarks sections` lie
# within a factor of two of their sum.
SECONDS: Mapping[str, Callable[[Config], float]] = {
    "triggering": lambda config: 2.0,
    "response": lambda config: 10.0,
    "mesh": lambda config: 3.0,
    "fem": lambda config: 25.0 if config.fem.accuracy else 10.0,
    "variants": lambda config: 10.0 * len(config.variants.which),
    "bounds": lambda config: 10.0 + 0.8 * config.bounds.seconds,
    "slices": lambda config: 5.0,
    "faces": lambda config: len(structures_of(config.section)) * (40.0 + 0.8 * config.bounds.seconds),
    "residual": lambda config: 40.0,
    "liquefied": lambda config: 30.0 * _cases(config),
    "mpm": lambda config: 70.0 * _cases(config) * (config.slide.mpm_cells / CELLS) ** POWER,
    "calibrate": lambda config: (
        5.0 * len(config.section.strata) * config.dem.element_tests + 35.0 * _packings(config) * _discs(config)
    ),
    "slide": lambda config: 12.0 * (1 + _packings(config) * _cases(config)) * _discs(config),
    "report": lambda config: 10.0,
}


def announcement(decisions: Sequence[Decision], config: Config) -> str:
    """Return how long the stages that will run take, in a sentence; empty if it is half a minute or less, or cannot be
    foreseen.
    """
    costs = {item.stage.name: SECONDS[item.stage.name](config) for item in decisions if item.action == "run"}
    processors = max(1, min(os.cpu_count() or 1, config.dem.workers))
    total = sum(costs.values())
    if total / processors <= LEAST or not PREDICTABLE & costs.keys():
        return ""
    names = ", ".join(sorted((name for name in costs if costs[name] > SHARE * total), key=lambda name: -costs[name]))
    on = "a free processor" if processors == 1 else f"{processors} free processors"
    time = _about(total / processors)
    return f"The run takes about {time} on {on}, within a factor of two. The longest stages are {names}."


def _about(seconds: float) -> str:
    if seconds < 90.0:
        return f"{10 * round(seconds / 10.0)} s"
    return f"{round(seconds / 60.0)} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
