"""Slip circles beside the numbers of another program for the same circles."""

import numpy as np
import pytest

from meshes.section.section import Section
from tests.support.sections import layer
from workflow.estimates.slice_methods import bishop_factor, spencer_factor
from workflow.estimates.slices import LEFT, divide
from workflow.estimates.slip_circles import critical_circle


def test_circles_of_xslope() -> None:
    """The slope "lface" of xslope (N. L. Jones, template 6), three soils under a piezometric line, with the numbers of
    its own solvers on 200 slices: two of its circles, and the least one that it finds (0.751 and 0.763)."""
    foot, psf, pcf = 0.3048, "lbf/ft^2", "lbf/ft^3/g_0"
    soils = (
        ("Silt", 130, 200, 28, [[115.7, 40], [145.3, 64], [320, 64]]),
        ("Sand", 120, 100, 32, [[0, 40], [320, 40]]),
        ("Clay", 132, 400, 27, None),
    )
    strata = [
        layer(
            name, cohesion=f"{c} {psf}", friction_angle=f"{phi} deg", density_ordinary=f"{weight} {pcf}",
            density_seismic=f"{weight} {pcf}",
            **({} if line is None else {"bottom": {"elevation": [[foot * x, foot * z] for x, z in line]}}),
        )
        for name, weight, c, phi, line in soils
    ]  # fmt: skip
    level = [[0, 40], [115.7, 40], [130.5, 52], [150, 61], [180, 70], [208, 76], [245, 79], [320, 80]]
    surface = [[0, 40], [115.7, 40], [145.3, 64], [170, 84], [320, 84]]
    section = Section.parse(
        {
            "name": "lface", "surface": (foot * np.array(surface)).tolist(), "base": {"elevation": 0.0},
            "water": {"table": (foot * np.array(level)).tolist(), "unit_weight": f"62.4 {pcf}"}, "strata": strata,
        }
    )  # fmt: skip
    for x, z, radius, left, right, bishop, spencer in (
        (145.0, 100.0, 100.0, 65.0, 243.71, 1.929, 1.944),
        (145.0, 120.0, 80.0, 120.4576, 216.4395, 1.350, 1.360),
    ):
        ends = np.linspace(left, right, 401)
        arc = foot * (z - np.sqrt(radius**2 - (ends - x) ** 2))
        base = np.minimum(arc, section.layering.interface(0, foot * ends))
        slices = divide(section, foot * ends[None], base[None])
        values = bishop_factor(slices, *(np.array([foot * value]) for value in (x, z, radius)))
        balance = spencer_factor(slices)
        assert balance is not None
        assert values[0] == pytest.approx(bishop, abs=6e-4)
        assert balance.factor == pytest.approx(spencer, abs=6e-4)
    least = critical_circle(section, LEFT)
    assert least is not None
    assert (least.bishop, least.spencer) == (pytest.approx(0.751, abs=0.003), pytest.approx(0.763, abs=0.003))
