"""Strength of the knot spans at the edges of a weak layer, so that it slips where its edge is in the ground.

The strain rate of quadratic splines is a sum of hats two knot spans wide. A hat that reaches into ground which holds
cannot shear, so that a shear band at the edge of a weak layer would lie 1 to 2 cells inside it, where it takes a larger
Kh. Hence knot spans whose node lies less than a cell above the layer, or up to two below it, have the layer's strength
at its edge, and below it

    s(z) = s_e M(z) / M_e,

M the mass above (kg/m²), s_e and M_e at the edge. The shear stress that Kh and the slope ask for grows with M, so that
these spans yield under the Kh under which a rigid block slips on the edge, wherever the edge lies on the grid.
"""

from dataclasses import dataclass

import numpy as np

BELOW = 2.0  # cells under a layer, down to which its strength reaches
STEEPEST = 1.0  # slope up to which edges in neighbouring columns are one edge


@dataclass(frozen=True)
class _Edge:
    """An edge of a weak layer in a column of points: its height (m), and the ``donor``, the last point of the layer."""

    column: int
    z: float
    below: bool  # whether the layer ends here downwards
    donor: int
    per_mass: float  # strength over the mass above it, at the edge
    others: np.ndarray  # numbers of the points of its column


@dataclass(frozen=True, eq=False)
class EdgeStrength:
    """Strength of points at the edges of weak layers.

    Attributes
    ----------
    points : ndarray (k,) of int
        Numbers of the points.
    donors : ndarray (k,) of int
        Number of the point of a weak layer at whose edge each of them lies.
    strength : ndarray (k,)
        Strength of each (Pa).
    """

    points: np.ndarray
    donors: np.ndarray
    strength: np.ndarray


def edge_strength(
    x: np.ndarray, height: np.ndarray, mass: np.ndarray, layer: np.ndarray, strength: np.ndarray, cell: float
) -> EdgeStrength:
    """Strength of points in the knot spans at the upper and lower edges of weak layers.

    Ground at the end of a layer, such as a quay wall, keeps its strength.

    Parameters
    ----------
    x : ndarray (n, 2)
        Places of all points on the grid (m), in columns half a cell apart.
    height : ndarray (n,)
        Height of each point's part of its column (m).
    mass : ndarray (n,)
        Mass of each point (kg/m).
    layer : ndarray (n,) of int
        Number of the weak layer of each point, -1 for sound ground.
    strength : ndarray (n,)
        Strength of each point (Pa); that of sound ground does not matter.
    cell : float
        Side of a cell of the grid (m).

    Returns
    -------
    EdgeStrength
        Points of sound ground, in the order of their numbers.
    """
    column, row = np.floor(2.0 * x[:, 0] / cell).astype(int), np.round(x[:, 1] / cell).astype(int)
    above = np.zeros(len(x))
    edges: dict[int, list[_Edge]] = {}
    order = np.lexsort((-x[:, 1], column))
    for mine in np.split(order, np.flatnonzero(np.diff(column[order])) + 1):
        above[mine] = np.cumsum(mass[mine]) - 0.5 * mass[mine]
        edges[int(column[mine[0]])] = _edges(mine, int(column[mine[0]]), x, height, mass, above, layer, strength)
    found: dict[int, tuple[float, int, float]] = {}
    for edge in (edge for of_column in edges.values() for edge in of_column):
        low, high = _rows(edge, edges, layer, cell)
        near = edge.others[(row[edge.others] >= low) & (row[edge.others] <= high)]
        for p in near[layer[near] < 0]:
            scaled = edge.per_mass * above[p] if edge.below else strength[edge.donor]
            away = abs(x[p, 1] - edge.z)
            if away < found.get(p, (np.inf,))[0]:
                found[p] = away, edge.donor, scaled
    points = np.array(sorted(found), dtype=int)
    return EdgeStrength(
        points, np.array([found[p][1] for p in points], dtype=int), np.array([found[p][2] for p in points], dtype=float)
    )


def _edges(
    mine: np.ndarray, column: int, x: np.ndarray, height: np.ndarray, mass: np.ndarray, above: np.ndarray,
    layer: np.ndarray, strength: np.ndarray,
) -> list[_Edge]:  # fmt: skip
    """The edges in a column of points, which are listed from the surface down."""
    edges = []
    for k in np.flatnonzero(np.diff(layer[mine])):
        for at, after, inwards in ((k, k + 1, -1), (k + 1, k, 1)):
            donor, beside = mine[at], mine[after]
            if layer[donor] < 0:
                continue
            below = after > at
            inner = mine[at + inwards] if 0 <= at + inwards < len(mine) else donor
            slope = strength[donor] - strength[inner] if layer[inner] == layer[donor] else 0.0
            at_edge = max(strength[donor] + 0.5 * slope, 0.0)
            per_mass = at_edge / (above[donor] + (0.5 if below else -0.5) * mass[donor])
            half = 0.5 * height[[donor, beside]]
            z = 0.5 * (x[donor, 1] + x[beside, 1] + (half[1] - half[0] if below else half[0] - half[1]))
            edges.append(_Edge(column, float(z), below, int(donor), float(per_mass), mine))
    return edges


def _rows(edge: _Edge, edges: dict[int, list[_Edge]], layer: np.ndarray, cell: float) -> tuple[int, int]:
    """First and last row of nodes in whose knot spans the ground beside an edge has the strength of the layer.

    Of an edge that dips, the highest and the lowest place over the three columns of nodes about it count.
    """
    node = (edge.column + 1) // 2
    heights = [edge.z]
    for column in range(2 * node - 2, 2 * node + 2):
        far = STEEPEST * 0.5 * cell * abs(column - edge.column) + 1e-9
        heights += [
            other.z
            for other in edges.get(column, ())
            if other.below == edge.below and layer[other.donor] == layer[edge.donor] and abs(other.z - edge.z) <= far
        ]
    low = min(heights) / cell - (BELOW if edge.below else 1.0)
    return int(np.ceil(low - 1e-6)), int(np.ceil(max(heights) / cell + 1.0 - 1e-6)) - 1
