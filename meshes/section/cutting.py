"""Divides strata where water crosses them: the part above is moist, the part below is saturated."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from meshes.section.dense_lines import CELL
from meshes.section.layering import Layering, at_ends
from meshes.section.liquefies import Cases
from meshes.section.polyline import Line, crossings, without_repeats
from meshes.section.stratum import Stratum

# What is added to the name of a stratum for the part of it that lies below water, and for a pocket or a film of water
# or of moist ground in it that meshes of elements leave out.
BELOW_WATER, FILM_IN = ", below water", ", film"
ABOVE_WATER = {"liquefies_in": Cases(), "excess_pore_pressure_ratio": 0.0}  # shaking adds no pore pressure there
# What is added for the part of it that has the least of a cohesion that varies, which meshes of bounds know.
LEAST_STRENGTH = ", least strength"
# What is added for the part of it above the bottom of tension cracks.
CRACKED = ", cracked"
# The second, third, ... part of a soil that zones have parted, and the cracked part.
PART = re.compile(r"(?:, part \d+|, cracked)+(?=$|, below water$)")
# Pockets that water cuts off a stratum are left out up to this length and thickness, and of any length up to the
# thickness of a film, all in cells of the default size.
LONGEST_POCKET, THICKEST_POCKET, FILM = 15.0, 1.0 / 6.0, 1.0 / 12.0
Value = TypeVar("Value")
OfCrack = Callable[[int], Mapping[str, object]]  # changes of the part of stratum k that cracks cross
Cutting = Callable[[Sequence[Stratum], Layering, Sequence[np.ndarray | None], tuple[float, float]], tuple[Stratum, ...]]


def shown_name(name: str, quoted: bool = True) -> str:
    """Return a name of a stratum for messages.

    Parameters
    ----------
    name : name of the stratum
    quoted : whether the name is in quotation marks

    Returns
    -------
    Name of its soil in the file, followed by "below water" for the part below water.
    """
    soil = whole_soil(name)
    return (f'"{soil}"' if quoted else soil) + (" below water" if name.endswith(BELOW_WATER) else "")


def named_strata(names: Iterable[str]) -> list[str]:
    """Return strata as messages name them: with the names of their soils in the file."""
    return [f"stratum {shown_name(name)}" for name in names]


def without_film(name: str) -> str:
    """Return the stratum from which a thin part was cut off for bounds.

    Parameters
    ----------
    name : name of a stratum, such as that of a film at the water table, or of a part with the least strength

    Returns
    -------
    Name of the stratum; the same name for other strata.
    """
    return name.removesuffix(LEAST_STRENGTH).removesuffix(FILM_IN)


def part_name(soil: str, taken: Collection[str]) -> str:
    """Return a name for a part of a soil that is not among those ``taken``: the first part has the name of the soil."""
    numbers = (f"{soil}, part {number}" for number in range(2, len(taken) + 3))
    return soil if soil not in taken else next(name for name in numbers if name not in taken)


def soil_of(name: str) -> str:
    """Return the name of a stratum without the number of its part.

    Parameters
    ----------
    name : name of a stratum that zones or tension cracks may have parted

    Returns
    -------
    The name, with ", below water" for the part below water.
    """
    return PART.sub("", name)


def whole_soil(name: str) -> str:
    """Return the name of the soil of a stratum in the file, for the part above and for the part below water.

    Parameters
    ----------
    name : name of a stratum that water, zones or tension cracks may have parted

    Returns
    -------
    Name of the soil.
    """
    return soil_of(name.removesuffix(BELOW_WATER))


def soil_numbers(names: Sequence[str]) -> list[int]:
    """Return the number of the soil of every stratum.

    Parameters
    ----------
    names : names of the strata

    Returns
    -------
    Numbers from 0 in the order of the soils. Parts of one soil have the same number, but parts below water their own.
    """
    soils = list(dict.fromkeys(map(soil_of, names)))
    return [soils.index(soil_of(name)) for name in names]


def key_in_file(strata: Sequence[Stratum], k: int) -> str:
    """Return the key of a stratum for messages.

    Parameters
    ----------
    strata : strata after water and zones divided them
    k : number of the stratum

    Returns
    -------
    Table of the stratum in the file, before it was divided, and name of its soil, such as 'strata 2 "sand"'.
    """
    return f"{place_in_file(strata, k)} {shown_name(soil_of(strata[k].name))}"


def place_in_file(strata: Sequence[Stratum], k: int) -> str:
    """Return the table of stratum k in the file, such as "strata 2", before water and zones divided it."""
    names = [stratum.name for stratum in strata[: k + 1]]
    parts = [names[i] == names[i - 1] + BELOW_WATER for i in range(1, k + 1)]
    return strata[k].file_table or f"strata {k + 1 - sum(parts)}"


def layers_in_file(names: Sequence[str], layers: Layering) -> tuple[list[str], Layering]:
    """Return the names and the layers of strata as in the file, before water divided some of them.

    Parameters
    ----------
    names : names of the strata
    layers : layers of the strata

    Returns
    -------
    Names and layers, in which both parts of a stratum are one.
    """
    tops = [k for k, name in enumerate(names) if not k or name != names[k - 1] + BELOW_WATER]
    remaining = [*tops, len(names)]
    whole = replace(layers, left=layers.left[:, remaining], right=layers.right[:, remaining], strata=len(tops))
    return [names[k] for k in tops], whole


def uncut_strata(strata: Sequence[Stratum]) -> list[Stratum]:
    """Return only the lower parts of strata that water has divided, since their bottoms are those of the whole
    strata."""
    names = [stratum.name for stratum in strata]
    return [s for k, s in enumerate(strata) if k + 1 == len(names) or names[k + 1] != s.name + BELOW_WATER]


def value_of_stratum(values: Mapping[str, Value], name: str) -> Value | None:
    """Return the setting for a stratum by name.

    Parameters
    ----------
    values : settings by names of strata
    name : name of the stratum

    Returns
    -------
    The setting; parts that water or zones cut off have that of the whole stratum. None without a setting.
    """
    return next((values[key] for key in _settings_names(name) if key in values), None)


def _settings_names(name: str) -> tuple[str, ...]:
    """Return the names by which settings may call a stratum, its own first."""
    whole = name.removesuffix(BELOW_WATER)
    return name, whole, soil_of(name), soil_of(whole)


def unknown_strata(names: Iterable[str], strata: Iterable[str]) -> list[str]:
    """Return the names in settings that stand for no stratum.

    Parameters
    ----------
    names : names in settings
    strata : names of the strata, those of a file or those that water and zones divided

    Returns
    -------
    The names that are neither a stratum nor the soil of one of its parts.
    """
    known = {key for stratum in strata for key in _settings_names(stratum)}
    return [name for name in names if name not in known]


@dataclass(frozen=True, eq=False)
class DividedStratum:
    """Holds a stratum between breakpoints, and the level of its water.

    Attributes
    ----------
    x (intervals + 1,) : the breakpoints (m)
    level (intervals, 2) : elevation (m) of the water at both ends of each interval, kept within the stratum
    thickness (2, intervals, 2) : thickness (m) of what is above and what is below it
    """

    x: np.ndarray
    level: np.ndarray
    thickness: np.ndarray

    def has(self, part: int) -> bool:
        """Return whether the stratum has a part above (``part`` 0) or below (1) the water."""
        return bool((self.thickness[part] > 0.0).any())

    def line(self, left: float, right: float) -> Line:
        """Return the level as the bottom of the upper part, from ``left`` to ``right`` (m)."""
        points = np.column_stack([np.repeat(self.x, 2)[1:-1], self.level.ravel()])
        points = points[(points[:, 0] >= left) & (points[:, 0] <= right)]
        return Line(elevation=[[float(x), float(z)] for x, z in without_repeats(points)])


def divided_by_water(layers: Layering, k: int, water: np.ndarray) -> DividedStratum:
    """Divide a stratum by a water level.

    Parameters
    ----------
    layers : the ground layer by layer
    k : number of the stratum
    water (n, 2) : points of the water level from side to side (m)

    Returns
    -------
    The level within the stratum, and the thickness of the parts above and below it.
    """
    x = layers.x
    inside = water[(water[:, 0] > x[0]) & (water[:, 0] < x[-1]), 0]
    x = np.union1d(x, [at for at in inside if np.abs(x - at).min() > layers.tolerance])
    top, bottom, level = _at_ends(layers, k, water, x)
    cuts = [crossings(x, *(level - line).T, snap=layers.tolerance) for line in (top, bottom)]
    x = np.union1d(x, np.concatenate(cuts))
    top, bottom, level = _at_ends(layers, k, water, x)
    for line in (top, bottom):
        level = np.where(np.abs(level - line) <= _reach(level - line, x, layers.tolerance), line, level)
    level = np.clip(level, bottom, top)
    return DividedStratum(x, level, np.stack([top - level, level - bottom]))


def _reach(gap: np.ndarray, x: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the distance (m) between two lines, at both ends of intervals, below which the lines count as meeting.

    This distance is the tolerance within which two points are one, or the distance between lines that cross within this
    tolerance to either side of a breakpoint.
    """
    reach = tolerance * np.maximum(1.0, np.abs(gap[:, 1] - gap[:, 0]) / np.diff(x))
    ends = np.concatenate([reach[:1], np.maximum(reach[1:], reach[:-1]), reach[-1:]])
    return np.column_stack([ends[:-1], ends[1:]])


def without_pockets(parts: DividedStratum, cell: float) -> DividedStratum:
    """Return a divided stratum in which thin wedges of one part are given to the other part, if they are small compared
    with the cells (m) and with the other part.

    The corners of such wedges would be as sharp as the angle between the water level and the layer.
    """
    level, thickness = parts.level.copy(), parts.thickness.copy()
    whole = thickness.sum(axis=0)
    for part in (0, 1):
        for first, last in _runs(thickness[part]):
            span = slice(first, last)
            short = parts.x[last] - parts.x[first] <= LONGEST_POCKET * cell
            thin = thickness[part, span].max() <= (THICKEST_POCKET if short else FILM) * cell
            sharp = min(thickness[part, first, 0], thickness[part, last - 1, 1]) <= 0.0
            if thin and sharp and np.all(2.0 * thickness[part, span] <= whole[span]):
                level[span] += thickness[0, span] if part == 0 else -thickness[1, span]
                thickness[1 - part, span], thickness[part, span] = whole[span], 0.0
    return DividedStratum(parts.x, level, thickness)


def _runs(thick: np.ndarray) -> list[tuple[int, int]]:
    """Return the first interval, and the interval after the last, of every run of adjacent intervals (n, 2) with a
    thickness."""
    runs: list[tuple[int, int]] = []
    for i in np.flatnonzero(thick.max(axis=1) > 0.0):
        joined = runs and runs[-1][1] == i and min(thick[i - 1, 1], thick[i, 0]) > 0.0
        runs.append((runs.pop()[0] if joined else int(i), int(i) + 1))
    return runs


def _at_ends(layers: Layering, k: int, water: np.ndarray, x: np.ndarray) -> list[np.ndarray]:
    """Return the top and bottom of stratum k and the water level, each (intervals, 2), at both ends of the
    intervals."""
    middle = 0.5 * (x[1:] + x[:-1])
    sides = [layers.interfaces(end, near=middle)[:, k : k + 2] for end in (x[:-1], x[1:])]
    top, bottom = (np.column_stack([side[:, j] for side in sides]) for j in (0, 1))
    return [top, bottom, at_ends(water, x)]


def cut_strata(
    strata: Sequence[Stratum],
    layers: Layering,
    levels: Sequence[np.ndarray | None],
    extent: tuple[float, float],
) -> tuple[Stratum, ...]:
    """Divide the strata that their water ``levels`` (n, 2) cross. Strata entirely below water get the saturated
    density.

    New lines reach over the ``extent`` (x in m) of the given section. The upper part keeps the name, and shaking adds
    no pore pressure to it. If zones divide a soil into several strata, and one of them lies above water, a stratum
    entirely below water gets the name of a part below water, and one entirely above water is like the upper part. Thin
    wedges smaller than cells stay with the other part of the stratum (``cut_films`` makes them strata); the pore
    pressure in them is unchanged. ``layers``: the ground layer by layer.
    """
    cut: list[Stratum] = []
    cell = _cell(layers)
    divided = [None if level is None else divided_by_water(layers, k, level) for k, level in enumerate(levels)]
    cut_outlines = [None if exact is None else without_pockets(exact, cell) for exact in divided]
    soils = list(zip((whole_soil(stratum.name) for stratum in strata), cut_outlines, strict=True))
    dry_soils = {soil for soil, parts in soils if parts is None or parts.has(0)}
    wet_soils = {soil for soil, parts in soils if parts is not None and parts.has(1)}
    for stratum, exact, parts in zip(strata, divided, cut_outlines, strict=True):
        if exact is None or parts is None:
            cut.append(stratum)
            continue
        wet, dry = parts.has(1), parts.has(0)
        if wet and dry:
            cut.append(stratum.model_copy(update={"bottom": parts.line(*extent), **ABOVE_WATER}))
        elif dry and whole_soil(stratum.name) in wet_soils:
            stratum = stratum.model_copy(update=ABOVE_WATER)
        if wet:
            below = whole_soil(stratum.name) in dry_soils and not stratum.name.endswith(BELOW_WATER)
            name = stratum.name + BELOW_WATER if below else stratum.name
            film = (parts.thickness[1] > exact.thickness[1]).any()
            moist = (stratum.density or stratum.density_ordinary) if film else stratum.density_saturated
            stratum = _with_density(stratum, stratum.density_saturated, name=name, density=moist)
        cut.append(stratum)
    return tuple(cut)


def _cell(layers: Layering) -> float:
    """Return the default size (m) of cells."""
    return CELL * float(layers.areas().sum() / (layers.x[-1] - layers.x[0]))


def cut_at_cracks(
    strata: Sequence[Stratum], layers: Layering, bottom: np.ndarray, extent: tuple[float, float], of_crack: OfCrack
) -> tuple[Stratum, ...]:
    """Divide the strata with a cohesion that the ``bottom`` (n, 2) of tension cracks crosses. The part above it has no
    tensile strength, the name of the soil with ``CRACKED``, and the changes in ``of_crack``. ``layers``, ``extent``: as
    in ``cut_strata``.
    """
    cut: list[Stratum] = []
    for k, stratum in enumerate(strata):
        parts = without_pockets(divided_by_water(layers, k, bottom), _cell(layers))
        placed = stratum.in_table(place_in_file(strata, k))
        is_cracked = parts.has(0) and stratum.has_cohesion
        if is_cracked:
            changes: dict[str, object] = {"tension": 0.0, **of_crack(k)}
            if parts.has(1):
                soil, water, _ = stratum.name.partition(BELOW_WATER)
                changes |= {"name": soil + CRACKED + water, "bottom": parts.line(*extent)}
            cut.append(placed.model_copy(update=changes))
        if parts.has(1) or not is_cracked:
            cut.append(placed)
    return tuple(cut)


def cut_films(
    strata: Sequence[Stratum], layers: Layering, levels: Sequence[np.ndarray | None], extent: tuple[float, float]
) -> tuple[Stratum, ...]:
    """Return the strata of ``cut_strata``, in which thin wedges smaller than cells that water cuts off are separate
    strata.

    These strata, called films, have the weight of their side of the water, and the name of the stratum with
    ``FILM_IN``. ``layers``, ``levels``, ``extent``: as in ``cut_strata``.
    """
    cut: list[Stratum] = []
    for k, (stratum, level) in enumerate(zip(strata, levels, strict=True)):
        parts = None if level is None else divided_by_water(layers, k, level)
        if parts is None or not (parts.has(0) and parts.has(1)):
            cut.append(stratum)
            continue
        film, moist = stratum.name + FILM_IN, {"bottom": parts.line(*extent)}
        if stratum.density_ordinary == stratum.density_saturated:
            cut += [_with_density(stratum, stratum.density, name=film, **moist), stratum]
        else:
            cut += [stratum.model_copy(update=moist), _with_density(stratum, stratum.density_saturated, name=film)]
    return tuple(cut)


def _with_density(stratum: Stratum, density: float | None, /, **changes: object) -> Stratum:
    """Return a stratum with other properties and, if a density is given, with this density (kg/m³)."""
    weights = {} if density is None else dict.fromkeys(("density_ordinary", "density_seismic"), density)
    return stratum.model_copy(update={**changes, **weights})
