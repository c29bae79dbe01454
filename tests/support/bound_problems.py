"""Provides problems of limit analysis with known answers, as grounds and first meshes."""

import math

import numpy as np

from fem.limit.adaptive_bounds import BoundSearch
from fem.limit.bracket import Bracket, Limits
from fem.limit.limit_problem import RigidPlasticBody, Side
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate
from tests.support.sections import layer

FIXED = Side("xy")


def bracket(mesh: TriMesh, body: RigidPlasticBody, limits: Limits) -> Bracket:
    """Return the lower and upper bound of the load multiplier on a sequence of ever finer meshes, up to a limit."""
    search = BoundSearch(mesh, body, limits)
    while search.bracket.end_reason is None:
        search.advance()
    return search.bracket


def ground(cohesion, phi, sides, weight=0.0, tension=None):
    """Return ground of one soil, φ in degrees; ``weight`` is the downward body force that the multiplier acts on."""
    return RigidPlasticBody(
        cohesion=np.array([cohesion]),
        friction=np.array([math.radians(phi)]),
        dead_force=np.zeros((1, 2)),
        live_force=np.array([[0.0, -weight]]),
        sides=sides,
        tension=None if tension is None else np.array([tension]),
    )


def own_weight(surface, base, phi, left=FIXED, gap=0.01, max_cells=20_000, size=0.2, tension=None) -> Bracket:
    """Return γH/c of a body 1 m high, fixed at its base and right side, whose weight grows."""
    soil = layer("soil", friction_angle=f"{phi} deg")
    mesh = triangulate(Section.parse({"name": "body", "surface": surface, "base": base, "strata": [soil]}), size)
    sides = {"surface": Side(), "base": FIXED, "left": left, "right": FIXED}
    return bracket(mesh, ground(1.0, phi, sides, weight=1.0, tension=tension), Limits(gap, max_cells))


def slope_box(phi, **settings):
    """Return a block 1.2 m by 1 m, free at its left side and its top."""
    return own_weight([[0.0, 1.0], [1.2, 1.0]], {"elevation": 0.0}, phi, left=Side(), **settings)


def vertical_cut(phi, **settings):
    """Return a step of 1 m in ground that is wide and deep enough not to affect the failure."""
    surface = [[-2.5, 0.0], [0.0, 0.0], [0.0, 1.0], [2.5, 1.0]]
    return own_weight(surface, {"elevation": -1.0}, phi, size=0.4, **settings)


def slope_45(phi, **settings):
    """Return a slope of 45°, 1 m high."""
    surface = [[-1.5, 0.0], [0.0, 0.0], [1.0, 1.0], [3.5, 1.0]]
    return own_weight(surface, {"elevation": -0.7}, phi, size=0.4, **settings)


def rectangles(x, y) -> TriMesh:
    """Return triangles, two in every rectangle between the increasing lines x and y (m); the surface up to x = 1 is
    "footing"."""
    columns, rows = len(x) - 1, len(y) - 1
    node = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]))
    cells = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    lines = {"surface": node[-1], "base": node[0], "left": node[:, 0], "right": node[:, -1]}
    boundaries = {name: np.column_stack([line[:-1], line[1:]]) for name, line in lines.items()}
    points = np.column_stack([array.ravel() for array in np.meshgrid(x, y)])
    under = points[boundaries["surface"]].mean(axis=1)[:, 0] < 1.0
    boundaries["footing"] = boundaries["surface"][under]
    boundaries["surface"] = boundaries["surface"][~under]
    return TriMesh(points, cells, np.zeros(len(cells), dtype=int), boundaries)


def pressure(value):
    """Return a pressure (Pa) on a horizontal surface."""
    return lambda at: np.tile([0.0, -value], (len(at.points), 1))


def footing(phi, surcharge=False, gap=0.02, max_cells=20_000) -> Bracket:
    """Return the bearing capacity factor Nc, or Nq under a ``surcharge``, of half of a smooth strip footing 2 m wide on
    weightless ground; the box contains Prandtl's mechanism."""
    spiral = math.exp(math.pi / 2 * math.tan(math.radians(phi)))
    half = math.radians(45.0 + phi / 2)
    reach = spiral / math.cos(half)
    width, depth = 1.0 + 2.4 * reach * math.sin(half), 1.2 * reach
    step = width / 8.0
    x = np.concatenate([[0.0, 0.5], np.linspace(1.0, width, max(3, round((width - 1.0) / step)) + 1)])
    mesh = rectangles(x, np.linspace(-depth, 0.0, max(3, round(depth / step)) + 1))
    sides = {
        "footing": Side(live=pressure(1.0)),
        "surface": Side(dead=pressure(1.0)) if surcharge else Side(),
        "left": Side("x"),
        "right": FIXED,
        "base": FIXED,
    }
    return bracket(mesh, ground(0.0 if surcharge else 1.0, phi, sides), Limits(gap, max_cells))
