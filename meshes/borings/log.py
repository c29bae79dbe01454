"""Holds a boring log as the file gives it: the place, the layers met, and the measurements."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from meshes.borings.blows import is_refusal
from meshes.borings.boring import Cone, Sample
from meshes.section.plausibility import Range, is_within, sentence

DEPTH = Range(0.0, 300.0, "m", 1.0, ((1e-2, "cm"), (1e-3, "mm")))  # of the deepest borings for foundations
# Largest difference (m) of two depths of one contact: a centimetre, and rounding.
CONTACT = 0.0101
# Largest depth (m) of the last test below the end of the boring.
BELOW_END = 1.0
DEPTHS_EXPECTED = "expected depths below the ground, from 0 downwards without a sign; not elevations"


@dataclass(frozen=True)
class LogLayer:
    """Holds a layer that a boring met: name, depths of top and bottom (m), and unit weight as written in the file."""

    name: str
    top: float
    bottom: float
    unit_weight: str = ""
    description: str = ""


@dataclass(frozen=True)
class Log:
    """Holds the log of one boring.

    Attributes
    ----------
    name : name of the boring
    location : (easting, northing) in m, or (x, nan) where it is given along the section
    ground_level : elevation of the ground (m)
    layers : layers from the top down; empty for a sounding
    samples : blow counts from the top down
    water_level : elevation of the water table (m); None if not known
    cones : cone resistances from the top down
    """

    name: str
    location: tuple[float, float]
    ground_level: float
    layers: tuple[LogLayer, ...]
    samples: tuple[Sample, ...] = field(default=())
    water_level: float | None = None
    cones: tuple[Cone, ...] = field(default=())

    @property
    def bottom(self) -> float:
        """Return the elevation at which the boring ends (m)."""
        return self.ground_level - self.layers[-1].bottom


@dataclass(frozen=True)
class BoringFile:
    """Holds the borings of a file.

    Attributes
    ----------
    logs : logs in the order of the file
    notices : notices on how they were read, one sentence each
    """

    logs: list[Log]
    notices: list[str]


def refusal_notices(logs: Sequence[Log]) -> list[str]:
    """Return a notice if blow counts are refusals, with the place of the first refusal."""
    notices = [f'{log.name} at {sample.depth:g} m "{getattr(sample.N, "written", sample.N)}", N = {sample.N:g}'
             for log in logs for sample in log.samples if is_refusal(sample.N)]  # fmt: skip
    if not notices:
        return []
    more = f" and {len(notices) - 3} more" if len(notices) > 3 else ""
    return [f"a refusal counts as the smallest possible N: {'; '.join(notices[:3])}{more}"]


def layer_problems(name: str, layers: list[LogLayer]) -> list[str]:
    """Return the problems of the layers of a boring: no layers, gaps, overlaps, or layers upside down."""
    problems = [] if layers else [f"boring {name}: it has no layers"]
    if layers and min(min(layer.top, layer.bottom) for layer in layers) < -CONTACT:
        return [f"boring {name}: layers at {layers[0].top:g} to {layers[0].bottom:g} m; {DEPTHS_EXPECTED}"]
    for layer in layers:
        if layer.bottom <= layer.top:
            problems.append(f'boring {name}, "{layer.name}": the bottom at {layer.bottom:g} m is not below the top')
    for above, below in pairwise(layers):
        if abs(below.top - above.bottom) > CONTACT:
            problems.append(
                f'boring {name}: "{above.name}" ends at {above.bottom:g} m and "{below.name}" begins at {below.top:g} m'
            )
    if layers and abs(layers[0].top) > CONTACT:
        problems.append(f"boring {name}: its first layer begins at {layers[0].top:g} m; expected 0, the ground")
    return problems


def depth_problems(log: Log) -> list[str]:
    """Return blow counts and water levels far below the end of a boring, which suggest a typing error or another
    unit."""
    end = log.layers[-1].bottom if log.layers else math.inf
    if end < math.inf and not is_within(end, DEPTH):
        return [sentence(f"boring {log.name}, depth of its end", round(end, 2), DEPTH, "")]
    depths = [(f"N = {sample.N:g}", sample.depth) for sample in log.samples]
    depths += [] if log.water_level is None else [("water", log.ground_level - log.water_level)]
    return [f"boring {log.name}: {what} at a depth of {depth:.4g} m; the boring ends at {end:g} m"
            for what, depth in depths if depth > end + BELOW_END]  # fmt: skip


def merged_layers(layers: list[LogLayer]) -> list[LogLayer]:
    """Merge neighbouring layers with the same name, since a file may have a line for each test, or for each
    description."""
    merged: list[LogLayer] = []
    for layer in layers:
        if merged and merged[-1].name == layer.name and abs(merged[-1].bottom - layer.top) <= CONTACT:
            last = merged.pop()
            layer = LogLayer(layer.name, last.top, layer.bottom, last.unit_weight, last.description)
        merged.append(layer)
    return merged


def cone_problems(name: str, cones: Sequence[Cone]) -> list[str]:
    """Return the depths of a sounding that do not increase."""
    return [f"sounding {name}: {b.depth:g} m follows {a.depth:g} m; expected every depth below the one before"
            for a, b in pairwise(cones) if b.depth <= a.depth]  # fmt: skip
