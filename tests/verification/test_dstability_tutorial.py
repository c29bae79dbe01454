"""The dike of the tutorial of D-Stability, whose results are public (GEOLib, tests/test_data/dstability,
Tutorial_v2026_1.stix; MIT licence): factors of safety on its slip surfaces, at the mean level of the river and in a
flood."""

from typing import Any

import numpy as np
import pytest

from meshes.section.section import Section
from workflow.estimates.slice_methods import bishop_factor, spencer_factor
from workflow.estimates.slices import RIGHT, divide

SURFACE = [
    [-100, 10.92], [-12.5, 10.92], [-9.5, 10.94], [-8, 11.08], [-7, 10.97], [-5.5, 11.02], [-4, 11.46],
    [-1.997, 12.075], [-1, 12.35], [0, 12.53], [0.5, 12.57], [3, 12.66], [4.5, 12.66], [5.5, 12.64], [6.5, 12.57],
    [7.5, 12.44], [8, 12.29], [9.5, 11.75], [10.5, 11.38], [11.5, 10.97], [13, 10.34], [15, 9.56], [16, 9.16],
    [17, 8.69], [18, 8.3], [19, 7.95], [20.5, 7.81], [22.5, 7.69], [23.5, 7.59], [25, 7.54], [27.5, 7.37], [30.5, 7.2],
    [34.5, 6.99], [37, 6.75], [39, 6.65], [41.4, 4.9], [44.4, 4.9], [46, 6.13], [53.5, 6.52], [150, 6.751],
]  # fmt: skip
DAILY = [[-100, 5.6], [-9.8, 5.6], [0.5, 7.5], [8.5, 7.5], [20.4, 5.5], [150, 5.5]]
FLOOD = [[-100, 12], [-1.1, 12], [1.2, 10.9], [7, 10.9], [18.9, 7.7], [40, 5.7], [150, 5.7]]
AQUIFER = [[-100, 10], [-0.8, 8.4], [42.5, 8.1], [150, 8]]
TOP_OF_ORGANIC_CLAY = [[-100, 3.5], [-8.8, 3.5], [-1.4, 1], [10.6, 1], [20, 4], [40.348, 5.667]]
TOP_OF_AQUIFER = [[-100, -2], [-9, -2], [-1, -3], [11, -3], [20, -5], [150, -5]]
CORE = [[20, 6], [16, 7], [7, 11], [-1, 11], [-5, 10], [-8, 9], [-8, 6]]
# Where the water tables divide the core, which has c and φ above them and an undrained strength below.
IN_DAILY, IN_FLOOD = (
    [[-7.631579, 6], [0.5, 7.5], [8.5, 7.5], [17.425, 6]],
    [[0.990909, 11], [1.2, 10.9], [7, 10.9], [7.569681, 10.746809]],
)
WET, DRY = (
    {False: IN_DAILY, True: [*CORE[:2], *IN_FLOOD[::-1], *CORE[3:]]},
    {False: [*CORE, *IN_DAILY], True: [*IN_FLOOD, CORE[2]]},
)


def clay(name: str, weight: float, ratio: float, exponent: float, past: float, **more: Any) -> dict[str, Any]:
    return {
        "name": name, "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "density": f"{weight} kN/m^3",
        "density_saturated": f"{weight} kN/m^3", "cohesion": 0, "friction_angle": 0, "strength_ratio": ratio,
        "ocr_exponent": exponent, "pre_overburden_pressure": f"{past} kPa", **more,
    }  # fmt: skip


def dike(flood: bool) -> Section:
    """Return the dike at the mean level of the river, or in a flood, with traffic and artesian water below it."""
    flow = {"lower_level": AQUIFER, "top": [*TOP_OF_ORGANIC_CLAY, [150, 5.667]], "bottom": TOP_OF_AQUIFER}
    between: dict[str, Any] = {"vertical_flow": flow} if flood else {}
    sand = clay("Sand", 18, 0.3, 0.9, 0, friction_angle="30 deg", density_saturated="20 kN/m^3")
    sand = {key: value for key, value in sand.items() if key not in ("strength_ratio", "ocr_exponent",
            "pre_overburden_pressure")} | ({"piezometric_level": AQUIFER} if flood else {})  # fmt: skip
    core = clay("Core", 18, 0.22, 0.9, 18.88 if flood else 20.18, points=WET[flood])
    dry = {**sand, "name": "Dry core", "friction_angle": "33 deg", "density": "18 kN/m^3", "points": DRY[flood]}
    dry.pop("piezometric_level", None)
    strata = [
        clay("Clay", 14.8, 0.23, 0.9, 10, bottom={"elevation": TOP_OF_ORGANIC_CLAY}),
        clay("Organic clay", 13.9, 0.24, 0.85, 20,
             bottom={"elevation": [[-100, -2], [-9, -2], [-1, -3], [11, -3], [20, 0], [150, 0]]}, **between),
        clay("Peat", 11, 0.27, 0.9, 5, bottom={"elevation": TOP_OF_AQUIFER}, **between),
        sand,
    ]  # fmt: skip
    state: dict[str, Any] = {
        "consolidation": {"table": DAILY},
        "surcharges": [{"from": 3.5, "to": 6, "pressure": "13 kPa", "consolidated": 0.1}],
    }
    water = {"table": FLOOD if flood else DAILY, "unit_weight": "9.81 kN/m^3"}
    ground = {"name": "dike", "surface": SURFACE, "base": {"elevation": -15}, "strata": strata, "water": water}
    return Section.parse({**ground, "zones": [core, dry], **(state if flood else {})})


def circle(section: Section, x: float, z: float, radius: float, ends: tuple[float, float]) -> float:
    """Return the factor of safety of a circle by Bishop's method, between its ends on the ground."""
    places = np.linspace(*ends, 401)
    base = np.minimum(z - np.sqrt(radius**2 - (places - x) ** 2), section.layering.interface(0, places))
    slices = divide(section, places[None], base[None], RIGHT)
    return float(bishop_factor(slices, np.array([-x]), np.array([z]), np.array([radius]))[0])


def surface(section: Section, points: list[tuple[float, float]]) -> float:
    """Return the factor of safety of a slip surface by Spencer's method."""
    corners = np.array(points)
    x = np.unique(np.concatenate([np.linspace(*corners[[0, -1], 0], 401), corners[:, 0]]))
    z = np.minimum(np.interp(x, *corners.T), section.layering.interface(0, x))
    balance = spencer_factor(divide(section, x[None], z[None], RIGHT))
    assert balance is not None
    return balance.factor


def test_at_the_mean_level_of_the_river() -> None:
    """D-Stability: 1.2851 by Bishop's method on the circle around (20, 20) m."""
    assert circle(dike(flood=False), 20.0, 20.0, 20.0, (1.41, 35.13)) == pytest.approx(1.2851, rel=0.005)


def test_in_a_flood() -> None:
    """The flood lowers σ'v in the dike, and leaves σ'p; the pore pressure between the clay and the aquifer is linear in
    elevation. D-Stability: 1.0043 by Bishop's method on a circle in the dike, 1.7606 by Spencer's on a surface down to
    the peat. Measured: 0.9966 and 1.7613."""
    section = dike(flood=True)
    assert circle(section, 15.7, 18.6, 13.7, (3.352, 23.828)) == pytest.approx(1.0043, rel=0.01)
    deep = [(-12.5, 10.92), (-8.36, 4.32), (-1.88, -0.45), (9.88, -2.13), (25.24, -1.17), (30.76, 2.41), (37.0, 6.75)]
    assert surface(section, deep) == pytest.approx(1.7606, rel=0.005)
