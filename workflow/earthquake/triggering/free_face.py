"""A free face towards which liquefied ground spreads: a table [free_face]."""

import numpy as np
from pydantic import Field

from meshes.section.quantity import Coordinate
from meshes.section.section import Model


class FreeFaceSettings(Model):
    """Toe and top of a free face, and the place behind it where the displacement is required."""

    crest: Coordinate | None = Field(default=None, description="the x of its upper edge")
    toe: Coordinate | None = Field(default=None, description="the x of its foot")
    at: Coordinate | None = Field(
        default=None, description="the x, behind the crest, where the displacement is computed; by default the crest"
    )

    def problems(self, ground: np.ndarray) -> list[str]:
        """Problems of the free face on this ground, points (n, 2) in m, one sentence each."""
        if self.crest is None and self.toe is None and self.at is None:
            return []
        problems = [f"free_face, {key}: missing; expected both crest and toe" for key in ("crest", "toe")
                if getattr(self, key) is None]  # fmt: skip
        for key in ("crest", "toe", "at"):
            value = getattr(self, key)
            if value is not None and not ground[0, 0] <= value <= ground[-1, 0]:
                problems.append(f"free_face, {key} = {value:g}: off the section, which goes from {ground[0, 0]:g} to "
                            f"{ground[-1, 0]:g} m")  # fmt: skip
        if self.crest is None or self.toe is None or problems:
            return problems
        if self.distance_and_height(ground)[1] <= 0.0:
            problems.append(f"free_face: the ground at the crest, x = {self.crest:g} m, is not above that at the toe")
        if self.at is not None and (self.at - self.crest) * (self.toe - self.crest) > 0.0:
            problems.append(f"free_face, at = {self.at:g}: lies before the crest; expected a place behind it")
        return problems

    def distance_and_height(self, ground: np.ndarray) -> tuple[float, float]:
        """Distance L (m) from the toe to the required place, and height H (m) of the free face."""
        if self.crest is None or self.toe is None:
            raise ValueError("the section has no free face")
        upper, lower = np.interp([self.crest, self.toe], *ground.T)
        place = self.crest if self.at is None else self.at
        return abs(float(place) - float(self.toe)), float(upper - lower)

    def __bool__(self) -> bool:
        return self.toe is not None
