"""Describes the table [consolidation] of an input: the state to which the ground consolidated, if it is not the present
one.

A flood that lasts for days raises the pore pressure in a dike, and a new berm its weight, but not the preconsolidation
stress σ'p, which stays that of the state before: σ'p = OCR σ'vc, or σ'vc + POP, with the vertical effective stress σ'vc
of that state. The undrained strength is S σ'v (σ'p / σ'v)^m with the present σ'v (Jardine & Hight 1987; as D-Stability
computes the strength of a stage from the state of an earlier stage).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine, Line, lower_line
from meshes.section.water_pressure import WaterPressure


class Consolidation(Model):
    """Holds the water table and the ground surface under which strata with a strength_ratio have consolidated."""

    table: ElevationOrLine | None = Field(
        default=None,
        description="water table under which the ground consolidated, such as the mean level of a river, with "
        "hydrostatic pressure in all strata; by default the present water",
    )
    surface: ElevationOrLine | None = Field(
        default=None,
        description="ground surface under which the ground consolidated, such as that before a berm; by default the "
        "present ground surface",
    )

    @model_validator(mode="after")
    def _has_a_line(self) -> Self:
        if self.table is None and self.surface is None:
            raise ValueError("table and surface: missing; expected at least one of them")
        return self


@dataclass(frozen=True, eq=False)
class ConsolidatedState:
    """Computes the vertical effective stress of the state to which the ground consolidated.

    Attributes
    ----------
    water : water of that state; the weights of the strata are the present ones
    table, surface (n, 2) : water table and ground surface of that state (m); None for the present ones
    """

    water: WaterPressure
    table: np.ndarray | None
    surface: np.ndarray | None

    @classmethod
    def of(cls, water: WaterPressure, state: Consolidation, elevations_of: Callable[[Line], np.ndarray]) -> Self:
        """Return the state of the table [consolidation]; ``elevations_of`` gives a line as (n, 2) from side to side."""
        table, surface = (None if line is None else elevations_of(line) for line in (state.table, state.surface))
        if table is not None:
            count = len(water.strata)
            levels, heads = (table,) * count, (None,) * count
            water = replace(water, levels=levels, heads=heads, table_before=table, table_after=table, flow=None)
        return cls(water, table, surface)

    @property
    def lines(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Return the water table and the ground surface (n, 2) of the state; None for the present ones."""
        return self.table, self.surface

    def at(
        self, points: np.ndarray, near: np.ndarray, stratum: np.ndarray, top: np.ndarray | None, load: np.ndarray
    ) -> np.ndarray:
        """Return the vertical effective stress (n,) in Pa, never negative. ``points``, ``near``, ``stratum``, ``top``,
        ``load``: as in ``WaterPressure.vertical_effective``."""
        surface = top if self.surface is None else self.surface if top is None else lower_line(top, self.surface)
        return self.water.vertical_effective(points, near, stratum, surface, load)
