"""The ledger: where the energy of the discs is, where it came from and where it went (J per metre out of plane)."""

from dataclasses import dataclass

import numpy as np

from dem.kernels.arguments import BONDS as LIQUEFIED_SLIP
from dem.kernels.arguments import (
    CRACKS,
    DASHPOT,
    ROLLING,
    SLIDING,
    STAND_IN,
    VISCOSITY,
    WORK_BOUNDARY,
    WORK_EXTERNAL,
    WORK_WEIGHT,
)
from dem.kernels.energy import (
    BONDS,
    ELEMENTS,
    LATE_BOUNDARY,
    LATE_CRACKS,
    LATE_DASHPOT,
    LATE_ROLLING,
    LATE_SLIDING,
    LIQUEFIED_BONDS,
    PORE_WATER,
    PORES,
    ROLLING_SPRINGS,
    ROTATION,
    TRANSLATION,
)


@dataclass(frozen=True)
class Ledger:
    """Energies at one instant, and work and losses since the model was made, all in J per metre.

    Attributes
    ----------
    translation, rotation : float
        Kinetic.
    elements, pores, rolling_springs : float
        Stored in springs: of elements, of pore springs, of rolling resistance.
    bonds : float
        Of discs of cohesive soil that attract each other; negative, it takes as much to part them all.
    dashpots, sliding, cracks, rolling : float
        Dissipated by dashpots, by sliding, by cracks, by rolling resistance.
    pore_water, liquefied_bonds : float
        Stored in liquefied ground: in its pore water, and in the bonds that are its residual strength.
    liquefied_slip, viscosity : float
        Dissipated in liquefied ground: by bonds that slip, and by viscosity.
    stand_in : float
        Work of pore water that stands in for ground beside it which has not liquefied.
    weight, external, boundary : float
        Work of weight, of the external acceleration (Kh), of boundaries that move.
    edits : float
        Energy that came with changes of the model between runs (springs set, cut or changed, velocities set).
    turnover : float
        The most that was ever in play.
    """

    translation: float
    rotation: float
    elements: float
    pores: float
    rolling_springs: float
    bonds: float
    dashpots: float
    sliding: float
    cracks: float
    rolling: float
    weight: float
    external: float
    boundary: float
    edits: float
    turnover: float
    pore_water: float = 0.0
    liquefied_bonds: float = 0.0
    liquefied_slip: float = 0.0
    viscosity: float = 0.0
    stand_in: float = 0.0

    @classmethod
    def of(cls, energies: np.ndarray, sums: np.ndarray, edits: float, turnover: float) -> "Ledger":
        """From what the kernels return: `energy.energies` and the sums of all slices."""
        total = sums.sum(axis=0)
        ledger = cls(
            translation=float(energies[TRANSLATION]),
            rotation=float(energies[ROTATION]),
            elements=float(energies[ELEMENTS]),
            pores=float(energies[PORES]),
            rolling_springs=float(energies[ROLLING_SPRINGS]),
            bonds=float(energies[BONDS]),
            dashpots=float(total[DASHPOT] + energies[LATE_DASHPOT]),
            sliding=float(total[SLIDING] + energies[LATE_SLIDING]),
            cracks=float(total[CRACKS] + energies[LATE_CRACKS]),
            rolling=float(total[ROLLING] + energies[LATE_ROLLING]),
            weight=float(total[WORK_WEIGHT]),
            external=float(total[WORK_EXTERNAL]),
            boundary=float(total[WORK_BOUNDARY] + energies[LATE_BOUNDARY]),
            edits=edits,
            turnover=turnover,
            pore_water=float(energies[PORE_WATER]),
            liquefied_bonds=float(energies[LIQUEFIED_BONDS]),
            liquefied_slip=float(total[LIQUEFIED_SLIP]),
            viscosity=float(total[VISCOSITY]),
            stand_in=float(total[STAND_IN]),
        )
        in_play = ledger.kinetic + ledger.in_springs + ledger.dissipated
        in_play += abs(ledger.weight) + abs(ledger.external) + abs(ledger.boundary)
        object.__setattr__(ledger, "turnover", max(turnover, in_play))
        return ledger

    @property
    def kinetic(self) -> float:
        """Kinetic energy of translation and rotation (J/m)."""
        return self.translation + self.rotation

    @property
    def in_springs(self) -> float:
        """What springs carry."""
        return self.elements + self.pores + self.rolling_springs

    @property
    def stored(self) -> float:
        """In springs and bonds, and in liquefied ground."""
        return self.in_springs + self.bonds + self.pore_water + self.liquefied_bonds

    @property
    def dissipated(self) -> float:
        """By dashpots, sliding, cracks and rolling resistance, and in liquefied ground."""
        return self.dashpots + self.sliding + self.cracks + self.rolling + self.liquefied_slip + self.viscosity

    @property
    def gap(self) -> float:
        """What is there and what is gone, less all work done: zero for a step that is infinitely small."""
        work = self.weight + self.external + self.boundary + self.stand_in + self.edits
        return self.kinetic + self.stored + self.dissipated - work
