"""Makes random sections that combine all difficulties, each known by its number, as data of a file.

The sections are steep and fall to either side. They have thin seams and wedges, outcropping bases, zones that touch
boundaries, hang or stand on the ground, sand and clay, all kinds of water, cracks, strength ratios and loads. Most are
valid, and some are refused with a sentence; none may end in a traceback.
"""

import math
from typing import Any

import numpy as np

Data = dict[str, Any]


def hostile_data(number: int) -> Data:
    """Return the section of a number."""
    return _Hostile(np.random.default_rng([number, 44])).section(f"hostile_{number}")


class _Hostile:
    """Holds the random draws of one section."""

    def __init__(self, draw: np.random.Generator) -> None:
        self.draw = draw
        self.surface = self._surface()
        (self.left, self.top), (self.right, _) = self.surface[0], self.surface[-1]
        elevations = [z for _, z in self.surface]
        self.low, self.high = min(elevations), max(elevations)
        self.height = max(self.high - self.low, 1.0)
        self.flows = self.chance(0.3)

    def chance(self, share: float) -> bool:
        return bool(self.draw.uniform() < share)

    def between(self, low: float, high: float, digits: int = 2) -> float:
        return round(float(self.draw.uniform(low, high)), digits)

    def pick(self, *of: Any) -> Any:
        return of[int(self.draw.integers(len(of)))]

    def section(self, name: str) -> Data:
        kind, base = self._base()
        strata = self._strata(kind, base)
        data: Data = {"name": name, "surface": self.surface, "base": {kind: base}, "strata": strata}
        if self.chance(0.75):
            data["water"] = self._water()
        if self.chance(0.5):
            data["zones"] = [self._zone(k, [s["name"] for s in strata]) for k in range(int(self.draw.integers(1, 3)))]
        if self.chance(0.35):
            data["surcharges"] = [self._surcharge()]
        if self.chance(0.25):
            water = self.pick("dry", "full", f"{self.between(0.1, 2.0)} m")
            data["tension_crack"] = {"bottom": {"depth": self.between(0.2, 0.6 * self.height)}, "water": water}
        if self.chance(0.15):
            data["beyond"] = f"{self.between(1.0, 4.0 * self.height)} m"
            data["beyond_slope"] = self.pick("level", "parallel")
        return data

    def _surface(self) -> list[list[float]]:
        """Return a slope, an embankment, a cut with a berm, or a few random points, falling to the right or the
        left."""
        height = self.between(1.0, 20.0)
        run = self.pick(0.0, round(height / math.tan(math.radians(self.between(10.0, 85.0))), 2), height)
        crest, following = (self.between(0.3, 3.0) * height for _ in range(2))
        kind = self.pick("slope", "slope", "embankment", "berm", "random", "level")
        if kind == "slope":
            points = [[0.0, height], [crest, height], [crest + run, 0.0], [crest + run + following, 0.0]]
        elif kind == "berm":
            middle = self.between(0.2, 0.8) * height
            x = [0.0, crest, crest + run, crest + run + 2.0, crest + 2.0 * run + 2.5]
            points = [*zip(x, [height, height, middle, middle, 0.0], strict=True), (x[-1] + following, 0.0)]
        elif kind == "embankment":
            x = np.cumsum([0.0, following, run, crest, self.between(0.5, 3.0) * height, following])
            points = [*zip(x, [0.0, 0.0, height, height, 0.0, self.between(-1.0, 1.0)], strict=True)]
        elif kind == "level":
            fall = self.pick(0.0, 1e-4, 0.01)
            points = [[0.0, height], [6.0 * height, height - fall]]
        else:
            x = np.cumsum(self.draw.uniform(0.05, 2.0, int(self.draw.integers(3, 9))) * height)
            points = [*zip(x, self.draw.uniform(0.0, height, len(x)), strict=True)]
        shift = self.pick(0.0, 0.0, self.between(-500.0, 500.0))
        points = [[round(float(x) + shift, 2), round(float(z), 4)] for x, z in points]
        if self.chance(0.4):
            width = points[0][0] + points[-1][0]
            points = [[round(width - x, 2), z] for x, z in points[::-1]]
        return points

    def _base(self) -> tuple[str, list[list[float]]]:
        """Return the base: the kind of its line, and its points."""
        kind = self.pick("level", "depth", "sloping", "at_toe", "out")
        ends = [round(self.low - self.between(0.1, 1.0) * self.height, 2) for _ in range(2)]
        if kind == "depth":
            ends = [round(self.between(0.3, 1.5) * self.height, 2)] * 2
        elif kind == "level":
            ends = ends[:1] * 2
        elif kind == "at_toe":
            ends = [self.low, self.low]
        elif kind == "out":
            share, depth = self.between(0.6, 0.95), round(self.between(0.3, 1.5) * self.height, 2)
            at = round(self.left + share * (self.right - self.left), 2)
            if self.chance(0.5):
                return "depth", [[self.left, depth], [at, 0.0], [self.right, 0.0]]
            at = round(self.left + self.right - at, 2)
            return "depth", [[self.left, 0.0], [at, 0.0], [self.right, depth]]
        line = [[self.left, ends[0]], [self.right, ends[1]]]
        return ("depth" if kind == "depth" else "elevation"), line

    def _strata(self, kind: str, base: list[list[float]]) -> list[Data]:
        """Return up to four strata, whose contacts divide the ground above the base: layers, seams, wedges, blocks."""
        strata, share = [], 0.0
        for k in range(count := int(self.draw.integers(1, 5))):
            soil = self._soil(f"{k + 1} {self.pick('sand', 'clay', 'loam')}")
            if k + 1 < count:
                share += (1.0 - share) * self.pick(self.between(0.003, 0.03, 4), self.between(0.1, 0.6))
                top = 0.0 if kind == "depth" else self.high
                points = [[x, round((1.0 - share) * top + share * z, 3)] for x, z in base]
                if self.chance(0.25):
                    at = round(self.left + self.between(0.2, 0.8) * (self.right - self.left), 2)
                    points = [points[0], [at, points[0][1]]]
                    points[1][1] = 0.0 if kind == "depth" and self.chance(0.5) else points[1][1]
                soil["bottom"] = {kind: points}
            strata.append(soil)
        return strata

    def _soil(self, name: str) -> Data:
        kind = name.split()[-1]
        phi = {"sand": self.pick(30.0, 38.0, 45.0), "clay": 0.0, "loam": self.between(5.0, 40.0, 1)}[kind]
        cohesion = {"sand": 0.0, "clay": self.between(3.0, 100.0, 1), "loam": self.between(0.5, 40.0, 1)}[kind]
        soil: Data = {
            "name": name, "youngs_modulus": f"{self.between(2.0, 100.0)} MPa",
            "poissons_ratio": self.pick(0.0, 0.2, 0.3, 0.45, 0.49), "density": f"{self.between(1.2, 2.1)} t/m^3",
            "density_saturated": "2.1 t/m^3", "cohesion": f"{cohesion} kPa", "friction_angle": f"{phi} deg",
        }  # fmt: skip
        if kind == "clay" and self.chance(0.4):
            soil |= {"strength_ratio": self.between(0.1, 0.5), "cohesion_minimum": "1 kPa", "cohesion": "0 kPa"}
            if self.chance(0.5):
                soil |= self.pick({"ocr": self.between(1.0, 6.0)}, {"pre_overburden_pressure": "15 kPa"})
            if self.chance(0.3):
                soil["consolidated_below"] = self.pick({"depth": 1.0}, round(self.low, 2))
        elif kind != "sand" and self.chance(0.2):
            soil |= {"cohesion_increase": "1.5 kPa/m", "cohesion_from": self.pick({"depth": 0}, round(self.high, 2))}
        if kind == "loam" and self.chance(0.2):
            soil["tension"] = "0 kPa"
        if phi > 10.0 and self.chance(0.2):
            soil["dilation_angle"] = f"{self.pick(0.0, 5.0, phi)} deg"
        if self.chance(0.12):
            soil["pore_pressure_ratio"] = self.pick(0.0, 0.25, 0.5)
        elif self.chance(0.1):
            soil["piezometric_level"] = self.between(self.low, self.high)
        if self.chance(0.05):
            soil["excess_pore_pressure_ratio"] = 0.3
        soil["permeability"] = f"{self.pick(1e-3, 1e-5, 1e-8)} m/s"
        soil["drains"] = self.chance(0.5)
        return soil

    def _water(self) -> Data:
        low, high = self.low - 0.5 * self.height, self.high + 0.5 * self.height
        levels = [self.between(low, high) for _ in range(2)]
        kind = self.pick("level", "sloping", "depth", "bent")
        table: Any = levels[0]
        if kind == "sloping":
            table = [[self.left, levels[0]], [self.right, levels[1]]]
        elif kind == "depth":
            table = {"depth": self.pick(0.0, self.between(0.0, self.height))}
        elif kind == "bent":
            at = round(0.5 * (self.left + self.right), 2)
            table = [[self.left, levels[0]], [at, self.between(low, high)], [self.right, levels[1]]]
        water: Data = {"table": table}
        if self.flows:
            water["flow"] = True
            if self.chance(0.3):
                at = round(self.left + self.between(0.2, 0.8) * (self.right - self.left), 2)
                water["cutoffs"] = [{"x": at, "bottom": self.between(low, self.low)}]
        elif self.chance(0.3):
            water["after_drawdown"] = self.between(low, levels[0])
        if self.chance(0.15):
            water["head"] = "normal"
        if self.chance(0.1):
            water["westergaard"] = True
        return water

    def _zone(self, number: int, names: list[str]) -> Data:
        width, at = self.right - self.left, self.left + self.between(-0.1, 0.9) * (self.right - self.left)
        x = sorted(round(at + self.between(0.0, 0.5) * width, 2) for _ in range(2))
        z = sorted(self.between(self.low - 0.8 * self.height, self.high + 0.2 * self.height) for _ in range(2))
        kind = self.pick("box", "triangle", "trapeze", "edge", "random")
        if kind == "box":
            points = [[x[0], z[0]], [x[1], z[0]], [x[1], z[1]], [x[0], z[1]]]
        elif kind == "triangle":
            points = [[x[0], z[0]], [x[1], z[0]], [x[0], z[1]]]
        elif kind == "trapeze":
            middle = 0.5 * sum(x)
            points = [[x[0], z[0]], [x[1], z[0]], [round(middle + 0.1, 2), z[1]], [round(middle - 0.1, 2), z[1]]]
        elif kind == "edge":  # along the ground and down from it
            subset = self.surface[int(self.draw.integers(len(self.surface) - 1)) :][:3]
            points = [*subset, *[[px, round(pz - self.between(0.02, 0.5) * self.height, 3)] for px, pz in subset[::-1]]]
        else:
            angles = np.sort(self.draw.uniform(0.0, 2.0 * math.pi, 6))
            centre, radii = (0.5 * sum(x), 0.5 * sum(z)), (0.5 * (x[1] - x[0]), 0.5 * (z[1] - z[0]))
            points = [[round(centre[0] + radii[0] * math.cos(a), 2), round(centre[1] + radii[1] * math.sin(a), 2)]
                      for a in angles]  # fmt: skip
        zone: Data = {"name": f"zone {number + 1}", "points": points}
        if self.chance(0.3):
            return zone | {"material": self.pick(*names)}
        return self._soil(f"zone {number + 1} {self.pick('sand', 'clay', 'loam')}") | zone

    def _surcharge(self) -> Data:
        start, end = sorted(round(self.left + self.between(0.0, 1.0) * (self.right - self.left), 2) for _ in range(2))
        pressure: Any = self.pick("10 kPa", "100 kPa", ["0 kPa", "50 kPa"])
        return {"from": start, "to": round(end + 0.5, 2), "pressure": pressure, "consolidated": self.pick(0.0, 1.0)}
