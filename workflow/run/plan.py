"""Which stages run, and why: a stage runs when something that it is made from has changed."""

from dataclasses import dataclass, replace
from typing import Literal, Self

from meshes.errors import InputError
from workflow.run.fingerprint import fingerprint_of, inputs
from workflow.run.record import Record
from workflow.stages import Job, Stage, stages

Action = Literal["run", "redraw", "reuse", "off"]


@dataclass(frozen=True)
class Choice:
    """Which stages may run, and which of them run whether anything changed or not."""

    chosen: tuple[str, ...]
    forced: tuple[str, ...] = ()

    @classmethod
    def of(cls, start: str | None = None, only: tuple[str, ...] = (), force: bool = False) -> Self:
        """All stages, or ``only`` some; from ``start`` on they run anyhow, with ``force`` all that may run.

        Raises InputError if there is no such stage.
        """
        names = tuple(stage.name for stage in stages())
        options = {"--from": [start] if start else [], "--only": list(only)}
        for option, given in options.items():
            unknown = [name for name in given if name not in names]
            if unknown:
                raise InputError(option, [f"{name!r}: expected a stage, one of {', '.join(names)}" for name in unknown])
        chosen = only or names
        if force:
            return cls(chosen, chosen)
        return cls(chosen, names[names.index(start) :] if start else ())

    @classmethod
    def up_to(cls, name: str, force: bool = False) -> Self:
        """A stage, forced if so wished, and before it those that it cannot do without."""
        needed = {name}
        for stage in reversed(stages()):
            needed |= set(stage.needs) if stage.name in needed else set()
        return cls(tuple(stage.name for stage in stages() if stage.name in needed), (name,) if force else ())


@dataclass(frozen=True)
class Step:
    """What is to be done about a stage, and why; ``inputs`` are the fingerprints it is made from now."""

    stage: Stage
    action: Action
    why: str
    inputs: dict[str, str]


def plan(job: Job, record: Record, choice: Choice) -> list[Step]:
    """What is to be done about every stage. Raises InputError if the choice leaves out what it needs."""
    steps: list[Step] = []
    for stage in stages():
        step = _step(stage, made_from(stage, job, record), job, record, choice)
        news = any(other.action == "run" for other in steps)
        if stage.name == "report" and step.action in ("reuse", "redraw") and stage.name in choice.chosen and news:
            step = replace(step, action="run", why=step.why or "there are new results")
        steps.append(step)
    off = {step.stage.name: step.why for step in steps if step.action == "off"}
    for step in steps:
        if step.action in ("run", "redraw") and step.stage.name != "report":
            missing = [name for name in step.stage.needs if name in off]
            if missing:
                raise InputError(
                    step.stage.name, [f"needs the stage {name}: {off[name]}; let it run, too" for name in missing]
                )
    return steps


def made_from(stage: Stage, job: Job, record: Record) -> dict[str, str]:
    """The fingerprints of all that matters to a stage; the report also depends on how the others ended."""
    prints = inputs(stage, job)
    if stage.name == "report":
        ends = {name: [entry.outcome, entry.ended] for name, entry in record.entries.items() if name != "report"}
        prints["the results"] = fingerprint_of(ends)
    return prints


def _step(stage: Stage, prints: dict[str, str], job: Job, record: Record, choice: Choice) -> Step:
    why = changes(stage, prints, record)
    if stage.name not in choice.chosen:
        return Step(stage, "off" if why else "reuse", why, prints)
    asked = stage.name in choice.forced
    if not stage.wanted(job.run) and stage.name != choice.chosen[-1]:
        return Step(stage, "off" if why else "reuse", "not asked for", prints)
    if asked or why:
        return Step(stage, "run", "asked for" if asked else why, prints)
    if not record.pictures_left(stage.name):
        return Step(stage, "redraw", "pictures are missing", prints)
    return Step(stage, "reuse", "", prints)


def changes(stage: Stage, prints: dict[str, str], record: Record) -> str:
    """Why what a stage left cannot be used again, in words; empty if it can."""
    entry = record[stage.name]
    if entry is None:
        return "it has not run yet"
    changed = [name for name in {**prints, **entry.inputs} if prints.get(name) != entry.inputs.get(name)]
    if changed:
        return f"changed: {', '.join(changed)}"
    if entry.outcome == "begun":
        return "it was stopped, and goes on"
    if entry.outcome == "part":
        return "some of its cases are still to come"
    if entry.outcome == "done" and not record.left(stage.name):
        return "files are missing or have changed"
    return ""
