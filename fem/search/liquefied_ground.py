"""The ground after liquefaction: liquefied strata have a residual strength without friction, and hardly change their
volume.
"""

import math
from collections.abc import Mapping
from typing import Any

from fem.continuum.shallow_failure import faces_at
from fem.limit_load.conic_limit_load import conic_limit_load
from fem.path.gravity import under_weight
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.liquefies import Remains
from meshes.section.section import Section

# Water does not flow off while the ground fails, so that liquefied ground keeps its volume and presses on the sides
# nearly as a liquid does, with ν / (1 - ν) = 0.96 of its weight.
UNDRAINED = 0.49
# Of the vertical effective stress: what is left of ground that is said to keep nothing, for a strength there must be.
LEAST = 1e-3
LITTLE = 1e-3  # of the weight, that is there before the rest is brought on: limit loads are measured by it


def liquefied_section(section: Section, remains: Mapping[int, Remains]) -> Section:
    """The section with the strata of these numbers liquefied; ψ = 0 in them, and ν = 0.49."""
    strata = list(section.strata)
    for k, kept in remains.items():
        friction = math.atan(kept.friction * math.tan(strata[k].friction_angle))
        cohesion = kept.cohesion * strata[k].cohesion + kept.strength
        if friction == 0.0 and not kept.residual:
            cohesion = max(cohesion, LEAST * section.cohesion_field.mean_effective_stress(k))
        change: dict[str, float | None] = {
            "cohesion": cohesion,
            "cohesion_increase": kept.cohesion * strata[k].cohesion_increase,
            "cohesion_minimum": None,
            "strength_ratio": kept.cohesion * (strata[k].strength_ratio or 0.0),
            "friction_angle": friction,
            "dilation_angle": 0.0,
            "poissons_ratio": max(UNDRAINED, strata[k].poissons_ratio),
        }
        if kept.residual:
            removed = dict.fromkeys(("ocr", "ocr_exponent", "pre_overburden_pressure", "consolidated_below"))
            change |= {**removed, "strength_ratio": kept.residual}
        strata[k] = strata[k].model_copy(update=change)
    return section.with_strata(strata)


def weight_borne(section: Section, mesh: QuadMesh, settings: FemSettings, comm: Any) -> float:
    """The multiple of its weight that the ground resists between held sides (limit load of a mesh); below 1 it flows.

    Cohesionless faces that fail by themselves are strengthened, as in the search for the critical Kh: they bear no
    share of their weight, whatever the ground below them does. The flow is associated. Raises what
    ``conic_limit_load`` does.
    ``section``: the ground; ``mesh``: cells of it; ``settings``: of the elements; ``comm``: MPI communicator.
    """
    faces = [face for face in faces_at(section, settings, 0.0) if face.kh < 0.0]
    problem, weight = under_weight(section, mesh, settings.changed(element="reduced"), comm, faces)
    return LITTLE + conic_limit_load(problem, mesh, LITTLE * weight, weight).multiplier
