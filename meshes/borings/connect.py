"""Places borings on the line of a section, and connects layers of the same name from one boring to the next."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise

import numpy as np

from meshes.borings.complaints import folded
from meshes.borings.log import Log, LogLayer, merged_layers
from meshes.errors import InputError
from meshes.section.numbering import Piece, Stack, stacked

REMEDY = "--borings selects the borings of the section"
WATER_ABOVE = 0.1  # m, by which water is reported to stand above the ground
OFF_LINE = 20.0  # m, beside the line, beyond which a boring does not belong to the section


@dataclass(frozen=True)
class PlacedBoring:
    """Holds a boring, its place along the section, and its distance from the line of the section (m)."""

    log: Log
    x: float
    off_line: float


@dataclass(frozen=True)
class ConnectedBorings:
    """Holds the parts of a section that borings determine.

    Attributes
    ----------
    borings : borings with layers, from left to right
    names : names of the strata, from the top down
    x : x of the borings and of the middles between them (m)
    ground : elevations of the ground at ``x`` (m)
    bottoms (strata, x) : elevations of their bottoms; where a stratum is not, that of the one above
    soundings : borings without layers, from left to right
    notices : notices on how layers were connected, one sentence each
    """

    borings: tuple[PlacedBoring, ...]
    names: tuple[str, ...]
    x: np.ndarray
    ground: np.ndarray
    bottoms: np.ndarray
    soundings: tuple[PlacedBoring, ...] = ()
    notices: tuple[str, ...] = ()


def placed(logs: Sequence[Log], off_line: float = OFF_LINE) -> tuple[PlacedBoring, ...]:
    """Place the borings at the x that they give, or along the line through the two borings with layers that are
    farthest apart.

    Raises InputError if two borings have the same name or place, if a boring lies off the line, or if a sounding lies
    beyond the borings.
    """
    names = [log.name for log in logs]
    problems = [f"boring {name}: {names.count(name)} borings have this name" for name in dict.fromkeys(names)
                if names.count(name) > 1]  # fmt: skip
    along = [math.isnan(log.location[1]) for log in logs]
    if any(along) and not all(along):
        problems.append("some borings have an x, others easting and northing; expected the same coordinates for all")
    layered_logs = [log for log in logs if log.layers]
    if len(layered_logs) < 2:
        have = "fewer than two borings have" if layered_logs else "soundings alone have no"
        problems.append(f"{have} layers; expected borings with layers at both ends of the section")
    if problems:
        raise InputError("borings", problems)
    if all(along):
        borings = [PlacedBoring(log, log.location[0], 0.0) for log in logs]
    else:
        points = np.array([log.location for log in logs])
        apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
        layered = np.array([bool(log.layers) for log in logs])
        apart[~layered] = apart[:, ~layered] = 0.0
        first, last = sorted(np.unravel_index(int(apart.argmax()), apart.shape))
        if apart[first, last] == 0.0:
            raise InputError("borings", ["all borings are at the same place"])
        direction = (points[last] - points[first]) / apart[first, last]
        x, offsets = (points - points[first]) @ direction, (points - points[first]) @ [-direction[1], direction[0]]
        problems = [f"boring {log.name}: {abs(away):.1f} m off the line of the section; {REMEDY}, --off allows more "
                    f"than {off_line:g} m"
                    for log, away in zip(logs, offsets, strict=True) if abs(away) > off_line]  # fmt: skip
        borings = [PlacedBoring(log, round(float(a), 3), float(b)) for log, a, b in zip(logs, x, offsets, strict=True)]
    borings.sort(key=lambda at: at.x)
    layers = [at for at in borings if at.log.layers]
    problems += [f"borings {a.log.name} and {b.log.name} stand at the same x = {a.x:g} m; {REMEDY}"
                 for a, b in pairwise(layers) if b.x - a.x < 1e-3]  # fmt: skip
    ends = [at.x for at in layers]
    problems += [
        f"sounding {at.log.name}: at x = {at.x:g} m it stands beyond the borings with layers, "
        f"{ends[0]:g} to {ends[-1]:g} m"
        for at in borings
        if not ends[0] <= at.x <= ends[-1]
    ]
    if problems:
        raise InputError("borings", folded(problems))
    return tuple(borings)


def order(logs: Sequence[Log]) -> tuple[str, ...] | None:
    """Return the names of the strata from the top down, in the order in which every boring has them; None if there is
    no such order."""
    below: dict[str, set[str]] = {}
    for log in logs:
        names = [layer.name for layer in log.layers]
        for name in names:
            below.setdefault(name, set())
        for above, name in pairwise(names):
            below[name].add(above)
    try:
        return tuple(TopologicalSorter(below).static_order())
    except CycleError:  # a layer that is met twice lies above and below another
        return None


def _piece(log: Log, layer: LogLayer) -> Piece:
    ends = (log.ground_level - layer.top, log.ground_level - layer.bottom)
    return Piece(layer.name, ends, ends)


def _numbered(borings: Sequence[PlacedBoring]) -> tuple[tuple[PlacedBoring, ...], Stack]:
    """Return the borings with the names of the strata, and the stack of all strata. A layer that lies both above and
    below another one becomes several strata, whose names have numbers."""
    stack = stacked([[_piece(boring.log, layer) for layer in boring.log.layers] for boring in borings])
    numbered = []
    for boring, numbers in zip(borings, stack.numbers, strict=True):
        pairs = zip(boring.log.layers, numbers, strict=True)
        layers = tuple(replace(layer, name=stack.names[number]) for layer, number in pairs)
        numbered.append(replace(boring, log=replace(boring.log, layers=layers)))
    return tuple(numbered), stack


def connected(logs: Sequence[Log], off_line: float = OFF_LINE) -> ConnectedBorings:
    """Connect the strata of neighbouring borings by straight lines.

    A stratum that is missing in the next boring ends half-way. The fill of an embankment ends at the ground of the next
    boring. A layer that lies above and below other layers becomes several strata, with numbers. The ground below a
    boring's end is continued level from the nearest boring that is deep enough.

    Parameters
    ----------
    logs : borings with layers, and soundings between them
    off_line : largest distance of a boring from the line of the section (m)

    Returns
    -------
    The strata of the section, and notices.

    Raises
    ------
    InputError
        If the borings cannot be placed on the line of a section, see `placed`.
    """
    logs, alike = _spelled_alike(logs)
    everything = placed(logs, off_line)
    borings = tuple(boring for boring in everything if boring.log.layers)
    soundings = tuple(boring for boring in everything if not boring.log.layers)
    names, notices = order([boring.log for boring in borings]), []
    if names is None:
        borings, stack = _numbered(borings)
        names, notices = stack.names, [f"{text}, connected by their order" for text in stack.notices]
    at = np.array([boring.x for boring in borings])
    levels = np.array([boring.log.ground_level for boring in borings])
    known = [[_bottom(boring.log, name, names) for name in names] for boring in borings]
    x = np.sort(np.concatenate([at, 0.5 * (at[1:] + at[:-1])]))
    ground = np.interp(x, at, levels)
    bottoms = np.empty((len(names), len(x)))
    for k in range(len(names)):
        above = ground if k == 0 else bottoms[k - 1]
        bottoms_here = [_estimated_bottom(known, k, i, at, borings[i].log) for i in range(len(borings))]
        for place in range(len(x)):
            left, odd = divmod(place, 2)
            values = (bottoms_here[left], bottoms_here[left + 1]) if odd else (bottoms_here[left],)
            known_values = [value for value in values if value is not None]
            level = float(np.mean(known_values)) if len(known_values) == len(values) else float(above[place])
            if len(known_values) < len(values) == 2 and known_values and above[place] == ground[place]:
                level = _end_at_the_ground(known_values[0], levels[left if values[0] is None else left + 1], level)
            bottoms[k, place] = min(level, float(above[place]))
    notices = [*alike, *notices, *_water_above(borings)]
    return ConnectedBorings(borings, names, x, ground, bottoms, soundings, tuple(notices))


def _spelled_alike(logs: Sequence[Log]) -> tuple[list[Log], list[str]]:
    """Return the borings, in which layers whose names differ only in capitals and blanks get one name, and a sentence
    for each such name."""
    first: dict[str, str] = {}
    spellings: dict[str, list[str]] = {}
    for name in (layer.name for log in logs for layer in log.layers):
        plain = " ".join(name.split()).casefold()
        spellings.setdefault(first.setdefault(plain, name), []).append(name)
    whole = {name: spelling for spelling, names in spellings.items() for name in names}
    unified = [
        replace(log, layers=tuple(merged_layers([replace(layer, name=whole[layer.name]) for layer in log.layers])))
        for log in logs
    ]
    several = [list(dict.fromkeys(names)) for names in spellings.values() if len(set(names)) > 1]
    notices = [f'{" and ".join(json.dumps(name, ensure_ascii=False) for name in names)} are read as one stratum, '
               f'"{names[0]}"' for names in several]  # fmt: skip
    return unified, notices


def _water_above(borings: Sequence[PlacedBoring]) -> list[str]:
    """Return a sentence for each boring whose water level is above the ground, which is either open water, an artesian
    head, or an error of the file."""
    above = [(at.log, at.log.water_level - at.log.ground_level) for at in borings if at.log.water_level is not None]
    return [f"boring {log.name}: the water level, {log.water_level:.4g} m, is {height:.3g} m above its ground: "
            "expected the elevation of a water table, or of a river or pond that stands there"
            for log, height in above if height > WATER_ABOVE]  # fmt: skip


def _end_at_the_ground(bottom: float, ground: float, half_way: float) -> float:
    """Return the elevation at which a layer at the ground ends, half-way to a boring that lacks it. As a rule it is
    that of the ground surface there.

    The ground surface half-way may be higher than both the ``bottom`` in the one boring and the ``ground`` at the
    other, as under an embankment whose fill the next boring lacks. In this case the bottom goes straight to the ground
    at the other boring.
    """
    return 0.5 * (bottom + ground) if half_way > max(bottom, ground) + 1e-9 else half_way


UNKNOWN = math.nan  # below the end of a boring


def _bottom(log: Log, name: str, names: Sequence[str]) -> float | None:
    """Return the elevation of the bottom of a stratum in a boring; None if the boring does not meet it, `UNKNOWN` below
    the end of the boring."""
    met = [layer.name for layer in log.layers]
    if name in met[:-1]:
        return log.ground_level - next(layer.bottom for layer in log.layers if layer.name == name)
    return UNKNOWN if names.index(name) >= names.index(met[-1]) else None


def _estimated_bottom(
    known: Sequence[Sequence[float | None]], k: int, i: int, at: np.ndarray, log: Log
) -> float | None:
    """Return the bottom of stratum k in boring i. If it is unknown, return that of the nearest boring in which it is
    known.

    The bottom does not lie above the end of the boring, since the boring ended in this layer.
    """
    value = known[i][k]
    if value is None or not math.isnan(value):
        return value
    others = [j for j in range(len(at)) if known[j][k] is None or not math.isnan(float(known[j][k] or 0.0))]
    nearest = known[min(others, key=lambda j: abs(at[j] - at[i]))][k] if others else None
    ends_here = k == 0 or known[i][k - 1] is None or not math.isnan(float(known[i][k - 1] or 0.0))
    if nearest is None:
        return log.bottom if ends_here else None
    return min(nearest, log.bottom)
