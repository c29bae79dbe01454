"""What presses on the ground beside still water: surcharges, their inertia, and that of the water."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.surcharge import Surcharge
from meshes.section.water_pressure import WaterPressure

# Of the pressure of moving water on a wall, Westergaard 1933, Trans. ASCE 98, eq. 24 in its rounded form.
WESTERGAARD = 7.0 / 8.0


@dataclass(frozen=True)
class SurfaceLoads:
    """Tractions (n, 2) in Pa at ``points`` (n, 2) in m of the ground, where its outward ``normal`` is (n, 2).

    ``near`` (n, 2) is a point on the same straight stretch of the ground, such as the middle of an edge of a mesh.
    """

    surcharges: Sequence[Surcharge]
    water: WaterPressure

    @property
    def present(self) -> bool:
        """Whether there is anything but still water."""
        return bool(self.surcharges) or self.water.moves

    def dead(self, points: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """The weight of the surcharges; they press on the ground by its horizontal area."""
        load = sum((s.at(points[:, 0], near[:, 0]) for s in self.surcharges), np.zeros(len(points)))
        return np.column_stack([np.zeros(len(points)), -load * np.abs(normal[:, 1])])

    def shaken(self, sign: int, points: np.ndarray, near: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """What Kh = 1 adds, the inertia force on the ground being to the right (``sign`` 1) or to the left (-1).

        Surcharges push with the share of their mass that shakes. Ground that shakes away from water draws on it, and
        presses on it in the other direction, by 7/8 γw sqrt(H y) Kh on a wall at a depth y in water that is H deep
        (Westergaard 1933); a face that is not upright takes the part of it that its horizontal normal is.
        """
        load = sum((s.seismic_share * s.at(points[:, 0], near[:, 0]) for s in self.surcharges), np.zeros(len(points)))
        traction = np.column_stack([sign * load * np.abs(normal[:, 1]), np.zeros(len(points))])
        if self.water.moves:
            depth = self.water.on_ground(points, near) / self.water.unit_weight
            drawn = WESTERGAARD * self.water.unit_weight * np.sqrt(self.water.deepest * depth)
            traction = traction + (sign * drawn * normal[:, 0])[:, None] * normal
        return traction
