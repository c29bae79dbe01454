"""What can be computed of a sample, part by part."""

from collections.abc import Callable
from dataclasses import dataclass

from workflow.study.continuum import bounds, continuum
from workflow.study.discs import STAGES, discs
from workflow.study.sample import Numbers, Sample


@dataclass(frozen=True)
class Part:
    """A part of a study.

    Attributes
    ----------
    name : the word by which the command line knows it
    function : what computes it, of one sample
    tables : the tables of settings that matter to it; where others differ it is not computed again
    keeps : whether it takes so long that it keeps a folder to go on from
    """

    name: str
    function: Callable[[Sample], Numbers]
    tables: tuple[str, ...]
    keeps: bool = False


PARTS = (
    Part("fem", continuum, ("mesh", "fem")),
    Part("bounds", bounds, ("fem", "bounds")),
    Part("slide", discs, tuple(dict.fromkeys(table for stage in STAGES for table in stage.tables)), keeps=True),
)
