"""Models of D-Stability: a zip of JSON files that name each other by numbers (`.stix`, since 2022)."""

import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshes.errors import InputError
from meshes.models.foreign_model import ForeignModel, FoundSection, Layer, YieldStress, layer_names, section_of

EXPECTED = "expected a model of D-Stability, as it writes it since 2022"
ON_LINE = 0.05  # m: how far a corner of a layer may lie from a state line or a reference line on its edge
ABOVE, BELOW = "ShearStrengthModelTypeAbovePhreaticLevel", "ShearStrengthModelTypeBelowPhreaticLevel"
Json = Mapping[str, Any]


def read_stix(path: Path, name: str, scenario: str | None = None) -> FoundSection:
    """The section of a scenario of a model of D-Stability, in the last of its stages.

    Parameters
    ----------
    path : Path
        The file.
    name : str
        The name of the section.
    scenario : str, optional
        The label of the scenario; the first one if not given.

    Raises
    ------
    InputError
        If the file is no such model, or has no such scenario.
    """
    files = _read(path)
    try:
        return section_of(_model(files, path, scenario), path, name)
    except (LookupError, TypeError, StopIteration) as error:
        missing = f"no {error.args[0]}" if isinstance(error, KeyError) else "not all that they have"
        raise InputError(str(path), [f"{EXPECTED}; it has {missing}"]) from error


def _read(path: Path) -> list[tuple[str, Json]]:
    """The JSON files in it by their folders, in the order of their names."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = sorted(name for name in archive.namelist() if name.endswith(".json") and "result" not in name)
            files = [(name.split("/")[0].removesuffix(".json"), archive.read(name)) for name in names]
            return [(folder, json.loads(text.decode("utf-8-sig"))) for folder, text in files]
    except (zipfile.BadZipFile, UnicodeDecodeError, json.JSONDecodeError, OSError) as error:
        raise InputError(str(path), [f"{EXPECTED}; it cannot be read: {error}"]) from error


def _model(files: Sequence[tuple[str, Json]], path: Path, label: str | None) -> ForeignModel:
    scenarios = [content for folder, content in files if folder == "scenarios"]
    labels = [scenario["Label"] for scenario in scenarios]
    if label is not None and label not in labels:
        raise InputError("--part", [f'"{label}": expected a scenario of {path}, one of {", ".join(labels)}'])
    scenario = scenarios[0 if label is None else labels.index(label)]
    stage = scenario["Stages"][-1]

    def part(folder: str, key: str) -> Json:
        return next(content for name, content in files if name == folder and content["Id"] == stage[key])

    soils = {soil["Id"]: soil for soil in next(content for name, content in files if name == "soils")["Soils"]}
    of_layer = {pair["LayerId"]: soils[pair["SoilId"]] for pair in part("soillayers", "SoilLayersId")["SoilLayers"]}
    water, states = part("waternets", "WaternetId"), part("states", "StateId")
    notices = [f'scenario "{scenario["Label"]}", stage "{stage["Label"]}"']
    others = [one for one in labels if one != scenario["Label"]]
    notices += [f"not taken: scenarios {', '.join(others)} (--part names one)"] if others else []
    if len(scenario["Stages"]) > 1:
        notices.append("not taken: the stages before it; preconsolidation is that over the stress in this one")
    table = _table(water)
    layers: list[Layer] = []
    yields: list[tuple[int, dict[str, Any]]] = []
    for one in part("geometries", "GeometryId")["Layers"]:
        points, soil = _points(one["Points"]), of_layer[one["Id"]]
        level, told = _head(water, points, table)
        notices += [f'"{soil["Name"]}": {text}' for text in told]
        state = _state(states, one["Id"], points)
        dry, wet = (
            _strength(soil, model, notices) | (_preconsolidation(state) if model == "Su" else {})
            for model in (soil[ABOVE], soil[BELOW])
        )
        if state.get("StateType") == "YieldStress" and "Su" in (soil[ABOVE], soil[BELOW]):
            yields.append((len(layers), state))
        layers.append(Layer(soil["Name"], points, level, dry, wet))
    names = layer_names(layers)
    loads = part("loads", "LoadsId")
    surcharges = [
        {"from": load["Start"], "to": load["End"], "pressure": _kPa(load["Magnitude"])}
        for load in loads["UniformLoads"]
    ]
    notices += _not_taken(loads, part("reinforcements", "ReinforcementsId"))
    weights = {
        soil["Name"]: {
            "density": f"{soil['VolumetricWeightAbovePhreaticLevel']:g} kN/m^3",
            "density_saturated": f"{soil['VolumetricWeightBelowPhreaticLevel']:g} kN/m^3",
        }
        for soil in soils.values()
    }
    return ForeignModel(
        layers,
        weights,
        {} if table is None else {"table": table.tolist(), "unit_weight": f"{water['UnitWeightWater']:g} kN/m^3"},
        surcharges,
        [YieldStress(names[k], state["At"]["X"], state["At"]["Z"], 1e3 * state["YieldStress"]) for k, state in yields],
        list(dict.fromkeys(notices)),
    )


def _points(points: Sequence[Json]) -> np.ndarray:
    return np.array([[point["X"], point["Z"]] for point in points], dtype=float)


def _kPa(value: float) -> str:
    return f"{value:g} kPa"


def _table(water: Json) -> np.ndarray | None:
    """The phreatic line (n, 2) in m, if there is one."""
    line = next((line for line in water["HeadLines"] if line["Id"] == water["PhreaticLineId"]), None)
    return None if line is None else _points(line["Points"])


def _middle(points: np.ndarray) -> np.ndarray:
    """A point in the middle of a layer: half-way between its edges at the x in the middle of its corners."""
    x = float(0.5 * (points[:, 0].min() + points[:, 0].max())) + 1e-6
    start, end = points, np.roll(points, -1, axis=0)
    cut = (start[:, 0] < x) != (end[:, 0] < x)
    share = (x - start[cut, 0]) / (end[cut, 0] - start[cut, 0])
    z = np.sort(start[cut, 1] + share * (end[cut, 1] - start[cut, 1]))
    return np.array([x, 0.5 * (z[0] + z[1])])


def _strength(soil: Json, model: str, told: list[str]) -> dict[str, Any]:
    """A strength model of a soil as keys of a stratum; what is not taken is ``told``."""
    keys: dict[str, Any] = {"cohesion": "0 kPa", "friction_angle": "0 deg"}
    if model.startswith("MohrCoulomb"):
        given = soil[f"{model}ShearStrengthModel"]
        keys = {"cohesion": _kPa(given["Cohesion"]), "friction_angle": f"{given['FrictionAngle']:g} deg"}
        if (dilatancy := given.get("Dilatancy")) is not None:
            keys["dilation_angle"] = f"{dilatancy:g} deg"
    elif model == "Su":
        given = soil["SuShearStrengthModel"]
        keys |= {"strength_ratio": given["ShearStrengthRatio"], "ocr_exponent": given["StrengthIncreaseExponent"]}
    else:
        told.append(f'not taken: the strength of "{soil["Name"]}" by {model}; give a cohesion and a friction angle')
    return keys


def _head(water: Json, points: np.ndarray, table: np.ndarray | None) -> tuple[dict[str, Any], list[str]]:
    """The piezometric level of a layer where it is not the phreatic line: that of the reference line above it, or else
    of the one below."""
    x, z = _middle(points)
    heads = {line["Id"]: _points(line["Points"]) for line in water["HeadLines"]}
    lines = [(float(np.interp(x, *_points(line["Points"]).T)), line) for line in water["ReferenceLines"]]
    above = min((pair for pair in lines if pair[0] >= z), key=lambda pair: pair[0], default=None)
    below = max((pair for pair in lines if pair[0] < z), key=lambda pair: pair[0], default=None)
    over = None if above is None else above[1]["BottomHeadLineId"]
    under = None if below is None else below[1]["TopHeadLineId"]
    chosen = over or under
    told = []
    if under is not None and (over or water["PhreaticLineId"]) != under:
        chosen = over
        told.append("not taken: pore pressure that changes with depth between two head lines; it has that of the upper")
    if chosen is None or chosen == water["PhreaticLineId"] or table is None:
        return {}, told
    return {"piezometric_level": heads[chosen].tolist()}, told


def _state(states: Json, layer: str, points: np.ndarray) -> dict[str, Any]:
    """The preconsolidation of a layer: of a state point in it, or of a state line along its edge."""
    for point in states["StatePoints"]:
        if point["LayerId"] == layer:
            return {**point["Stress"], "At": point["Point"]}
    middle = _middle(points)
    for line in states["StateLines"]:
        course = _points(line["Points"])
        if not line["Values"] or not _lies_along(course, points):
            continue
        side = "Below" if np.interp(middle[0], *course.T) > middle[1] else "Above"
        value = line["Values"][0]
        at = {"X": value["X"], "Z": float(np.interp(value["X"], *course.T))}
        return {**value[side], "At": at}
    return {}


def _lies_along(line: np.ndarray, points: np.ndarray) -> bool:
    """Whether most corners of a line are corners of a layer."""
    near = np.hypot(*(line[:, None] - points[None]).transpose(2, 0, 1)).min(axis=1) < ON_LINE
    return bool(near.mean() > 0.5)


def _preconsolidation(state: Json) -> dict[str, Any]:
    kind = state.get("StateType")
    if kind == "Pop" and state["Pop"] > 0.0:
        return {"pre_overburden_pressure": _kPa(state["Pop"])}
    if kind == "Ocr" and state["Ocr"] > 1.0:
        return {"ocr": state["Ocr"]}
    if kind == "YieldStress":  # the layer has a name of its own until its stress is known
        return {"pre_overburden_pressure": "0 kPa"}
    return {}


def _not_taken(loads: Json, reinforcements: Json) -> Iterator[str]:
    """One sentence for each kind of thing that a section has not."""
    for what, items in (("line loads", loads["LineLoads"]), ("trees", loads["Trees"])):
        if items:
            yield f"not taken: {what}, {len(items)}"
    if loads["UniformLoads"]:
        yield "loads take all of their mass along when the ground shakes, unless seismic_share says less"
    partial = [
        pair for load in (*loads["LayerLoads"], *loads["UniformLoads"]) for pair in load["Consolidations"]
        if pair["Degree"] < 100.0
    ]  # fmt: skip
    if partial:
        yield "not taken: degrees of consolidation below 100 %; see consolidated_below"
    quake = loads["Earthquake"]
    if quake["IsEnabled"]:
        yield f"not taken: the earthquake, Kh = {quake['HorizontalFactor']:g}; see safety_factor_at in [fem]"
    for kind, items in reinforcements.items():
        if isinstance(items, list) and items:
            yield f"not taken: {kind.lower()}, {len(items)}"
