"""Adds borings to a section whose ground a drawing, a model or a file gives."""

import math
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from meshes.borings.connect import PlacedBoring
from meshes.borings.log import Log
from meshes.borings.section_text import boring_lines, soil_lines, water_lines
from meshes.errors import InputError

OTHER_DATUM = 0.5  # m, between the grounds of a boring and of the section, beyond which one of them is doubtful
NUMBER = re.compile(r"(, part)? \d+$")  # which a drawn layer that is met twice has behind its name


class DrawnSoils:
    """Gives the soils of drawn strata by the layers of the same name in borings.

    Parameters
    ----------
    logs : borings
    """

    def __init__(self, logs: Sequence[Log]) -> None:
        self._logs = logs
        self._unknown: list[str] = []

    def lines(self, stratum: str) -> list[str]:
        """Return the lines of the soil of a stratum; those of an unknown soil if no boring has a layer of its name."""
        names = {stratum.casefold(), NUMBER.sub("", stratum).casefold()}
        layers = [(layer, log) for log in self._logs for layer in log.layers if layer.name.casefold() in names]
        if not layers:
            self._unknown.append(f'"{stratum}"')
        return list(soil_lines(layers))

    def notices(self) -> list[str]:
        """Return a sentence on the strata of which no boring has a layer."""
        unknown = ", ".join(dict.fromkeys(self._unknown))
        layers = ", ".join(dict.fromkeys(f'"{layer.name}"' for log in self._logs for layer in log.layers))
        return [f"no boring has a layer named as the strata {unknown}; the borings have {layers}"] if unknown else []


def with_borings(text: str, path: Path, logs: Sequence[Log], water: bool = False) -> tuple[str, list[str]]:
    """Add the tests of borings to the text of a section.

    Parameters
    ----------
    text : section as TOML, from ``path``
    path : file of the ground, named in messages
    logs : borings; their x is that of the section
    water : whether borings give a water table if the section has none

    Returns
    -------
    Text of the section, and a sentence for each boring whose ground is not that of the section.

    Raises
    ------
    InputError : A boring has no x, stands beyond the section, or has a name that another boring has, or the borings of
        the section are written in one line.
    """
    read = tomllib.loads(text)
    surface = np.array(read["surface"], dtype=float)
    left, right = float(surface[0, 0]), float(surface[-1, 0])
    taken = [str(boring.get("name")) for boring in read.get("triggering", {}).get("borings", [])]
    names = [log.name for log in logs]
    problems, notices = [], []
    for log in logs:
        x, northing = log.location
        level = float(np.interp(x, *surface.T))
        if not math.isnan(northing):
            problems.append(f"boring {log.name}: it has easting and northing; expected its x in {path}")
        elif not left <= x <= right:
            problems.append(f"boring {log.name}: x = {x:g} m; expected {left:g} to {right:g} m, as in {path}")
        elif abs(log.ground_level - level) > OTHER_DATUM:
            notices.append(f"boring {log.name} begins at {log.ground_level:g} m, and the ground of {path} lies at "
                           f"{level:.2f} m there: its depths count from the latter")  # fmt: skip
    problems += [f"boring {name}: several borings have this name" for name in dict.fromkeys(names)
                 if [*taken, *names].count(name) > 1]  # fmt: skip
    if problems:
        raise InputError("borings", problems)
    borings = [PlacedBoring(log, log.location[0], 0.0) for log in sorted(logs, key=lambda log: log.location[0])]
    table = ["", *water_lines(borings, left, right)] if water and "water" not in read else []
    made = "\n".join([text.rstrip(), *table, *boring_lines(borings)]) + "\n"
    try:
        tomllib.loads(made)
    except tomllib.TOMLDecodeError:
        expected = "expected a table [[triggering.borings]] for each of its borings"
        raise InputError(str(path), [f"triggering.borings: a list in one line; {expected}"]) from None
    return made, notices
