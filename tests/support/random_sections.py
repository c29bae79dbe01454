"""Makes random slopes of layered ground, each known by its number, for the bounds and for the finite elements.

Two to five layers lie under a face of 15° to 60°, 5 to 15 m high, with thin seams and wedges that end inside the
section; φ is 0 to 45°, c 0 to 50 kPa, some of it clay (φ = 0), some of it sand (c = 0). Only numbers of sections that
stand under their own weight are listed.
"""

import itertools
import math
from typing import Any

import numpy as np

from meshes.errors import InputError
from meshes.section.section import Section

NUMBERS = (
    *(0, 1, 2, 3, 6, 11, 14, 15, 18, 19, 20, 21, 23, 24, 25),
    *(26, 27, 28, 29, 30, 31, 34, 35, 36, 38, 41, 42, 43, 44, 45),
)


def random_section(number: int) -> Section:
    """Return the section of a number, in round figures."""
    return Section.parse(random_data(number))


def random_data(number: int) -> dict[str, Any]:
    """Return the section of a number as data of a file."""
    for attempt in itertools.count():
        data = _drawn(np.random.default_rng([number, attempt]), f"random_{number}")
        try:
            Section.parse(data)
        except InputError:  # a layer that is nowhere
            continue
        return data
    raise AssertionError


def _drawn(draw: np.random.Generator, name: str) -> dict[str, Any]:
    height, angle = draw.integers(50, 151) / 10.0, float(draw.integers(15, 61))
    crest, following = (round(height * float(draw.uniform(1.8, 3.0)), 1) for _ in range(2))
    toe = round(crest + height / math.tan(math.radians(angle)), 2)
    deep = round(height * float(draw.uniform(0.4, 1.0)), 1)
    layers = _Layers(draw, round(toe + following, 2), height, deep, int(draw.integers(2, 6)))
    return {
        "name": name,
        "surface": [[0.0, height], [crest, height], [toe, 0.0], [layers.width, 0.0]],
        "base": {"elevation": -deep},
        "strata": layers.strata(),
    }


class _Layers:
    """Holds layers from the top down; each contact is a straight line at or below the previous one."""

    def __init__(self, draw: np.random.Generator, width: float, height: float, deep: float, count: int) -> None:
        self.draw, self.width = draw, width
        self.ends = np.array([height, height])  # elevations (m) of the last contact at the left and the right side
        self.lowest = 0.3 - deep
        self.levels = height - np.sort(draw.uniform(0.15, 0.9, count - 1)) * (height + deep)

    def strata(self) -> list[dict[str, Any]]:
        upper = [{**self.soil(k), "bottom": {"elevation": self.contact(level)}} for k, level in enumerate(self.levels)]
        return [*upper, self.soil(len(upper))]

    def contact(self, level: float) -> list[list[float]]:
        """Return the bottom of a layer: dipping, parallel to the previous contact (a seam), or ending where it meets
        that contact."""
        kind = self.draw.choice(["dipping", "seam", "wedge"], p=[0.6, 0.2, 0.2])
        before = self.ends
        dip = math.tan(math.radians(float(self.draw.uniform(-8.0, 8.0)))) * self.width / 2.0
        wanted = before - self.draw.uniform(0.2, 0.6) if kind == "seam" else np.array([level - dip, level + dip])
        if kind == "wedge":  # half a metre thick at its thick end, at least
            wanted = np.minimum(wanted, before - 0.5)
        self.ends = np.round(np.maximum(np.minimum(wanted, before), self.lowest), 2)
        if kind != "wedge":
            return [[0.0, float(self.ends[0])], [self.width, float(self.ends[1])]]
        x = round(float(self.draw.uniform(0.4, 0.7)) * self.width, 2)
        tip = [x, float(before[0] + (before[1] - before[0]) * x / self.width)]
        if self.draw.uniform() < 0.5:
            self.ends[1] = before[1]
            return [[0.0, float(self.ends[0])], tip]
        self.ends[0] = before[0]
        return [tip, [self.width, float(self.ends[1])]]

    def soil(self, number: int) -> dict[str, Any]:
        """Return sand, clay or a soil between them, some of it below water."""
        draw = self.draw
        kind = str(draw.choice(["sand", "clay", "loam"], p=[0.2, 0.25, 0.55]))
        density, uplift = round(float(draw.uniform(1.6, 2.1)), 2), 0.9 if draw.uniform() < 0.3 else 0.0
        friction = 0 if kind == "clay" else int(draw.integers(20, 46))
        cohesion = 0 if kind == "sand" else int(draw.integers(15 if kind == "clay" else 1, 51))
        return {
            "name": f"{number + 1} {kind}",
            "youngs_modulus": f"{int(draw.integers(5, 60))} MPa",
            "poissons_ratio": 0.45 if kind == "clay" else 0.3,
            "density_ordinary": f"{density - uplift:.2f} t/m^3",
            "density_seismic": f"{density:.2f} t/m^3",
            "cohesion": f"{cohesion} kPa",
            "friction_angle": f"{friction} deg",
        }
