"""Writes and reads sections as DXF drawings: every stratum is a closed polyline on a layer of its name, and the water
an open polyline."""

import importlib.util
import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from meshes.drawings.drawn_section import DrawnSection, drawn_section, missing_soil
from meshes.drawings.shapes import shapes_of
from meshes.drawings.water_line import WATER
from meshes.errors import InputError
from meshes.section.cutting import BELOW_WATER, layers_in_file, soil_numbers, soil_of
from meshes.section.section import Section

# What a layer's name may not hold, and its look-alike in a drawing; the name itself stands in the layer's data.
LOOK_ALIKES = str.maketrans('<>/\\":;?*|=,`', "＜＞／＼＂：；？＊｜＝，｀")
APPLICATION = "NOSHIRO"
LONGEST_NAME = 255
RESERVED = {"0", "defpoints", WATER.casefold()}


def _ezdxf(path: Path) -> Any:
    if importlib.util.find_spec("ezdxf") is None:
        raise InputError(str(path), ["drawings need the package ezdxf: pip install noshiro[drawings]"])
    import ezdxf

    logging.getLogger("ezdxf").setLevel(logging.CRITICAL + 1)  # what it mends of a broken file is no news here
    return ezdxf


def write_dxf(section: Section, path: Path) -> list[str]:
    """Draw the strata and the water table in a DXF file, 1 unit = 1 m.

    Parameters
    ----------
    section : the section
    path : path of the file

    Returns
    -------
    A sentence for each thing of the section that a drawing has no place for, or another name for.
    """
    drawing = _ezdxf(path).new(setup=True, units=6)
    drawing.appids.add(APPLICATION)
    space = drawing.modelspace()
    strata, layering = layers_in_file([stratum.name for stratum in section.strata], section.layering)
    names, numbers = list(dict.fromkeys(map(soil_of, strata))), soil_numbers(strata)
    layers = layer_names(names)
    for number, (name, layer) in enumerate(zip(names, layers, strict=True)):
        drawing.layers.add(layer, color=number % 7 + 1).set_xdata(APPLICATION, [(1000, name[:LONGEST_NAME])])
        polygons = [outline for k in range(len(strata)) if numbers[k] == number for outline in layering.polygons(k)]
        for polygon in polygons:
            space.add_lwpolyline([(float(x), float(z)) for x, z in polygon], close=True, dxfattribs={"layer": layer})
    water = section.water_points()
    if water is not None:
        drawing.layers.add(WATER, color=5)
        space.add_lwpolyline([(float(x), float(z)) for x, z in water], dxfattribs={"layer": WATER})
    drawing.saveas(path)
    notices = [f'stratum "{name}" is on layer "{layer}": a drawing layer cannot have the name of the stratum'
            for name, layer in zip(names, layers, strict=True) if layer != name]  # fmt: skip
    lines = [stratum.name.removesuffix(BELOW_WATER) for stratum in section.strata
             if stratum.confined]  # fmt: skip
    notices += [f"not drawn: the piezometric levels of {', '.join(dict.fromkeys(lines))}"] if lines else []
    if section.water is not None and section.water.after_drawdown is not None:
        notices.append("not drawn: the water table after the drawdown")
    return notices


def layer_names(names: Sequence[str]) -> list[str]:
    """Return names of drawing layers for names of strata: forbidden characters are replaced by similar ones, and all
    names are different."""
    taken, result = set(RESERVED), []
    for name in names:
        plain = layer = name.translate(LOOK_ALIKES)[: LONGEST_NAME - 5]
        number = 1
        while layer.casefold() in taken:  # programs that draw take "Sand" and "SAND" for one
            number += 1
            layer = f"{plain} ({number})"
        taken.add(layer.casefold())
        result.append(layer)
    return result


def read_dxf(
    path: Path, name: str, unit: float | None = None, soil: Callable[[str], list[str]] = missing_soil
) -> DrawnSection:
    """Read the section of a drawing.

    Parameters
    ----------
    path : path of the drawing
    name : name of the section
    unit : length (m) of one unit of the drawing, whatever its $INSUNITS says
    soil : the lines of the soil of a stratum by its name; by default its keys, without values

    Returns
    -------
    The section as TOML, and notices.

    Raises
    ------
    InputError
        If the file cannot be read. The error contains all problems.
    """
    ezdxf = _ezdxf(path)
    from ezdxf import recover

    try:
        # What mends broken files reads none that are binary.
        binary = path.read_bytes().startswith(b"AutoCAD Binary DXF")
        drawing = ezdxf.readfile(path) if binary else recover.readfile(path)[0]
    except (OSError, ezdxf.DXFError, ValueError) as error:
        raise InputError(str(path), [f"is no DXF drawing: {error}"]) from None
    return drawn_section(shapes_of(drawing, _names(drawing), unit), path, name, soil)


def _names(drawing: Any) -> dict[str, str]:
    """Return the names of the strata by layers of the drawing, for strata whose layers could not have the same name."""
    named = {}
    for layer in drawing.layers:
        if layer.has_xdata(APPLICATION):
            name = next((str(tag.value) for tag in layer.get_xdata(APPLICATION) if tag.code == 1000), "")
            named[str(layer.dxf.name)] = name or str(layer.dxf.name)
    return named
