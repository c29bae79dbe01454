"""Provides a section of loose sand on dense sand with water, two borings and an earthquake."""

from typing import Any

from tests.support.sections import layer

SAND = {"density_ordinary": "0.9 t/m^3", "density_seismic": "1.9 t/m^3", "cohesion": 0, "friction_angle": "32 deg"}


def bored() -> dict[str, Any]:
    """Return the section as data of a file: level ground at 0 m, water at -1 m, loose sand to -6 m, dense sand to -20
    m."""
    return {
        "name": "bored",
        "surface": [[0.0, 0.0], [100.0, 0.0]],
        "base": {"elevation": -20.0},
        "water_table": {"elevation": -1.0},
        "strata": [
            layer("loose", bottom={"depth": 6.0}, liquefies_in="triggered", **SAND),
            layer("dense", liquefies_in="triggered", **SAND),
        ],
        "earthquake": {"magnitude": 7.5, "peak_acceleration": "250 gal"},
        "triggering": {
            "borings": [
                {"name": "B-1", "x": 20.0, "spt": [test(0.5, 4), test(3.0, 5), test(5.0, 6), test(8.0, 40)]},
                {"name": "B-2", "x": 80.0, "spt": [test(4.0, 50), test(10.0, 60)]},
            ]
        },
    }


def test(depth: float, blows: float, **more: float) -> dict[str, float]:
    """Return one test as data of a file."""
    return {"depth": depth, "N": blows, **more}


test.__test__ = False  # type: ignore[attr-defined]  # no test of pytest's
