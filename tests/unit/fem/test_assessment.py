"""All answers for a section: what is looked for side by side is found as one after the other, to the last bit."""

import numpy as np
import pytest
from mpi4py import MPI

from fem import assessment
from fem.assessment import assess
from fem.errors import UnstableError
from fem.meanwhile import IN_TURN
from fem.settings import FemSettings
from meshes.gmsh_model import generate
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import layer


def test_two_threads_find_the_same_bits_as_one(monkeypatch):
    surface = [[0.0, 10.0], [20.0, 10.0], [35.0, 4.0], [55.0, 4.0]]
    ground = Section.parse({"name": "a", "surface": surface, "base": {"elevation": 0.0}, "strata": [layer("only")]})
    settings = FemSettings(accuracy=0.05, max_cells=400, safety_factor_at=(0.0, 0.05))
    meshing = MeshSettings(size=2.5)
    found = []
    for alone in (False, True):
        if alone:
            monkeypatch.setattr(assessment, "Meanwhile", lambda beside: IN_TURN)
        mesh = generate(ground, meshing)
        found.append(assess(ground, meshing, mesh, settings, MPI.COMM_SELF, lambda *_: None))
    one, other = found
    assert one.critical.kc == other.critical.kc
    assert one.critical.steps == other.critical.steps
    assert [each.result.factor for each in one.safety] == [each.result.factor for each in other.safety]
    assert one.associated.result.kc == other.associated.result.kc
    assert one.rigid_box.result.kc == other.rigid_box.result.kc
    assert len(one.safety) == 2
    np.testing.assert_array_equal(one.mesh.points, other.mesh.points)


def test_ground_whose_factor_of_safety_is_below_one_has_no_critical_kh():
    """A cut of 51 degrees in loam: coarse cells bear Kh = 0.005, finer ones have a factor of 0.99 (psi = 0)."""
    loam = layer("loam", bottom={"elevation": [[0.0, 19.0], [31.0, 19.0], [40.0, 26.0], [75.0, 27.0]]})
    loam |= {"cohesion": "12 kPa", "friction_angle": "28 deg", "dilation_angle": "0 deg"}
    loam |= {"density_ordinary": "1.9 t/m^3", "density_seismic": "1.9 t/m^3"}
    rock = layer("rock") | {"cohesion": "60 kPa", "friction_angle": "38 deg", "dilation_angle": "5 deg"}
    rock |= {"density_ordinary": "2.2 t/m^3", "density_seismic": "2.2 t/m^3"}
    surface = [[0.0, 20.0], [30.0, 20.0], [38.0, 30.0], [75.0, 31.0]]
    cut = Section.parse({"name": "cut", "surface": surface, "base": {"elevation": 8.0}, "strata": [loam, rock]})
    settings = FemSettings(direction="downhill", rigid_box=False)
    with pytest.raises(UnstableError, match=r"its factor of safety is 0\.9\d by Davis.*, and 1\.\d\d with ψ = φ"):
        assess(cut, MeshSettings(), generate(cut), settings, MPI.COMM_SELF, lambda *_: None)
