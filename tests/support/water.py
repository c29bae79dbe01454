"""Provides sections with water for tests."""

from typing import Any

import numpy as np
from hypothesis import strategies as st

from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

WATER = 1000.0 * GRAVITY
SOIL: dict[str, Any] = {
    "youngs_modulus": "30 MPa", "poissons_ratio": 0.3, "cohesion": "10 kPa", "friction_angle": "25 deg",
    "density": "18 kN/m^3", "density_saturated": "20 kN/m^3",
}  # fmt: skip
BANK = {"surface": [[0.0, 10.0], [20.0, 10.0], [40.0, 2.0], [60.0, 2.0]], "base": {"elevation": -5.0}}


def soil(name: str = "Soil", **changes: Any) -> dict[str, Any]:
    """Return a stratum as data of a file; None removes a key."""
    return {key: value for key, value in {"name": name, **SOIL, **changes}.items() if value is not None}


def section(*strata: dict[str, Any], **changes: Any) -> Section:
    """Return a bank 8 m high with strata, or with one soil."""
    return Section.parse({"name": "bank", **BANK, "strata": list(strata) or [soil()], **changes})


def at_rest(inputs: Section, *points: tuple[float, float]) -> np.ndarray:
    """Return the pore pressure (Pa) without shaking at points (m)."""
    at = np.array(points)
    return inputs.water_pressure.at_rest(at, at, inputs.stratum_at(*at.T))


@st.composite
def random_water(draw: st.DrawFn) -> Section:
    """Return a bank of two soils with a random water table, random ratios and a random load."""
    level = st.floats(-6.0, 14.0)
    table = [[x, draw(level)] for x in (0.0, 17.0, 33.0, 60.0)]
    contact = [[0.0, draw(st.floats(-1.0, 6.0))], [60.0, draw(st.floats(-3.0, 1.0))]]
    ratios = [draw(st.sampled_from([None, None, 0.0, 0.3])) for _ in range(2)]
    upper = soil("Sand", bottom={"elevation": contact}, pore_pressure_ratio=ratios[0])
    start = draw(st.floats(1.0, 50.0))
    load = {"from": start, "to": start + 7.3, "pressure": ["10 kPa", "30 kPa"]}
    return section(upper, soil("Clay", pore_pressure_ratio=ratios[1]), water={"table": table}, surcharges=[load])
