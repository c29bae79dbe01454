"""Tests of the Kh at which level ground slides, and of the warning that it governs."""

import math

import pytest
from mpi4py import MPI

from fem.limit_load.limit_load import critical_limit_load
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.answers import fem, results, warned
from tests.support.sections import SOIL
from workflow.config import Config
from workflow.estimates.level_ground import sliding_level_ground
from workflow.texts.report_texts import Texts


def ground(surface: list[list[float]] | None = None) -> dict[str, object]:
    """Return a crust of 1.5 m of clay above 4.5 m of loose and 8 m of dense sand, with water below the crust."""
    sand = {**SOIL, "cohesion": "0 kPa", "density_ordinary": "1.9 t/m^3", "density_seismic": "1.9 t/m^3"}
    return {
        "name": "level",
        "surface": surface or [[0.0, 0.0], [60.0, 0.0]],
        "base": {"elevation": -14.0},
        "water": {"table": -1.5},
        "strata": [
            {**SOIL, "name": "Crust", "bottom": {"elevation": -1.5}},
            {**sand, "name": "Loose sand", "friction_angle": "31 deg", "bottom": {"elevation": -6.0}},
            {**sand, "name": "Dense sand", "friction_angle": "38 deg"},
        ],
    }


def test_the_least_strength_over_weight_by_hand() -> None:
    """At the bottom of the loose sand: σv = 6 · 1.9 g, u = 4.5 · 1.0 g (t/m2), tan 31°."""
    section = Section.parse(ground())
    by_hand = (6.0 * 1.9 - 4.5 * 1.0) * math.tan(math.radians(31.0)) / (6.0 * 1.9)
    for side in ("left", "right"):
        failure = sliding_level_ground(section, side, 0.0)
        assert failure is not None
        assert failure.kh == pytest.approx(by_hand, rel=3e-3)
        assert failure.stratum.startswith("Loose sand")
        assert failure.elevation == pytest.approx(-6.0, abs=0.01)


def test_upward_acceleration_takes_friction_away() -> None:
    section = Section.parse(ground())
    level, lifted = (sliding_level_ground(section, "left", vertical) for vertical in (0.0, 0.1))
    assert level is not None
    assert lifted is not None
    assert lifted.kh == pytest.approx(level.kh - 0.1 * math.tan(math.radians(31.0)), rel=1e-3)


def test_the_limit_load_of_periodic_level_ground_is_the_same() -> None:
    section = Section.parse(ground())
    failure = sliding_level_ground(section, "left", 0.0)
    assert failure is not None
    settings = FemSettings(sides="periodic", flow="associated", direction="downhill", kh=())
    mesh = generate(section, MeshSettings(columns=4, rows=28))
    assert critical_limit_load(section, mesh, settings, MPI.COMM_SELF).kc == pytest.approx(failure.kh, rel=0.012)


def test_sloping_ground_at_a_side_is_left_out() -> None:
    section = Section.parse(ground([[0.0, 2.0], [30.0, 0.0], [60.0, 0.0]]))
    assert sliding_level_ground(section, "left", 0.0) is None
    assert sliding_level_ground(section, "right", 0.0) is not None


def test_a_mechanism_of_level_ground_is_told_as_that() -> None:
    """A longer section does not change the Kh of level ground, so that it is no remedy; a Kh above that of level
    ground, as in a section that is too short, falls to it ("changes little" was said of 0.214 and 0.187)."""
    run = Config.parse({**ground([[0.0, 4.0], [20.0, 4.0], [30.0, 0.0], [60.0, 0.0]]), "fem": {"sides": "smooth"}})
    for kc, governs in ((0.365, True), (0.38, True), (0.2, False), (0.5, False)):  # at 0.5 the side holds level ground
        answer = fem(run, kc).model_copy(update={"at_sides": ("right",)})
        [sides] = [text for text in warned(results(run, fem=answer)) if "reaches the right side" in text]
        assert ("level ground slides" in sides) == governs
        assert ("Move the sides away" in sides) != governs
        if governs:
            assert '"Loose sand" by itself at Kh = 0.36' in sides
            longer = "changes this critical Kh little" if kc < 0.37 else "has a smaller critical Kh, down to that one"
            assert f"A longer section {longer}; see" in sides
            for sentence in sides.split(". "):
                text = f"{sentence.rstrip('.')}."
                assert Texts("ja").sentence(text) != text
