"""Steady seepage beside what flow nets and other programs found, as in the groundwater manual of Slide2.

Others let ground above the phreatic line conduct, too, which carries up to a tenth of the water; here it does not.
"""

import numpy as np
import pytest

from meshes.section.section import Section

SOIL = {
    "youngs_modulus": "10 MPa", "poissons_ratio": 0.3, "density": "1.8 t/m^3", "density_saturated": "2 t/m^3",
    "cohesion": "5 kPa", "friction_angle": "30 deg",
}  # fmt: skip


def section(ground: list, table: list, k: float, zones: dict, base: float = -0.5, **water: list) -> Section:
    """Ground of permeability k (m/s), rock from z = 0 down unless the base is deeper, zones {name: (k, corners)}."""
    rock = {"name": "rock", **SOIL, "permeability": 1e-16}
    soil = {"name": "soil", **SOIL, "permeability": k, "bottom": {"elevation": 0.0}}
    return Section.parse({
        "name": "t", "surface": ground, "base": {"elevation": base},
        "water": {"table": table, "flow": True, **water},
        "strata": [soil, rock] if base == -0.5 else [{key: v for key, v in soil.items() if key != "bottom"}],
        "zones": [{"name": name, **SOIL, "permeability": of, "points": at} for name, (of, at) in zones.items()],
    })  # fmt: skip


def discharge(outcome: Section) -> float:
    """Water that flows through a metre of the section (m²/s)."""
    flow = outcome.water_pressure.flow
    assert flow is not None
    return flow.discharge


def heads(outcome: Section, points: list) -> np.ndarray:
    """Heads (m) at points below the phreatic line."""
    at = np.array(points, dtype=float)
    pressure = outcome.water_pressure.at_rest(at, at, outcome.stratum_at(*at.T))
    return at[:, 1] + pressure / outcome.water_pressure.unit_weight


def test_bowles_dam_has_the_discharge_of_his_flow_nets() -> None:
    """Bowles (1984): 1.10 to 1.28e-3 m³/min by flow nets; Slide 1.378e-3 with the ground above the line, too."""
    ground = [[-1, 0], [0, 0], [50, 20], [60, 20], [100, 0], [101, 0]]
    result = section(ground, [[-1, 18.5], [46.25, 18.5], [100, 0], [101, 0]], 6.67e-6, {})
    assert 1.10e-3 <= 60.0 * discharge(result) <= 1.378e-3


def test_bowles_dam_on_a_toe_drain_has_the_discharge_of_his_flow_net() -> None:
    """Bowles (1984), example 9-2: 3.8e-6 m³/s by a flow net; SEEP/W and Slide 4.23e-6 with ground above the line."""
    ground = [[-1, 0], [0, 0], [90, 45], [100, 45], [190, 0], [191, 0]]
    drain = (1e-4, [[100, 0], [190, 0], [145, 22.5]])
    result = section(ground, [[-1, 40], [80, 40], [190, 0], [191, 0]], 2e-7, {"drain": drain})
    assert 3.8e-6 <= discharge(result) <= 4.23e-6


def test_heads_below_a_dam_are_those_of_rushton_and_redshaw() -> None:
    """Rushton & Redshaw (1979), 10 m of ground below an impermeable dam from x = 8 to 20 m, 5 m of water before it.

    No water crosses the sides of their block: walls stand beside ours.
    """
    ground = [[0, 0], [8, 0], [8, 6], [20, 6], [20, 0], [40, 0]]
    walls = [{"x": x, "bottom": -9.99} for x in (0.1, 39.9)]
    dam = (1e-16, [[8, 0], [20, 0], [20, 6], [8, 6]])
    result = section(ground, [[0, 5], [8, 5], [20, 0], [40, 0]], 1e-6, {"dam": dam}, -10.0, cutoffs=walls)
    x = [0.5, 10.0, 14.0, 20.0, 30.0]
    assert heads(result, [[at, -4.0] for at in x]) == pytest.approx([4.50, 3.45, 2.47, 1.05, 0.20], abs=0.08)
