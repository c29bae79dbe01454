"""Defines stages and jobs, as the engine of a run uses them."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshes.executor import SERIAL, Executor
from workflow.config import Config
from workflow.run.progress import Progress, silent
from workflow.run.store import Store

if TYPE_CHECKING:
    from workflow.run.ranks import Ranks


def unless_it_liquefies(config: Config) -> str:
    """Return the reason why stages of liquefied ground do not run, if no layer of the section liquefies; else empty."""
    return "" if config.section.liquefies else "no layer liquefies"


@dataclass(frozen=True)
class Job:
    """Holds the input of a stage.

    Attributes
    ----------
    config: the section with the settings of all stages.
    store: the folder of the run.
    stages: all stages of a run, in their order.
    progress: called with the progress of a stage.
    mesh_file: a given mesh that replaces a new one.
    cases: the cases of liquefaction to compute, numbered from 1; all of them where this is None.
    ranks: the MPI ranks that may help; None where the program is SERIAL.
    executor: computes independent tasks.
    section_file: where the section was read, as errors name it; None where it is the copy in the folder.
    mesh_options: settings of the mesh from the command line, which are stored in the folder. None leaves stored ones
    unchanged.
    """

    config: Config
    store: Store
    stages: tuple["Stage", ...]
    progress: Progress = silent
    mesh_file: Path | None = None
    cases: tuple[int, ...] | None = None
    ranks: "Ranks | None" = None
    mesh_options: Mapping[str, Any] | None = None
    executor: Executor = SERIAL
    section_file: Path | None = None


@dataclass(frozen=True, kw_only=True)
class Stage:
    """Holds one stage of a run, declared at the end of its module in `workflow/stages`.

    Attributes
    ----------
    name: the word by which the command line knows it.
    what: its result, in a few words.
    work: computes, writes results and draws pictures, unless these are drawn after it. Raises NoAnswerError, after it
        Function that computes, writes results and draws pictures, unless pictures are drawn after it. If there is no
        answer, it writes what it found and raises NoAnswerError.
    draw: draws the pictures again from stored results; None where they can only be drawn while it computes.
    drawn_after: whether its work leaves the pictures to ``draw``, which then runs concurrently with the work of the
        Whether the work leaves the pictures to ``draw``, which then runs concurrently with the work of the next stage.
    needs: stages whose results it reads.
    reads: settings that its work reads, a whole "table" or one "table.key" of it.
    ignores: settings that are read, by it or by a stage that it needs, but do not change its results.
    takes: inputs that follow from settings it does not read itself, by names for messages, such as cases from blow
        Inputs that follow from settings which the stage does not read itself, such as cases from blow counts, by names
        for messages.
    files: files of the user that it reads, by names for messages.
    results: patterns of the files of its results.
    read: reads its answers; raises OtherVersionError where another version of the program wrote one.
    pictures: patterns of its pictures.
    leftovers: patterns of the files from which it continues after a stop; they are removed when the input has changed.
    unwanted: why the settings do not require it; empty where they do. Where they do not, it runs only if it is
        Function that returns the reason why the settings do not require the stage, empty if they do. A stage that is
        not required runs only if it is requested by name, and its earlier results are reused while they are valid.
    partial: whether the job requests only a part of it.
    concurrent_after: the stages that must have ended before it may run beside others, in another process; None where it
        Stages that must have ended before this stage may run concurrently with others, in another process; None if it
        runs in this process. Only a stage ``of_all`` may need such a stage.
    of_all: whether it reports the results of all other stages. It then runs after any change of them, even if stages
        Whether the stage reports the results of all other stages. It then runs after any change of them, even if stages
        that it needs have no answer.
    """

    name: str
    what: str
    work: Callable[[Job], None]
    draw: Callable[[Job], None] | None = None
    drawn_after: bool = False
    needs: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    ignores: Callable[[Config], Collection[str]] = lambda config: ()
    takes: Callable[[Config], Mapping[str, Any]] = lambda config: {}
    files: Callable[[Job], Mapping[str, Path]] = lambda job: {}
    results: tuple[str, ...] = ()
    read: Callable[[Store], object] = lambda store: None
    pictures: tuple[str, ...] = ()
    leftovers: tuple[str, ...] = ()
    unwanted: Callable[[Config], str] = lambda config: ""
    partial: Callable[[Job], bool] = lambda job: False
    concurrent_after: tuple[str, ...] | None = None
    of_all: bool = False
