"""Releases a column of soil behind a gate: dry columns, clay that slumps, vertical cuts.

The column is on a rough floor between a smooth wall at x = 0, which is an axis of symmetry, and a smooth gate at x =
width.
"""

from collections.abc import Callable, Sequence

import numpy as np

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.laboratory.patch import POROSITIES
from dem.model import DiscModel
from dem.packing import densest, one_stratum, random_packing
from dem.search.undrained_clay import replace_contacts_of_clay
from dem.slides.surface import topmost
from dem.slides.until_rest import UntilRest, run_until_rest
from dem.springs import SMOOTH, LayerSprings
from dem.undisturbed_contacts import mark_undisturbed

G = 9.81  # m/s2
WALL, FLOOR, GATE = range(3)  # numbers of the rigid lines
SINKING = 0.015  # of the height, in settling
SPREAD = 0.2  # half the width of the range of radii, over the mean radius
ROUGHNESS = 0.4  # mean radii that the tops of the floor's discs lie below z = 0, at most
REST_ENERGY = 1e-7  # of g times the height: kinetic energy per mass
REST_DISPLACEMENT = 1e-3  # of the width
LONGEST_SETTLING = 60.0  # sqrt(height / g), until which a column has settled
FADING_TIME = 5.0  # sqrt(height / g), in which the contacts of clay fade out

LayersOf = Callable[[float], Sequence[LayerSprings]]  # void ratio to springs


class SoilColumn:
    """Holds discs packed between a wall and a gate, and releases them.

    Parameters
    ----------
    width, height
        Width and height of the column (m).
    radius
        Mean radius of the discs (m).
    layers_of
        Function that returns the springs for a void ratio of the packing; the column is of the first layer.
    seed
        Seed of the random packing.
    reach
        Length of the rough floor over the width.

    Attributes
    ----------
    model : DiscModel
        The discs, which `settle` and `release` change.

    Raises
    ------
    ValueError
        If no packing fits.
    """

    def __init__(
        self,
        width: float,
        height: float,
        radius: float,
        layers_of: LayersOf,
        *,
        seed: int = 0,
        reach: float = 8.0,
    ) -> None:
        self.width, self.height, self.radius = width, height, radius
        x, z, r = _packed_column(width, height * (1.0 + SINKING), radius, seed)
        floor = _rough_floor(np.random.default_rng(1000 + seed), radius, -3.0 * radius, reach * width)
        void_ratio = width * height / float(np.sum(np.pi * r**2)) - 1.0
        lines = np.array([
            [0.0, 0.0, 1.0, 0.0, -4.0 * radius, 50.0 * height],
            [0.0, -3.0 * radius, 0.0, 1.0, -1e4 * width, 1e4 * width],
            [width, 0.0, -1.0, 0.0, -50.0 * height, 4.0 * radius],
        ])  # fmt: skip
        self.model = DiscModel.create(
            DiscGeometry(
                np.concatenate([x, floor[0]]),
                np.concatenate([z, floor[1]]),
                np.concatenate([r, floor[2]]),
                np.where(np.arange(len(x) + floor.shape[1]) < len(x), 0, -1),
            ),
            DiscMaterials(layers_of(void_ratio), law="soil"),
            DiscBoundary(lines, line_strength=(SMOOTH, None, SMOOTH)),
            gravity=(0.0, -G),
        )

    @property
    def unit(self) -> float:
        """Return sqrt(height / g) (s)."""
        return float(np.sqrt(self.height / G))

    @property
    def porosity(self) -> float:
        """Return the area of voids over total area of the column below its mean top, before the release."""
        free = ~self.model.fixed
        x, top = self.model.x[free], (self.model.z + self.model.radius)[free]
        level = np.mean(top[topmost(x, top, 4.0 * self.radius)])
        return float(1.0 - np.sum(np.pi * self.model.radius[free] ** 2) / (self.width * level))

    def settle(self) -> None:
        """Let the column settle with the gate closed; clay is undrained from then on. Raises DemError."""
        self._come_to_rest()
        if replace_contacts_of_clay(self.model, FADING_TIME * self.unit):
            self._come_to_rest()
        mark_undisturbed(self.model)

    def _come_to_rest(self) -> None:
        free = ~self.model.fixed
        for _ in range(round(LONGEST_SETTLING)):
            Engine(dt=0.5 * largest_step(self.model).seconds, energies=False).run(self.model, self.unit)
            if 0.5 * np.mean((self.model.vx**2 + self.model.vz**2)[free]) < REST_ENERGY * G * self.height:
                return

    def release(self, *, longest: float = 12.0) -> UntilRest:
        """Remove the gate instantaneously, and follow the column until it rests.

        Parameters
        ----------
        longest
            Longest time in units of sqrt(height / g).

        Returns
        -------
        UntilRest
            Record of the collapse; `dem.run_out(column.model)` returns the run-out.
        """
        if len(self.model.lines) > GATE:
            self.model.remove_lines([GATE])
        return run_until_rest(
            self.model, still=REST_DISPLACEMENT * self.width, longest=longest * self.unit, every=0.5 * self.unit
        )


def _packed_column(width: float, height: float, radius: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    outline = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    packing = densest(
        lambda porosity: random_packing(outline, one_stratum, radius, spread=SPREAD, porosity=porosity, seed=seed),
        POROSITIES["soil"],
    )
    return packing.x[packing.free], packing.z[packing.free], packing.radius[packing.free]


def _rough_floor(rng: np.random.Generator, radius: float, left: float, right: float) -> np.ndarray:
    """Return a row of adjacent discs whose tops are at or below z = 0: x, z, radius (3, n)."""
    discs, x = [], left
    while x < right:
        r = radius * rng.uniform(1.0 - SPREAD, 1.0 + SPREAD)
        discs.append((x + r, -r - radius * rng.uniform(0.0, ROUGHNESS), r))
        x += 2.0 * r
    return np.array(discs).T
