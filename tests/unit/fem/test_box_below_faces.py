"""The box of discs below faces without cohesion: what fails less deep than discs can show does not count."""

from mpi4py import MPI

from fem.search.assessment import assess
from fem.search.dem_counterpart import critical_of_dem_counterpart
from meshes.gmsh_model import generate
from tests.support.sections import layer
from workflow.config import Config


def test_below_a_face_of_sand_the_box_bears_more() -> None:
    """Sand of 32° at 26.6°: its face rolls down at tan 5.4° = 0.095; 2 m deeper the clay and the toe hold more."""
    config = Config.parse({
        "name": "face", "surface": [[0.0, 8.0], [12.0, 8.0], [24.0, 2.0], [36.0, 2.0]], "base": {"elevation": 0.0},
        "strata": [layer("sand", cohesion="0 kPa", friction_angle="32 deg")],
        "mesh": {"size": 1.5}, "fem": {"accuracy": 0.0, "direction": "downhill", "safety_factor_at": []},
    })  # fmt: skip
    mesh = generate(config.section, config.mesh)
    assessment = assess(config.section, config.mesh, mesh, config.fem, MPI.COMM_SELF, lambda *_: None)
    assert assessment.critical.shallow_failures
    assert assessment.critical.shallow_failures[0].kh < 0.1
    layer_springss = config.fem.changed(sides="fixed")
    deeper = layer_springss.changed(least_depth=2.0)
    box, deep_box = (
        critical_of_dem_counterpart(config.section, config.mesh, mesh, fem, lambda *_: None).result
        for fem in (layer_springss, deeper)
    )
    assert deep_box.kc > assessment.critical.shallow_failures[0].kh
    assert deep_box.kc >= box.kc - 0.01
