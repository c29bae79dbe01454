"""Describes zones of a section, each a table [[zones]]: ground of any outline, which replaces the strata there."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import BaseModel, Field, PlainSerializer, PlainValidator, SerializerFunctionWrapHandler, model_serializer

from meshes.section.columns import JOINED, ColumnFindings, Columns, columns_of, polygon_area
from meshes.section.cutting import named_strata, part_name
from meshes.section.layering import Layering, elevations_below, layering
from meshes.section.polyline import Line, Points, pairs_of, written
from meshes.section.stratum import Stratum


def read_outline(value: Any) -> Points:
    """Return the corners of a closed outline in order, without the first corner repeated at the end.

    Raises ValueError with every problem of the outline, one on each line of the message.
    """
    if not isinstance(value, list | tuple) or len(value) < 3:
        raise ValueError("expected three or more points [[x, z], ...], the corners in order")
    points = pairs_of(value)
    again = [point for point, before in zip(points, [points[-1], *points[:-1]], strict=True) if point != before]
    crossing = _crossing(np.array(again, dtype=float)) if len(again) > 2 else None
    if crossing is not None:
        at = f"x = {crossing[0]:.6g}, z = {crossing[1]:.6g} m"
        raise ValueError(
            f"the edges of the outline meet at {at}; expected corners in order along an outline that does not cross "
            f"itself"
        )
    if len(again) < 3 or polygon_area(np.array(again, dtype=float)) <= 0.0:
        raise ValueError("has no area; expected corners that do not lie on one line")
    return tuple(again)


def _crossing(points: np.ndarray) -> np.ndarray | None:
    """Return the point where an edge of a closed polygon (n, 2) meets an edge that is not its neighbour, or turns back
    on its neighbour; None without such a point."""
    start, run = points, np.roll(points, -1, axis=0) - points
    count, along = len(points), np.roll(run, -1, axis=0)
    back = (np.abs(_cross(run, along)) <= 1e-12 * np.abs(run * along).sum(axis=1)) & ((run * along).sum(axis=1) < 0.0)
    if back.any():
        return np.asarray(points[(int(np.argmax(back)) + 1) % count])
    for i in range(count):
        others = np.array([j for j in range(i + 2, count) if (j + 1) % count != i], dtype=int)
        between, across = start[others] - start[i], _cross(run[i], run[others])
        with np.errstate(divide="ignore", invalid="ignore"):
            own_share, other_share = _cross(between, run[others]) / across, _cross(between, run[i]) / across
        met = (across != 0.0) & (own_share >= 0.0) & (own_share <= 1.0) & (other_share >= 0.0) & (other_share <= 1.0)
        if met.any():
            return np.asarray(start[i] + own_share[np.argmax(met)] * run[i])
    return None


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def clipped(points: np.ndarray, left: float, right: float) -> np.ndarray:
    """Return the part of a closed polygon (n, 2) from ``left`` to ``right`` (m), by Sutherland & Hodgman (1974).

    The result may contain edges that run back and forth along a side; such edges are vertical and enclose no area.
    """
    for limit, sign in ((left, 1.0), (right, -1.0)):
        corners = []
        for start, end in zip(points, np.roll(points, -1, axis=0), strict=True):
            inside = [sign * (end_x - limit) >= 0.0 for end_x in (start[0], end[0])]
            if inside[0]:
                corners.append(start)
            if inside[0] != inside[1]:
                share = (limit - start[0]) / (end[0] - start[0])
                corners.append(np.array([limit, start[1] + share * (end[1] - start[1])]))
        points = np.array(corners, dtype=float).reshape(-1, 2)
    return points


Outline = Annotated[Points, PlainValidator(read_outline), PlainSerializer(written)]


OWN_KEYS = ("name", "points", "material")
# Lines whose depths are those below the ground before zones raised it.
OF_GROUND = ("piezometric_level", "consolidated_below")
AnyModel = TypeVar("AnyModel", bound=BaseModel)
BELOW_BASE = "\n"  # what lies below the base; no stratum is called so
# A zone of which no more than the first share lies in the section lies outside; less than the second is not reported.
MISSED, NOTABLE = 1e-6, 1e-3


class Zone(Stratum):
    """Holds a zone of ground of any outline: a core, a key, a trench, a lens, a berm. Its soil is that of a stratum
    or another zone, or a soil of its own.

    A zone above the ground surface raises the surface. Parts of a zone below the base or beyond the sides are left out.
    """

    points: Outline = Field(description="the corners of the outline in order, [[x, z], ...]")
    material: str | None = Field(
        default=None,
        description="name of the stratum or zone whose soil the zone has; it replaces keys of the soil in the zone",
    )
    bottom: None = Field(default=None, description="none, since a zone has points")

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data = super()._as_written(handler)
        return data if self.material is None else {key: data[key] for key in OWN_KEYS}

    @property
    def soil(self) -> Stratum:
        """Return the soil of the zone as a stratum."""
        return Stratum.model_construct(**{key: getattr(self, key) for key in Stratum.model_fields})


def with_materials(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the contents of a file, with the soils of strata and zones in zones that name them; raise ValueError if
    there is no such name."""
    zones, strata = data.get("zones"), data.get("strata")
    if not isinstance(zones, list | tuple) or not isinstance(strata, list | tuple):
        return data
    with_keys = [soil for soil in (*strata, *zones) if isinstance(soil, Mapping) and soil.get("material") is None]
    soils = {soil["name"]: soil for soil in with_keys if isinstance(soil.get("name"), str)}
    problems, filled = [], []
    for number, zone in enumerate(zones, start=1):
        name = zone.get("material") if isinstance(zone, Mapping) else None
        if name is None:
            filled.append(zone)
            continue
        where = f"zones {number}" + (f' "{zone["name"]}"' if isinstance(zone.get("name"), str) else "")
        if conflicting := [key for key in zone if key in Stratum.model_fields and key not in OWN_KEYS]:
            expected = "expected either the name of a stratum or zone, or keys of its own"
            problems.append(f"{where}, material = {name!r} together with {conflicting[0]}: {expected}")
        if not isinstance(name, str) or name not in soils:
            listed = ", ".join(f'"{soil}"' for soil in soils)
            problems.append(f"{where}, material = {name!r}: expected the name of a stratum or zone, one of {listed}")
        else:
            keys = {key: value for key, value in soils[name].items() if key not in ("name", "bottom", "points")}
            filled.append({**keys, **zone})
    if problems:
        raise ValueError("\n".join(problems))
    return {**data, "zones": filled}


@dataclass(frozen=True)
class ZonedGround:
    """Holds the ground including its zones, as strata from the top down.

    Attributes
    ----------
    surface : ground surface, raised by zones
    base : base of the section; depths are converted to elevations if zones raise the ground
    strata : strata; a soil that zones divide is several strata
    notices : notices for the user, one sentence each
    problems : problems of the zones, one sentence each
    """

    surface: Points
    base: Line
    strata: tuple[Stratum, ...]
    notices: list[str]
    problems: list[str]


def zoned(surface: Points, base: Line, strata: Sequence[Stratum], zones: Sequence[Zone]) -> ZonedGround:
    """Replace the ground by the zones, within their outlines.

    Parameters
    ----------
    surface, base, strata : surface, base and strata of the section without its zones, and without faults
    zones : the zones; each replaces the strata in its outline
    """
    ground = np.array(surface, dtype=float)
    layers = layering(ground, base, [stratum.bottom for stratum in strata]).layering
    inside = [clipped(np.array(zone.points, dtype=float), *ground[[0, -1], 0]) for zone in zones]
    whole = [(stratum.name, polygon) for k, stratum in enumerate(strata) for polygon in layers.polygons(k)]
    columns = columns_of(
        [BELOW_BASE, *(zone.material or zone.name for zone in zones), *(name for name, _ in whole)],
        [_region_below(layers, zones), *inside, *(polygon for _, polygon in whole)],
        [-1.0] + [0.0] * len(zones) + [1.0] * len(whole),
        without=BELOW_BASE,
    )
    problems, notices = _of_zones(zones, inside, columns.tally, layers.tolerance)
    if problems:
        return ZonedGround(surface, base, tuple(strata), [], problems)
    before = _ground_at(layers, columns.x)
    line, bottoms = columns.interfaces(before)
    above = float((line - before).max())
    if above > layers.tolerance:
        base = without_depth(ground, base) or base
        strata = [with_elevations(ground, layer, (*OF_GROUND, "cohesion_from")) for layer in strata]
        zones = [with_elevations(ground, layer, OF_GROUND) for layer in zones]  # those have depths of their own
        ground = columns.points(line)
        surface = tuple((float(x), float(z)) for x, z in ground)
        notices.append(f"zones: some of them raise the ground, by up to {above:.3g} m")
    parts = _strata(columns, bottoms, strata, zones)
    notices += _parted(columns, parts, strata)
    thick = _thick(ground, base, parts)
    named = named_strata(stratum.name for stratum in thick)
    faults = layering(ground, base, [stratum.bottom for stratum in thick], names=named).problems
    return ZonedGround(surface, base, thick, notices, [f"zones: {text}" for text in faults])


def without_depth(ground: np.ndarray, line: Line | None) -> Line | None:
    """Return a line as elevations if it is given as depths below the ``ground`` (n, 2); None for no line."""
    if line is None or line.depth is None:
        return line
    return Line(elevation=elevations_below(ground, line).tolist())


def with_elevations(ground: np.ndarray, model: AnyModel, keys: Sequence[str]) -> AnyModel:
    """Return a copy with elevations in place of depths below the ``ground`` (n, 2) in the lines ``keys``, and in those
    of its vertical flow."""
    lines = {key: without_depth(ground, getattr(model, key)) for key in keys}
    flow = getattr(model, "vertical_flow", None)
    return model.model_copy(update=lines | ({} if flow is None else {"vertical_flow": flow.as_elevations(ground)}))


def _region_below(layers: Layering, zones: Sequence[Zone]) -> np.ndarray:
    """Return the outline of the region below the base, as far down as any zone reaches."""
    x, floor = np.repeat(layers.x, 2)[1:-1], np.column_stack([layers.left[:, -1], layers.right[:, -1]]).ravel()
    deepest = min(float(floor.min()), *(z for zone in zones for _, z in zone.points)) - 1.0
    return np.vstack([np.column_stack([x, floor]), [[x[-1], deepest], [x[0], deepest]]])


def _of_zones(
    zones: Sequence[Zone], inside: Sequence[np.ndarray], tally: ColumnFindings, tolerance: float
) -> tuple[list[str], list[str]]:
    """Return the faults of zones, which are outlines 1 to n of the ``tally``, and notices on parts of them that are
    left out.

    ``inside`` are the outlines of the zones between the sides of the section.
    """
    called = {k: f'zones {k} "{zone.name}"' for k, zone in enumerate(zones, start=1)}
    problems, notices = [], []
    for k, zone in enumerate(zones, start=1):
        whole = polygon_area(np.array(zone.points, dtype=float))
        share = (polygon_area(inside[k - 1]) - tally.shared.get((0, k), [0.0])[0]) / whole
        if share <= MISSED:
            problems.append(f"{called[k]}: lies outside the section; expected points within it, or above its ground")
        elif share < 1.0 - NOTABLE:
            notices.append(f"{called[k]}: {100.0 * (1.0 - share):.2g} % of it lies past the sides or below the base, "
                           "and is left out")  # fmt: skip
    for (owner, other), (area, start, end) in tally.shared.items():
        if owner in called and other in called and area > tolerance * (end - start):
            problems.append(f"{called[owner]} and {called[other]} overlap by {area:.3g} m² from x = {start:.6g} to "
                            f"{end:.6g} m; expected zones that do not")  # fmt: skip
    for (above, below), (height, start, end) in tally.gaps.items():
        if height > max(tolerance, JOINED):
            zone_above = next((text for k, text in called.items() if tally.names[k] == above), f'"{above}"')
            problems.append(f'{zone_above}: hangs up to {height:.3g} m above "{below}" from x = {start:.6g} to '
                            f"{end:.6g} m; expected it to rest on the ground")  # fmt: skip
    return problems, notices


def _ground_at(layers: Layering, x: np.ndarray) -> np.ndarray:
    """Return the ground (columns, 2) without zones, at both ends of columns between the x."""
    middle = 0.5 * (x[1:] + x[:-1])
    return np.column_stack([layers.interface(0, end, near=middle) for end in (x[:-1], x[1:])])


def _strata(columns: Columns, bottoms: np.ndarray, strata: Sequence[Stratum], zones: Sequence[Zone]) -> list[Stratum]:
    """Return the strata of the columns, from the top down, with the ``bottoms`` (strata, columns, 2). Every stratum
    stores its place in the file."""
    soils = {stratum.name: stratum.in_table(f"strata {number}") for number, stratum in enumerate(strata, start=1)}
    soils |= {zone.name: zone.soil.in_table(f"zones {number}") for number, zone in enumerate(zones, start=1)
              if zone.material is None}  # fmt: skip
    placed: list[Stratum] = []
    for name, bottom in zip(columns.stack.layers, bottoms, strict=True):
        taken = {earlier.name for earlier in placed} | (soils.keys() - {name})
        line = Line(elevation=columns.points(bottom).tolist())
        placed.append(soils[name].model_copy(update={"name": part_name(name, taken), "bottom": line}))
    return placed


def _parted(columns: Columns, present: Sequence[Stratum], strata: Sequence[Stratum]) -> list[str]:
    """Return notices on soils that zones divide into several strata, and on strata of which nothing is left."""
    notices = []
    for name in dict.fromkeys(columns.stack.layers):
        parts = [
            f'"{stratum.name}"' for stratum, layer in zip(present, columns.stack.layers, strict=True) if layer == name
        ]
        if len(parts) > 1:
            notices.append(f'zones: of "{name}" there are {len(parts)} parts that lie one below another, '
                        f"{' and '.join(parts)}")  # fmt: skip
    gone = [stratum.name for stratum in strata if stratum.name not in columns.stack.layers]
    return notices + [f'zones: they replace the whole of stratum "{name}"' for name in gone]


def _thick(ground: np.ndarray, base: Line, parts: Sequence[Stratum]) -> tuple[Stratum, ...]:
    """Return the strata that are thicker somewhere than the smallest distance of points. The lowest stratum reaches
    down to the base.
    """
    areas = layering(ground, base, [stratum.bottom for stratum in parts]).layering.areas()
    present = [stratum for stratum, area in zip(parts, areas, strict=True) if area > 0.0]
    return (*present[:-1], present[-1].model_copy(update={"bottom": None}))
