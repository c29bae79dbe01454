"""Makes free meshes of any section that conform to every interface: quadrilaterals of a wanted size, or triangles."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise

import gmsh
import numpy as np
from scipy.spatial import KDTree

from meshes.mapped import name_groups
from meshes.seams import Seam, along_and_above, seam_ends, seams_of
from meshes.section.alike_sides import has_alike_sides
from meshes.section.layering import Layering
from meshes.section.section import Section
from meshes.settings import GROWTH_REACH

# gmsh's 2-D algorithms in the order of the quality they gave: frontal for quadrilaterals, frontal, Delaunay.
ALGORITHMS = (8, 6, 5)

# A point is on a line, where it was put, if its distance is this share of what makes two points one.
ON_LINE = 1e-4

# Triangles at a low vertical step, in heights of the step, and how their size grows with each metre from there.
STEP_CELLS, STEP_GROWTH = 2.0, 0.4


@dataclass(frozen=True, eq=False)
class Sizes:
    """Holds the required sizes of cell edges (m). At every place the smallest of the sizes that apply is used.

    Attributes
    ----------
    ordinary : default size
    strata : size in each stratum that has its own, by its name
    towards : size at "surface", "base" or the bottom of a stratum, by name
    corners, at_corners : triangles (k, 3, 2) in m that cover the section, and sizes (k, 3) at their corners, linear in
        between; empty without such sizes
    far_factor : factor by which ordinary sizes are larger far beyond the given ends of the section
    repeats : whether the right side gets the points of the left side, as periodic sides require, if both have the same
        layers
    """

    ordinary: float
    strata: Mapping[str, float] = field(default_factory=dict)
    towards: Mapping[str, float] = field(default_factory=dict)
    corners: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 2)))
    at_corners: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))
    far_factor: float = 1.0
    repeats: bool = False

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(self.corners.reshape(-1, 2))

    def at(self, stratum: str, points: np.ndarray) -> np.ndarray:
        """Return the size (n,) in a stratum at points (n, 2), without the sizes ``towards`` lines."""
        size = np.full(len(points), self.strata.get(stratum, self.ordinary))
        if len(self.corners):
            nearest = self._tree.query(points)[1]
            size = np.minimum(size, self.at_corners.ravel()[nearest])
        return size

    def times(self, scale: float) -> "Sizes":
        """Return all sizes multiplied by a factor."""
        return replace(
            self,
            ordinary=scale * self.ordinary,
            strata={name: scale * size for name, size in self.strata.items()},
            towards={name: scale * size for name, size in self.towards.items()},
            at_corners=scale * self.at_corners,
        )


def build_free(section: Section, layers: Layering, sizes: Sizes, algorithm: int) -> None:
    """Mesh the ``layers`` of a section in the current gmsh model with quadrilaterals of about the ``sizes``.

    Triangles of twice the size are merged to quadrilaterals, and then every cell is divided at the middles of its
    edges. A remaining triangle becomes three convex quadrilaterals, so that no triangle remains and no cell can fold.
    ``algorithm`` is one of ALGORITHMS.
    """
    before_division = sizes.times(2.0)
    surfaces, curves, steps = _geometry(section, layers, before_division)
    _size_field(section, surfaces, curves, before_division, steps)
    if sizes.repeats and has_alike_sides(section.strata, layers):
        _match_sides()
    option = gmsh.option.setNumber
    option("Mesh.MeshSizeFromPoints", 0)
    option("Mesh.MeshSizeExtendFromBoundary", 0)
    option("Mesh.Algorithm", algorithm)
    option("Mesh.RecombineAll", 1)
    # gmsh's "simple" pairing: Blossom (1) left overlapping cells in one random section of eight.
    option("Mesh.RecombinationAlgorithm", 0)
    option("Mesh.RecombineMinimumQuality", 0.3)  # a worse pair is better left as two triangles to divide
    option("Mesh.SubdivisionAlgorithm", 1)
    gmsh.model.mesh.generate(2)


def build_triangles(section: Section, sizes: Sizes, repeats: bool = False) -> None:
    """Mesh the section in the current gmsh model with triangles of about the ``sizes``.

    Edges follow the vertical lines at which the pore pressure changes its slope, since it is linear within a triangle.
    If the section ``repeats``, the right side has the points of the left side.
    """
    kinks = section.cohesion_field.kinks
    layers = section.layering_cut_at(kinks) if len(kinks) else section.layering
    surfaces, curves, _ = _geometry(section, layers, cuts=kinks)
    _size_field(section, surfaces, curves, sizes)
    if repeats:
        _match_sides()
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 5)  # Delaunay: others end the process on some geometries
    gmsh.model.mesh.generate(2)


def _match_sides() -> None:
    """Make gmsh copy the points of the left side to the right side, curve by curve from below upwards."""
    sides = []
    for name in ("left", "right"):
        tag = next(tag for d, tag in gmsh.model.getPhysicalGroups(1) if gmsh.model.getPhysicalName(d, tag) == name)
        curves = [int(curve) for curve in gmsh.model.getEntitiesForPhysicalGroup(1, tag)]
        sides.append(sorted(curves, key=lambda curve: float(gmsh.model.getBoundingBox(1, curve)[1])))
    for left, right in zip(*sides, strict=True):
        low, target = (np.array(gmsh.model.getBoundingBox(1, curve)[:2]) for curve in (left, right))
        x, z = target - low
        gmsh.model.mesh.setPeriodic(1, [right], [left], [1, 0, 0, x, 0, 1, 0, z, 0, 0, 1, 0, 0, 0, 0, 1])


def _geometry(
    section: Section, layers: Layering, sizes: Sizes | None = None, cuts: Sequence[float] | np.ndarray = ()
) -> tuple[dict[int, list[int]], dict[str, list[int]], dict[int, float]]:
    """Return the strata as plane surfaces that share their curves: surfaces by stratum, curves by line, and the heights
    (m) of vertical curves.

    Every edge of a polygon is cut at every corner of another polygon that lies on it. If ``sizes`` are given, layers
    that are thin compared with them get rows of cells. Otherwise vertical lines divide all strata at breakpoints that
    are ``cuts``.
    """
    size = partial(_size_in, section, sizes) if sizes is not None else None
    pieces = {
        (k, piece): polygon
        for k in range(len(section.strata))
        for piece, polygon in enumerate(
            layers.polygons(k, seam_ends(layers, k, partial(size, k)) if size is not None else cuts)
        )
    }
    corners = _corners(section, layers, list(pieces.values()))
    seams = seams_of(pieces, corners, size, layers.tolerance) if size is not None else {}
    corners, own_corners = np.concatenate([corners, *(seam.points() for seam in seams.values())]), corners
    corners = np.unique(corners, axis=0)
    # Points of a seam lie on its lines to rounding; beside the tip of a wedge others are as near as a centimetre.
    is_own = (corners[:, None] == own_corners).all(axis=-1).any(axis=1)
    reach = np.where(is_own, layers.tolerance, ON_LINE * layers.tolerance)
    geo = gmsh.model.geo
    points = [geo.addPoint(x, z, 0.0) for x, z in corners]
    number = {tuple(corner): i for i, corner in enumerate(corners.tolist())}
    lines: dict[tuple[int, int], int] = {}
    owners: dict[tuple[int, int], list[int]] = {}
    surfaces: dict[int, list[int]] = {k: [] for k in range(len(section.strata))}
    for (k, _), polygon in pieces.items():
        ring = _cut_ring(polygon, corners, number, layers.tolerance, reach)
        loop = []
        for start, end in pairwise([*ring, ring[0]]):
            edge = (min(start, end), max(start, end))
            if edge not in lines:
                lines[edge] = geo.addLine(points[edge[0]], points[edge[1]])
            owners.setdefault(edge, []).append(k)
            loop.append(lines[edge] if start < end else -lines[edge])
        surfaces[k].append(geo.addPlaneSurface([geo.addCurveLoop(loop)]))
    geo.synchronize()
    for (k, piece), seam in seams.items():
        _make_rows(seam, surfaces[k][piece], number, lines, points)
    boundaries, interfaces = _named_curves(section, layers, corners, lines, owners)
    name_groups(section, surfaces, boundaries)
    steps = {
        curve: abs(float(corners[start_corner, 1] - corners[end_corner, 1]))
        for (start_corner, end_corner), curve in lines.items()
        if corners[start_corner, 0] == corners[end_corner, 0]
    }
    return surfaces, {**interfaces, "surface": boundaries["surface"], "base": boundaries["base"]}, steps


def _corners(section: Section, layers: Layering, polygons: list[np.ndarray]) -> np.ndarray:
    """Return the corners (n, 2) of all polygons, and the ends of loads on the ground, since an edge has to end there,
    too."""
    ends = np.array([x for load in section.surcharges for x in (load.start, load.end)])
    return np.unique(np.concatenate([np.column_stack([ends, layers.interface(0, ends)]), *polygons]), axis=0)


def _size_in(section: Section, sizes: Sizes, k: int, points: np.ndarray) -> np.ndarray:
    """Return the size (n,) of cells in stratum k at points (n, 2). The stratum is thin, so that all points count as
    near its lines."""
    name, above = section.strata[k].name, section.strata[max(k - 1, 0)].name
    near = [size for line, size in sizes.towards.items() if line in (name, above, "surface", "base")]
    return np.minimum(sizes.at(name, points), min(near, default=np.inf))


def _make_rows(
    seam: Seam,
    surface: int,
    number: dict[tuple[float, float], int],
    lines: dict[tuple[int, int], int],
    points: list[int],
) -> None:
    """Make gmsh fill a thin layer with columns and rows."""

    def curve(start: np.ndarray, end: np.ndarray) -> int:
        first, second = number[tuple(start.tolist())], number[tuple(end.tolist())]
        return lines[min(first, second), max(first, second)]

    for line in (seam.top, seam.bottom):
        for start, end in pairwise(line):
            gmsh.model.mesh.setTransfiniteCurve(curve(start, end), 2)
    for end in (0, -1):
        gmsh.model.mesh.setTransfiniteCurve(curve(seam.bottom[end], seam.top[end]), seam.rows + 1)
    tags = [points[number[tuple(corner.tolist())]] for corner in seam.corners()]
    gmsh.model.mesh.setTransfiniteSurface(surface, cornerTags=tags)
    gmsh.model.mesh.setRecombine(2, surface)


def _cut_ring(
    polygon: np.ndarray,
    corners: np.ndarray,
    number: dict[tuple[float, float], int],
    tolerance: float,
    reach: np.ndarray,
) -> list[int]:
    """Return a polygon as indices of corners, including every corner that lies on one of its edges, nearer than the
    ``reach`` (m) of the corner."""
    ring: list[int] = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = float(np.hypot(*(end - start)))
        at, off = along_and_above(start, end, corners)
        on_edge = np.flatnonzero((off <= reach) & (at > tolerance) & (at < length - tolerance))
        ring.append(number[tuple(start.tolist())])
        ring += on_edge[np.argsort(at[on_edge])].tolist()
    return ring


def _named_curves(
    section: Section,
    layers: Layering,
    corners: np.ndarray,
    lines: dict[tuple[int, int], int],
    owners: dict[tuple[int, int], list[int]],
) -> tuple[dict[str, list[int]], dict[str, list[int]]]:
    """Return the curves of the four boundaries, and of the bottom of every stratum by its name.

    If no ground of the section reaches a side, the last face of the mesh is a face of the ground, and no side.
    """
    left, right = layers.x[0], layers.x[-1]
    heights = section.layering.left[0], section.layering.right[-1]
    has_side = {x: elevation[0] > elevation[-1] for x, elevation in zip((left, right), heights, strict=True)}
    boundaries: dict[str, list[int]] = {"surface": [], "base": [], "left": [], "right": []}
    bottoms: dict[str, list[int]] = {stratum.name: [] for stratum in section.strata}
    for edge, curve in lines.items():
        (x1, z1), (x2, z2) = corners[list(edge)]
        middle = np.array([0.5 * (x1 + x2)])
        if len(owners[edge]) == 2:
            if x1 != x2:
                bottoms[section.strata[min(owners[edge])].name].append(curve)
        elif x1 == x2 and x1 in has_side:
            boundaries[("left" if x1 == left else "right") if has_side[x1] else "surface"].append(curve)
        else:
            elevation = layers.interfaces(middle)[0]
            z = 0.5 * (z1 + z2)
            if x1 == x2:  # a step of the ground or of the base, or what a sliver too thin for points leaves
                i = int(np.argmin(np.abs(layers.x - x1)))
                steps = np.sort([layers.right[i - 1, [0, -1]], layers.left[i, [0, -1]]], axis=0)
                away = np.maximum(np.maximum(steps[0] - z, z - steps[1]), 0.0)
                is_surface = away[0] <= away[1]
            else:
                is_surface = abs(z - elevation[0]) < abs(z - elevation[-1])
            name = "surface" if is_surface else "base"
            boundaries[name].append(curve)
            if name == "base":
                bottoms[section.strata[owners[edge][0]].name].append(curve)
    return boundaries, bottoms


def _size_field(
    section: Section,
    surfaces: dict[int, list[int]],
    curves: dict[str, list[int]],
    sizes: Sizes,
    steps: Mapping[int, float] | None = None,
) -> None:
    """Return gmsh's size field: the smallest of the size of the stratum, the size of its neighbour on a common curve,
    and the sizes at interfaces.

    Cells at vertical ``steps`` (m, by curve) lower than these sizes are twice as large as the step, and grow with the
    distance from it.
    """
    fields = gmsh.model.mesh.field
    numbers = []
    for k, stratum in enumerate(section.strata):
        inside = fields.add("Constant")
        fields.setNumbers(inside, "SurfacesList", surfaces[k])
        fields.setNumber(inside, "VIn", sizes.strata.get(stratum.name, sizes.far_factor * sizes.ordinary))
        numbers.append(inside)
    for name, wanted in sizes.towards.items():
        far = max(sizes.ordinary, wanted)
        numbers.append(_near_field(curves[name], wanted, far, GROWTH_REACH * far))
    for curve, height in (steps or {}).items():
        near = STEP_CELLS * height
        if near < sizes.ordinary:
            numbers.append(_near_field([curve], near, sizes.ordinary, (sizes.ordinary - near) / STEP_GROWTH))
    if len(sizes.corners):
        numbers.append(_view_field(sizes))
    if sizes.far_factor > 1.0:
        numbers.append(_inside_field(section, sizes))
    smallest = fields.add("Min")
    fields.setNumbers(smallest, "FieldsList", numbers)
    fields.setAsBackgroundMesh(smallest)


def _near_field(curves: list[int], near: float, far: float, reach: float) -> int:
    """Return gmsh's size field that is ``near`` at some curves up to a distance ``near``, and grows to ``far`` at the
    distance ``reach`` (all in m); beyond it has no effect.
    """
    fields = gmsh.model.mesh.field
    distance = fields.add("Distance")
    fields.setNumbers(distance, "CurvesList", curves)
    fields.setNumber(distance, "Sampling", 200)
    number = int(fields.add("Threshold"))
    fields.setNumber(number, "InField", distance)
    fields.setNumber(number, "SizeMin", near)
    fields.setNumber(number, "SizeMax", far)
    fields.setNumber(number, "StopAtDistMax", 1)
    fields.setNumber(number, "DistMin", near)
    fields.setNumber(number, "DistMax", reach)
    return number


def _inside_field(section: Section, sizes: Sizes) -> int:
    """Return gmsh's size field that has the ordinary size within the given ends of the section and grows to the far
    size outside."""
    fields = gmsh.model.mesh.field
    number = int(fields.add("Box"))
    (left, right), (low, high) = section.given_extent, (section.outline()[:, 1].min(), section.outline()[:, 1].max())
    far = sizes.far_factor * sizes.ordinary
    values = {
        "VIn": sizes.ordinary, "VOut": far, "XMin": left, "XMax": right, "YMin": low, "YMax": high,
        "ZMin": -1.0, "ZMax": 1.0, "Thickness": (far - sizes.ordinary) / STEP_GROWTH,
    }  # fmt: skip
    for name, value in values.items():
        fields.setNumber(number, name, value)
    return number


def _view_field(sizes: Sizes) -> int:
    """Return gmsh's size field that interpolates the sizes at the corners of triangles."""
    view = gmsh.view.add("sizes")
    count = len(sizes.corners)
    x, z = sizes.corners[..., 0], sizes.corners[..., 1]
    gmsh.view.addListData(view, "ST", count, np.hstack([x, z, np.zeros((count, 3)), sizes.at_corners]).ravel())
    number = int(gmsh.model.mesh.field.add("PostView"))
    gmsh.model.mesh.field.setNumber(number, "ViewTag", view)
    gmsh.model.mesh.field.setNumber(number, "UseClosest", 1)  # for points that rounding puts outside
    return number
