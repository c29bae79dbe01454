"""The table [tension_crack] of an input: a vertical crack at the head of slip surfaces, and the water in it."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator, model_validator

from meshes.section.model import Model
from meshes.section.polyline import ElevationOrLine, written
from meshes.section.quantity import HEIGHT
from meshes.section.section import Section


def _read_water(value: Any) -> str | float:
    if isinstance(value, str) and value in ("dry", "full"):
        return value
    try:
        return HEIGHT.read(value)
    except ValueError:
        raise ValueError('expected "dry", "full", or the depth of the water in it, such as "1.5 m"') from None


class TensionCrack(Model):
    """Slip circles end at the bottom of the crack, where strength ends; its water presses on the ground that slides."""

    bottom: ElevationOrLine | None = Field(
        default=None,
        description="where cracks end: { depth = 2.0 } below the ground (m), an elevation (m) or a line; there is none "
        "where that is above the ground",
    )
    water: Annotated[str | float, PlainValidator(_read_water), PlainSerializer(written)] = Field(
        default="dry",
        description='"dry", "full", or the depth of the water in it, such as "1.5 m", but full where that is '
        "more than the crack's",
    )

    @model_validator(mode="after")
    def _has_bottom(self) -> Self:
        if self.bottom is None and self.water != "dry":
            raise ValueError("water without bottom: expected bottom, such as { depth = 2.0 }, where cracks end")
        return self

    @property
    def words(self) -> str:
        """A sentence on the cracks; empty where there are none."""
        if self.bottom is None:
            return ""
        words = {"dry": "dry", "full": "full of water"}
        filled = words[self.water] if isinstance(self.water, str) else f"with {self.water:g} m of water in them"
        return f"Slip circles end at tension cracks, {filled}."

    def depth(self, section: Section, x: np.ndarray) -> np.ndarray:
        """Depth (m) of a crack in the ground at every ``x`` (m), 0 where there is none."""
        if self.bottom is None:
            return np.zeros(np.shape(x))
        bottom = np.interp(x, *section.elevations_of(self.bottom).T)
        ground = section.layering.interfaces(np.ravel(x))[:, 0].reshape(np.shape(x))
        return np.maximum(ground - bottom, 0.0)

    def water_depth(self, depth: np.ndarray) -> np.ndarray:
        """Depth (m) of the water in cracks of a ``depth`` (m)."""
        return depth if self.water == "full" else np.minimum(0.0 if self.water == "dry" else float(self.water), depth)
