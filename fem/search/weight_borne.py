"""Computes whether ground between held sides resists its own weight. Liquefied ground may fail under its own weight."""

from fem.continuum.shallow_failure import faces_at
from fem.limit_load.conic_limit_load import conic_limit_load
from fem.path.gravity import under_weight
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

LITTLE = 1e-3  # of the weight, that is there before the rest is brought on: limit loads are measured by it


def weight_borne(section: Section, mesh: QuadMesh, settings: FemSettings) -> float:
    """Return the multiple of its weight that the ground resists between fixed sides (limit load of a mesh); below 1 the
    ground flows.

    Cohesionless faces that fail by themselves are strengthened, as in the search for the critical Kh: they bear no
    share of their weight, whatever the ground below them does. The flow is associated. Raises the errors of
    ``conic_limit_load``. ``section``: the section of the ground; ``mesh``: a mesh of the section; ``settings``:
    settings of the finite elements.
    """
    faces = [face for face in faces_at(section, settings, 0.0) if face.kh < 0.0]
    problem, weight = under_weight(section, mesh, settings.changed(element="reduced"), faces=faces)
    return LITTLE + conic_limit_load(problem, mesh, LITTLE * weight, weight).multiplier
