"""Strength of contacts with rigid lines, where it differs from that of the discs: smooth gates, rough floors."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dem.kernels.contact import COHESION, COHESION_OTHER, MU, MU_OTHER, MU_ROLLING
from dem.pair_table import PairTable
from dem.springs import NOTHING_ROLLS, Law, Strength

LineStrengths = Strength | Sequence[Strength | None] | None


def strength_of_each(strengths: LineStrengths, count: int) -> tuple[Strength | None, ...]:
    """One strength for each line, None for the strength of the layer of the disc; empty if it is None for all lines.

    Raises ValueError unless there are ``count`` strengths.
    """
    each = (strengths,) * count if strengths is None or isinstance(strengths, Strength) else tuple(strengths)
    if len(each) != count:
        raise ValueError(f"discs: {len(each)} strengths of rigid lines given, there are {count} lines")
    return each if any(strength is not None for strength in each) else ()


def with_line_strengths(table: PairTable, strengths: Sequence[Strength | None], law: Law) -> PairTable:
    """The table with a block of columns for every strength given to lines.

    Stiffness and dashpots of a line are always those of its partner. Raises ValueError if friction or cohesion is
    negative, and for cohesion with the paper's discs, whose contacts have none.
    """
    distinct = list(dict.fromkeys(strength for strength in strengths if strength is not None))
    blocks = [table.lines]
    for strength in distinct:
        if strength.friction < 0.0 or strength.cohesion < 0.0 or (law == "paper" and strength.cohesion > 0.0):
            raise ValueError(
                f"rigid lines: expected friction of at least 0, and cohesion only for soil discs, not {strength}"
            )
        block = table.lines.copy()
        block[[MU, MU_OTHER]], block[[COHESION, COHESION_OTHER]] = strength.friction, strength.cohesion
        block[MU_ROLLING] = min(strength.rolling_friction, NOTHING_ROLLS)
        blocks.append(block)
    number = {None: 0} | {strength: k + 1 for k, strength in enumerate(distinct)}
    return replace(
        table, lines=np.concatenate(blocks, axis=1), line_block=tuple(number[strength] for strength in strengths)
    )
