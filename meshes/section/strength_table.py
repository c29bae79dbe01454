"""Reads an undrained strength that is given as a table over the vertical effective stress, and evaluates it.

The strength is linear between the entries, and constant before the first and after the last (s_u tables of D-Stability;
Mohr-Coulomb envelopes of undrained tests). Stresses and strengths are in Pa.
"""

from typing import Annotated, Any

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from meshes.section.polyline import written
from meshes.section.quantity import STRENGTH, Quantity

Entries = tuple[tuple[Quantity, Quantity], ...]  # vertical effective stress and strength


def read_table(value: Any) -> Entries:
    """Return the entries of a table [[stress, strength], ...]; raise ValueError if they are no such table."""
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise ValueError('expected two or more pairs of stress and strength, [["0 kPa", "20 kPa"], ...]')
    entries = []
    for number, pair in enumerate(value, start=1):
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            raise ValueError(f"pair {number} = {pair!r}: expected a stress and a strength")
        try:
            entries.append((STRENGTH.read(pair[0]), STRENGTH.read(pair[1])))
        except ValueError as error:
            raise ValueError(f"pair {number}: {error}") from error
    stress, strength = np.array(entries, dtype=float).T
    if not (np.diff(stress) > 0.0).all():
        raise ValueError("expected stresses that grow from pair to pair")
    if not (np.diff(strength) >= 0.0).all():
        raise ValueError("expected strengths that do not fall with the stress")
    return tuple(entries)


StrengthTable = Annotated[Entries, PlainValidator(read_table), PlainSerializer(written)]


def table_strength(entries: Entries, stress: np.ndarray) -> np.ndarray:
    """Return the strength (n,) in Pa at vertical effective stresses (n,) in Pa."""
    return np.asarray(np.interp(stress, *np.array(entries, dtype=float).T))


def linear_strength(entries: Entries, stress: np.ndarray, above: bool) -> np.ndarray:
    """Return strengths (m, 3) in Pa at the corners of triangles, linear in their stresses (m, 3) in Pa, that are
    nowhere above the true strength within each triangle, or nowhere below it if ``above``.

    The line has the slope of the chord between the smallest and the largest stress of the triangle; its distance to the
    broken line of the table is largest at an entry or at an end.
    """
    known = np.array(entries, dtype=float)
    low, high = stress.min(axis=1, keepdims=True), stress.max(axis=1, keepdims=True)
    at_ends = table_strength(entries, low), table_strength(entries, high)
    slope = (at_ends[1] - at_ends[0]) / np.maximum(high - low, 1e-9)
    inside = np.clip(known[:, 0], low, high)  # (m, entries); entries outside count as the nearer end
    offset = table_strength(entries, inside) - slope * inside
    offsets = np.concatenate([offset, at_ends[0] - slope * low, at_ends[1] - slope * high], axis=1)
    extreme = (offsets.max if above else offsets.min)(axis=1, keepdims=True)
    return np.asarray(extreme + slope * stress)
