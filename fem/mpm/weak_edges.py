"""Gives the knot spans at the edges of a weak layer the strength at which the layer slips at its edge.

The strain rate of quadratic splines is a sum of hat functions two knot spans wide. A hat function that reaches into
strong ground cannot shear, so that a shear band at the edge of a weak layer would lie 1 to 2 cells inside the layer,
where failure needs a larger Kh. Hence knot spans whose node lies less than a cell above the layer, or up to two cells
below it, have the strength of the layer at its edge, and below the layer

    s(z) = s_e M(z) / M_e,

with the mass above M (kg/m²), and s_e and M_e at the edge. The shear stress by Kh and the slope is proportional to M,
so that these spans yield at the Kh at which a rigid block slips on the edge, wherever the edge lies on the grid. They
do so along the edge only (`fem.kernels.point_stress`): firm ground below a layer carries what lies above and beside it.
A quay whose ground was weak in all directions up to two cells below the layer behind it sank and overturned without
shaking, at a factor of safety of 1.3.

Sand that strains by its strain potential γ_max before it regains strength would strain over all spans of its hat
functions, or not at all where stiff points in the same spans carry the shear. Therefore the points in these spans also
have the stress-strain law of the layer along the edge: their γ at τ M(z) / M is the γ of the layer at τ, and all
strains are scaled by the thickness of the layer over the width that shears on the grid. The width W of a column of
points p follows from its equilibrium: with φ_k the hat of knot k, h the cell,

    Σ_l (Σ_p V_p g_p φ_k φ_l) γ_l = Σ_p V_p M_p φ_k,   W = Σ_k γ_k ∫ φ_k dz from the lowest to the highest point,

with g_p = M_p at points that shear, and many times M_p at points that do not. Uniformly sheared ground has γ_k = 1. The
crust then moves by the strain of the layer times its thickness, for cells of any size.
"""

from dataclasses import dataclass

import numpy as np

CELLS_BELOW = 2.0  # cells below a layer that have its strength
STIFF_RATIO = 1e4  # stiffness of ground that does not shear over that of ground that shears; only their order matters
STEEPEST_EDGE = 1.0  # slope up to which edges in neighbouring columns are one edge


@dataclass(frozen=True)
class _Edge:
    """Holds an edge of a weak layer in a column of points: its height (m), and the ``donor``, which is the last point
    of the layer."""

    column: int
    z: float
    below: bool  # whether the layer ends here downwards
    donor: int
    per_mass: float  # strength over the mass above it, at the edge
    others: np.ndarray  # numbers of the points of its column


@dataclass(frozen=True, eq=False)
class EdgeStrength:
    """Holds the strength of points at the edges of weak layers.

    Attributes
    ----------
    points (k,) : numbers of the points
    donors (k,) : number of the weak point at whose layer's edge each point lies (its donor)
    strength (k,) : strength of each point (Pa)
    demand (k,) : mass above each point over the mass above its weak point (donor), which is the ratio of the shear
        stresses at the two points (-)
    below (k,) : whether the edge is the lower edge of the layer
    """

    points: np.ndarray
    donors: np.ndarray
    strength: np.ndarray
    demand: np.ndarray
    below: np.ndarray


def edge_strength(
    x: np.ndarray, height: np.ndarray, mass: np.ndarray, layer: np.ndarray, strength: np.ndarray, cell: float
) -> EdgeStrength:
    """Compute the strength of points in the knot spans at the upper and lower edges of weak layers.

    Ground at the horizontal end of a layer, such as a quay wall, keeps its strength.

    Parameters
    ----------
    x (n, 2) : positions of all points on the grid (m), in columns half a cell apart
    height (n,) : height of each point's part of its column (m)
    mass (n,) : mass of each point (kg/m)
    layer (n,) : number of the weak layer of each point, -1 for firm ground, which does not lose strength
    strength (n,) : strength of each point (Pa); that of firm ground does not matter
    cell : side of a cell of the grid (m)

    Returns
    -------
    Strength (Pa) of the points of firm ground that lie in a knot span with the edge of a weak layer, by their numbers.
    """
    column, row = _grid_places(x, cell)
    above = np.zeros(len(x))
    edges: dict[int, list[_Edge]] = {}
    for points_of_column in in_columns(x, column):
        above[points_of_column] = np.cumsum(mass[points_of_column]) - 0.5 * mass[points_of_column]
        edges[int(column[points_of_column[0]])] = _edges(
            points_of_column, int(column[points_of_column[0]]), x, height, mass, above, layer, strength
        )
    nearest: dict[int, tuple[float, int, float, bool]] = {}
    for edge in (edge for of_column in edges.values() for edge in of_column):
        low, high = _rows(edge, edges, layer, cell)
        neighbours = edge.others[(row[edge.others] >= low) & (row[edge.others] <= high)]
        for p in neighbours[layer[neighbours] < 0]:
            scaled = edge.per_mass * above[p] if edge.below else strength[edge.donor]
            distance = abs(x[p, 1] - edge.z)
            if distance < nearest.get(p, (np.inf,))[0]:
                nearest[p] = distance, edge.donor, scaled, edge.below
    points = np.array(sorted(nearest), dtype=int)
    donors = np.array([nearest[p][1] for p in points], dtype=int)
    strengths = np.array([nearest[p][2] for p in points], dtype=float)
    below = np.array([nearest[p][3] for p in points], dtype=bool)
    return EdgeStrength(points, donors, strengths, above[points] / above[donors], below)


def thickness_over_width(
    x: np.ndarray, height: np.ndarray, mass: np.ndarray, layer: np.ndarray, in_layer: np.ndarray, cell: float
) -> np.ndarray:
    """Return the thickness of a weak layer over the width of ground that shears in its place on the grid, column by
    column.

    Parameters
    ----------
    x : ndarray (n, 2)
        Positions of all points on the grid (m), in columns half a cell apart.
    height : ndarray (n,)
        Height of each point's part of its column (m).
    mass : ndarray (n,)
        Mass of each point (kg/m).
    layer : ndarray (n,) of int
        Number of the weak layer whose stress-strain law each point has, -1 for firm ground.
    in_layer : ndarray (n,) of bool
        Whether the point belongs to the layer itself, not to the ground at the edge of the layer.
    cell : float
        Side of a cell of the grid (m).

    Returns
    -------
    Ratio (n,) of thickness to width, at most 1; 1 for firm ground.
    """
    column, _ = _grid_places(x, cell)
    share = np.ones(len(x))
    for points_of_column in in_columns(x, column):
        weak = layer[points_of_column] >= 0
        if not weak.any():
            continue
        above = np.cumsum(mass[points_of_column]) - 0.5 * mass[points_of_column]
        strain, width = _equilibrium(x[points_of_column, 1] / cell, height[points_of_column] / cell, above, weak)
        moved = np.where(weak, height[points_of_column] * strain, 0.0)
        moved *= cell * width / moved.sum()
        for k in np.unique(layer[points_of_column][weak]):
            of_layer = layer[points_of_column] == k
            thickness, sheared = (
                height[points_of_column][of_layer & in_layer[points_of_column]].sum(),
                moved[of_layer].sum(),
            )
            if 0.0 < thickness < sheared:
                share[points_of_column[of_layer]] = thickness / sheared
    return share


def _equilibrium(z: np.ndarray, height: np.ndarray, above: np.ndarray, weak: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the shear strain (n,) of the points of a column, in units of the strain of freely shearing ground, and the
    width that shears (cells).

    ``z``, ``height`` (n,): places and heights (cells); ``above`` (n,): mass above; ``weak`` (n,): mask of the points
    that shear.
    """
    knot = np.floor(z - 0.5).astype(int)  # below the point, which lies between knots and has a hat of each
    first = knot.min()
    hats = np.zeros((len(z), knot.max() - first + 2))
    upper = z - 0.5 - knot
    hats[np.arange(len(z)), knot - first], hats[np.arange(len(z)), knot - first + 1] = 1.0 - upper, upper
    force = height * above
    stiffness = hats.T @ (np.where(weak, force, STIFF_RATIO * force)[:, None] * hats)
    strains = np.linalg.lstsq(stiffness, hats.T @ force, rcond=None)[0]
    # A hat that hardly reaches the highest or the lowest point has any strain; beyond these points nothing shears.
    knots = first + np.arange(hats.shape[1])
    reached = _hat_integral(z.max() - knots) - _hat_integral(z.min() - knots)
    return hats @ strains, float(strains @ reached)


def _hat_integral(z: np.ndarray) -> np.ndarray:
    """Return the integral of the hat function of a knot up to heights ``z`` above its lower end, half a cell below the
    place by which the knot is numbered (cells)."""
    t = np.clip(z + 0.5, 0.0, 2.0)
    return np.where(t < 1.0, 0.5 * t**2, 1.0 - 0.5 * (2.0 - t) ** 2)


def in_columns(x: np.ndarray, column: np.ndarray) -> list[np.ndarray]:
    """Return the numbers of the points of each column, from the surface down.

    ``x`` (n, 2): positions (m); ``column`` (n,): numbers of their columns.
    """
    order = np.lexsort((-x[:, 1], column))
    return np.split(order, np.flatnonzero(np.diff(column[order])) + 1)


def _grid_places(x: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the column of points, and the row of nodes in whose knot span each point lies."""
    return np.floor(2.0 * x[:, 0] / cell).astype(int), np.round(x[:, 1] / cell).astype(int)


def _edges(
    points_of_column: np.ndarray, column: int, x: np.ndarray, height: np.ndarray, mass: np.ndarray, above: np.ndarray,
    layer: np.ndarray, strength: np.ndarray,
) -> list[_Edge]:  # fmt: skip
    """Return the edges of weak layers in a column of points; ``points_of_column`` numbers its points from the surface
    down."""
    edges = []
    for k in np.flatnonzero(np.diff(layer[points_of_column])):
        for at, after, inwards in ((k, k + 1, -1), (k + 1, k, 1)):
            donor, receiver = points_of_column[at], points_of_column[after]
            if layer[donor] < 0:
                continue
            below = after > at
            next_inwards = points_of_column[at + inwards] if 0 <= at + inwards < len(points_of_column) else donor
            slope = strength[donor] - strength[next_inwards] if layer[next_inwards] == layer[donor] else 0.0
            at_edge = max(strength[donor] + 0.5 * slope, 0.0)
            per_mass = at_edge / (above[donor] + (0.5 if below else -0.5) * mass[donor])
            half = 0.5 * height[[donor, receiver]]
            z = 0.5 * (x[donor, 1] + x[receiver, 1] + (half[1] - half[0] if below else half[0] - half[1]))
            edges.append(_Edge(column, float(z), below, int(donor), float(per_mass), points_of_column))
    return edges


def _rows(edge: _Edge, edges: dict[int, list[_Edge]], layer: np.ndarray, cell: float) -> tuple[int, int]:
    """Return the first and last row of nodes in whose knot spans the ground at an edge has the strength of the layer.

    For an inclined edge they follow from its highest and lowest place over the three nearest columns of nodes.
    """
    node = (edge.column + 1) // 2
    heights = [edge.z]
    for column in range(2 * node - 2, 2 * node + 2):
        height_tolerance = STEEPEST_EDGE * 0.5 * cell * abs(column - edge.column) + 1e-9
        heights += [
            other.z
            for other in edges.get(column, ())
            if other.below == edge.below
            and layer[other.donor] == layer[edge.donor]
            and abs(other.z - edge.z) <= height_tolerance
        ]
    low = min(heights) / cell - (CELLS_BELOW if edge.below else 1.0)
    return int(np.ceil(low - 1e-6)), int(np.ceil(max(heights) / cell + 1.0 - 1e-6)) - 1
