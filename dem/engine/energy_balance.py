"""Computes the energy balance of the discs: energy, work and losses (J per metre out of plane)."""

from dataclasses import dataclass

import numpy as np

from dem.kernels import arguments, energy


@dataclass(frozen=True)
class EnergyBalance:
    """Holds the energies at one instant, and work and losses since the model was made, in J per metre out of plane.

    Attributes
    ----------
    translation, rotation : kinetic energy of translation and of rotation
    elements, pores, rolling_springs : energy stored in springs: contact springs, pore springs, springs of rolling
        resistance
    bonds : energy of contacts between discs of cohesive soil, which attract each other: minus the work that would
        separate all of these contacts
    dashpots, sliding, cracks, rolling : energy dissipated by dashpots, by sliding, by cracks and by rolling resistance
    pore_water, liquefied_bonds : energy stored in liquefied ground: in its pore water, and in the bonds that model its
        residual strength
    liquefied_slip, viscosity : energy dissipated in liquefied ground: by slip of bonds, and by viscosity
    stand_in : work of the pore pressure with which ground that has not liquefied supports liquefied ground
    weight, external, boundary : work of weight, of the external acceleration (Kh) and of moving boundaries
    edits : energy added by changes of the model between runs (springs set, cut or changed, velocities set)
    turnover : total energy exchanged so far, the reference of relative errors
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
    def of(cls, measured: np.ndarray, sums: np.ndarray, edits: float, turnover: float) -> "EnergyBalance":
        """Return the energy balance from the results of the kernels: `energy.energies`, and the sums over all slices.

        measured: (ENERGIES,) energies now (J); sums: (slices, ENERGY_COLUMNS) work and losses (J); edits: energy that
        changes of the model added (J); turnover: total energy exchanged so far (J).
        """
        total = sums.sum(axis=0)
        balance = cls(
            translation=float(measured[energy.TRANSLATION]),
            rotation=float(measured[energy.ROTATION]),
            elements=float(measured[energy.ELEMENTS]),
            pores=float(measured[energy.PORES]),
            rolling_springs=float(measured[energy.ROLLING_SPRINGS]),
            bonds=float(measured[energy.BONDS]),
            dashpots=float(total[arguments.DASHPOT] + measured[energy.LATE_DASHPOT]),
            sliding=float(total[arguments.SLIDING] + measured[energy.LATE_SLIDING]),
            cracks=float(total[arguments.CRACKS] + measured[energy.LATE_CRACKS]),
            rolling=float(total[arguments.ROLLING] + measured[energy.LATE_ROLLING]),
            weight=float(total[arguments.WORK_WEIGHT]),
            external=float(total[arguments.WORK_EXTERNAL]),
            boundary=float(total[arguments.WORK_BOUNDARY] + measured[energy.LATE_BOUNDARY]),
            edits=edits,
            turnover=turnover,
            pore_water=float(measured[energy.PORE_WATER]),
            liquefied_bonds=float(measured[energy.LIQUEFIED_BONDS]),
            liquefied_slip=float(total[arguments.BONDS]),
            viscosity=float(total[arguments.VISCOSITY]),
            stand_in=float(total[arguments.STAND_IN]),
        )
        in_play = balance.kinetic + balance.in_springs + balance.dissipated
        in_play += abs(balance.weight) + abs(balance.external) + abs(balance.boundary)
        object.__setattr__(balance, "turnover", max(turnover, in_play))
        return balance

    @property
    def kinetic(self) -> float:
        """Return the kinetic energy of translation and rotation (J/m)."""
        return self.translation + self.rotation

    @property
    def in_springs(self) -> float:
        """Return the energy stored in springs."""
        return self.elements + self.pores + self.rolling_springs

    @property
    def stored(self) -> float:
        """Return the energy stored in springs and bonds, and in liquefied ground."""
        return self.in_springs + self.bonds + self.pore_water + self.liquefied_bonds

    @property
    def dissipated(self) -> float:
        """Return the energy dissipated by dashpots, sliding, cracks and rolling resistance, and in liquefied ground."""
        return self.dashpots + self.sliding + self.cracks + self.rolling + self.liquefied_slip + self.viscosity

    @property
    def gap(self) -> float:
        """Return the energy that is unaccounted for: present and dissipated energy less the work of all forces; zero in
        the limit of small steps."""
        work = self.weight + self.external + self.boundary + self.stand_in + self.edits
        return self.kinetic + self.stored + self.dissipated - work
