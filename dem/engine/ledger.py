"""The ledger: where the energy of the discs is, where it came from and where it went (J per metre out of plane)."""

from dataclasses import dataclass

import numpy as np

from dem.kernels.energy import (
    ELEMENTS,
    LATE_BOUNDARY,
    LATE_CRACKS,
    LATE_DASHPOT,
    LATE_SLIDING,
    PORES,
    ROTATION,
    TRANSLATION,
)
from dem.kernels.stepping import CRACKS, DASHPOT, SLIDING, WORK_BOUNDARY, WORK_EXTERNAL, WORK_WEIGHT


@dataclass(frozen=True)
class Ledger:
    """Energies at one instant, and work and losses since the model was made.

    kinetic = translation + rotation; stored in element and pore springs; dissipated by dashpots, sliding, cracks; work
    of weight, of the external acceleration (Kh) and of boundaries that move; edits: energy that came with changes of
    the model between runs (springs set, cut or changed, velocities set). turnover: the most that was ever in play.
    """

    translation: float
    rotation: float
    elements: float
    pores: float
    dashpots: float
    sliding: float
    cracks: float
    weight: float
    external: float
    boundary: float
    edits: float
    turnover: float

    @classmethod
    def of(cls, energies: np.ndarray, books: np.ndarray, edits: float, turnover: float) -> "Ledger":
        """From what the kernels return: `energy.energies` and the books of all slices."""
        total = books.sum(axis=0)
        ledger = cls(
            translation=float(energies[TRANSLATION]),
            rotation=float(energies[ROTATION]),
            elements=float(energies[ELEMENTS]),
            pores=float(energies[PORES]),
            dashpots=float(total[DASHPOT] + energies[LATE_DASHPOT]),
            sliding=float(total[SLIDING] + energies[LATE_SLIDING]),
            cracks=float(total[CRACKS] + energies[LATE_CRACKS]),
            weight=float(total[WORK_WEIGHT]),
            external=float(total[WORK_EXTERNAL]),
            boundary=float(total[WORK_BOUNDARY] + energies[LATE_BOUNDARY]),
            edits=edits,
            turnover=turnover,
        )
        in_play = ledger.kinetic + ledger.stored + ledger.dissipated
        in_play += abs(ledger.weight) + abs(ledger.external) + abs(ledger.boundary)
        object.__setattr__(ledger, "turnover", max(turnover, in_play))
        return ledger

    @property
    def kinetic(self) -> float:
        """Of translation and rotation."""
        return self.translation + self.rotation

    @property
    def stored(self) -> float:
        """In element and pore springs."""
        return self.elements + self.pores

    @property
    def dissipated(self) -> float:
        """By dashpots, sliding and cracks."""
        return self.dashpots + self.sliding + self.cracks

    @property
    def gap(self) -> float:
        """What is there and what is gone, less all work done: zero for a step that is infinitely small."""
        work = self.weight + self.external + self.boundary + self.edits
        return self.kinetic + self.stored + self.dissipated - work
