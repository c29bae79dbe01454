"""Runs a study: samples of the uncertain numbers, each computed once, and their statistics."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshes.errors import InputError, NoAnswerError
from meshes.section.section import Section
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.figures import study as figures
from workflow.results.answer import SectionLabel
from workflow.results.cases import Spread
from workflow.results.study import Failure, Group, Result, StudyAnswer
from workflow.run.fingerprint import fingerprint_of_file
from workflow.run.pipeline import leave_input
from workflow.run.store import Store
from workflow.study.ensemble import Ensemble, OnRow, TaskOutcome
from workflow.study.fragility import block, failure, fragility
from workflow.study.parts import PARTS, StudyPart
from workflow.study.statistics import effects
from workflow.study.table import FILE, SampleRow, SampleTable
from workflow.study.task import Numbers, StudySample, Task
from workflow.uncertain.sampling import samples

BLOCK = "block"  # the part that takes no task: a closed form of the critical Kh


@dataclass(frozen=True)
class Study:
    """Holds the samples of a study, and their statistics."""

    table: SampleTable
    answer: StudyAnswer

    def refuse_parts_without_answer(self) -> None:
        """Raise NoAnswerError, with the reasons, if a requested part has no answer in any sample."""
        if not self.answer.parts_without_answer:
            return
        names = " and ".join(self.answer.parts_without_answer)
        reasons = "; ".join(f"{failed.samples} of them: {failed.reason}" for failed in self.answer.failures)
        raise NoAnswerError(f"{names}: none of {self.answer.samples} samples has an answer; {reasons}")


def parts_of(only: Sequence[str]) -> tuple[list[StudyPart], bool]:
    """Return the parts by their names, and whether the sliding block is requested; raise InputError for an unknown
    name."""
    names = [*(part.name for part in PARTS), BLOCK]
    if unknown := [name for name in only if name not in names]:
        raise InputError("--only", [f"{name!r}: expected one of {', '.join(names)}" for name in unknown])
    wanted = {*only, *(["fem"] if BLOCK in only else [])}
    return [part for part in PARTS if part.name in wanted], BLOCK in only


def run(config: Config, store: Store, only: Sequence[str], ensemble: Ensemble, on_row: OnRow | None = None) -> Study:
    """Compute missing samples of a study, and write section.toml, samples.csv and study.json to its folder.

    Parameters
    ----------
    config : section, settings, and the uncertain numbers
    store : folder of the study
    only : names of the parts to compute
    ensemble : computes the parts of samples
    on_row : function that is called after each of them

    Returns
    -------
    The table of all samples, in which failed samples have the reason, and their statistics.

    Raises
    ------
    InputError : No number is uncertain, or a part is unknown.
    """
    if not config.uncertain.numbers:
        raise InputError(
            config.section.name, ['[uncertain]: no number is uncertain; expected one such as "strata.1.friction_angle"']
        )
    parts, with_block = parts_of(only)
    leave_input(config, store)
    table = computed(config, store, parts, with_block, ensemble, on_row)
    store.write_text(FILE, table.text())
    answer = statistics_of(config, table, only)
    answer.write(store)
    return Study(table, answer)


def computed(
    config: Config, store: Store, parts: Sequence[StudyPart], with_block: bool, ensemble: Ensemble, on_row: OnRow | None
) -> SampleTable:
    """Return the table of all samples. Samples that fail have the reason.

    ``config``: config of the study; ``store``: store of the folder with the results; ``parts``: parts to compute;
    ``with_block``: whether the sliding block is among them; ``ensemble``: computes the rows; ``on_row``: called with
    each.
    """
    drawn = samples(config.uncertain, config.study, config.reach)
    inputs = [_input(config, sample) for sample in drawn]
    sound = [(place, sample) for place, sample in enumerate(inputs) if isinstance(sample, Config)]
    # sample by sample: the time of finished samples predicts the time of the rest, whichever part takes longest
    wanted = [(place, part) for place, _ in sound for part in parts]
    tasks = [task_of(sample, part, store) for _, sample in sound for part in parts]
    results: dict[int, list[tuple[StudyPart, TaskOutcome[Numbers]]]] = {place: [] for place in range(len(drawn))}
    for (place, part), row in zip(wanted, ensemble.rows(tasks, on_row), strict=True):
        results[place].append((part, row))
    units = {path: distribution.unit for path, distribution in config.uncertain.numbers.items()}
    rows = [_row(drawn[place], inputs[place], results[place], with_block) for place in range(len(drawn))]
    return SampleTable(units, rows)


def _input(config: Config, drawn: Mapping[str, Any]) -> Config | str:
    """Return the input of a sample, or the reason why it is invalid."""
    try:
        return config_after_triggering(config.with_drawn(drawn))
    except InputError as error:
        return "; ".join(error.problems)


def task_of(read: Config, part: StudyPart, store: Store) -> Task[StudySample, Numbers]:
    """Return the task of one part of a sample: its section, and only the settings that this part reads.

    If a part of the sample reads borings and earthquake, they are in the input of its task. A part that does not read
    them does not depend on which strata liquefy, since pore pressures that follow from borings are already in the
    strata.
    """
    data = read.to_data(part.tables)
    for table, key in (name.split(".") for name in part.ignores):
        data[table].pop(key, None)
    if "triggering" not in part.tables:
        data["strata"] = [{**stratum, "liquefies_in": []} for stratum in data["strata"]]
    files = {name: fingerprint_of_file(path) for name, path in read.files(*part.tables).items()}
    task = Task(part.function, StudySample(data={**data, "name": "sample", "title": ""}, files=files))
    if not part.keeps:
        return task
    folder = store.folder.absolute() / "running" / task.fingerprint
    return Task(part.function, task.argument.model_copy(update={"folder": str(folder)}))


def _row(
    drawn: dict[str, Any],
    read: Config | str,
    answers: Sequence[tuple[StudyPart, TaskOutcome[Numbers]]],
    with_block: bool,
) -> SampleRow:
    if isinstance(read, str):
        return SampleRow(drawn, Numbers(numbers={}), read)
    answered = [part.name for part, row in answers if row.answer is not None]
    numbers: dict[str, float | None] = {}
    texts: dict[str, str] = {}
    for _, row in answers:
        if row.answer is not None:
            numbers |= row.answer.numbers
            texts |= row.answer.texts
    if with_block:
        kc = numbers.get("kc")
        answered += [BLOCK] if kc is not None else []
        if (slide := block(read, kc)) is not None:
            numbers["block_slide_m"] = slide
    reasons = [f"{part.name}: {row.reason}" for part, row in answers if row.answer is None]
    return SampleRow(drawn, Numbers(numbers=numbers, texts=texts), "; ".join(reasons), tuple(answered))


def statistics_of(config: Config, table: SampleTable, only: Sequence[str]) -> StudyAnswer:
    """Return the statistics of the samples."""
    words = [path for path, distribution in config.uncertain.numbers.items() if distribution.is_words]
    indices = config.study.method == "saltelli"
    names = [name for name in table.names if name != "cells"]
    reasons = [row.reason for row in table.rows if row.reason]
    counts = Counter(map(_without_digits, reasons))
    first = {_without_digits(reason): reason for reason in reversed(reasons)}
    return StudyAnswer(
        section=SectionLabel.of(config.section),
        parts=tuple(only),
        method=config.study.method,
        seed=config.study.seed,
        samples=len(table.rows),
        failed=table.failed,
        failures=tuple(Failure(reason=first[kind], samples=count) for kind, count in counts.most_common()),
        parts_without_answer=tuple(name for name in only if not any(name in row.answered for row in table.rows)),
        results=tuple(
            Result(
                name=name,
                samples=int(np.isfinite(table.column(name)).sum()),
                spread=_spread(table.column(name)),
                effects=effects(table, name, words, indices),
                groups=tuple(group for path in words for group in _groups(table, name, path)),
            )
            for name in names
        ),
        failure_probability=failure(table),
        fragility=tuple(fragility(config, table)),
    )


def _without_digits(reason: str) -> str:
    """Return a reason without the numbers that were drawn, which differ from sample to sample."""
    return re.sub(r"-?\d+\.\d{3,}(e-?\d+)?", "…", reason)


def _spread(values: np.ndarray) -> Spread:
    """Return the spread of a column; the single values are in samples.csv."""
    known = [float(value) for value in values[np.isfinite(values)]]
    spread = Spread.of(known)
    return (spread.from_zero if known and min(known) >= 0.0 else spread).model_copy(update={"values": ()})


def _groups(table: SampleTable, name: str, path: str) -> Iterator[Group]:
    column, drawn = table.column(name), [str(value) for value in table.drawn(path)]
    for value in dict.fromkeys(drawn):
        group = column[[value_of_group == value for value_of_group in drawn]]
        yield Group(path=path, value=value, samples=int(np.isfinite(group).sum()), spread=_spread(group))


def draw_all(section: Section, table: SampleTable, answer: StudyAnswer, store: Store) -> None:
    """Write figures/study_*.png; pictures without data are left out.

    Parameters
    ----------
    section : the ground, whose name is in the titles
    table : drawn values and results of all samples
    answer : statistics of the samples
    store : folder of the study
    """
    title = section.heading
    store.remove(["figures/study_*.png"])
    if answer.failure_probability is not None:
        kc = table.column("kc")
        store.save(
            "figures/study_fails.png", figures.failure_histogram(kc[np.isfinite(kc)], answer.failure_probability, title)
        )
    if any(effect.correlation is not None for result in answer.results for effect in result.effects):
        store.save("figures/study_effects.png", figures.effects(answer.results, title))
    if answer.fragility:
        store.save("figures/study_fragility.png", figures.fragility(answer.fragility, title))
    first = answer.results[:1]
    slides = [result for result in answer.results[1:] if result.name.startswith("case") and not result.is_detail]
    for result in (*first, *slides):
        drawn = {table.heading(effect.path): table.drawn(effect.path) for effect in result.effects}
        name = "samples" if result in first else f"samples_{result.name.split('_')[0]}"
        picture = figures.scatter(result.title, table.column(result.name), drawn, title)
        store.save(f"figures/study_{name}.png", picture)
