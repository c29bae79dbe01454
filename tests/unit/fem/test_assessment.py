"""All answers for a section: what is looked for side by side is found as one after the other, to the last bit."""

import numpy as np
from mpi4py import MPI

from fem import assessment
from fem.assessment import assess
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
