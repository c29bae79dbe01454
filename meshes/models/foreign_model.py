"""Makes a section from the model of another program, and holds the parts of the model that a section can take."""

import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import reduce
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w

from meshes.errors import InputError
from meshes.section.columns import SNAP, columns_of
from meshes.section.cutting import divided_by_water
from meshes.section.layering import layering
from meshes.section.polyline import Line
from meshes.section.section import Section

PAIR = re.compile(r"\[\s+([-+.\de]+),\s+([-+.\de]+),\s+\]")  # a point over four lines, as the writer has it
# Slope programs have no stiffness; it moves displacements, and hardly the critical Kh or a factor of safety.
STIFFNESS = {"youngs_modulus": "20 MPa", "poissons_ratio": 0.3}
NO_STRENGTH = {"cohesion": "0 kPa", "friction_angle": "0 deg"}
LARGEST_MODEL = 200e6  # bytes of the documents of a model


class YieldStress(NamedTuple):
    """Holds a preconsolidation stress (Pa) at a point (m)."""

    x: float
    z: float
    stress: float


class ForeignLayer(NamedTuple):
    """Holds one layer of a model of another program.

    Attributes
    ----------
    soil : name of the soil of the layer
    points : outline of the layer (n, 2) in m
    keys : properties that do not depend on the water table, as keys of a stratum
    dry, wet : properties above and below the water table, as keys of a stratum
    yield_stress : preconsolidation stress of the layer, which becomes a pre-overburden pressure where it is known
    parts : upper parts of the layer with other water, from the top down, each with the line (n, 2) in m at its bottom
        and its ``keys``
    """

    soil: str
    points: np.ndarray
    keys: Mapping[str, Any]
    dry: Mapping[str, Any]
    wet: Mapping[str, Any]
    yield_stress: YieldStress | None = None
    parts: tuple[tuple[list[list[float]], Mapping[str, Any]], ...] = ()


@dataclass(frozen=True)
class ForeignModel:
    """Holds the parts of a model of another program that a section can take.

    Attributes
    ----------
    layers : layers of the model
    water : the table [water] of the section
    surcharges : the tables [[surcharges]] of the section
    notices : notices on assumptions, and on parts of the model that are not read, one sentence each
    consolidation : the table [consolidation] of the section
    """

    layers: Sequence[ForeignLayer]
    water: Mapping[str, Any] = field(default_factory=dict)
    surcharges: Sequence[Mapping[str, Any]] = ()
    notices: Sequence[str] = ()
    consolidation: Mapping[str, Any] = field(default_factory=dict)


class ImportedSection(NamedTuple):
    """Holds a section that was read from the model of another program.

    Attributes
    ----------
    text : the section as TOML
    notices : notices on how it was read, one sentence each
    """

    text: str
    notices: list[str]


@contextmanager
def as_input_errors(path: Path, expected: str) -> Iterator[None]:
    """Report as an InputError anything that a file lacks, or that has another form than ``expected``."""
    try:
        yield
    except InputError:
        raise
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, RuntimeError, SyntaxError, UnicodeDecodeError) as error:
        raise InputError(str(path), [f"{expected}; it cannot be read: {error}"]) from error
    except KeyError as error:
        raise InputError(str(path), [f'{expected}; it has no "{error.args[0]}"']) from error
    except (LookupError, TypeError, ValueError, AttributeError, StopIteration) as error:
        reason = f" ({error})" if type(error) in (LookupError, ValueError) else ""
        raise InputError(
            str(path), [f"{expected}; required parts are missing, or have another form{reason}"]
        ) from error


def within_reason(entries: Sequence[zipfile.ZipInfo]) -> Sequence[zipfile.ZipInfo]:
    """Return the documents of a model. Raises ValueError if they are too large."""
    if (size := sum(entry.file_size for entry in entries)) > LARGEST_MODEL:
        raise ValueError(
            f"the documents in the file have {size / 1e6:.0f} MB; at most {LARGEST_MODEL / 1e6:.0f} MB are read"
        )
    return entries


def chosen_part(names: Sequence[str], wanted: str | None, path: Path, kind: str, kinds: str) -> tuple[int, list[str]]:
    """Return the number of the part of a model that is read, the first one by default, and a notice on other parts.

    ``names``: names of the parts; ``wanted``: name of the part, or None; ``kind``, ``kinds``: what a part is called,
    such as "a scenario" and "scenarios"; ``path``: the file, for messages. Raises InputError if there is no such part.
    """
    if wanted is not None and wanted not in names:
        raise InputError("--part", [f'"{wanted}": expected {kind} of {path}, one of {", ".join(names)}'])
    number = 0 if wanted is None else names.index(wanted)
    others = [name for name in names if name != names[number]]
    return number, [f"not read: {kinds} {', '.join(others)} (--part names one)"] if others else []


def corners(points: Sequence[tuple[float, float]]) -> np.ndarray:
    """Return points (n, 2) in m; raise ValueError if a coordinate is no number."""
    array = np.array(points, dtype=float).reshape(-1, 2)
    if not np.isfinite(array).all():
        raise ValueError("a point whose coordinates are not numbers")
    return array


def line_of(points: Sequence[tuple[float, float]]) -> np.ndarray:
    """Return the points (n, 2) in m of a line of water, from left to right."""
    line = corners(points)
    return line[::-1] if line[0, 0] > line[-1, 0] else line


def section_of(model: ForeignModel, path: Path, name: str) -> ImportedSection:
    """Return the section of a model that was read from a file.

    Parameters
    ----------
    model : the model; its layers become strata in the same places
    path : the file, for messages
    name : the name of the section

    Raises
    ------
    InputError : if the layers do not form a section
    """
    names = layer_names(model.layers)
    columns = columns_of(names, [layer.points for layer in model.layers])
    if columns.problems:
        raise InputError(str(path), columns.problems)
    ground, bottoms = columns.interfaces()
    of_name = dict(zip(names, model.layers, strict=True))
    sides = float(columns.x[0]), float(columns.x[-1])
    lines = [columns.points(bottom) for bottom in bottoms]
    water = _across(model.water, "table", *sides)
    whole = [of_name[layer] for layer in columns.stack.layers]
    lines, layers, names = _with_parts(columns.points(ground), lines, whole, columns.stack.names)
    parts = _parted(columns.points(ground), lines, layers, water)
    strata: list[dict[str, Any]] = []
    for k, bottom, wet in parts:
        layer = layers[k]
        keys = {**layer.keys, **(layer.wet if wet else layer.dry)}
        levels = _across(keys, "piezometric_level", *sides)
        if flow := levels.get("vertical_flow"):
            levels["vertical_flow"] = reduce(lambda lines, key: _across(lines, key, *sides), flow, flow)
        called = names[k] + (", wet" if [number for number, _, _ in parts].count(k) > 1 and wet else "")
        strata.append({"name": called, "bottom": {"elevation": _points(bottom)}, **STIFFNESS, **levels})
    data = {"name": name, "surface": _points(columns.points(ground)), "base": strata[-1].pop("bottom")}
    data |= {"water": water} if water else {}
    data |= {"surcharges": [dict(load) for load in model.surcharges]} if model.surcharges else {}
    if model.consolidation:
        state = reduce(lambda lines, key: _across(lines, key, *sides), ("table", "surface"), model.consolidation)
        data["consolidation"] = dict(state)
    data["strata"] = strata
    _consolidate(data, [layers[k].yield_stress for k, _, _ in parts], path)
    notices = [
        *model.notices, *columns.stack.notices, *columns.tally.sentences(),
        f"not in the file: stiffness; {STIFFNESS['youngs_modulus']} and a Poisson's ratio of "
        f"{STIFFNESS['poissons_ratio']} are assumed everywhere",
    ]  # fmt: skip
    comments = [f"# Section from {path.name}.", *(f"# {text}." for text in notices), ""]
    text = PAIR.sub(r"[\1, \2]", tomli_w.dumps(data))
    return ImportedSection("\n".join(comments) + text, notices)


def ground_of(outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Return the ground surface (n, 2) in m of layers with outlines (n, 2)."""
    columns = columns_of([str(number) for number in range(len(outlines))], outlines)
    return columns.points(columns.interfaces()[0])


def layer_names(layers: Sequence[ForeignLayer]) -> list[str]:
    """Return a name for every layer: the name of its soil, with a number if layers of one soil have different keys."""
    kinds: dict[str, list[Mapping[str, Any]]] = {}
    names = []
    for layer in layers:
        known = kinds.setdefault(layer.soil, [])
        keys = layer._asdict() | {"points": None}
        if keys not in known:
            known.append(keys)
        number = known.index(keys) + 1
        names.append(layer.soil if number == 1 else f"{layer.soil} {number}")
    return names


def _with_parts(
    ground: np.ndarray, bottoms: Sequence[np.ndarray], layers: Sequence[ForeignLayer], names: Sequence[str]
) -> tuple[list[np.ndarray], list[ForeignLayer], list[str]]:
    """Return bottoms (n, 2), layers and names with the upper parts of layers that have other water as layers of their
    own."""
    lines = [Line(elevation=_points(bottom)) for bottom in bottoms]
    stack = layering(ground, lines[-1], [*lines[:-1], None]).layering
    parts: list[tuple[np.ndarray, ForeignLayer, str]] = []
    for k, (bottom, layer, name) in enumerate(zip(bottoms, layers, names, strict=True)):
        number = 0
        for line, keys in layer.parts:
            cut = divided_by_water(stack, k, np.array(line))
            if cut.has(0) and cut.has(1):
                number += 1
                points = cut.line(*ground[[0, -1], 0]).points(0.0, 1.0)
                parts.append((points, layer._replace(keys=keys), name if number == 1 else f"{name}, part {number}"))
        parts.append((bottom, layer, name if number == 0 else f"{name}, part {number + 1}"))
    parted = list(zip(*parts, strict=True))
    return list(parted[0]), list(parted[1]), list(parted[2])


def _parted(
    ground: np.ndarray, bottoms: Sequence[np.ndarray], layers: Sequence[ForeignLayer], water: Mapping[str, Any]
) -> list[tuple[int, np.ndarray, bool]]:
    """Return the strata from the top down: the number of the layer, the bottom (n, 2), and whether the stratum is below
    water. A layer with other properties below water becomes two strata where the water table crosses it."""
    if not water:
        return [(k, bottom, False) for k, bottom in enumerate(bottoms)]
    lines = [Line(elevation=_points(bottom)) for bottom in bottoms]
    stack = layering(ground, lines[-1], [*lines[:-1], None]).layering
    table = np.array(water["table"], dtype=float)
    strata = []
    for k, (bottom, layer) in enumerate(zip(bottoms, layers, strict=True)):
        cut = divided_by_water(stack, k, table)
        if layer.wet != layer.dry and cut.has(0) and cut.has(1):
            line = cut.line(*ground[[0, -1], 0]).points(0.0, 1.0)
            strata += [(k, line, False), (k, bottom, True)]
        else:
            strata.append((k, bottom, not cut.has(0)))
    return strata


def _consolidate(data: dict[str, Any], yields: Sequence[YieldStress | None], path: Path) -> None:
    """Give strata the pre-overburden pressures σ'p - σ'v that correspond to their yield stresses."""
    if not any(yields):
        return
    strata = data["strata"]
    section = Section.parse({**data, "strata": [NO_STRENGTH | stratum for stratum in strata]}, str(path))
    for yield_stress, stratum in zip(yields, strata, strict=True):
        if yield_stress is not None and "strength_ratio" in stratum:
            at = np.array([[yield_stress.x, yield_stress.z]])
            field, k = section.cohesion_field, section.stratum_at(*at.T)
            effective = float(field.consolidation_stress(at, at, k, int(k[0]))[0])
            stratum["pre_overburden_pressure"] = f"{max(yield_stress.stress - effective, 0.0) / 1e3:.4g} kPa"


def _across(table: Mapping[str, Any], key: str, left: float, right: float) -> dict[str, Any]:
    """Return a table whose line ``key``, if the table has it, goes from side to side (m) and is level beyond its
    ends."""
    if key not in table:
        return dict(table)
    line = np.array(table[key], dtype=float)
    between = line[(line[:, 0] > left + SNAP) & (line[:, 0] < right - SNAP)]
    ends = [[x, float(np.interp(x, *line.T))] for x in (left, right)]
    return {**table, key: _points(np.vstack([ends[:1], between, ends[1:]]))}


def _points(line: np.ndarray) -> list[list[float]]:
    return [[float(x), float(z)] for x, z in line.round(6) + 0.0]
