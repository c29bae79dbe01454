"""Runs element tests of the discs of every layer of a section, and compares them with the soil of the layer."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from dem.errors import DemError
from dem.laboratory.element_test import element_test
from dem.laboratory.patch import PackingKind, PatchSample
from dem.springs import LayerSprings
from meshes.executor import SERIAL, Executor, Tell
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.stratum import Stratum

SHARES = (0.25, 0.5, 1.0)  # of the vertical effective stress in the middle of a layer: from active pressure up
COLUMNS, POINTS = 41, 4001  # along the section, and down each of them
PACKINGS: tuple[PackingKind, ...] = ("lattice", "random")


def middle_stresses(section: Section) -> np.ndarray:
    """Return the vertical effective stress (Pa) in the middle of each stratum, at the place where the stratum is
    thickest."""
    left, right = section.extent
    outline = section.outline()
    sums = np.zeros((len(section.strata), 2))  # thickness, stress
    density = np.array([s.density_ordinary for s in section.strata])
    for x in np.linspace(left, right, COLUMNS + 2)[1:-1]:
        z = np.linspace(outline[:, 1].max(), outline[:, 1].min(), POINTS)
        layer = section.stratum_at(np.full(POINTS, x), z)
        weight = np.where(layer >= 0, density[layer], 0.0) * GRAVITY * (z[0] - z[1])
        stress = np.cumsum(weight)
        for k in np.unique(layer[layer >= 0]):
            points_in_layer = np.flatnonzero(layer == k)
            if len(points_in_layer) > sums[k, 0]:
                middle = points_in_layer[len(points_in_layer) // 2]
                sums[k] = len(points_in_layer), stress[middle] - _pore_pressure(section, x, float(z[middle]), int(k))
    return sums[:, 1]


def _pore_pressure(section: Section, x: float, z: float, stratum: int) -> float:
    """Return the pore pressure at a place (m) of a stratum less the weight of the water on the ground above it (Pa)."""
    water = section.water_pressure
    if not water.present:
        return 0.0
    place = np.array([[x, z]])
    ponded = water.ponded(water.table_after, place, place)
    return float(water.at_rest(place, place, np.array([stratum]))[0] - ponded[0])


def element_tests(
    section: Section,
    layers: Sequence[LayerSprings],
    radius: float,
    *,
    seed: int = 0,
    executor: Executor = SERIAL,
) -> list[dict[str, Any]]:
    """Test the discs of every layer as a lattice and as a random packing.

    Parameters
    ----------
    section : the ground, which determines the confining pressures
    layers : springs of each stratum
    radius : mean radius of the discs (m)
    seed : seed of the random packing
    executor : computes the tests

    Returns
    -------
    One row for each test, as of `ElementTest.as_json`. Instead of the results, the row of a test that failed has the
    reason of its failure. Strata without effective stress are not tested.
    """
    stresses = middle_stresses(section)
    tests = [
        (
            section.strata[k],
            PatchSample(layers[k], packing, radius, seed),
            [float(share * stresses[k]) for share in SHARES],
        )
        for k in np.flatnonzero(stresses > 0.0)
        for packing in PACKINGS
    ]
    return executor.compute(_test_result, tests)


def _test_result(task: tuple[Stratum, PatchSample, list[float]], _: Tell) -> dict[str, Any]:
    """Return the result of one element test."""
    stratum, sample, pressures = task
    try:
        return element_test(sample, pressures).as_json(stratum)
    except (DemError, ValueError) as error:
        row = {"soil": None, "assembly": None, "reason": str(error)}
        return {"stratum": stratum.name, "packing": sample.packing, **row}
