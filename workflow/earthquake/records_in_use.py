"""Reads the records that the tables of an input name, and returns warnings about them."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dem.settings import AVERAGE
from meshes.errors import InputError
from workflow.earthquake.accelerogram import PEAK_TOLERANCE, Accelerogram, read
from workflow.earthquake.attenuation import GAL

PLACES = (
    ("sliding_block", "accelerogram"), ("slide", "accelerogram"), ("site_response", "record"), ("earthquake", "record"),
)  # fmt: skip


def records(config: Any) -> Iterator[tuple[str, Accelerogram]]:
    """Return every record that an input names and uses, with the place of its name, such as "slide, accelerogram".

    Raises InputError if a record cannot be read.
    """
    for table, key in PLACES:
        settings = getattr(config, table)
        name = getattr(settings, key)
        if name in ("", AVERAGE) or getattr(settings, "peak_acceleration", None) is not None:
            continue
        try:
            record = read(Path(name), settings.unit, settings.component)
        except InputError as error:
            raise InputError(error.source, [f"{table}, {key}: {text}" for text in error.problems]) from None
        yield f"{table}, {key}", record.scaled(settings.scale)


def unreadable_records(tables: Mapping[str, Any]) -> list[str]:
    """Return a sentence on every record in use that exists but cannot be read.

    Parameters
    ----------
    tables : settings of the input by the names of their tables

    Returns
    -------
    The sentences, with table, key and file.
    """
    problems = []
    for table, key in PLACES:
        if table not in tables or getattr(tables[table], "peak_acceleration", None) is not None:
            continue
        settings, name = tables[table], getattr(tables[table], key)
        if name in ("", AVERAGE) or not Path(name).is_file():
            continue
        try:
            read(Path(name), settings.unit, settings.component)
        except InputError as error:
            problems += [f"{table}, {key} = {name}: {text}" for text in error.problems]
    return problems


def other_peak(config: Any) -> list[str]:
    """Return a warning if the peak of the record of sliding blocks is not that of [earthquake].

    Displacements and liquefaction are then of two motions. A peak by magnitude and distance is a median; records within
    its standard deviation are of the same motion. The record of [slide] shakes the base of the discs, and that of
    [site_response] the rock: their peaks may differ.

    Parameters
    ----------
    config : the input

    Returns
    -------
    At most one sentence; none if either peak cannot be determined.
    """
    try:
        motion = config.earthquake.motion()
        record = next((record for place, record in records(config) if place == "sliding_block, accelerogram"), None)
    except InputError:  # reported where it is read
        return []
    if motion is None or record is None or record.peak == 0.0:
        return []
    if (1.0 - PEAK_TOLERANCE) * motion.low <= record.peak <= (1.0 + PEAK_TOLERANCE) * motion.high:
        return []
    scale = config.sliding_block.scale * motion.median / record.peak
    return [
        f"the peak of the record of [sliding_block] is {record.peak / GAL:.0f} gal, while [earthquake] has "
        f"{motion.median / GAL:.0f} gal, {motion.relation}: block slides are of one motion, and liquefaction is of "
        f"another one; sliding_block.scale = {scale:.3g} gives both one peak"
    ]


def remarks(config: Any) -> list[str]:
    """Return corrections of the records in use, and warnings about these records.

    Parameters
    ----------
    config : the input

    Returns
    -------
    One sentence each, with the table and the key that name the record; none if a record cannot be read.
    """
    try:
        texts = [f"{place}, {record.name}: {text}" for place, record in records(config) for text in record.remarks]
    except InputError:  # reported when it is read
        return []
    return texts
