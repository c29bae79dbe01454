"""Draws pictures of slides, of discs or of material points: every case at its end, and its animation."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from meshes.executor import Tell
from workflow.config import Config
from workflow.results.cases import CaseAnswer, equal_cases
from workflow.results.disc_grids import case_name, frames
from workflow.results.material_points import PointCase
from workflow.run.store import Store

POINTS = "mpm"  # the set of springs of material points, and the folder of their states


@dataclass(frozen=True)
class CasePictures:
    """Holds cases with equal slides to be drawn. The frames of their animation are drawn once.

    Attributes
    ----------
    config, store : the input, and the folder of the run
    springs : set of springs of the discs, or `POINTS`
    cases : answers by the number of the case
    """

    config: Config
    store: Store
    springs: str
    cases: Mapping[int, CaseAnswer | PointCase]

    def picture(self, number: int) -> str:
        """Return the name of the pictures of a case."""
        return f"{POINTS}_case{number}" if self.springs == POINTS else case_name(self.springs, number)

    def states(self, number: int) -> list[Path]:
        """Return the files of the states of a case."""
        of_points = self.springs == POINTS
        name = f"case{number}" if of_points else case_name(self.springs, number)
        return [self.store.folder / file for file in frames(self.store, name, POINTS if of_points else "dem").values()]


def case_pictures(
    config: Config, store: Store, springs: str, cases: Mapping[int, CaseAnswer | PointCase]
) -> list[CasePictures]:
    """Return the pictures of all ``cases`` of a set of ``springs`` from the run folder ``store``. Cases with equal
    answers share their states. ``config``: inputs of the run."""
    return [
        CasePictures(config, store, springs, {number: cases[number] for number in numbers})
        for numbers in equal_cases(cases)
    ]


def draw_cases(wanted: CasePictures, _: Tell) -> None:
    """Draw the picture of each case at its end, and its animation, from its states."""
    from workflow.figures.slides import animate, end

    config, store = wanted.config, wanted.store
    with_states = {number: states for number in wanted.cases if (states := wanted.states(number))}
    for number, states in with_states.items():
        sheet = end(config, states[-1], wanted.cases[number], wanted.springs, number)
        store.save(f"figures/{wanted.picture(number)}.png", sheet)
    if with_states:
        with ExitStack() as files:
            names = {number: f"figures/{wanted.picture(number)}.webp" for number in with_states}
            out = {number: files.enter_context(store.writing(name)) for number, name in names.items()}
            animate(config, next(iter(with_states.values())), wanted.springs, out)
