"""Puts sections, settings and cases in tables for people."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from dem.case import PAPER_CASES, Case, cases_of_loose_sand
from meshes.section.polyline import Line
from meshes.section.section import Section, Stratum
from meshes.section.sentences import coordinate
from meshes.section.vertical_flow import LINES as FLOW_LINES
from workflow.config import FILES, Config
from workflow.earthquake.settings import EarthquakeSettings

STRATA_HEADS = (
    "stratum", "area\nm²", "thickness\nm", "from-to x\nm", "E\nMPa", "ν\n", "ρ\nt/m³", "c\nkPa", "φ/ψ\ndeg",
)  # fmt: skip

FILE = "section file"
# The parameters of a stratum as they were written: field, symbol, and the SI unit of a plain number.
WRITTEN = (
    ("youngs_modulus", "E", "Pa"),
    ("poissons_ratio", "ν", ""),
    ("density_ordinary", "ordinary density", "kg/m³"),
    ("density_seismic", "seismic density", "kg/m³"),
    ("cohesion", "c", "Pa"),
    ("friction_angle", "φ", "rad"),
    ("dilation_angle", "ψ", "rad"),
)
# Columns that are shown where a stratum has the value.
WRITTEN_OF_SOME = (
    ("density_saturated", "saturated density", "kg/m³"),
    ("pore_pressure_ratio", "pore pressure ratio", ""),
    ("excess_pore_pressure_ratio", "excess pore pressure ratio", ""),
    ("residual_cohesion", "residual c", "Pa"),
    ("residual_friction_angle", "residual φ", "rad"),
)


def _dilation(stratum: Stratum) -> str:
    """Return the dilation angle in degrees, or a dash if the section gives none, so that the flow rule decides."""
    return "–" if stratum.dilation_angle is None else f"{math.degrees(stratum.dilation_angle):.3g}"


def strata_rows(section: Section) -> Iterator[list[str]]:
    """Yield a row for every stratum.

    Parameters
    ----------
    section : the section

    Yields
    ------
    Name, area (m2), thickness (m), range of x (m), E (MPa), Poisson's ratio, density (t/m3), cohesion (kPa), and
    friction and dilation angles (degrees).
    """
    layers = section.layering
    at_left, at_right = layers.thickness()
    for k, (stratum, area) in enumerate(zip(section.strata, layers.areas(), strict=True)):
        present = layers.present()[:, k]
        ends = [*at_left[present, k], *at_right[present, k]]
        start, end = layers.x[:-1][present].min(), layers.x[1:][present].max()
        yield [
            stratum.name,
            f"{area:.1f}",
            "-".join(dict.fromkeys((f"{min(ends):.1f}", f"{max(ends):.1f}"))),
            f"{coordinate(start)}-{coordinate(end)}",
            f"{stratum.youngs_modulus / 1e6:.4g}",
            f"{stratum.poissons_ratio:g}",
            ", seismic ".join(
                dict.fromkeys(f"{d / 1e3:.4g}" for d in (stratum.density_ordinary, stratum.density_seismic))
            ),
            _cohesion(stratum) + (f", tension {stratum.tension / 1e3:.3g}" if stratum.tension is not None else ""),
            f"{math.degrees(stratum.friction_angle):.3g}/{_dilation(stratum)}",
        ]


def _cohesion(stratum: Stratum) -> str:
    """Return the cohesion (kPa) of a stratum as a formula; z is the depth (m) below its line, σ'v is in kPa."""
    terms = [f"{stratum.cohesion / 1e3:.4g}"] if stratum.cohesion or not stratum.cohesion_varies else []
    terms += [f"{stratum.cohesion_increase / 1e3:.3g} z"] if stratum.cohesion_increase else []
    if stratum.strength_ratio:
        past = f"(1+{stratum.pre_overburden_pressure / 1e3:.3g}/σ'v)" if stratum.pre_overburden_pressure else ""
        past = past or (f"{stratum.ocr:.3g}" if stratum.ocr not in (None, 1.0) else "")
        terms.append(f"{stratum.strength_ratio:.3g} σ'v" + (f" {past}^{stratum.exponent:.3g}" if past else ""))
    if stratum.strength_table is not None:
        pairs = [f"{stress / 1e3:.3g}: {strength / 1e3:.3g}" for stress, strength in stratum.strength_table]
        terms.append(f"({', '.join(pairs)}) by σ'v")
    least = f", ≥ {stratum.cohesion_minimum / 1e3:.3g}" if stratum.cohesion_minimum else ""
    return " + ".join(terms) + least


def source_of(section: Section, stratum: Stratum) -> str:
    """Return the source of the parameters of a stratum: its description, and whether the ground is a reconstruction."""
    phrases = [stratum.description or FILE]
    return "; ".join([*phrases, *(["reconstruction"] if section.reconstruction else [])])


def parameter_rows(config: Config) -> Iterator[tuple[str, str, str]]:
    """Yield name, value and source of the water, the earthquake, the shaking and the cases of liquefaction."""
    section, after = config.section, config.section.water_points_after_drawdown()
    if (water := section.water_points()) is not None:
        name = "water table" if after is None else "water table before the drawdown"
        yield name, _elevations(water), FILE
    if after is not None:
        yield "water table after the drawdown", _elevations(after), FILE
    earthquake = config.earthquake
    if facts := _of_earthquake(earthquake):
        yield "earthquake", ", ".join(facts), "[earthquake]"
    if config.section.liquefies:
        default = earthquake.is_assumed(config.slide)
        derived = "kh" in config.left_open or earthquake.driving(config.slide) is not None  # also of a stored section
        by = "[earthquake]" if derived else "default" if default else "slide.kh"
        yield "shaking of the slides", config.slide.shaking, by
    heads = [name for name, _ in case_heads(config)]
    assumed = config.slide.cases in (PAPER_CASES, cases_of_loose_sand(config.section))
    for number, names, *left in case_rows(config):
        phrase = ", ".join(f"{head} {value}" for head, value in zip(heads, left, strict=True) if head != "name")
        derived = int(number) > len(config.slide.cases)
        by = "borings ([triggering])" if derived else "default" if assumed else "slide.cases"
        yield config.called(int(number)), f"{names}: {phrase}", by


def _elevations(line: np.ndarray) -> str:
    """Return the elevations between which a line (n, 2) lies, in words."""
    low, high = line[:, 1].min(), line[:, 1].max()
    return f"elevation {coordinate(low)} to {coordinate(high)} m" if high > low else f"elevation {coordinate(low)} m"


def _of_earthquake(earthquake: EarthquakeSettings) -> list[str]:
    """Return the magnitude, distance and peak acceleration, as far as they are known."""
    facts = [] if earthquake.magnitude is None else [f"M {earthquake.magnitude:g}"]
    facts += [] if earthquake.distance is None else [f"at {earthquake.distance / 1e3:.3g} km"]
    if earthquake.peak_acceleration is not None:
        facts.append(f"peak acceleration {earthquake.peak_acceleration * 100.0:.3g} gal")
    return facts


def texts(section: Section) -> list[str]:
    """Return the names and descriptions in a section.

    Parameters
    ----------
    section : the section

    Returns
    -------
    The texts, for a search for characters that no font has.
    """
    names = [section.name, section.title, section.reconstruction_note]
    return names + [text for stratum in section.strata for text in (stratum.name, stratum.description)]


# What a case multiplies; the other properties of a case replace those of the stratum.
FACTORS = ("stiffness", "damping", "friction", "cohesion")
# What a case need not have: a column where one has it.
OPTIONAL = ("name", "residual", "residual_strength", "strain_potential", "volumetric_strain")


def case_heads(config: Config) -> list[tuple[str, str]]:
    """Return the heads of the table of cases: the name of each factor, and the property that it multiplies."""
    heads = {"residual": "residual strength ratio"}
    return [
        (heads.get(name, name.replace("_", " ")), str(Case.model_fields[name].description)) for name in _changed(config)
    ]


def _changed(config: Config) -> list[str]:
    """Return the fields of a case that the tables show."""
    return [name for name in Case.model_fields if name not in OPTIONAL or any(getattr(c, name) for c in config.cases)]


def case_rows(config: Config) -> Iterator[list[str]]:
    """Yield every case in which a stratum liquefies: its number, the strata, and its factors."""
    for number, case in enumerate(config.cases, start=1):
        names = [stratum.name for stratum in config.section.strata if number in stratum.liquefies_in]
        if names:
            left = {"damping": case.damping_left}
            values = {name: _of_one(left.get(name, getattr(case, name)), names) for name in _changed(config)}
            shown = (f"{'× ' * (name in FACTORS)}{factor(value, name)}" for name, value in values.items())
            yield [str(number), ", ".join(names), *shown]


def _of_one(value: Any, names: list[str]) -> Any:
    """Return the value without the name of the stratum if only one stratum liquefies."""
    return value[names[0]] if isinstance(value, dict) and list(value) == names[:1] == names else value


def factor(value: Any, name: str = "") -> str:
    """Return a factor of a case in three digits, a strength in kPa, or a strain in %, by stratum if the strata
    differ."""
    if isinstance(value, dict):
        return "; ".join(
            f"{stratum} {factor(factors_of_stratum, name)}" for stratum, factors_of_stratum in value.items()
        )
    if name == "residual_strength" and value:
        return f"{round(value / 1e3, 1):.3g} kPa"
    if name in ("strain_potential", "volumetric_strain") and value:
        return f"{100.0 * value:.2g} %"
    return f"{value:.3g}" if isinstance(value, float) else str(value) or "–"


def written_columns(config: Section) -> list[tuple[str, str, str]]:
    """Return the field, symbol and SI unit of the parameters of strata that the file gives."""
    return [*WRITTEN, *(column for column in WRITTEN_OF_SOME if any(getattr(s, column[0]) for s in config.strata))]


def written_rows(config: Section) -> Iterator[list[str]]:
    """Yield the strata as in the file, with its units."""
    for stratum in config.strata:
        cases = ", ".join(map(str, stratum.liquefies_in)) or "–"
        cases = f"triggered: {cases}" if stratum.liquefies_in.triggered else cases
        yield [
            stratum.name,
            *(_written_value(stratum, field, unit) for field, _, unit in written_columns(config)),
            cases,
        ]


def _written_value(stratum: Stratum, field: str, unit: str) -> str:
    value = getattr(stratum, field)
    if value is None:
        return "–"
    written = getattr(value, "written", value)
    if isinstance(written, str):
        return written
    return f"{written:g} {unit}".strip() if written else "0"


def line_rows(config: Section) -> Iterator[tuple[str, str, str]]:
    """Yield the lines of the section: name, kind (elevation or depth), and points (m)."""
    yield "ground surface", "elevation", _points(config.surface)
    for name, line in _named_lines(config):
        if line is not None:
            yield name, *_line(line)


def _named_lines(config: Section) -> Iterator[tuple[str, Line | None]]:
    """Yield the lines of strata, base and water by their names; None where the section has no such line."""
    yield from ((f"bottom of {stratum.name}", stratum.bottom) for stratum in config.strata)
    yield from (("base of the section", config.base), ("water table", config.water_table))
    if (water := config.water) is not None:
        yield from (("water table", water.table), ("after a drawdown", water.after_drawdown))
    if (state := config.consolidation) is not None:
        yield from (("water table of the consolidation", state.table), ("ground of the consolidation", state.surface))
    for stratum in config.strata:
        yield f"piezometric level of {stratum.name}", stratum.piezometric_level
        if (flow := stratum.vertical_flow) is not None:
            for key in FLOW_LINES:
                yield f"vertical flow through {stratum.name}: {key.replace('_', ' ')}", getattr(flow, key)


def _line(line: Line) -> tuple[str, str]:
    config = line.depth if line.elevation is None else line.elevation
    return "depth" if line.elevation is None else "elevation", _points(config)


def _points(points: Any) -> str:
    """Return points as pairs; one number for a constant line."""
    if isinstance(points, float):
        return f"{points:g}"
    return "  ".join(f"({x:g}, {z:g})" for x, z in points)


def changed_settings(config: Config) -> Iterator[tuple[str, str, str]]:
    """Yield the settings that differ from their defaults: name, value and description."""
    for table in config.tables():
        settings: BaseModel = getattr(config, table)
        for key, field in type(settings).model_fields.items():
            value = getattr(settings, key)
            if value != field.get_default(call_default_factory=True) and table != "report":
                shown = Path(value).name if (table, key) in FILES else setting_text(value)
                yield f"{table}.{key}", shown, str(field.description or "")


def setting_text(value: Any) -> str:
    """Return a setting as text; a file by its name alone."""
    if value is None:
        return "not given"
    if isinstance(value, Path):
        return value.name
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, BaseModel):
        return ", ".join(
            f"{name.replace('_', ' ')} {setting_text(each)}" for name, each in value if each not in ("", None)
        )
    if isinstance(value, dict):
        return ", ".join(f"{name}: {setting_text(each)}" for name, each in value.items())
    if isinstance(value, tuple | list):
        return "; ".join(setting_text(each) for each in value) or "none"
    written = getattr(value, "written", value)
    return f"{written:g}" if isinstance(written, float) else str(written)
