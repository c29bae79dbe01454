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
    """Return the reason why stages of liquefied ground do not run.

    Parameters
    ----------
    config : section and settings

    Returns
    -------
    The reason, if no layer of the section liquefies; else empty.
    """
    return "" if config.section.liquefies else "no layer liquefies"


def unless_discs_slide(config: Config) -> str:
    """Return the reason why stages of sliding discs do not run.

    Parameters
    ----------
    config : section and settings

    Returns
    -------
    The reason, if no layer liquefies or "discs" is missing in ``slide.methods``; else empty.
    """
    return unless_it_liquefies(config) or ("" if "discs" in config.slide.methods else "slide.methods")


@dataclass(frozen=True)
class Job:
    """Holds the input of a stage.

    Attributes
    ----------
    config : the section with the settings of all stages.
    store : the folder of the run.
    stages : all stages of a run, in their order.
    progress : function that is called with the progress of a stage.
    mesh_file : a given mesh, which replaces a new mesh.
    cases : numbers, from 1, of the cases of liquefaction to compute; None for all of them.
    ranks : the MPI ranks that compute together; None outside the command `noshiro fem`.
    executor : executor of independent tasks.
    section_file : file from which the section was read, as errors name it; None if it is the copy in the folder.
    mesh_options : settings of the mesh from the command line, which are stored in the folder. None leaves stored ones
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
    name : name of the stage on the command line.
    description : result of the stage, in a few words.
    work : function that computes, writes results and draws pictures, unless pictures are drawn after it. If there is no
        answer, it writes what it found and raises NoAnswerError.
    draw : function that draws the pictures again from stored results; None if they can only be drawn while the stage
        computes.
    drawn_after : whether the work leaves the pictures to ``draw``, which then runs concurrently with the work of the
        next stage.
    needs : stages whose results this stage reads.
    reads : settings that the work of this stage reads, each a whole "table" or one "table.key".
    ignores : settings that this stage, or a stage that it needs, reads, but that do not change its results.
    adds : settings that only add or leave out some answers of this stage, so that the others remain valid.
    takes : inputs that follow from settings which the stage does not read itself, such as cases from borings, or of
        which it reads a part, by names for messages.
    files : files of the user that the stage reads, by names for messages.
    results : patterns of the files with the results of the stage.
    read : function that reads the answers of the stage. The function raises OtherVersionError if another version of the
        program wrote an answer.
    pictures : patterns of the pictures of the stage.
    leftovers : patterns of the files from which the stage continues after a stop; they are removed when the input has
        changed.
    unwanted : function that returns the reason why the settings do not require the stage, empty if they do. A stage
        that is not required runs only if it is requested by name, and its earlier results are reused while they are
        valid.
    partial : function that returns whether the job requests only a part of the stage.
    concurrent_after : stages that must have ended before this stage may run concurrently with others, in another
        process; None if it runs in this process. Only a stage ``of_all`` may need a stage that runs concurrently.
    of_all : whether the stage reports the results of all other stages. A stage that reports all others runs after any
        change of their results, even if stages that it needs have no answer.
    """

    name: str
    description: str
    work: Callable[[Job], None]
    draw: Callable[[Job], None] | None = None
    drawn_after: bool = False
    needs: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()
    ignores: Callable[[Config], Collection[str]] = lambda config: ()
    adds: tuple[str, ...] = ()
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
