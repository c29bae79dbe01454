"""Reads models of D-Stability: a zip of JSON files that refer to each other by numbers (`.stix`, since 2022)."""

import json
import zipfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
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
    ground_of,
    line_of,
    section_of,
    within_reason,
)
from meshes.models.waternet import Waternet, middle_of, xz

EXPECTED = "expected a model of D-Stability, as it writes it since 2022"
LEAST_COHESION = 0.05  # kPa: less is a number that keeps a program from dividing by zero
ON_LINE = 0.05  # m: how far a corner of a layer may lie from a state line or a reference line on its edge
MODEL_ABOVE_WATER, MODEL_BELOW_WATER = (
    "ShearStrengthModelTypeAbovePhreaticLevel",
    "ShearStrengthModelTypeBelowPhreaticLevel",
)
Json = Mapping[str, Any]


@dataclass(frozen=True)
class ModelStage:
    """Holds the parts of a stage to which the ground may have consolidated: its label, states, layers and water."""

    label: str
    states: Json
    layers: Sequence[Json]
    water: Waternet

    @property
    def outlines(self) -> list[np.ndarray]:
        """Return the outlines (n, 2) in m of the layers."""
        return _outlines(self.layers)


def read_stix(path: Path, name: str, scenario: str | None = None) -> ImportedSection:
    """Read the section of a scenario of a model of D-Stability, in the last of its stages.

    Parameters
    ----------
    path : path of the file
    name : name of the section
    scenario : label of the scenario; the first scenario if left out

    Returns
    -------
    The section as TOML, and notices.

    Raises
    ------
    InputError
        If the file is no such model, or has no such scenario.
    """
    with as_input_errors(path, EXPECTED):
        return section_of(_model(_read(path), path, scenario), path, name)


def _outlines(layers: Sequence[Json]) -> list[np.ndarray]:
    return [corners(xz(item["Points"])) for item in layers]


def _ground(layers: Sequence[Json]) -> np.ndarray:
    """Return the ground surface (n, 2) in m of the layers of a stage, which may have none."""
    return ground_of(_outlines(layers)) if layers else np.empty((0, 2))


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
    stages = [
        ModelStage(
            of["Label"],
            part("states", "StateId", of),
            layers := part("geometries", "GeometryId", of)["Layers"],
            Waternet.read(part("waternets", "WaternetId", of), _ground(layers)),
        )
        for of in reversed(scenario["Stages"])
    ]
    water = stages[0].water
    stage_words = f'scenario "{scenario["Label"]}", stage "{stage["Label"]}"'
    notices = [stage_words, *others]
    if len(scenario["Stages"]) > 1:
        notices.append("not read: earlier stages, except the preconsolidation and the state to which it refers")
    if "WaterMeshId" in stage and part("watermeshes", "WaterMeshId")["Elements"]:
        notices.append(
            "not read: pore pressure of a mesh" + (", so that the ground is dry" if water.table is None else "")
        )
    outlines = part("geometries", "GeometryId")["Layers"]
    if not outlines:
        raise InputError(str(path), [f"{stage_words}: the stage has no layers; expected at least one"])
    used: list[int] = []  # numbers of the stages with the preconsolidation of layers
    layers = [_layer(corners(xz(item["Points"])), of_layer[item["Id"]], stages, used, notices)
              for item in outlines]  # fmt: skip
    state = _consolidated_state(stages, used, notices)
    loads = part("loads", "LoadsId")
    undrained = {
        number
        for number, soil in of_layer.items()
        if {"Su", "SuTable"} & {soil[MODEL_ABOVE_WATER], soil[MODEL_BELOW_WATER]}
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
        state,
    )


def _layer(
    points: np.ndarray, soil: Json, stages: Sequence[ModelStage], used: list[int], notices: list[str]
) -> ForeignLayer:
    """Return a layer with an outline (n, 2) in m. Properties that a stratum cannot have are added to ``notices``, and
    the number of the stage that states its preconsolidation to ``used``."""
    (*upper, lowest), of_level = stages[0].water.keys_of(points)
    notices += [f'"{soil["Name"]}": {text}' for text in of_level]
    models = soil[MODEL_ABOVE_WATER], soil[MODEL_BELOW_WATER]
    number, state = _latest_state(stages, points, soil["Name"], notices) if "Su" in models else (None, {})
    used += [] if number is None else [number]
    dry, wet = (
        _strength(soil, model, notices) | (_preconsolidation(state) if model == "Su" else {}) for model in models
    )
    stress = None
    if state.get("StateType") == "YieldStress":
        x, z = corners(xz([state["At"]]))[0]
        stress = YieldStress(x, z, 1e3 * float(state["YieldStress"]))
    parts = tuple((part.bottom or [], _weights(soil) | part.keys) for part in upper)
    return ForeignLayer(soil["Name"], points, _weights(soil) | lowest.keys, dry, wet, stress, parts)


def _weights(soil: Json) -> dict[str, str]:
    dry, wet = (soil[f"VolumetricWeight{side}PhreaticLevel"] for side in ("Above", "Below"))
    return {"density": f"{dry:g} kN/m^3", "density_saturated": f"{wet:g} kN/m^3"}


def _kPa(value: float) -> str:
    return f"{value:g} kPa"


def _strength(soil: Json, model: str, notices: list[str]) -> dict[str, Any]:
    """Return a strength model of a soil as keys of a stratum. Properties that a stratum cannot have are added to
    ``notices``."""
    keys: dict[str, Any] = {}
    if f"{model}".startswith("MohrCoulomb"):
        parameters = soil[f"{model}ShearStrengthModel"]
        cohesion = parameters["Cohesion"]
        if 0.0 < cohesion < LEAST_COHESION:
            notices.append(f'the cohesion of {cohesion:g} kPa of "{soil["Name"]}" is taken as 0')
            cohesion = 0.0
        keys = {"cohesion": _kPa(cohesion), "friction_angle": f"{parameters['FrictionAngle']:g} deg"}
        if (dilatancy := parameters.get("Dilatancy")) is not None:
            keys["dilation_angle"] = f"{dilatancy:g} deg"
            if dilatancy < parameters["FrictionAngle"]:
                notices.append(
                    f'D-Stability reduces c and tan φ of "{soil["Name"]}" for its dilation angle as Davis\'s estimate '
                    "does: the factors of safety by this estimate are comparable, those with ψ = φ are larger"
                )
    elif model == "Su":
        parameters = soil["SuShearStrengthModel"]
        keys = NO_STRENGTH | {
            "strength_ratio": parameters["ShearStrengthRatio"],
            "ocr_exponent": parameters["StrengthIncreaseExponent"],
        }
    elif model == "SuTable":
        pairs = [(point["EffectiveStress"], point["Su"]) for point in soil["SuTable"]["SuTablePoints"]]
        keys = NO_STRENGTH | {"strength_table": [[_kPa(stress), _kPa(strength)] for stress, strength in sorted(pairs)]}
        notices.append(f'not read: the preconsolidation of "{soil["Name"]}"; its table of strengths is taken at σ\'v')
    else:
        notices.append(f'not read: the strength of "{soil["Name"]}" by {model}')
    return keys


def _latest_state(
    stages: Sequence[ModelStage], points: np.ndarray, soil: str, notices: list[str]
) -> tuple[int | None, dict[str, Any]]:
    """Return the preconsolidation of a layer in the last stage that states it, and the number of this stage;
    ``stages`` has the last stage first.

    D-Stability keeps the yield stress of a stage in later stages; a layer is identified by the place of its middle.
    """
    for count, stage in enumerate(stages):
        places = stage.outlines
        same = next((k for k, place in enumerate(places) if _holds(place, middle_of(points))), None)
        keys = {} if same is None else _state(stage.states, stage.layers[same]["Id"], places[same], soil, notices)
        if keys:
            return count, keys
    return None, {}


def _consolidated_state(
    stages: Sequence[ModelStage], used: Collection[int], notices: list[str]
) -> dict[str, list[list[float]]]:
    """Return the lines of the stage that the preconsolidation of layers refers to, if it is not the last stage.

    ``used``: numbers of the stages with preconsolidation of layers, of which the earliest counts.
    """
    if not any(used):
        return {}
    now, before = stages[0], stages[max(used)]
    notices.append(f'preconsolidation is that of stage "{before.label}"')
    if len(set(used)) > 1:
        notices.append("not read: preconsolidation of several stages; all of it refers to the earliest of them")
    if any(line.below not in (None, before.water.phreatic) for line in before.water.lines):
        notices.append(
            f'not read: head lines of stage "{before.label}"; the ground consolidated under its phreatic line'
        )
    state = {} if before.water.table is None else {"table": before.water.table.tolist()}
    x = np.union1d(now.water.ground[:, 0], before.water.ground[:, 0])
    now_z, before_z = (np.interp(x, *stage.water.ground.T) for stage in (now, before))
    return state | ({"surface": before.water.ground.tolist()} if np.abs(now_z - before_z).max() > ON_LINE else {})


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
    middle = middle_of(points)
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
