"""Defines the parts of a study: the results that can be computed for a sample."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from fem.settings import WITHOUT_EFFECT
from workflow.study.continuum import bounds, continuum
from workflow.study.discs import STAGES, discs
from workflow.study.task import Numbers, StudySample


@dataclass(frozen=True)
class StudyPart:
    """Holds a part of a study: a result that the study computes for every sample, such as the critical Kh.

    Attributes
    ----------
    name : name of the part on the command line
    function : function that computes the part for one sample
    tables : tables of settings that the part reads; it is not computed again after changes of other tables
    ignores : settings in these tables without effect on the numbers of the part, as "table.key"
    keeps : whether the part takes so long that it stores a folder from which it continues
    """

    name: str
    function: Callable[[StudySample], Numbers]
    tables: tuple[str, ...]
    ignores: tuple[str, ...] = ()
    keeps: bool = False


# What the stages of slides read, and what decides on their cases.
OF_SLIDES = (*dict.fromkeys(name.split(".")[0] for stage in STAGES for name in stage.reads), "earthquake", "triggering")
PARTS = (
    StudyPart("fem", continuum, ("mesh", "fem"), (*WITHOUT_EFFECT, "fem.rigid_box")),
    StudyPart("bounds", bounds, ("fem", "bounds"), (*WITHOUT_EFFECT, "fem.rigid_box", "bounds.safety_factor")),
    StudyPart("slide", discs, OF_SLIDES, keeps=True),
)

# What the sliding block of a sample reads, which needs no part of its own.
OF_THE_BLOCK = ("fem", "sliding_block", "slide", "site_response")
# What every study reads, whatever it computes.
OF_ALL = ("study", "uncertain", "earthquake", "triggering", "figures", "report", "dem.workers")


def read_by(parts: Sequence[str]) -> tuple[str, ...]:
    """Return the tables of settings that some parts of a study read.

    Parameters
    ----------
    parts : names of parts, "block" among them

    Returns
    -------
    Names of tables, also of those that every study reads; a table may be named twice.
    """
    tables = [table for part in PARTS if part.name in parts for table in part.tables]
    return (*OF_ALL, *tables, *(OF_THE_BLOCK if "block" in parts else ()))
