"""Follows the path to a known limit load: Kh rises in steps, and at every step the ground is brought to equilibrium.

With associated flow the equilibrium under a given Kh is the minimum of a convex potential, which Newton's method finds
from any start (``newton.py``): the load steps may be large, however soft the ground.
"""

from collections.abc import Sequence

from fem.continuum.fields import FieldState, state_of
from fem.path.equilibrium_path import EquilibriumPath
from fem.path.plateau import LimitLoad, PathListener
from meshes.quad_mesh import QuadMesh

# Shares of the limit load at which the curve has a point, and the share up to which the path is followed in any case.
LOAD_SHARES, CERTAIN_SHARE = (0.25, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98, 0.99), 0.95
# A load level is omitted if its distance to a requested level is below this share of the limit load.
SMALLEST_DISTANCE = 0.02
# After a level with more iterations of Newton's method than this, only requested levels are computed: higher levels
# take as many iterations or more, and four points suffice to draw the curve.
MANY_ITERATIONS = 8


def step_to_limit(
    path: EquilibriumPath,
    mesh: QuadMesh,
    known: float,
    limit: float,
    wanted: Sequence[float],
    listener: PathListener | None = None,
) -> tuple[LimitLoad, list[FieldState]]:
    """Raise Kh in steps to just below its limit load, or to a limit of the search that is smaller.

    Parameters
    ----------
    path : the path at its start, at Kh = 0
    mesh : the mesh of the path
    known : the limit load on the same mesh by limit analysis (-)
    limit : largest Kh of the search (-)
    wanted : Kh at which the fields are requested (-)
    listener : called with the path after every step

    Returns
    -------
    The limit load, whose value is ``known`` unless ``limit`` is smaller, and the fields at those ``wanted`` Kh that
    were reached.
    """
    recorded_kh = {kh for kh in wanted if 0.0 < kh <= min(known, limit)}
    certain_level = limit if known > limit else CERTAIN_SHARE * known
    shares = (share * known for share in LOAD_SHARES if share * known < limit)
    levels = {kh for kh in shares if all(abs(kh - other) > SMALLEST_DISTANCE * known for other in recorded_kh)}
    states: list[FieldState] = []
    for kh in sorted({*levels, *recorded_kh, certain_level}):
        is_hard = any(step.iterations > MANY_ITERATIONS for step in path.steps)
        if is_hard and kh not in recorded_kh and kh != certain_level:
            continue
        if not path.reach(kh):
            continue
        if kh in recorded_kh:
            states.append(state_of(path.problem, mesh, f"Kh = {kh:g}", kh))
        if listener is not None:
            listener(path)
    if known > limit:
        remedy = "raise the limit to search for larger values"
        return LimitLoad(path.factor, path.factor, "no failure", f"no failure up to {limit:g}", remedy), states
    reason = f"the limit load is known by limit analysis; the path was followed to Kh = {path.factor:.3f}"
    return LimitLoad(path.factor, known, "plateau", reason), states
