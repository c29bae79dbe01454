"""Decides which stages run, and why: a stage runs when one of its inputs has changed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self

from meshes.errors import InputError
from workflow.run.fingerprint import PROGRAM, fingerprint_of, inputs, title
from workflow.run.record import Record
from workflow.run.stage import Job, Stage
from workflow.run.store import OtherVersionError

Action = Literal["run", "redraw", "reuse", "off"]


OTHER_VERSION = "computed by another version of noshiro"
# The fingerprint of the inputs of a stage without the settings that only add answers.
WITHOUT_ADDITIONS = "inputs without additions"


@dataclass(frozen=True)
class Choice:
    """Holds the choice of stages that a command may run.

    Attributes
    ----------
    chosen : the names of the stages that may run, in their order.
    forced : chosen stages that run even if nothing has changed.
    requested : stages requested by name, which run even if the settings do not require them.
    """

    chosen: tuple[str, ...]
    forced: tuple[str, ...] = ()
    requested: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, stages: Sequence[Stage], start: str | None = None, only: Sequence[str] = (), force: bool = False
    ) -> Self:
        """Return all stages, or ``only`` some; stages from ``start`` on run even if unchanged, with ``force`` all of
        them.

        Raises InputError if there is no such stage.
        """
        names = tuple(stage.name for stage in stages)
        requested = {"--from": [start] if start else [], "--only": list(only)}
        for option, names_given in requested.items():
            unknown = [name for name in names_given if name not in names]
            if unknown:
                raise InputError(option, [f"{name!r}: expected a stage, one of {', '.join(names)}" for name in unknown])
        chosen = tuple(name for name in names if name in only) or names
        after = names[names.index(start) :] if start else ()
        return cls(chosen, chosen if force else after, tuple(requested["--from"] + requested["--only"]))

    @classmethod
    def up_to(cls, stages: Sequence[Stage], name: str, force: bool = False, also: Sequence[str] = ()) -> Self:
        """Choose a stage (run again with ``force``), the stages in ``also``, and the stages that these need.

        ``stages``: all stages in the order of their execution; ``name``: name of the stage.
        """
        needed = {name, *also}
        for stage in reversed(stages):
            needed |= set(stage.needs) if stage.name in needed else set()
        chosen = tuple(stage.name for stage in stages if stage.name in needed)
        return cls(chosen, (name, *also) if force else (), (name, *also))


@dataclass(frozen=True)
class Decision:
    """Holds the decision whether a stage runs, is reused, is drawn again or is skipped, with the reason.

    Attributes
    ----------
    stage : the stage.
    action : whether to run the stage, draw its pictures again, reuse its results, or leave it out.
    reason : reason of the action, in words; empty if nothing has changed.
    """

    stage: Stage
    action: Action
    reason: str


def plan(job: Job, record: Record, choice: Choice) -> list[Decision]:
    """Decide which stages run.

    Parameters
    ----------
    job : section, settings, and all stages of the run
    record : outcomes and inputs of the stages when they ran last
    choice : stages that the command may run

    Returns
    -------
    One decision for each stage of the job, in the order of the stages.

    Raises
    ------
    InputError : The choice leaves out a stage without valid results that a stage to run needs.
    """
    decisions: list[Decision] = []
    for stage in job.stages:
        news = any(decision.action in ("run", "redraw") for decision in decisions)
        decisions.append(_decision(stage, job, record, choice, news))
    off = {decision.stage.name: decision.reason for decision in decisions if decision.action == "off"}
    for decision in decisions:
        if decision.action in ("run", "redraw") and not decision.stage.of_all:
            missing = [name for name in decision.stage.needs if name in off]
            if missing:
                raise InputError(
                    decision.stage.name, [f"needs the stage {name}: {off[name]}; let it run, too" for name in missing]
                )
    return decisions


def made_from(stage: Stage, job: Job, record: Record) -> dict[str, str]:
    """Return the fingerprints of all inputs of a stage, as its entry in the record holds them.

    Parameters
    ----------
    stage : the stage
    job : section, settings, and all stages of the run
    record : outcomes of the other stages, which are inputs of a stage that reports all of them

    Returns
    -------
    Fingerprints by names for messages, see `inputs`. A stage with settings that only add answers has another one of the
    inputs without them, by the name `WITHOUT_ADDITIONS`.
    """
    prints = inputs(stage, job)
    if stage.of_all:
        ends = {name: [entry.outcome, entry.ended] for name, entry in record.entries.items() if name != stage.name}
        prints["the results"] = fingerprint_of(ends)
    if stage.adds:
        prints[WITHOUT_ADDITIONS] = fingerprint_of(inputs(stage, job, frozenset(stage.adds)))
    return prints


def has_answers_of(stage: Stage, prints: dict[str, str], record: Record) -> bool:
    """Return whether the stored answers of a stage belong to some inputs.

    There may be more or fewer answers than requested, such as factors of safety, since settings that only add answers
    (`Stage.adds`) are left out of the comparison.

    Parameters
    ----------
    stage : the stage
    prints : fingerprints of the inputs, by names, see `made_from`
    record : outcomes and inputs of the stages

    Returns
    -------
    False also if the stage has not run, if its results are not whole, or if no setting only adds answers to it.
    """
    entry = record[stage.name]
    if entry is None or WITHOUT_ADDITIONS not in prints:
        return False
    same = entry.inputs.get(WITHOUT_ADDITIONS) == prints[WITHOUT_ADDITIONS]
    return same and not changes(stage, entry.inputs, record)


def is_of_this_input(stage: Stage, job: Job, record: Record) -> bool:
    """Return whether the stored answer of a stage may be reported and drawn.

    Parameters
    ----------
    stage : the stage
    job : section, settings, and all stages of the run
    record : outcomes and inputs of the stages

    Returns
    -------
    True if the answer belongs to this input, though perhaps to another version of the program, if this version can read
    it, and if the same holds for all stages that it needs, none of which was computed again since then. The answer may
    be a part of what is requested.
    """
    entry = record[stage.name]
    if entry is None:
        return False
    needed = [(other, record[other.name]) for other in job.stages if other.name in stage.needs]
    if any(left is None or left.ended > entry.ended for _, left in needed):
        return False
    with_program = (PROGRAM, *(other.name for other, _ in needed), *((WITHOUT_ADDITIONS,) if stage.adds else ()))
    of_the_program = {name: entry.inputs.get(name, "") for name in with_program}
    if {**made_from(stage, job, record), **of_the_program} != entry.inputs:
        return False
    readable = entry.outcome == "part" or not changes(stage, entry.inputs, record)
    return readable and all(is_of_this_input(other, job, record) for other, _ in needed)


def _decision(stage: Stage, job: Job, record: Record, choice: Choice, news: bool) -> Decision:
    """Decide whether a stage runs; ``news``: whether results of a stage before it will change."""
    reason = changes(stage, made_from(stage, job, record), record)
    if stage.name not in choice.chosen:
        return Decision(stage, "off" if reason else "reuse", reason)
    if (unwanted := stage.unwanted(job.config)) and stage.name not in choice.requested:
        return Decision(stage, "off" if reason else "reuse", unwanted)
    if stage.name in choice.forced:
        return Decision(stage, "run", "asked for")
    if reason or (stage.of_all and news):
        return Decision(stage, "run", reason or "there are new results")
    if not record.pictures_left(stage.name):
        return Decision(stage, "redraw", "pictures are missing")
    left = record.entries[stage.name]
    if stage.drawn_after and not left.title:
        return Decision(stage, "redraw", "the stage was stopped before its pictures were drawn")
    if stage.draw is not None and left.pictures and left.title != title(job.config):
        return Decision(stage, "redraw", "the title or the language has changed")
    return Decision(stage, "reuse", "")


def changes(stage: Stage, prints: dict[str, str], record: Record) -> str:
    """Return why the results of a stage cannot be reused.

    Parameters
    ----------
    stage : the stage
    prints : fingerprints of its present inputs, by names, see `made_from`
    record : outcomes and inputs of the stages, and the folder with their results

    Returns
    -------
    The reason in words, such as "inputs changed: [fem]"; empty if the results can be reused.
    """
    entry = record[stage.name]
    if entry is None:
        return OTHER_VERSION if stage.name in record.outdated else "not run"
    changed = [
        name for name in {**prints, **entry.inputs}
        if name != WITHOUT_ADDITIONS and prints.get(name) != entry.inputs.get(name)
    ]  # fmt: skip
    if changed:
        return f"inputs changed: {', '.join(changed)}"
    if entry.outcome == "begun":
        return "the stage was stopped, and continues" if stage.leftovers else "the stage was stopped, and begins again"
    if entry.outcome == "part":
        return "some cases are not yet computed"
    if entry.outcome == "done" and not record.left(stage.name):
        return "files are missing or have changed"
    try:
        stage.read(record.store)
    except OtherVersionError:
        return OTHER_VERSION
    except InputError:
        # a stage without an answer need not have left a file
        return "files are missing or have changed" if entry.outcome == "done" else ""
    return ""
