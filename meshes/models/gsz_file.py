"""Reads models of GeoStudio: a zip with one XML document of all analyses (`.gsz`), of which those of SLOPE/W are
read."""

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from meshes.errors import InputError
from meshes.models.foreign_model import (
    ForeignLayer,
    ForeignModel,
    ImportedSection,
    as_input_errors,
    chosen_part,
    corners,
    line_of,
    section_of,
    within_reason,
)

EXPECTED = "expected a model of GeoStudio with an analysis of SLOPE/W"
REGION = re.compile(r"Regions-(\d+)")
BEDROCK = "10 MPa"  # cohesion: slips do not pass it
# Parts of an analysis of SLOPE/W that are read, have a notice of their own, or say only how slips are searched.
KNOWN_PARTS = {
    "DataPoints", "PiezometricSurfaces", "MaterialUsesPiezs", "Surcharges", "LineLoadPoints", "ReinforcementLines",
    "TensionCrack", "Seismic", "InitialInputInfo", "SlipSurface", "Convergence", "LambdaSettings",
}  # fmt: skip


class GeoStudioUnits(NamedTuple):
    """Holds the length (m) of a unit, and the functions that write a stress and a unit weight."""

    length: float
    stress: str
    weight: str
    water: float


METRIC, IMPERIAL = GeoStudioUnits(1.0, "kPa", "kN/m^3", 9.807), GeoStudioUnits(0.3048, "lbf/ft^2", "lbf/ft^3", 62.4)


def read_gsz(path: Path, name: str, analysis: str | None = None) -> ImportedSection:
    """Read the section of an analysis of SLOPE/W in a model of GeoStudio.

    Parameters
    ----------
    path : path of the file
    name : name of the section
    analysis : name of the analysis; the first analysis of SLOPE/W if left out

    Returns
    -------
    The section as TOML, and notices.

    Raises
    ------
    InputError
        If the file is no such model, or has no such analysis.
    """
    with as_input_errors(path, EXPECTED):
        return section_of(_model(_document(path), path, analysis), path, name)


def _document(path: Path) -> Element:
    """Return the document at the top of the zip. A document with XML entities of its own is refused."""
    with zipfile.ZipFile(path) as archive:
        inside = [file for file in archive.infolist() if "/" not in file.filename and file.filename.endswith(".xml")]
        if not inside:
            raise InputError(str(path), [f"{EXPECTED}; it has no document of that kind"])
        text = archive.read(within_reason(inside[:1])[0])
    if b"<!ENTITY" in text:
        raise InputError(str(path), [f"{EXPECTED}; its document defines entities, which GeoStudio does not"])
    return ElementTree.fromstring(text)


def _model(root: Element, path: Path, wanted: str | None) -> ForeignModel:
    analyses = [node for node in root.iterfind("./Analyses/Analysis") if "SLOPE" in _text(node, "Kind").upper()]
    if not analyses:
        kinds = dict.fromkeys(_text(node, "Kind") for node in root.iterfind("./Analyses/Analysis"))
        raise InputError(
            str(path), [f"{EXPECTED}; the analyses in it are of {', '.join(filter(None, kinds)) or 'no kind'}"]
        )
    names = [_text(node, "Name") for node in analyses]
    place, others = chosen_part(names, wanted, path, "an analysis", "analyses")
    analysis, notices = analyses[place], [f'analysis "{names[place]}"', *others]
    number = _text(analysis, "ID")
    system = root.find("./Coordinates/EngCoords")
    word = system.get("UnitSystem", "metric") if system is not None else "metric"
    if word.lower() not in ("metric", "imperial"):
        raise InputError(str(path), [f'EngCoords, UnitSystem = "{word}": expected metric or imperial'])
    units = METRIC if word.lower() == "metric" else IMPERIAL
    stored = _of_analysis(root, "./StabilityItems/StabilityItem", number).find("Entry")
    entry = Element("Entry") if stored is None else stored
    local = {
        str(node.get("Number")): _point_in_metres(node, units) for node in entry.iterfind("./DataPoints/DataPoint")
    }
    lines = {
        _text(node, "ID"): line_of([local[at.text or ""] for at in node.iterfind("./DataPoints/DataPoint")])
        for node in entry.iterfind("./PiezometricSurfaces/PiezometricSurface")
    }
    uses = {node.get("ID"): node.get("UsesID") for node in entry.iterfind("./MaterialUsesPiezs/MaterialUsesPiez")}
    table = next((lines[line] for line in uses.values() if line in lines), None)
    soils: dict[str, tuple[str, dict[str, Any]]] = {}
    for material in root.iterfind("./Materials/Material"):
        called, key = _text(material, "Name"), _text(material, "ID")
        density = f"{_number(material, 'StressStrain/UnitWeight'):g} {units.weight}"
        keys: dict[str, Any] = {"density": density, "density_saturated": density, **_strength(material, units, notices)}
        soils[key] = called, keys
        line = lines.get(uses.get(key) or "")
        if line is None and table is not None:
            keys["pore_pressure_ratio"] = 0.0
        elif line is not None and line is not table:
            keys["piezometric_level"] = line.tolist()
    geometry = root.findall("./Geometries/Geometry")[int(_text(analysis, "GeometryId") or 1) - 1]
    notices += _not_taken(entry, root.find(f"./WaterItems/WaterItem[AnalysisID='{number}']"))
    water = root.find(f"./WaterItems/WaterItem[AnalysisID='{number}']/Entry/UnitWaterWeight")
    weight = f"{float(water.text) if water is not None and water.text else units.water:g} {units.weight}"
    regions = list(_regions(root, geometry, number, units, notices))
    return ForeignModel(
        [ForeignLayer(soils[key][0], points, soils[key][1], {}, {}) for key, points in regions],
        {} if table is None else {"table": table.tolist(), "unit_weight": weight},
        notices=list(dict.fromkeys(notices)),
    )


def _of_analysis(root: Element, items: str, number: str) -> Element:
    """Return the item of ``items`` that belongs to an analysis. Raises LookupError if none does."""
    analysis = next((node for node in root.iterfind(items) if _text(node, "AnalysisID") == number), None)
    if analysis is None:
        raise LookupError(f"no {items.rsplit('/', 1)[-1]} of analysis {number}")
    return analysis


def _regions(
    root: Element, geometry: Element, number: str, units: GeoStudioUnits, notices: list[str]
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the number of the material and the outline (n, 2) in m of every region that has a material. Other regions
    are reported in a notice."""
    points = {
        node.get("ID"): _point_in_metres(node, units) for node in geometry.iterfind("./Points/Point") if node.get("X")
    }
    context = _of_analysis(root, "./Contexts/Context", number)
    pairs = context.iterfind("./GeometryUsesMaterials/GeometryUsesMaterial")
    materials = {m[1]: node.get("Entry") for node in pairs if (m := REGION.fullmatch(node.get("ID", "")))}
    for region in geometry.iterfind("./Regions/Region"):
        if (material := materials.get(_text(region, "ID"))) is None:
            notices.append(f"not read: region {_text(region, 'ID')}, which has no material in this analysis")
        else:
            yield material, corners([points[key.strip()] for key in _text(region, "PointIDs").split(",")])


def _strength(material: Element, units: GeoStudioUnits, notices: list[str]) -> dict[str, Any]:
    """Return the strength of a material as keys of a stratum."""
    model, name = _text(material, "SlopeModel"), _text(material, "Name")
    cohesion, friction = (_number(material, f"StressStrain/{key}") for key in ("CohesionPrime", "PhiPrime"))
    if model == "Bedrock":
        notices.append(f'"{name}" is bedrock: a cohesion of {BEDROCK} prevents that slip surfaces enter it')
        return {"cohesion": BEDROCK, "friction_angle": "0 deg"}
    if model == "UndrainedPhiZero":
        cohesion, friction = _number(material, "StressStrain/Cohesion") or cohesion, 0.0
    elif model != "MohrCoulomb":
        notices.append(
            f'not read: the strength of "{name}" by {model or "no model"}; c and φ are read if the model gives them'
        )
    if not cohesion and not friction:  # missing strengths are requested when the section is read
        return {}
    return {"cohesion": f"{cohesion:g} {units.stress}", "friction_angle": f"{friction:g} deg"}


def _not_taken(entry: Element, water: Element | None) -> Iterator[str]:
    """Yield one sentence for each kind of object of the model that a section cannot have."""
    for what, items in (
        ("surcharges", "./Surcharges/Surcharge"),
        ("line loads", "./LineLoadPoints/LineLoadPoint"),
        ("reinforcement lines", "./ReinforcementLines/ReinforcementLine"),
    ):
        if count := len(entry.findall(items)):
            yield f"not taken: {what}, {count}"
    if entry.find("./TensionCrack/TensionOption") is not None:
        yield "not read: the tension crack; see [tension_crack]"
    seismic = entry.find("Seismic")
    if seismic is not None and (kh := float(seismic.get("Horizontal") or 0.0)):
        yield f"not taken: the earthquake, Kh = {kh:g}; see safety_factor_at in [fem]"
    if seismic is not None and (kv := float(seismic.get("Vertical") or 0.0)):
        yield f"not taken: the vertical earthquake, Kv = {kv:g}; see vertical in [fem], which is positive upwards"
    for part in entry:
        if part.tag not in KNOWN_PARTS and (len(part) or (part.text or "").strip() or part.attrib):
            yield f"not read: {part.tag} of the analysis"
    option = "" if water is None else _text(water, "Entry/ResultInputInfo/Option")
    if option and option.lower() != "none":
        yield f"not read: pore pressure by {option}"


def _point_in_metres(point: Element, units: GeoStudioUnits) -> tuple[float, float]:
    return float(point.get("X", "nan")) * units.length, float(point.get("Y", "nan")) * units.length


def _text(node: Element, tag: str) -> str:
    """Return the text of a child element; an empty text if it is missing, or marked as empty."""
    child = node.find(tag)
    return "" if child is None or child.get("Missing") == "true" else (child.text or "").strip()


def _number(node: Element, tag: str) -> float:
    return float(_text(node, tag) or 0.0)
