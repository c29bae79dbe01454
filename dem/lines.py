"""What contacts with rigid lines hold where that is not what the discs' own layers hold: smooth gates, rough floors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dem.kernels.contact import COHESION, COHESION_OTHER, MU, MU_OTHER, MU_ROLLING
from dem.springs import NOTHING_ROLLS, Law, PairTable, Strength

LineStrengths = Strength | Sequence[Strength | None] | None


def strength_of_each(given: LineStrengths, count: int) -> tuple[Strength | None, ...]:
    """One strength for each of so many lines, None for what the disc's layer holds; empty where it is that for all.

    Raises ValueError for another number of strengths.
    """
    each = (given,) * count if given is None or isinstance(given, Strength) else tuple(given)
    if len(each) != count:
        raise ValueError(f"discs: {len(each)} strengths of rigid lines given, there are {count} lines")
    return each if any(one is not None for one in each) else ()


def with_line_strengths(table: PairTable, strengths: Sequence[Strength | None], law: Law) -> PairTable:
    """The table with a block of columns for every strength that lines have of their own.

    Stiffness and dashpots of a line are those of its partner in any case. Raises ValueError for a friction or cohesion
    below zero, and for cohesion of the paper's discs, whose contacts know none.
    """
    distinct = list(dict.fromkeys(one for one in strengths if one is not None))
    blocks = [table.lines]
    for one in distinct:
        if one.friction < 0.0 or one.cohesion < 0.0 or (law == "paper" and one.cohesion > 0.0):
            raise ValueError(f"rigid lines: expected friction of at least 0, cohesion for soil discs alone, not {one}")
        block = table.lines.copy()
        block[[MU, MU_OTHER]], block[[COHESION, COHESION_OTHER]] = one.friction, one.cohesion
        block[MU_ROLLING] = min(one.rolling_friction, NOTHING_ROLLS)
        blocks.append(block)
    number = {None: 0} | {one: k + 1 for k, one in enumerate(distinct)}
    return replace(table, lines=np.concatenate(blocks, axis=1), line_block=tuple(number[one] for one in strengths))
