"""The factor of safety at a given seismic coefficient: by how much cohesion and tan φ can be divided (Zienkiewicz,
Humpheson & Lewis 1975), with the factor as an unknown along the path."""

from dataclasses import dataclass, replace
from typing import Any

from fem.continuation import WeakerGround
from fem.critical import (
    at_rest_under_gravity,
    carry,
    path_settings,
    push,
    seismic_load,
)
from fem.errors import UnstableError
from fem.path import Step, Walk
from fem.plateau import Plateau, Progress, Verdict, walk_to_plateau
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section

# Divisors of the strength to start from, the ordinary ground first, then ever stronger ground.
STARTS = (1.0, 0.5, 0.2, 0.05)
# A change of the factor that counts in the path length as much as the reference displacement.
FACTOR_UNIT = 0.1
# The reference displacement, in elastic displacements under all of the load.
DISPLACEMENT_UNIT = 0.1
LARGEST_FACTOR = 20.0


@dataclass(frozen=True)
class SafetyFactor:
    """The factor of safety at ``kh``: the largest divisor of c and tan φ in equilibrium, and what it may be at most."""

    kh: float
    factor: float
    upper: float
    verdict: Verdict
    reason: str
    remedy: str
    steps: list[Step]


def safety_factor(
    section: Section,
    mesh: QuadMesh,
    settings: FemSettings,
    kh: float,
    comm: Any,
    progress: Progress | None = None,
) -> SafetyFactor:
    """The factor of safety of a meshed section under its weight and ``kh``.

    Where the ground does not stand as it is, it is first made stronger, so that factors below 1 come out as well.
    Raises InputError as ``critical_coefficient`` does, UnstableError if even 20 times the strength does not do.
    """
    for start in STARTS:
        try:
            problem, fixed, _ = at_rest_under_gravity(section, mesh, settings, comm, start)
            load = kh * seismic_load(problem, push(section, settings))
            if kh != 0.0:
                carry(problem, fixed, load, settings)
            break
        except UnstableError as error:
            failure = error
    else:
        raise failure
    forces = fixed + load
    norm, dot = problem.exchange.norm, problem.exchange.dot
    pushing = load
    if kh == 0.0:
        pushing = problem.body_force([s.density_ordinary for s in problem.strata], (0.0, -1.0))
    control = pushing / norm(pushing)
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = abs(dot(control, problem.solve(forces)))
    path = replace(path_settings(problem, settings), first=0.2, largest=0.5)
    walk = Walk(
        problem, WeakerGround(forces), control, DISPLACEMENT_UNIT * elastic, norm(forces), path,
        share=1.0 / FACTOR_UNIT, factor=start,
    )  # fmt: skip

    def stretch(walk: Walk) -> float:
        return walk.displacement / walk.reference

    outcome = walk_to_plateau(walk, stretch, LARGEST_FACTOR, Plateau(), progress=progress)
    return SafetyFactor(kh, outcome.held, outcome.upper, outcome.verdict, outcome.reason, outcome.remedy, walk.steps)
