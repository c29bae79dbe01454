"""Reads borings from an AGS4 file, from its groups LOCA, GEOL, ISPT, WSTG, WSTD, SCPG and SCPT."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from meshes.borings.ags4_groups import KINDS, LINE, Groups, Row, read_groups
from meshes.borings.blows import is_refusal, read_blows
from meshes.borings.boring import Cone, Sample
from meshes.borings.complaints import folded, unread_counts
from meshes.borings.log import (
    BoringFile,
    Log,
    LogLayer,
    cone_problems,
    depth_problems,
    layer_problems,
    merged_layers,
    refusal_notices,
)
from meshes.borings.plausible import implausible_cones, implausible_sample
from meshes.borings.table import NOT_MEASURED
from meshes.errors import InputError
from meshes.section.sentences import sentences

NO_READING = re.compile(r"-9{3,}(\.\d*)?")  # what loggers write for a reading that is missing


def cones_of(name: str, groups: Groups) -> tuple[Cone, ...]:
    """Return the readings of all cone tests at a boring, from the top down. Of two readings at one depth the first
    counts.

    The resistance is SCPT_QT; if SCPT_QT was not reported, it is SCPT_RES + (1 - a) SCPT_PWP2 with the area ratio a of
    the cone, SCPG_CAR, or SCPT_RES alone, which in sand is nearly the same. Negative sleeve friction, which is noise,
    counts as zero. Readings without a resistance or a sleeve friction, or with -999 in its place, are left out; files
    have such readings at the beginning of a push.
    """
    ratios = {location.get("SCPG_TESN", ""): location.get("SCPG_CAR", "") for location in groups.of("SCPG", name)}
    cones: dict[float, Cone] = {}
    for row in groups.of("SCPT", name):
        if not (row.get("SCPT_RES") or row.get("SCPT_QT")) or not row.get("SCPT_FRES"):
            continue
        if any(NO_READING.fullmatch(row.get(key, "")) for key in ("SCPT_QT", "SCPT_RES", "SCPT_FRES")):
            continue
        depth = row.get("SCPT_DPTH", "")
        if not depth:
            groups.problems.append(f"boring {name}: a cone resistance without a depth, SCPT_DPTH")
            continue
        try:
            cone = _cone(row, groups, ratios.get(row.get("SCPG_TESN", ""), ""))
        except ValueError as error:
            groups.problems.append(f"boring {name}, SCPT at {depth} {groups.units['SCPT_DPTH']}, {error}")
            continue
        if cone is not None:
            cones.setdefault(float(cone.depth), cone)
    return tuple(cones[depth] for depth in sorted(cones))


def _cone(row: Row, groups: Groups, ratio: str) -> Cone | None:
    """Return one reading; None at the ground itself, or if the cone met no resistance. Raises ValueError that names the
    key."""
    if row.get("SCPT_QT"):
        resistance = _value(row, "SCPT_QT", groups)
    else:
        resistance = _value(row, "SCPT_RES", groups)
        if ratio and row.get("SCPT_PWP2"):
            resistance += (1.0 - float(ratio)) * _value(row, "SCPT_PWP2", groups)
    depth = _value(row, "SCPT_DPTH", groups)
    if resistance <= 0.0 or depth == 0.0:
        return None
    data = {"depth": depth, "qc": resistance, "fs": max(0.0, _value(row, "SCPT_FRES", groups))}
    try:
        return Cone.model_validate(data)
    except ValidationError as error:
        raise ValueError("; ".join(sentences(error, data, Cone))) from None


def _value(row: Row, key: str, groups: Groups) -> float:
    try:
        return groups.read(row, key)
    except ValueError as error:
        raise ValueError(f"{key} = {row[key]!r}: {error}") from None


NATIONAL, LOCAL = ("LOCA_NATE", "LOCA_NATN"), ("LOCA_LOCX", "LOCA_LOCY")
COUNTS = ("ISPT_NVAL", "ISPT_REP")
# Depth (m) of the middle of the counted 30 cm below the top of a test, with 15 cm of seating.
MIDDLE = 0.30
DRY = {
    "dry",
    "none",
    "nil",
    "no",
    "n/a",
    "na",
    "-",
    "ne",
    "not encountered",
    "not struck",
    "none encountered",
    "no water",
}


def read_ags4(path: Path, columns: Mapping[str, str] | None = None) -> BoringFile:
    """Read the borings of a file that have layers or a cone test, in the order of the file.

    A boring with an error is left out, and so is a blow count that cannot be read; a notice reports both.

    Parameters
    ----------
    path : path of the file
    columns : {"layer": heading of GEOL} that names the layers; by default GEOL_GEOL, or GEOL_LEG where that is empty

    Returns
    -------
    The borings, and notices.

    Raises
    ------
    InputError
        If fewer than two borings with layers are without error, or if more than half of the blow counts cannot be read.
        The error contains all problems.
    """
    groups, columns = read_groups(path), columns or {}
    naming = (columns["layer"],) if "layer" in columns else ("GEOL_GEOL", "GEOL_LEG")
    if problems := _input_problems(groups, columns):
        raise InputError(str(path), problems)
    borings = groups.rows["LOCA"]
    axes = _axes(borings, groups.notices)
    groups.notices.extend(_on_unlisted_borings(groups))
    logs = [log for row in borings if (log := _log(row, axes, naming, groups)) is not None]
    left_out, too_many = unread_counts(groups.unread, sum(len(log.samples) for log in logs))
    if too_many:
        raise InputError(str(path), [*folded(groups.problems), *too_many])
    groups.notices.extend(f"{path.name}, {text}" for text in left_out)
    if not logs and not groups.problems:
        groups.problems.append("no boring of group LOCA has layers in GEOL or cone readings in SCPT")
    if groups.problems and sum(bool(log.layers) for log in logs) < 2:
        raise InputError(str(path), folded(groups.problems))
    groups.notices.extend(f"a boring is left out: {text}" for text in folded(groups.problems))
    if groups.rows.get("MOND"):
        groups.notices.append(
            "piezometer readings (group MOND) are not used: the water table is that of the water struck in borings"
        )
    return BoringFile(logs, [*folded(groups.notices), *refusal_notices(logs)])


def _input_problems(groups: Groups, columns: Mapping[str, str]) -> list[str]:
    """Return the reasons why the file has no layers, or none by the column that ``columns`` names."""
    problems = [f"--columns {key}={name}: the names of columns in an AGS4 file are fixed; expected only layer, which "
                "--layers sets"
                for key, name in columns.items() if key != "layer"]  # fmt: skip
    if not groups.rows.get("LOCA"):
        problems.append("group LOCA: missing; expected the list of borings")
    if not groups.rows.get("GEOL") and not groups.rows.get("SCPT"):
        problems.append("group GEOL: missing; expected the layers of the borings, or their cone readings in SCPT")
    of_layers = [name for name in groups.headings.get("GEOL", ()) if name.startswith("GEOL_")]
    layer = columns.get("layer")
    if layer is not None and of_layers and layer not in of_layers:
        problems.append(f"--layers {layer}: group GEOL has no such column; expected one of {', '.join(of_layers)}")
    return problems


def _axes(borings: Sequence[Row], notices: list[str]) -> tuple[str, str]:
    """Return the headings of the coordinates that all borings have, and a notice if they are local."""
    axes = next((axes for axes in (NATIONAL, LOCAL) if all(row.get(axes[0]) for row in borings)), NATIONAL)
    if axes is LOCAL:
        missing = "not all borings have" if any(row.get(NATIONAL[0]) for row in borings) else "no boring has"
        notices.append(f"{missing} national coordinates: LOCA_LOCX and LOCA_LOCY are taken")
    return axes


def _on_unlisted_borings(groups: Groups) -> Iterator[str]:
    """Yield a notice for each group with rows of borings that the list of borings does not contain."""
    known = {row.get("LOCA_ID", "") for row in groups.rows["LOCA"]}
    for group in ("GEOL", "ISPT", "SCPT", "WSTG"):
        strangers = dict.fromkeys(row.get("LOCA_ID", "") for row in groups.rows.get(group, ()))
        if lost := [name or "without a name" for name in strangers if name not in known]:
            more = f" and {len(lost) - 3} more" if len(lost) > 3 else ""
            yield (
                f"group {group}, borings {', '.join(lost[:3])}{more}: not used, since group LOCA does not list "
                "these borings"
            )


def _log(row: Row, axes: tuple[str, str], naming: tuple[str, ...], groups: Groups) -> Log | None:
    name = row.get("LOCA_ID", "")
    strata = groups.of("GEOL", name)
    before = len(groups.problems)
    cones = cones_of(name, groups)
    groups.problems.extend(cone_problems(name, cones))
    groups.problems.extend(implausible_cones(f"boring {name}, ", cones, with_units=True))
    if not strata and not cones:
        return None
    place = (_number(row, axes[0], name, groups), _number(row, axes[1], name, groups))
    level = "LOCA_LOCZ" if row.get("LOCA_LOCZ") and not row.get("LOCA_GL") else "LOCA_GL"
    ground = _number(row, level, name, groups) if strata else math.nan
    layers = []
    for group_row in strata:
        label = next((group_row[key] for key in naming if group_row.get(key, "").lower() not in NOT_MEASURED), "")
        if not label:
            groups.problems.append(
                f"boring {name}: the layer at {group_row.get('GEOL_TOP', '?')} m has no name ({naming[0]}); "
                "--layers GEOL_DESC takes the names from another column"
            )
        top, bottom = _number(group_row, "GEOL_TOP", name, groups), _number(group_row, "GEOL_BASE", name, groups)
        layers.append(LogLayer(groups.meaning(label), top, bottom, "", group_row.get("GEOL_DESC", "")))
    layers = merged_layers(sorted(layers, key=lambda layer: layer.top))
    samples = _samples(name, groups)
    water = _water_level(name, ground, groups) if strata else None
    if len(groups.problems) == before and strata:
        groups.problems.extend(layer_problems(name, layers))
    log = Log(name, place, ground, tuple(layers), samples, water, cones)
    if len(groups.problems) == before:
        groups.problems.extend(depth_problems(log))
    return log if len(groups.problems) == before else None


def _samples(name: str, groups: Groups) -> tuple[Sample, ...]:
    """Return the blow counts of a boring from the top down. Of two blow counts at one depth the smaller one counts."""
    samples: dict[float, Sample] = {}
    for row in groups.of("ISPT", name):
        count, report = ("" if row.get(key, "").lower() in NOT_MEASURED else row[key] for key in COUNTS)
        if not row.get("ISPT_TOP"):
            groups.problems.append(f"boring {name}: a blow count N = {count or report} without a depth, ISPT_TOP")
            continue
        place_words = f"boring {name}, SPT at {row['ISPT_TOP']} {groups.units['ISPT_TOP']}"
        driven = _driven(row)
        if not count and not report and not driven:
            groups.notices.append(f"{place_words}: has neither ISPT_NVAL nor ISPT_REP, and is not used")
            continue
        depth = _number(row, "ISPT_TOP", name, groups) + MIDDLE
        if math.isnan(depth):
            continue
        sample = _sample(row, f"{place_words}, ", depth, _count_of(count, report, driven), groups)
        if sample is None:
            continue
        other = samples.setdefault(depth, sample)
        if other is not sample:
            samples[depth] = min(sample, other, key=lambda candidate: candidate.N)
            groups.notices.append(f"{place_words}: N = {other.N:g} and {sample.N:g}; the smaller value is used")
    return tuple(samples[depth] for depth in sorted(samples))


def _driven(row: Row) -> str:
    """Return the blows of the main drive, ISPT_MAIN, for their penetration, ISPT_NPEN (mm); empty if one is missing."""
    blows, depth = row.get("ISPT_MAIN", ""), row.get("ISPT_NPEN", "")
    return f"{blows} for {depth} mm" if blows.isdecimal() and depth.isdecimal() and float(depth) > 0.0 else ""


def _count_of(count: str, report: str, driven: str) -> str:
    """Return the text of the blow count: ISPT_NVAL, unless ISPT_NVAL is missing, or the report or the drive states a
    refusal.

    ``count``: ISPT_NVAL; ``report``: ISPT_REP; ``driven``: blows and penetration of the drive.
    """
    for text in (report, driven):
        try:
            if text and (not count or is_refusal(read_blows(text))):
                return text
        except ValueError:
            continue
    return count or report


def _sample(row: Row, where: str, depth: float, count: str, groups: Groups) -> Sample | None:
    data: dict[str, object] = {"depth": depth, "N": count}
    if energy := row.get("ISPT_ERAT", ""):
        try:
            data["energy_ratio"] = Sample(depth=1.0, N=1.0, energy_ratio=float(energy.strip(" %"))).energy_ratio
        except ValueError:
            groups.notices.append(f"{where}ISPT_ERAT = {energy!r} is not used; expected percent, from 20 to 120")
    try:
        sample = Sample.model_validate(data)
    except ValidationError as error:
        groups.unread.extend(f"line {row[LINE]}, {where}{text}" for text in sentences(error, data, Sample))
        return None
    groups.problems.extend(implausible_sample(where, sample))
    return sample


def _water_level(name: str, ground: float, groups: Groups) -> float | None:
    """Return the highest elevation (m) that struck water had risen to; None if no water was struck."""
    rows = [*groups.of("WSTG", name), *groups.of("WSTD", name)]
    keys = [(row, key) for row in rows for key in ("WSTG_DPTH", "WSTD_POST") if row.get(key)]
    dry = [row[key] for row, key in keys if row[key].lower() in DRY]
    if dry:
        groups.notices.append(f'boring {name}: water "{dry[0]}" means that no water was struck')
    depths = [_number(row, key, name, groups) for row, key in keys if row[key].lower() not in DRY]
    return ground - min(depths) if depths else None


def _number(row: Row, key: str, name: str, groups: Groups) -> float:
    try:
        return groups.read(row, key)
    except ValueError as error:
        problem = f"= {row[key]!r}: {error}" if row.get(key) else f"is missing; {KINDS[key].expected}"
        groups.problems.append(f"boring {name}, {key} {problem}")
        return math.nan
