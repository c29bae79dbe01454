"""Describes the table [water] of an input: where water stands, in the ground and on it, and its unit weight."""

from typing import Literal, Self

from pydantic import Field, StrictBool, model_validator

from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine
from meshes.section.quantity import GRAVITY, Coordinate, Quantity, UnitWeight

# Of fresh water (kg/m³).
FRESH = 1000.0


class Cutoff(Model):
    """Holds a wall, such as a sheet pile, that no water crosses, from the ground surface down; it has neither strength
    nor weight."""

    x: Coordinate = Field(description="the x of the wall (m)")
    bottom: Coordinate = Field(description="the elevation (m) of the foot of the wall")


class Water(Model):
    """Describes where water stands in the ground and on it.

    Below the water table the pores are full and their pressure is hydrostatic. Above it there is no pressure: capillary
    water is left out. Where the table lies above the ground, water stands on the ground and presses on it.
    """

    table: ElevationOrLine | None = Field(
        default=None,
        description="water table: points [[x, elevation], ...], one elevation, or { depth = ... } below the ground",
    )
    flow: StrictBool = Field(
        default=False,
        description=(
            "true for the pore pressures of steady seepage: the table then gives the heads at both sides "
            "and where water stands on the ground, and the water table in between is computed"
        ),
    )
    cutoffs: tuple[Cutoff, ...] = Field(
        default=(), description="walls that water does not flow through, a table [[water.cutoffs]] each"
    )
    after_drawdown: ElevationOrLine | None = Field(
        default=None,
        description=(
            "water table after a rapid drawdown; the key table then gives the water table before it. In strata that do "
            "not drain, the pore pressure falls only by the load of the water that was removed from the ground surface"
        ),
    )
    unit_weight: UnitWeight = Field(
        default=Quantity(FRESH * GRAVITY), description='the unit weight of the water, such as "9.81 kN/m^3"'
    )
    head: Literal["vertical", "normal"] = Field(
        default="vertical",
        description=(
            'direction in which the pressure head below a sloping water table is measured: "vertical", or '
            '"normal" to it (times cos² of the slope, as in seepage parallel to the slope)'
        ),
    )
    westergaard: StrictBool = Field(
        default=False,
        description="true if the inertia of water on the ground acts on the ground, too (Westergaard 1933)",
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.after_drawdown is not None and self.table is None:
            raise ValueError("after_drawdown without table: expected the water table before the drawdown as well")
        if self.westergaard and self.table is None:
            raise ValueError("westergaard = true without table: expected table with the level of the free water")
        if self.flow and self.table is None:
            raise ValueError(
                "flow = true without table: expected table with the levels of free water and of the water at both sides"
            )
        if self.flow and self.after_drawdown is not None:
            raise ValueError("flow = true and after_drawdown: expected one of them, since seepage is steady")
        if self.cutoffs and not self.flow:
            raise ValueError("cutoffs without flow = true: expected flow = true, since walls act on seepage")
        return self
