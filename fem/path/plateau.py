"""Finds the limit load of a path of equilibria: the rule that ends the path, and the verdict."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fem.errors import NoEquilibriumError
from fem.path.equilibrium_path import MULTIPLIER_REDUCTIONS, EquilibriumPath
from fem.settings import PathVerdict

PathListener = Callable[[EquilibriumPath], None]

# The smallest ductility at which a rule applies.
SMALLEST_DUCTILITY = 3.0
# Decrease of the multiplier below its maximum from which the verdict is "peak" instead of "plateau", and the growth
# that still counts as a plateau at the end of the path, as shares.
PEAK_FALL, TOLERATED_GROWTH = 0.05, 0.04
# Where the largest multiplier in equilibrium without overstress is lower than the maximum of the path by more than this
# share, equilibrium is searched for again just below this maximum.
EQUILIBRIUM_SHORTFALL = 0.025
# The ductility at the first relaxation of the overstress, and its ratio from one relaxation to the next.
RELAXATION_RATIO = 1.3
MOST_STEPS = 400  # of a path


class StopReason(NamedTuple):
    """Holds the verdict, the reason and the remedy with which a path has ended."""

    verdict: PathVerdict
    reason: str
    remedy: str


@dataclass(frozen=True)
class PlateauRule:
    """Holds the rule that ends a path once the load multiplier has grown by less than ``growth`` while the displacement
    doubled.

    Displacements enter as ductility: the control displacement over the control displacement of elastic ground at the
    same load (-).

    Attributes
    ----------
    growth : relative growth of the multiplier over the second half of the displacement, below which the path has a
        plateau
    latest : ductility at which the path ends in any case
    """

    growth: float = 0.01
    latest: float = 12.0


# With associated flow the path is followed until the multiplier hardly grows, since long steps are possible.
ASSOCIATED_RULE = PlateauRule(growth=0.002, latest=60.0)


@dataclass(frozen=True)
class LimitLoad:
    """Holds the limit load found by an equilibrium path.

    Attributes
    ----------
    in_equilibrium : largest load multiplier found in equilibrium (-)
    upper : the limit load if it is known beforehand; else the largest multiplier of the path, or its extrapolation to
        twice the displacement (-)
    verdict : "plateau", "peak" (the load falls after a maximum), "no failure" (up to the limit) or "undecided"
    reason, remedy : the reason of the verdict, and what to change if it is "undecided"
    """

    in_equilibrium: float
    upper: float
    verdict: PathVerdict
    reason: str
    remedy: str = ""


def find_limit_load(
    path: EquilibriumPath,
    ductility: Callable[[EquilibriumPath], float],
    limit: float,
    rule: PlateauRule | None = None,
    listener: PathListener | None = None,
) -> LimitLoad:
    """Follow a path until the load multiplier no longer grows or exceeds ``limit``.

    If there is overstress, only relaxed states count as in equilibrium.

    Parameters
    ----------
    path : the path at its start
    ductility : function of the path that returns its control displacement over the elastic displacement (-)
    limit : load multiplier at which the search ends (-)
    rule : rule that ends the path, by default that of the flow
    listener : called with the path after every step

    Returns
    -------
    The limit load with its verdict: "plateau", "peak", "no failure" or "undecided".

    Raises
    ------
    NoEquilibriumError
        If no state on the path is in equilibrium.
    """
    rule = rule or (ASSOCIATED_RULE if path.problem.associated else PlateauRule())
    in_equilibrium, next_relaxation = -np.inf, RELAXATION_RATIO
    highest, summit = path.factor, path.mark()
    while True:
        if not path.advance():
            verdict, reason, remedy = _broken_off(path, ductility, rule)
            break
        if path.factor > highest:
            highest, summit = path.factor, path.mark()
        now = ductility(path)
        if path.settings.relaxation <= 0.0 or (now >= next_relaxation and path.relax()):
            in_equilibrium = max(in_equilibrium, path.factor)
        if now >= next_relaxation:
            next_relaxation = RELAXATION_RATIO * now
        if listener is not None:
            listener(path)
        stop = _stop_reason(path, now, limit, rule)
        if stop is not None:
            verdict, reason, remedy = stop
            break
    if in_equilibrium < (1.0 - EQUILIBRIUM_SHORTFALL) * highest:
        in_equilibrium = max(in_equilibrium, _equilibrium_below(path, highest, summit))
    if not np.isfinite(in_equilibrium):
        raise NoEquilibriumError(
            f'no state on the path is in equilibrium ({reason}); use flow = "davis", whose limit load is unique, or '
            "try another mesh or element"
        )
    likely = in_equilibrium * (1.0 + max(growth_per_doubling(path), 0.0))
    upper = max(likely, *(step.factor for step in path.steps), in_equilibrium)
    return LimitLoad(in_equilibrium, upper, verdict, reason, remedy)


def _equilibrium_below(path: EquilibriumPath, highest: float, summit: tuple[Any, ...]) -> float:
    """Return the multiplier in equilibrium without overstress at the peak of a path or a little below it; the path is
    not changed. The relaxed states along the path are too far apart to give this multiplier, and beyond the peak their
    multipliers are lower.
    """
    end, steps, in_equilibrium = path.mark(), list(path.steps), -np.inf
    for reduction in MULTIPLIER_REDUCTIONS:
        path.back(summit)
        if path.reach(highest * (1.0 - reduction)):
            in_equilibrium = path.factor
            break
    path.back(end)
    path.steps[:] = steps
    return in_equilibrium


def _broken_off(path: EquilibriumPath, ductility: Callable[[EquilibriumPath], float], rule: PlateauRule) -> StopReason:
    """Return the stop reason of a path on which no further step converged: a plateau if its load hardly rose any
    more."""
    growth = growth_per_doubling(path)
    if path.steps and ductility(path) >= SMALLEST_DUCTILITY and 0.0 <= growth < rule.growth:
        reason = f"the load changed by {100 * growth:.1f} % while the displacement doubled, after which {path.reason}"
        return StopReason("plateau", reason, "")
    return StopReason("undecided", path.reason, "try another mesh or element, or a smaller first_step")


def _stop_reason(path: EquilibriumPath, ductility: float, limit: float, rule: PlateauRule) -> StopReason | None:
    """Return the verdict, reason and remedy if the path has ended; None if it continues."""
    growth = growth_per_doubling(path)
    moving = [step.factor for step in path.steps if not step.at_rest]  # relaxed states lie below these, peak or not
    highest, last = max(moving), moving[-1]
    doubled = f"changed by {100 * growth:.1f} % while the displacement doubled"
    if path.factor > limit:
        return StopReason("no failure", f"no failure up to {limit:g}", "raise the limit to search for larger values")
    if ductility >= SMALLEST_DUCTILITY and last < (1.0 - PEAK_FALL) * highest:
        return StopReason("peak", f"the load fell by {100 * (1.0 - last / highest):.0f} % from its peak", "")
    if ductility >= SMALLEST_DUCTILITY and growth < rule.growth:
        return StopReason("plateau", f"the load {doubled}", "")
    if ductility >= rule.latest or len(path.steps) >= MOST_STEPS:
        verdict: PathVerdict = "plateau" if growth < TOLERATED_GROWTH else "undecided"
        remedy = "" if verdict == "plateau" else 'refine the mesh, or use the reduced element with flow = "davis"'
        return StopReason(verdict, f"at the end of the path the load {doubled}", remedy)
    return None


def growth_per_doubling(path: EquilibriumPath) -> float:
    """Return the relative growth of the load multiplier over the second half of the displacement so far."""
    moving = [step for step in path.steps if not step.at_rest]
    if not moving or moving[-1].factor <= 0.0:
        return 1.0
    displacement, factor = [0.0, *(s.displacement for s in moving)], [path.start, *(s.factor for s in moving)]
    half = float(np.interp(0.5 * displacement[-1], displacement, factor))
    return 1.0 - half / factor[-1]
