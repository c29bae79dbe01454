"""Stages and jobs, as the engine of a run knows them."""

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
    """Why stages of liquefied ground are not wanted: no layer of the section liquefies."""
    return "" if config.section.liquefies else "no layer liquefies"


@dataclass(frozen=True)
class Job:
    """Input of a stage.

    Attributes
    ----------
    config: the section with the settings of all stages.
    store: the folder of the run.
    stages: all stages of a run, in their order.
    progress: who hears how far a stage is.
    mesh_file: a mesh made elsewhere, to be taken instead of a new one.
    cases: the cases of liquefaction to compute, numbered from 1; all of them where this is None.
    ranks: the MPI ranks that may help; None where the program is SERIAL.
    executor: who does tasks that do not depend on each other.
    section_file: where the section was read, as errors name it; None where it is the copy in the folder.
    mesh_options: settings of the mesh that the command line gave; they stay with the folder. None leaves them alone.
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
    """One stage of a run, declared at the end of its module in `workflow/stages`.

    Attributes
    ----------
    name: the word by which the command line knows it.
    what: what it finds or makes, in a few words.
    work: computes, writes results and draws pictures, unless these are drawn after it. Raises NoAnswerError, after it
        wrote what it found, where there is no answer.
    draw: draws the pictures again from stored results; None where they can only be drawn while it computes.
    drawn_after: whether its work leaves the pictures to ``draw``, which then runs concurrently with the work of the
        next stage.
    needs: the stages whose results it reads.
    reads: the settings that its work reads, a whole "table" or one "table.key" of it.
    ignores: settings among those that it or a stage that it needs reads which do not change its own results for a given
    input. takes: inputs worked out from settings that it does not read itself, by the names that people use, such as
    the cases that follow from blow counts. files: the user's own files that it reads, by what people call them.
    results: patterns of the files in which it leaves its results. read: reads its answers; raises OtherVersionError
    where another version of the program wrote one. pictures: patterns of the pictures that it leaves. leftovers:
    patterns of files from which it continues after a stop; removed once they belong to other inputs. unwanted: why the
    settings do not ask for it, empty where they do. Where they do not, it runs only if it is asked
        for by name, and what it left before is used as long as it fits.
    partial: whether the job asks for a part of it only, so that the rest is still to come.
    beside: the stages that must have ended before it may run beside others, in another process; None where it
        runs in this process. Nobody but a stage ``of_all`` may need it.
    of_all: whether it tells of whatever the others left, with or without an answer. It then runs after any news from
        them, and whether or not those that it needs have an answer.
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
    beside: tuple[str, ...] | None = None
    of_all: bool = False
