"""Finds settings of the command line that a command does not use, and the commands that use them.

The settings that a command reads follow from the declarations of its stages (``Stage.reads``), and from their influence
on the inputs.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from meshes.errors import InputError
from workflow.run.fingerprint import inputs
from workflow.run.stage import Job, Stage

# What every command that runs stages reads, whatever they are: how many processes it may take.
OF_EVERY_RUN = ("dem.workers",)
# Settings that say whether a run computes a stage: the command of that stage computes it in any case.
WHETHER = {"bounds.run": "bounds"}
# Settings that only `noshiro study` reads; the report lists them like every setting.
OF_STUDIES = ("study", "uncertain")


def keys_of(settings: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return settings as "table.key"."""
    return [f"{table}.{key}" for table, values in settings.items() for key in values]


def is_read(key: str, reads: Iterable[str]) -> bool:
    """Return whether "table.key" is among settings that are read, which are whole tables or single keys."""
    return bool({key, key.split(".")[0]} & set(reads))


def reads_of(stages: Sequence[Stage]) -> list[str]:
    """Return the settings that the stages and the engine of a run read; settings of studies that only the report reads
    are left out."""
    names = [name for stage in stages for name in stage.reads if not (stage.of_all and name in OF_STUDIES)]
    return [*names, *OF_EVERY_RUN]


def unread(settings: Sequence[str], job: Job, chosen: Sequence[str], without: Callable[[str], Job]) -> list[str]:
    """Return the ``settings`` that no ``chosen`` stage uses; ``without`` returns the job without one setting.

    A setting that acts through other settings, such as a blow count that determines strengths, changes the inputs of a
    stage.
    """
    stages = [stage for stage in job.stages if stage.name in chosen]
    reads = reads_of(stages)
    computing = [stage for stage in stages if not stage.of_all]
    switches = {key for key, stage in WHETHER.items() if [*chosen] == [stage]}
    return [key for key in settings
            if key in switches or (not is_read(key, reads) and not _changes(computing, job, key, without))]  # fmt: skip


def _changes(stages: Sequence[Stage], job: Job, key: str, without: Callable[[str], Job]) -> bool:
    """Return whether leaving out a setting changes the inputs of any stage, or leaves no valid input."""
    try:
        other = without(key)
    except InputError:
        return True
    return any(inputs(stage, job) != inputs(stage, other) for stage in stages)


def in_words(keys: Sequence[str], command: str, commands: Sequence[str]) -> list[str]:
    """Return one sentence on each setting that a ``command`` does not read. Each sentence names the ``commands`` that
    read the setting."""
    from workflow.stages import command_of, declared
    from workflow.texts.report_texts import listed

    reads = {command_of(stage.name): stage.reads for stage in declared.STAGES if not stage.of_all}
    phrases = []
    for key in keys:
        others = [name for name, used in reads.items() if name in commands and is_read(key, used)
                  and name not in (command, WHETHER.get(key))]  # fmt: skip
        others = ["study"] if key.split(".")[0] in OF_STUDIES else [*others, *(["run"] if command != "run" else [])]
        does = listed([f"noshiro {name}" for name in others]) or "no command"
        phrases.append(f"Warning: noshiro {command} does not read {key}; it is read by {does}.")
    return phrases
