"""Checks quantities by ranges, beyond which a number is probably a typing error, mostly in the unit; and densities that
contradict the water."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from pydantic import TypeAdapter, ValidationError

from meshes.section.cutting import BELOW_WATER, divided_by_water, key_in_file
from meshes.section.layering import Layering
from meshes.section.model import Model
from meshes.section.polyline import level_at
from meshes.section.quantity import COMMON_UNITS, GRAVITY, NUMBER_AND_UNIT
from meshes.section.stratum import MISSING_DENSITY, Stratum
from meshes.section.surcharge import Surcharge
from meshes.section.water import Water
from meshes.section.water_pressure import WaterPressure


class Range(NamedTuple):
    """Holds the range of possible values of a quantity.

    Attributes
    ----------
    low, high : smallest and largest value, in the unit
    unit : the unit in messages
    si : size of the unit in SI units
    slips : factors of common errors on a value in SI units, each with the unit that was probably meant
    or_none : whether the quantity may also be 0, below its range
    """

    low: float
    high: float
    unit: str
    si: float
    slips: tuple[tuple[float, str], ...]
    or_none: bool = False


def is_within(value: float, limits: Range) -> bool:
    """Return whether a number lies in a range, to rounding.

    Parameters
    ----------
    value : the number in SI units
    limits : the range

    Returns
    -------
    True within the range, and for 0 if the range allows it.
    """
    none = limits.or_none and value == 0.0
    return none or limits.low * (1.0 - 1e-9) <= value / limits.si <= limits.high * (1.0 + 1e-9)


# Units of stress and length in SI.
SIZES = {unit: size for unit, (si, size) in COMMON_UNITS.items() if si in ("Pa", "m")} | {"µm": 1e-6}
UNUSUAL = ", or unusual = true at the head of the file if it is meant"


def sentence(key: str, value: float, limits: Range, remedy: str = UNUSUAL) -> str:
    """Return a message about a number outside its range.

    Parameters
    ----------
    key : key of the number in the file
    value : the number in SI units, as it was written if it is a `Quantity`
    limits : the range of such numbers
    remedy : end of the sentence: what the user can do if the number is correct

    Returns
    -------
    Sentence with the key, the written value, the value that was probably meant, and the range.
    """
    written = getattr(value, "written", value)
    shown = f'"{written}"' if isinstance(written, str) else f"{written:g}"
    unit = f" {limits.unit}" if limits.unit else ""
    number = str(written).split()[0]
    meant = next((unit for factor, unit in limits.slips if _is_meant(written, unit, factor * value, limits)), None)
    hint = f' (did you mean "{number} {meant}"?)' if meant and f"{number} {meant}" != written else ""
    expected = f"{'0, or ' if limits.or_none else ''}{limits.low:g} to {limits.high:g}{unit}"
    return f"{key} = {shown}: {value / limits.si:.6g}{unit} is implausible{hint}; expected {expected}{remedy}"


def _is_meant(written: str | float, unit: str, otherwise: float, limits: Range) -> bool:
    """Return whether a written number would be in the range if its unit were ``unit``. ``otherwise`` (SI) is used if it
    was written without a unit, or if ``unit`` has no size in the table SIZES."""
    number = NUMBER_AND_UNIT.fullmatch(written) if isinstance(written, str) else None
    return is_within(SIZES[unit] * float(number[1]) if number and unit in SIZES else otherwise, limits)


# Share of a stratum on the wrong side of the water that is reported.
WRONG_SIDE = 0.02
# How level (m) the surface of standing water has to be.
LEVEL = 0.01
# The same where the line of the water enters the ground, since a drawn line rarely bends exactly there.
ALMOST_LEVEL = 0.1


# From fresh peat to ore; buoyant peat; very soft clay to steel; a slurry to rock; rubble; from warm fresh water to the
# Dead Sea; a tent to the foot of a dam.
DENSITY = Range(0.7, 3.5, "t/m^3", 1e3, ((1e3, "t/m^3"), (1e3 / GRAVITY, "kN/m^3"), (1e-3, "kg/m^3"), (0.1, "kN/m^3")))
BUOYANT = DENSITY._replace(low=0.01)
STIFFNESS = Range(0.1, 2e5, "MPa", 1e6, ((1e3, "MPa"), (1e-3, "kPa")))
COHESION = Range(0.05, 5e4, "kPa", 1e3, ((1e3, "kPa"), (1e-3, "kPa")), or_none=True)
FRICTION = Range(0.0, 60.0, "deg", math.pi / 180.0, ())
WATER = Range(9.5, 12.5, "kN/m^3", 1e3, ((1e3, "kN/m^3"),))
LOAD = Range(0.05, 5e3, "kPa", 1e3, ((1e3, "kPa"), (1e-3, "kPa")), or_none=True)
# Mud to crust, per metre. Tailings that have liquefied to diatomaceous clay (0.2 to 0.35 in most); desiccated crust;
# pores that bear all of the weight. Rock that is written as impermeable to open rockfill.
INCREASE = Range(0.01, 200.0, "kPa/m", 1e3, ((1e3, "kPa/m"), (1e-3, "kPa/m")), or_none=True)
STRENGTH_RATIO = Range(0.01, 1.0, "", 1.0, ((0.01, "%"),), or_none=True)
OVERCONSOLIDATION = Range(1.0, 60.0, "", 1.0, ())
PRESSURE_RATIO = Range(0.0, 1.0, "", 1.0, ((0.01, "%"),))
PERMEABILITY = Range(1e-20, 1.0, "m/s", 1.0, ((1e-2, "cm/s"),))
OF_A_STRATUM = {
    "density_ordinary": BUOYANT, "density_seismic": DENSITY, "density_saturated": DENSITY, "youngs_modulus": STIFFNESS,
    "cohesion": COHESION, "cohesion_increase": INCREASE, "cohesion_minimum": COHESION, "tension": COHESION,
    "friction_angle": FRICTION, "strength_ratio": STRENGTH_RATIO, "ocr": OVERCONSOLIDATION,
    "pre_overburden_pressure": LOAD, "pore_pressure_ratio": PRESSURE_RATIO, "permeability": PERMEABILITY,
    "permeability_vertical": PERMEABILITY,
    "residual_cohesion": COHESION, "residual_friction_angle": FRICTION,
}  # fmt: skip


def implausible(strata: Sequence[Stratum], water: Water | None, surcharges: Sequence[Surcharge]) -> list[str]:
    """Return one sentence for each quantity outside its range."""
    sentences = [text for k, s in enumerate(strata) for text in _sentences(key_in_file(strata, k), s, OF_A_STRATUM)]
    sentences += [
        sentence(f"{key_in_file(strata, k)}, strength_table", quantity, COHESION)
        for k, s in enumerate(strata) for pair in s.strength_table or () for quantity in pair
        if not is_within(quantity, COHESION)
    ]  # fmt: skip
    sentences += _sentences("water", water, {"unit_weight": WATER}) if water is not None else []
    for number, load in enumerate(surcharges, start=1):
        sentences += [
            sentence(f"surcharges {number}, pressure", q, LOAD) for q in load.pressure if not is_within(q, LOAD)
        ]
    return list(dict.fromkeys(sentences))


def implausible_as_written(strata: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Return the same sentences for tables [[strata]] that have other faults, as far as they can be read, and a
    sentence for tables without density."""
    kinds = get_type_hints(Stratum, include_extras=True)
    for number, written in enumerate(strata, start=1):
        name = written.get("name")
        where = f"strata {number}" + (f' "{name}"' if isinstance(name, str) else "")
        if not any(key.startswith("density") for key in written):
            yield f"{where}: {MISSING_DENSITY}"
        for key, limits in {"density": DENSITY, **OF_A_STRATUM}.items():
            try:
                value = TypeAdapter(kinds[key]).validate_python(written[key])
            except (KeyError, ValidationError):
                continue
            if value is not None and not is_within(value, limits):
                yield sentence(f"{where}, {key}", value, limits)


def _sentences(where: str, model: Model, ranges: dict[str, Range]) -> Iterator[str]:
    for key, limits in ranges.items():
        value = getattr(model, key)
        if value is None or is_within(value, limits):
            continue
        is_single = key.startswith("density_") and isinstance(model, Stratum) and model.density is not None
        if is_single and key == "density_ordinary":
            continue  # both densities are the one that was given, and the other is reported
        yield sentence(f"{where}, {'density' if is_single and key == 'density_seismic' else key}", value, limits)


def against_the_water(
    layers: Layering, strata: Sequence[Stratum], drawn: np.ndarray | None, table: np.ndarray | None
) -> Iterator[str]:
    """Return densities, and layers that liquefy, which contradict the water, one sentence each.

    ``drawn`` is a water table (n, 2) that is only drawn, if densities include the water; ``table`` is a water table
    with pore pressures. ``layers``: the ground layer by layer; ``strata``: the strata with their soils.
    """
    level = drawn if table is None else table
    if level is None:
        return
    yield from _away_from_the_ground(layers, level)
    for k, s in enumerate(strata):
        parts = divided_by_water(layers, k, level)
        above, below = (float(0.5 * np.diff(parts.x) @ thick.sum(axis=1)) for thick in parts.thickness)
        key = key_in_file(strata, k)
        whole = max(above + below, 1e-300)
        if drawn is not None and s.buoyant and above > WRONG_SIDE * whole:
            yield (
                f"{key}: its ordinary density is buoyant, and {100 * above / whole:.0f} % of it lies above the water "
                "table; [water] with density and density_saturated cuts it there"
            )
        if drawn is not None and not s.buoyant and below > WRONG_SIDE * whole:
            yield (
                f"{key}: its ordinary density is not buoyant, and {100 * below / whole:.0f} % of it lies below the "
                "water table; [water] with density and density_saturated cuts it there"
            )
        if s.liquefiable and not s.confined and below <= WRONG_SIDE * whole:
            yield f"{key}: it liquefies in {list(s.liquefies_in)}, and lies above the water table"
        if table is not None and s.density_saturated is None and s.name.endswith(BELOW_WATER):
            yield f"{key}: it has no density_saturated, so that density is used below the water, too"


def not_lower(before: np.ndarray | None, after: np.ndarray) -> Iterator[str]:
    """Return a sentence if the water table ``after`` a drawdown lies above the table ``before`` it, both (n, 2)."""
    if before is None:
        return
    x = np.union1d(before[:, 0], after[:, 0])
    middle = 0.5 * (x[1:] + x[:-1])
    both = (np.array([level_at(table, end, middle) for end in (x[:-1], x[1:])]) for table in (before, after))
    rise = np.subtract(*reversed(list(both)))
    if rise.max() > LEVEL:
        risen = (rise > LEVEL).any(axis=0)
        start, end = x[:-1][risen][0], x[1:][risen][-1]
        yield (
            f"water: after_drawdown lies above table, by up to {rise.max():.3g} m, between x = {start:g} and {end:g} "
            "m; the water rises there"
        )


def _away_from_the_ground(layers: Layering, level: np.ndarray) -> Iterator[str]:
    """Yield a sentence if the water (n, 2) stands above all of the ground, or lies below all of it."""
    x = np.concatenate([layers.x[:-1], layers.x[1:]])
    top, base = (np.concatenate([layers.left[:, k], layers.right[:, k]]) for k in (0, -1))
    level_at_x = np.interp(x, *level.T)
    if (level_at_x > top).all():
        yield f"water: all of the ground lies below water, at most {float((level_at_x - top).max()):.4g} m deep"
    elif (level_at_x < base).all():
        yield "water: the water table lies below the base of the section, so that all of the ground is dry"


def not_level(ground: np.ndarray, table: np.ndarray) -> Iterator[str]:
    """Return a sentence if water stands on the ground (n, 2) and its surface, the ``table`` (n, 2), is not level
    there."""
    x = np.union1d(ground[:, 0], table[:, 0])
    middle = 0.5 * (x[1:] + x[:-1])
    ends, heights = (np.array([level_at(line, end, middle) for end in (x[:-1], x[1:])]) for line in (table, ground))
    depths = ends - heights  # on either side of a wall, where the ground steps
    under = np.clip(depths, 0.0, None).max(axis=0)  # depth of the free water
    # Of a stretch that is partly under water, the surface of this part falls less.
    share = under / np.maximum(np.abs(depths[1] - depths[0]), under + 1e-300)
    falls = np.abs(ends[1] - ends[0]) * np.where((depths > 0.0).all(axis=0), 1.0, share)
    least = np.where((depths > 0.0).all(axis=0), LEVEL, ALMOST_LEVEL)
    if (inclined := (under > LEVEL) & (falls > least)).any():
        k = int(np.flatnonzero(inclined)[0])
        at = x[k] if depths[0, k] > LEVEL else x[k + 1]
        yield (
            f"water: water stands on the ground at x = {at:g} m and its surface is not level there; "
            "expected a level surface, or a water table below the ground"
        )


def flow_notices(water: WaterPressure) -> Iterator[str]:
    """Return a sentence if nothing flows in seepage, and one for each wall that free water stands against."""
    yield from _nothing_flows(water)
    table = water.table_before
    if water.flow is None or table is None:
        return
    for x in water.flow.grid.walls:
        at, near = np.full(2, x), np.array([x - LEVEL, x + LEVEL])
        levels = level_at(table, at, near)
        above = np.maximum(levels - water.layers.interface(0, at, near=near), 0.0)
        if abs(levels[1] - levels[0]) > LEVEL and abs(above[1] - above[0]) > LEVEL:
            pressure = water.unit_weight * abs(above[1] - above[0]) / 1e3
            yield (
                f"water, cutoffs: free water stands at {levels[0]:g} m left of the wall at x = {x:g} m and at "
                f"{levels[1]:g} m right of it; a wall has no strength here, and the ground beside it carries "
                f"{pressure:.3g} kPa at its surface: give the wall as a zone if it carries them"
            )


def _nothing_flows(water: WaterPressure) -> Iterator[str]:
    """Return a sentence if seepage is to be computed, but its heads, or a wall, prevent any flow."""
    table = water.table_before
    if water.flow is None or table is None or water.flow.discharge:
        return
    low, high = float(table[:, 1].min()), float(table[:, 1].max())
    if high - low <= LEVEL:
        reason = f"the water table has one level, {high:g} m; expected levels that differ at the sides or in free water"
    else:
        reason = (
            "a wall closes the section, or the levels at the sides and of free water are equal where water could flow"
        )
    yield f"water, flow = true: no water flows, because {reason}"
