"""Stability of ground with another strength than that of the input: after liquefaction, or after large shear
strains.
"""

from typing import Literal

from pydantic import Field

from fem.continuum.loads import Direction
from workflow.results.answer import Part

Stands = Literal["stands", "flows"]


class Bearing(Part):
    """Whether ground stands, its factor of safety and its critical Kh."""

    stands: Stands = Field(description="without shaking: by strict bounds where they decide, else by the elements")
    reason: str
    kc: float | None = Field(description="critical Kh by finite elements; None: it fails under its weight")
    direction: Direction | None = Field(
        default=None, description="direction of the seismic force with the smallest critical Kh"
    )
    kc_lower: float | None = Field(description="strict bounds of that Kh, ψ = φ; None where they were not found")
    kc_upper: float | None
    factor: float | None = Field(description="factor of safety at Kh = 0 by finite elements, sides held horizontally")
    factor_lower: float | None = Field(description="strict bounds of that factor, with the sides of [fem], ψ = φ")
    factor_upper: float | None
    notes: tuple[str, ...] = Field(description="what could not be found, and why")
