"""Makes the table of contact constants for pairs of layers: means of both layers, and for soil discs the strength of
the weaker layer.

SI units, per metre out of plane: springs in N/m, damping in N s/m, forces in N.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dem.kernels import contact as row
from dem.kernels.contact import COHESION, COHESION_OTHER, MU, MU_OTHER, MU_ROLLING
from dem.springs import NOTHING_ROLLS, STOP_DEPTH, Law, LayerSprings, Mean, Strength

ANY_OVERLAP = 2.0  # half of the sum of radii, and more


@dataclass(frozen=True)
class PairTable:
    """Holds contact constants by kind of pair: column a * (n + 1) + b for layers a and b; index n stands for the
    boundary.

    pairs (CONSTANTS, 2 (n + 1)**2): constants between discs, then those of contacts of undisturbed ground
    (`dem.undisturbed_contacts`); lines (CONSTANTS, n + 1): constants against rigid lines, with an additional block for
    each special strength of lines; line_block: number of the block of every line;
    alpha ((n + 1)**2,): reach of new pore springs.
    """

    layers: tuple[LayerSprings, ...]
    pairs: np.ndarray
    lines: np.ndarray
    alpha: np.ndarray
    line_block: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """Return the number of rows of the square table of pairs: the layers and the boundary."""
        return len(self.layers) + 1


def pair_table(
    layers: Sequence[LayerSprings], mean: Mean = "arithmetic", law: Law = "paper", widest: float = np.inf
) -> PairTable:
    """Make the table of constants for contacts within and between layers. widest: largest gap (m) across which discs
    attract each other.

    Between layers: the mean of stiffness, damping, friction, cohesion, alpha, beta and allowed overlap. A boundary disc
    has the values of its partner, and the stiffness of a liquefied layer before liquefaction, so that no disc passes
    through it. A rigid line has the values of its partner, too, but with the stiffest normal spring of all layers and a
    dashpot of the same damping ratio, so that it stops discs of any stiffness.

    law "soil": a contact between two materials has the strength of the weaker one at its normal force, for slip and for
    rolling: between sand and clay it is the smaller of mu Fn and C. The stiffness of the contact is the mean of the
    stiffnesses of both layers: arithmetic by default, or harmonic. Stiffness, damping, cohesion and tensile strength of
    contacts of a liquefied layer are multiplied by the share that liquefaction leaves.

    law "paper": ValueError for constants of soil discs.
    """
    if not layers:
        raise ValueError("there are no layers; the table of springs needs at least one layer")
    if mean not in ("arithmetic", "harmonic"):
        raise ValueError(f"mean is 'arithmetic' or 'harmonic', not {mean!r}")
    if law not in ("paper", "soil"):
        raise ValueError(f"law is 'paper' or 'soil', not {law!r}")
    values = _columns(layers)
    if law == "paper" and any(s.contact_cohesion or s.rolling_friction or s.stop for s in layers):
        raise ValueError(
            "contact_cohesion, rolling_friction and stop (stiffness at large overlaps) belong to soil discs: use "
            "law='soil'"
        )
    n = len(layers)
    pairs = _square(values, mean)
    stiffness = np.maximum(values[row.KN], [layer.boundary for layer in layers])
    pairs[row.KN, :n, n] = pairs[row.KN, n, :n] = stiffness
    left = _share_left([layer.faded for layer in layers])
    _reduce_stiffness(pairs, left)
    np.divide(_attraction(layers) * left, pairs[row.KN], out=pairs[row.ATTRACTION_REACH], where=pairs[row.KN] > 0.0)
    np.minimum(pairs[row.ATTRACTION_REACH], widest, out=pairs[row.ATTRACTION_REACH])
    lines = np.zeros((row.CONSTANTS, n + 1))
    lines[:, :n] = values
    lines[row.KN] = (values[row.KN] + values[row.STOP_STIFFNESS]).max()
    lines[row.CN, :n] *= np.sqrt(lines[row.KN, :n] / values[row.KN])
    lines[[row.MU, row.MU_OTHER, row.COHESION, row.COHESION_OTHER, row.MU_ROLLING], :n] *= 1.0 - np.array(
        [s.faded for s in layers]
    )
    if law == "soil":
        _apply_weaker_strength(pairs[:, :n, :n], values)
        pairs[[row.COHESION, row.COHESION_OTHER]] *= left
    undisturbed = pairs.copy()
    if law == "soil":
        frictions = [row.MU, row.MU_OTHER]
        values = values.copy()  # those of rigid lines stay
        values[frictions] = [s.friction if s.undisturbed_friction is None else s.undisturbed_friction for s in layers]
        weaker = _square(values, mean)
        _apply_weaker_strength(weaker[:, :n, :n], values)
        undisturbed[frictions] = weaker[frictions]
    pairs = np.concatenate([table.reshape(row.CONSTANTS, -1) for table in (pairs, undisturbed)], axis=1)
    for table in (pairs, lines):
        for spring, flexibility in ((row.KS, row.FKS), (row.KPS, row.FKPS)):
            np.divide(1.0, table[spring], out=table[flexibility], where=table[spring] > 0.0)
    alpha = _square(np.array([[layer.alpha for layer in layers]]), mean)
    alpha[0, n, n] = 1.0
    return PairTable(tuple(layers), pairs, lines, alpha.ravel())


def _apply_weaker_strength(pairs: np.ndarray, values: np.ndarray) -> None:
    """Write friction and cohesion of both materials, and the smaller rolling friction, into the constants of a pair."""
    first, other = np.broadcast_arrays(values[:, :, None], values[:, None, :])
    for first_of_pair, second in ((row.MU, row.MU_OTHER), (row.COHESION, row.COHESION_OTHER)):
        pairs[first_of_pair], pairs[second] = first[first_of_pair], other[first_of_pair]
    pairs[row.MU_ROLLING] = np.minimum(first[row.MU_ROLLING], other[row.MU_ROLLING])


def _attraction(layers: Sequence[LayerSprings]) -> np.ndarray:
    """Return the tensile strength (N) of contacts between layers (n + 1, n + 1): the smaller strength of both layers;
    at the boundary the strength of the layer.
    """
    strength = np.array([*(layer.attraction * layer.contact_cohesion for layer in layers), np.inf])
    pull = np.minimum(strength[:, None], strength[None, :])
    pull[-1, -1] = 0.0
    return pull


def _square(values: np.ndarray, mean: Mean) -> np.ndarray:
    """Return constants for all pairs of layers and the boundary (rows, n + 1, n + 1), from the constants of the n
    layers (rows, n)."""
    n = values.shape[1]
    pairs = np.zeros((len(values), n + 1, n + 1))
    a, b = np.broadcast_arrays(values[:, :, None], values[:, None, :])
    if mean == "arithmetic":
        pairs[:, :n, :n] = 0.5 * (a + b)
    else:
        np.divide(2.0 * a * b, a + b, out=pairs[:, :n, :n], where=a + b > 0.0)
    pairs[:, :n, n] = pairs[:, n, :n] = values
    return pairs


def _columns(layers: Sequence[LayerSprings]) -> np.ndarray:
    """Return the constants of contacts within each layer, a column for each."""
    values = np.zeros((row.CONSTANTS, len(layers)))
    for k, layer in enumerate(layers):
        tan = layer.friction if layer.pore_friction is None else layer.pore_friction
        for constant, value in (
            (row.KN, layer.kn), (row.KS, layer.ks), (row.CN, layer.cn), (row.CT, layer.ct), (row.MU, layer.friction),
            (row.KPN, layer.kpn), (row.KPS, layer.kps), (row.TAN, tan), (row.BC, layer.cohesion),
            (row.BETA, layer.beta), (row.ALLOWED, 0.5 * layer.allowed_overlap), (row.MU_OTHER, layer.friction),
            (row.COHESION, layer.contact_cohesion), (row.COHESION_OTHER, layer.contact_cohesion),
            (row.STOP_STIFFNESS, max(layer.stop - layer.kn, 0.0)), (row.STOP_OVERLAP, 0.5 * STOP_DEPTH),
            (row.MU_ROLLING, min(layer.rolling_friction, NOTHING_ROLLS)),
        ):  # fmt: skip
            values[constant, k] = value
    return values


def _share_left(faded: Sequence[float]) -> np.ndarray:
    """Return the share of contact stiffness that liquefaction leaves, between n layers and with the boundary
    (n + 1, n + 1).

    faded: lost share by layer. For a contact between two layers the larger lost share counts.
    """
    left = 1.0 - np.array([*faded, 0.0])
    return np.asarray(np.minimum(left[:, None], left[None, :]))


def _reduce_stiffness(pairs: np.ndarray, left: np.ndarray) -> None:
    """Multiply the stiffness of contacts (CONSTANTS, n + 1, n + 1) by the remaining share `left`; their overlap is no
    longer limited.
    """
    pairs[[row.KN, row.KS, row.CN, row.CT, row.STOP_STIFFNESS]] *= left
    pairs[row.ALLOWED] = np.where(left < 1.0, ANY_OVERLAP, pairs[row.ALLOWED])


LineStrengths = Strength | Sequence[Strength | None] | None


def strength_of_each(strengths: LineStrengths, count: int) -> tuple[Strength | None, ...]:
    """Return one strength for each line, None for the strength of the disc's layer; empty if it is None for all lines.

    Raises ValueError unless there are ``count`` strengths.
    """
    each = (strengths,) * count if strengths is None or isinstance(strengths, Strength) else tuple(strengths)
    if len(each) != count:
        raise ValueError(f"discs: {len(each)} strengths of rigid lines given, there are {count} lines")
    return each if any(strength is not None for strength in each) else ()


def with_line_strengths(table: PairTable, strengths: Sequence[Strength | None], law: Law) -> PairTable:
    """Return the table with a block of columns for every strength given to lines.

    A line always has the stiffness and the dashpots of the disc that touches the line. Raises ValueError if friction or
    cohesion is negative, and if lines with a cohesion touch discs with the law "paper", whose contacts have none.
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
