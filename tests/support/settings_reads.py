"""Observes which settings a stage reads while it works, and which settings make it run again."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from dem.case import Case
from workflow.config import FILES, Config
from workflow.config.after_triggering import cases_after_triggering
from workflow.earthquake.triggering.assessment import assess
from workflow.run.fingerprint import inputs
from workflow.run.stage import Job, Stage
from workflow.run.store import Store
from workflow.stages.declared import STAGES

TABLES = {type(Config.model_fields[table].default): table for table in Config.tables()}
KEYS = tuple(f"{table}.{key}" for model, table in TABLES.items() for key in model.model_fields)


@contextmanager
def reads() -> Iterator[set[str]]:
    """Collect the settings that are read in the block, in any thread of this process, as "table.key"."""
    result: set[str] = set()
    for model, table in TABLES.items():
        model.__getattribute__ = _heard(table, frozenset(model.model_fields), result)  # type: ignore[method-assign]
    try:
        yield result
    finally:
        for model in TABLES:
            del model.__getattribute__


def _heard(table: str, fields: frozenset[str], outcome: set[str]) -> Any:
    def read(settings: object, name: str) -> Any:
        if name in fields:
            outcome.add(f"{table}.{name}")
        return object.__getattribute__(settings, name)

    return read


def traced(stages: tuple[Stage, ...], outcome: dict[str, set[str]]) -> tuple[Stage, ...]:
    """Return the same stages, which store under their names the settings that their work reads; pictures are
    omitted."""

    def entry(stage: Stage) -> Stage:
        def work(job: Job) -> None:
            with reads() as settings:
                try:
                    stage.work(job)
                finally:
                    outcome.setdefault(stage.name, set()).update(settings)

        return replace(stage, work=work, draw=None, drawn_after=False, pictures=())

    return tuple(entry(stage) for stage in stages)


def altered(case_input: Config, name: str) -> Config:
    """Return the same input with another value of one setting; nothing is computed with it."""
    table, _, key = name.partition(".")
    settings = getattr(case_input, table)
    other = str(Path(__file__)) if (table, key) in FILES else _other(getattr(settings, key))
    other = settings.model_copy(update={key: other})
    result = case_input.model_copy(update={table: other})
    if not result.triggering.cases:
        return result
    judged = assess(result.section, result.earthquake, result.triggering)
    return result.analysed(
        result.section, result.slide, cases_after_triggering(result.section, judged, result.triggering), ()
    )


def _other(value: Any) -> Any:
    match value:
        case bool():
            return not value
        case int() | float():
            return 1.5 * value + 0.125
        case str():
            return f"{value} or another"
        case tuple():
            return (*value, Case(stiffness=0.5)) if value and isinstance(value[0], Case) else (*value, 0.125)
        case dict():
            return {**value, "another": 0.125}
    return 0.125


def stale(before: Config, after: Config) -> set[str]:
    """Return the stages whose results for the input ``before`` are invalid for the input ``after``."""
    first, then = (Job(item, Store(Path("nowhere")), STAGES) for item in (before, after))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of values that no setting has
        return {stage.name for stage in STAGES if inputs(stage, first) != inputs(stage, then)}


def with_needed(name: str) -> set[str]:
    """Return a stage and all stages that it needs."""
    (stage,) = [item for item in STAGES if item.name == name]
    return {name}.union(*(with_needed(other) for other in stage.needs))
