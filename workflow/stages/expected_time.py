"""States before a run whether it takes a minute, some minutes or longer, and which stages take most of the time.

The time depends on the mechanism, on other programs on the machine, and on whether kernels are compiled already:
numbers of minutes were wrong by up to four times. The order of magnitude is not.
"""

from collections.abc import Callable, Mapping, Sequence

from dem.disc_count import lattice_count
from workflow.config import Config
from workflow.estimates.structures import structures_of
from workflow.run.plan import Decision
from workflow.stages.liquefaction import liquefying
from workflow.stages.mpm import alike_by_strength
from workflow.texts.report_texts import listed

NAMED_SHARE = 0.15  # of the total time: stages that take more are named
DISCS, CELLS = 2500, 3000  # to which the seconds of discs and material points belong
TIME_POWER = 1.5  # of the number of discs or cells: smaller ones also need shorter steps
ANNOUNCED_TIME = 30.0  # s of processor time: shorter runs are not announced
# Largest number of seconds of a processor, and what is said of the time on two of them, free or busy.
CLASSES = ((200.0, "a minute or two"), (1500.0, "some minutes"), (5400.0, "up to an hour"))
LONGEST_WORDS = "more than an hour"


def _cases(config: Config) -> int:
    """Return the number of cases of liquefaction that have to be computed. Cases with equal strength count once."""
    return len(set(alike_by_strength(config, list(liquefying(config))).values()))


def _discs(config: Config) -> float:
    """Return the time of a run of the discs over that of `DISCS` discs."""
    return float((lattice_count(config.section, config.dem.mean_radius(config.section)) / DISCS) ** TIME_POWER)


def _packings(config: Config) -> int:
    """Return the number of packings of discs that are computed."""
    return 1 + len(config.slide.packings(config.dem.model))


# Seconds of one processor by stage, as S-13, the river bank and the sections of `python -m tests.benchmarks sections`
# take on a free machine with compiled kernels.
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
    "mpm": lambda config: 70.0 * _cases(config) * (config.slide.mpm_cells / CELLS) ** TIME_POWER,
    "calibrate": lambda config: (
        5.0 * len(config.section.strata) * config.dem.element_tests + 35.0 * _packings(config) * _discs(config)
    ),
    "slide": lambda config: 12.0 * (1 + _packings(config) * _cases(config)) * _discs(config),
    "report": lambda config: 10.0,
}


def announcement(decisions: Sequence[Decision], config: Config) -> str:
    """Return how long the stages that will run take.

    Parameters
    ----------
    decisions : decisions on all stages
    config : section and settings, on which the times depend

    Returns
    -------
    A sentence with an order of magnitude and the longest stages; empty if they take less than 30 s of processor time.
    """
    costs = {item.stage.name: SECONDS[item.stage.name](config) for item in decisions if item.action == "run"}
    total = sum(costs.values())
    if total <= ANNOUNCED_TIME:
        return ""
    time = next((words for most, words in CLASSES if total <= most), LONGEST_WORDS)
    longest = sorted((name for name in costs if costs[name] > NAMED_SHARE * total), key=lambda name: -costs[name])
    first = ", and the critical Kh comes first" if "fem" in costs and len(costs) > 2 else ""
    stages = "stage" if len(longest) == 1 else "stages"
    return f"The run takes {time}{first}. Most of the time goes into the {stages} {listed(longest)}."
