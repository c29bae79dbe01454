"""Continues the ground beyond the ends of a section: surface, layers, base and water continue with the slope of the
ground.

The ground beyond the ends is unknown. But a side at the end of the survey influences the failure, and a side far away
does not. Lines continue parallel to the ground surface, so that every layer keeps its thickness.
"""

from typing import Literal, NamedTuple

import numpy as np

from meshes.section.polyline import Line

# "level", or "parallel" to the last stretch of the ground.
Slope = Literal["level", "parallel"]


class Continuation(NamedTuple):
    """Describes how a section continues beyond its ends.

    Attributes
    ----------
    left, right : x (m) of the ends of the section as it was given
    distance : length of the continuation at either end (m)
    left_slope, right_slope : slope of the ground in the continuation, positive if it rises to the right (-)
    """

    left: float
    right: float
    distance: float
    left_slope: float
    right_slope: float

    def elevations(self, points: np.ndarray) -> np.ndarray:
        """Return a polyline (n, 2) of elevations, continued if it reaches an end of the section."""
        rises = -self.distance * self.left_slope, self.distance * self.right_slope
        return self._continued(points, *rises)

    def depths(self, points: np.ndarray) -> np.ndarray:
        """Return a polyline (n, 2) of depths below the ground, continued with the same depth if it reaches an end of
        the section."""
        return self._continued(points, 0.0, 0.0)

    def line(self, line: Line) -> Line:
        """Return a line that continues beyond the ends."""
        points = line.points(self.left, self.right)
        if line.depth is None:
            return Line(elevation=self.elevations(points).tolist())
        return Line(depth=self.depths(points).tolist())

    def _continued(self, points: np.ndarray, left_rise: float, right_rise: float) -> np.ndarray:
        parts = [points]
        if points[0, 0] <= self.left:
            parts.insert(0, points[:1] + np.array([-self.distance, left_rise]))
        if points[-1, 0] >= self.right:
            parts.append(points[-1:] + np.array([self.distance, right_rise]))
        return np.vstack(parts)


def continuation(surface: np.ndarray, distance: float, slope: Slope) -> Continuation:
    """Return how a section with a ``surface`` (n, 2) continues over a ``distance`` (m)."""
    (x0, z0), (x1, z1) = surface[:2]
    (x2, z2), (x3, z3) = surface[-2:]
    slopes = ((z1 - z0) / (x1 - x0), (z3 - z2) / (x3 - x2)) if slope == "parallel" else (0.0, 0.0)
    return Continuation(float(x0), float(x3), distance, *map(float, slopes))


def continuation_words(length: float, slope: Slope, left: float, right: float) -> str:
    """Return words on the ground beyond the ends ``left`` and ``right`` (m) of a section.

    ``length``: length of this ground on either side (m); ``slope``: whether it is level or continues the slope there.
    """
    how = "level" if slope == "level" else "with the slope of the ground there"
    return f"beyond: ground, layers and water continue for {length:g} m past x = {left:g} and {right:g} m, {how}"
