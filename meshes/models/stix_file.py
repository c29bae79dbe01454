"""Reads models of D-Stability: a zip of JSON files that refer to each other by numbers (`.stix`, since 2022)."""

import json
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from meshes.errors import InputError
from meshes.models.foreign_model import (
    NO_STRENGTH,
    ForeignLayer,
    ForeignModel,
    ImportedSection,
    YieldStress,
    as_input_errors,
    chosen_part,
    corners,
    line_of,
    section_of,
    within_reason,
)
from meshes.models.waternet import Waternet, xz

EXPECTED = "expected a model of D-Stability, as it writes it since 2022"
ON_LINE = 0.05  # m: how far a corner of a layer may lie from a state line or a reference line on its edge
MODEL_ABOVE_WATER, MODEL_BELOW_WATER = (
    "ShearStrengthModelTypeAbovePhreaticLevel",
    "ShearStrengthModelTypeBelowPhreaticLevel",
)
Json = Mapping[str, Any]
State = tuple[str, Json, Sequence[Json]]  # of a stage: its label, its states, and the outlines of its layers


def read_stix(path: Path, name: str, scenario: str | None = None) -> ImportedSection:
    """Read the section of a scenario of a model of D-Stability, in the last of its stages.

    Parameters
    ----------
    path : the file
    name : the name of the section
    scenario : label of the scenario; the first scenario if left out

    Raises
    ------
    InputError : if the file is no such model, or has no such scenario
    """
    with as_input_errors(path, EXPECTED):
        return section_of(_model(_read(path), path, scenario), path, name)


def _read(path: Path) -> list[tuple[str, Json]]:
    """Return the JSON files of the zip by their folders, in the order of their names."""
    with zipfile.ZipFile(path) as archive:
        entries = [
            item for item in archive.infolist() if item.filename.endswith(".json") and "result" not in item.filename
        ]
        entries = sorted(within_reason(entries), key=lambda entry: entry.filename)
        files = [(item.filename.split("/")[0].removesuffix(".json"), archive.read(item)) for item in entries]
    return [(folder, json.loads(text.decode("utf-8-sig"))) for folder, text in files]


def _model(files: Sequence[tuple[str, Json]], path: Path, label: str | None) -> ForeignModel:
    scenarios = [content for folder, content in files if folder == "scenarios"]
    labels = [scenario["Label"] for scenario in scenarios]
    place, others = chosen_part(labels, label, path, "a scenario", "scenarios")
    scenario = scenarios[place]
    stage = scenario["Stages"][-1]

    def part(folder: str, key: str, of: Json = stage) -> Json:
        return next(content for name, content in files if name == folder and content["Id"] == of[key])

    soils = {soil["Id"]: soil for soil in next(content for name, content in files if name == "soils")["Soils"]}
    of_layer = {pair["LayerId"]: soils[pair["SoilId"]] for pair in part("soillayers", "SoilLayersId")["SoilLayers"]}
    water = Waternet.read(part("waternets", "WaternetId"))
    states = [
        (of["Label"], part("states", "StateId", of), part("geometries", "GeometryId", of)["Layers"])
        for of in reversed(scenario["Stages"])
    ]
    stage_words = f'scenario "{scenario["Label"]}", stage "{stage["Label"]}"'
    notices = [stage_words, *others]
    if len(scenario["Stages"]) > 1:
        notices.append(
            "not read: earlier stages, except preconsolidation, which is stored as the difference to the stress in "
            "this stage"
        )
    if "WaterMeshId" in stage and part("watermeshes", "WaterMeshId")["Elements"]:
        notices.append(
            "not read: pore pressure of a mesh" + (", so that the ground is dry" if water.table is None else "")
        )
    outlines = part("geometries", "GeometryId")["Layers"]
    if not outlines:
        raise InputError(str(path), [f"{stage_words}: the stage has no layers; expected at least one"])
    layers = [_layer(corners(xz(item["Points"])), of_layer[item["Id"]], water, states, notices)
              for item in outlines]  # fmt: skip
    loads = part("loads", "LoadsId")
    undrained = {
        number for number, soil in of_layer.items() if "Su" in (soil[MODEL_ABOVE_WATER], soil[MODEL_BELOW_WATER])
    }
    surcharges = [
        {"from": load["Start"], "to": load["End"], "pressure": _kPa(load["Magnitude"]),
         "consolidated": _consolidated(load, undrained, notices)}
        for load in loads["UniformLoads"]
    ]  # fmt: skip
    notices += _not_taken(loads, part("reinforcements", "ReinforcementsId"))
    return ForeignModel(
        layers,
        {} if water.table is None else {"table": water.table.tolist(), "unit_weight": f"{water.unit_weight:g} kN/m^3"},
        surcharges,
        list(dict.fromkeys(notices)),
    )


def _layer(
    points: np.ndarray, soil: Json, water: Waternet, states: Sequence[State], notices: list[str]
) -> ForeignLayer:
    """Return a layer with an outline (n, 2) in m. Properties that a stratum cannot have are added to ``notices``."""
    level, of_level = water.keys_of(points, _middle(points))
    notices += [f'"{soil["Name"]}": {text}' for text in of_level]
    models = soil[MODEL_ABOVE_WATER], soil[MODEL_BELOW_WATER]
    state = _latest_state(states, points, soil["Name"], notices) if "Su" in models else {}
    dry, wet = (
        _strength(soil, model, notices) | (_preconsolidation(state) if model == "Su" else {}) for model in models
    )
    stress = None
    if state.get("StateType") == "YieldStress":
        x, z = corners(xz([state["At"]]))[0]
        stress = YieldStress(x, z, 1e3 * float(state["YieldStress"]))
    return ForeignLayer(soil["Name"], points, {**_weights(soil), **level}, dry, wet, stress)


def _weights(soil: Json) -> dict[str, str]:
    dry, wet = (soil[f"VolumetricWeight{side}PhreaticLevel"] for side in ("Above", "Below"))
    return {"density": f"{dry:g} kN/m^3", "density_saturated": f"{wet:g} kN/m^3"}


def _kPa(value: float) -> str:
    return f"{value:g} kPa"


def _middle(points: np.ndarray) -> np.ndarray:
    """Return a point in the middle of a layer: at the mean x of its corners, half-way between its edges."""
    x = float(0.5 * (points[:, 0].min() + points[:, 0].max())) + 1e-6
    start, end = points, np.roll(points, -1, axis=0)
    cut = (start[:, 0] < x) != (end[:, 0] < x)
    share = (x - start[cut, 0]) / (end[cut, 0] - start[cut, 0])
    z = np.sort(start[cut, 1] + share * (end[cut, 1] - start[cut, 1]))
    return np.array([x, 0.5 * (z[0] + z[1])])


def _strength(soil: Json, model: str, notices: list[str]) -> dict[str, Any]:
    """Return a strength model of a soil as keys of a stratum. Properties that a stratum cannot have are added to
    ``notices``."""
    keys: dict[str, Any] = {}
    if f"{model}".startswith("MohrCoulomb"):
        parameters = soil[f"{model}ShearStrengthModel"]
        keys = {"cohesion": _kPa(parameters["Cohesion"]), "friction_angle": f"{parameters['FrictionAngle']:g} deg"}
        if (dilatancy := parameters.get("Dilatancy")) is not None:
            keys["dilation_angle"] = f"{dilatancy:g} deg"
    elif model == "Su":
        parameters = soil["SuShearStrengthModel"]
        keys = NO_STRENGTH | {
            "strength_ratio": parameters["ShearStrengthRatio"],
            "ocr_exponent": parameters["StrengthIncreaseExponent"],
        }
    else:
        notices.append(f'not read: the strength of "{soil["Name"]}" by {model}')
    return keys


def _latest_state(states: Sequence[State], points: np.ndarray, soil: str, notices: list[str]) -> dict[str, Any]:
    """Return the preconsolidation of a layer in the last stage that states it; ``stages`` has the last stage first.

    D-Stability keeps the yield stress of a stage in later stages; a layer is identified by the place of its middle.
    """
    for count, (label, state, outlines) in enumerate(states):
        places = [corners(xz(item["Points"])) for item in outlines]
        same = next((k for k, place in enumerate(places) if _holds(place, _middle(points))), None)
        keys = {} if same is None else _state(state, outlines[same]["Id"], places[same], soil, notices)
        if keys:
            if count:
                notices.append(
                    f'preconsolidation of "{soil}" is that of stage "{label}": too low where water has risen since'
                )
            return keys
    return {}


def _holds(outline: np.ndarray, point: np.ndarray) -> bool:
    """Return whether a point is inside an outline (n, 2), which holds if the number of edges to its left is odd."""
    start, end = outline, np.roll(outline, -1, axis=0)
    cut = (start[:, 1] < point[1]) != (end[:, 1] < point[1])
    share = (point[1] - start[cut, 1]) / (end[cut, 1] - start[cut, 1])
    return bool(np.count_nonzero(start[cut, 0] + share * (end[cut, 0] - start[cut, 0]) < point[0]) % 2)


def _state(states: Json, layer: str, points: np.ndarray, soil: str, notices: list[str]) -> dict[str, Any]:
    """Return the preconsolidation of a layer, given by a state point in it or by a state line along its edge. Other
    states are reported in a notice."""
    more = f'not read: preconsolidation that varies within "{soil}"; the value of one point is used'
    if inside := [point for point in states["StatePoints"] if point["LayerId"] == layer]:
        notices += [more] if len(inside) > 1 else []
        return {**inside[0]["Stress"], "At": inside[0]["Point"]}
    middle = _middle(points)
    for line in states["StateLines"]:
        course = line_of(xz(line["Points"]))
        if not line["Values"] or not _lies_along(course, points):
            continue
        side = "Below" if np.interp(middle[0], *course.T) > middle[1] else "Above"
        notices += [more] if len(line["Values"]) > 1 else []
        value = line["Values"][0]
        at = {"X": value["X"], "Z": float(np.interp(value["X"], *course.T))}
        return {**value[side], "At": at}
    return {}


def _lies_along(line: np.ndarray, points: np.ndarray) -> bool:
    """Return whether most corners of a line are corners of a layer."""
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


def _consolidated(load: Json, layers: Collection[str], notices: list[str]) -> float:
    """Return the share of a load under which the given layers have consolidated, the least share if they differ; 0
    without any."""
    degrees = [float(pair["Degree"]) for pair in load["Consolidations"] if pair["LayerId"] in layers]
    if len(set(degrees)) > 1:
        notices.append(
            "not read: degrees of consolidation that differ from layer to layer; each load has the smallest of them"
        )
    return min(degrees, default=0.0) / 100.0


def _not_taken(loads: Json, reinforcements: Json) -> Iterator[str]:
    """Yield one sentence for each kind of object of the model that a section cannot have."""
    for what, items in (("line loads", loads["LineLoads"]), ("trees", loads["Trees"])):
        if items:
            yield f"not taken: {what}, {len(items)}"
    if loads["UniformLoads"]:
        yield "the whole mass of loads shakes with the ground, unless seismic_share is smaller"
    partial = [pair for load in loads["LayerLoads"] for pair in load["Consolidations"] if pair["Degree"] < 100.0]
    if partial:
        yield "not read: degrees of consolidation below 100 % of layers; see consolidated_below"
    quake = loads["Earthquake"]
    if quake["IsEnabled"]:
        yield f"not taken: the earthquake, Kh = {quake['HorizontalFactor']:g}; see safety_factor_at in [fem]"
    for kind, items in reinforcements.items():
        if isinstance(items, list) and items:
            yield f"not taken: {kind.lower()}, {len(items)}"
