"""When a path has shown all that it has to: the rule for a plateau, and the verdict."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from fem.path import Walk

Verdict = Literal["plateau", "peak", "no failure", "undecided"]
Progress = Callable[[Walk], None]


class Ending(NamedTuple):
    """Why a walk is over."""

    verdict: Verdict
    reason: str
    remedy: str


@dataclass(frozen=True)
class Plateau:
    """When to stop: the load factor has grown by less than ``growth`` while the displacement doubled.

    Displacements are told by the stretch, in the first use the displacement over what it would be at this load if the
    ground were elastic. The rule holds from the stretch ``earliest`` on, and at ``latest`` the walk ends. ``fall`` is
    the loss of load that makes a peak of a plateau, ``still_a_plateau`` the growth that is let pass at the end. Where
    what was held is less than the highest load by ``loose``, more is looked for there. Rests begin at ``first_rest``
    and come whenever the stretch has grown ``next_rest`` times.
    """

    growth: float = 0.01
    earliest: float = 3.0
    latest: float = 12.0
    fall: float = 0.05
    still_a_plateau: float = 0.04
    loose: float = 0.025
    first_rest: float = 1.3
    next_rest: float = 1.3


@dataclass(frozen=True)
class Outcome:
    """The largest load factor ``held`` in equilibrium, the ``upper`` end of what it may be, and why the walk ended."""

    held: float
    upper: float
    verdict: Verdict
    reason: str
    remedy: str = ""


def walk_to_plateau(
    walk: Walk,
    stretch: Callable[[Walk], float],
    limit: float,
    plateau: Plateau,
    wanted: Sequence[float] = (),
    keep: Callable[[float], None] = lambda factor: None,
    progress: Progress | None = None,
) -> Outcome:
    """Walk until the load factor no longer grows or passes ``limit``.

    On the way the ``wanted`` factors are gone to, and ``keep`` is called in equilibrium at each that can be reached.
    Where there is overstress only states after a rest count as held.
    """
    left = sorted(factor for factor in wanted if factor > walk.factor)
    held, next_rest = walk.factor, plateau.first_rest
    highest, summit = walk.factor, walk.mark()
    while True:
        mark = walk.mark()
        if not walk.advance():
            verdict, reason, remedy = Ending("undecided", walk.reason, "try another mesh or a larger relaxation")
            break
        if left and walk.factor >= left[0]:
            factor = left.pop(0)
            walk.back(mark)
            if walk.reach(factor):
                held = max(held, factor)
                keep(factor)
            continue
        if walk.factor > highest:
            highest, summit = walk.factor, walk.mark()
        now = stretch(walk)
        if walk.settings.relaxation <= 0.0 or (now >= next_rest and walk.rest()):
            held = max(held, walk.factor)
        if now >= next_rest:
            next_rest = plateau.next_rest * now
        if progress is not None:
            progress(walk)
        ending = _ending(walk, now, limit, plateau)
        if ending is not None:
            verdict, reason, remedy = ending
            break
    if held < (1.0 - plateau.loose) * highest:
        held = max(held, _held_at(walk, highest, summit))
    growth = max(growth_per_doubling(walk), 0.0)
    upper = max(held * (1.0 + growth), *(step.factor for step in walk.steps), held)
    return Outcome(held, upper, verdict, reason, remedy)


def _held_at(walk: Walk, highest: float, summit: tuple[Any, ...]) -> float:
    """The load factor that stands without overstress where the walk was highest, or a little below; leaves the walk.

    Rests come too seldom to find it on the way, and past a peak they find less.
    """
    end, steps, held = walk.mark(), list(walk.steps), 0.0
    for less in walk.settings.give_way:
        walk.back(summit)
        if walk.reach(highest * (1.0 - less)):
            held = walk.factor
            break
    walk.back(end)
    walk.steps[:] = steps
    return held


def _ending(walk: Walk, stretch: float, limit: float, plateau: Plateau) -> Ending | None:
    """Verdict, reason and remedy if the walk is over."""
    growth = growth_per_doubling(walk)
    highest = max(step.factor for step in walk.steps)
    doubled = f"changed by {100 * growth:.1f} % while the displacement doubled"
    if walk.factor > limit:
        return Ending("no failure", f"no failure up to {limit:g}", "raise the limit if more is of interest")
    if stretch >= plateau.earliest and walk.factor < (1.0 - plateau.fall) * highest:
        return Ending("peak", f"it has fallen by {100 * (1.0 - walk.factor / highest):.0f} % from its peak", "")
    if stretch >= plateau.earliest and growth < plateau.growth:
        return Ending("plateau", f"it {doubled}", "")
    if stretch >= plateau.latest or len(walk.steps) >= walk.settings.longest:
        verdict: Verdict = "plateau" if growth < plateau.still_a_plateau else "undecided"
        remedy = "refine the mesh, or use the quadratic element"
        return Ending(verdict, f"at the end of the walk it {doubled}", remedy)
    return None


def growth_per_doubling(walk: Walk) -> float:
    """Relative growth of the load factor over the second half of the displacement so far."""
    moving = [step for step in walk.steps if not step.at_rest]
    if not moving or moving[-1].factor <= 0.0:
        return 1.0
    displacement, factor = [0.0, *(s.displacement for s in moving)], [walk.start, *(s.factor for s in moving)]
    half = float(np.interp(0.5 * displacement[-1], displacement, factor))
    return 1.0 - half / factor[-1]
