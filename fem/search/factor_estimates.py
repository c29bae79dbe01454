"""Estimates the factor of safety, and its error on a mesh, by the critical Kh that is already known."""

import math

from fem.limit_load.limit_load import LimitLoadResult
from fem.search.mesh_sequence import SMALLEST_KH, AdaptiveResult
from fem.search.slip_surface import slip_surface

# Largest first guess of a factor of safety, and the guess over the expected factor. From above, Newton's method needs
# one or two steps; from below, it first overshoots.
LARGEST_GUESS, GUESS_RATIO = 4.0, 1.2
# The error over what lies above the limit of the meshes, which has an error itself: 1.3 of an endless slope in closed
# form, 1.4 of a sheet pile wall by strict bounds.
ERROR_RATIO = 1.3


def factor_like(limit: AdaptiveResult[LimitLoadResult], kh: float) -> float:
    """Estimate the factor of safety at ``kh`` of ground whose critical Kh is known, by a block on the chord of the slip
    surface. Return 1 if there is no slip surface, or if its chord does not descend.

    A block on a plane at the angle β needs the friction tan(β + atan Kh). The estimate is the friction needed at the
    critical Kh over the friction needed at ``kh``, and a little more.
    """
    assert limit.result.mechanism is not None
    line = slip_surface(limit.mesh, limit.result.mechanism)
    if not len(line):
        return 1.0
    run, fall = line[-1, 0] - line[0, 0], line[0, 1] - line[-1, 1]
    slope = math.atan2(fall if limit.result.ground.load[0::2].sum() >= 0.0 else -fall, run)
    needed, present = slope + math.atan(limit.result.kc), slope + math.atan(kh)
    if slope <= 0.0 or needed >= 0.45 * math.pi:
        return 1.0
    return min(GUESS_RATIO * math.tan(needed) / math.tan(present), LARGEST_GUESS)


def factor_error(
    limit: AdaptiveResult[LimitLoadResult], similar: AdaptiveResult[LimitLoadResult], kh: float, factor: float
) -> float:
    """Estimate the error of the factor of safety at ``kh`` on the mesh of ``similar``, as a share of the ``factor``, by
    that of its critical Kh: what is above the ``limit`` of the sequence of meshes.

    The factor is 1 at the critical Kh, and changes from there to ``kh`` about linearly.
    """
    critical = similar.result.kc
    error = critical - min(limit.result.kc, limit.limit) if len(limit.rounds) > 1 else 0.0
    return ERROR_RATIO * max(error, 0.0) * abs(factor - 1.0) / (max(abs(critical - kh), SMALLEST_KH) * factor)
