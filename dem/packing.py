"""Makes initial packings: triangular lattices and random packings inside any polygon, with their boundary.

A polygon is given by its corners (n, 2) in m, counter-clockwise, as by `Section.outline`; edges that run from right to
left are the free surface, all others are walls. Boundary discs are outside the walls and touch them; rigid lines touch
the boundary discs on the outside.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.kernels.neighbours import pairs_within
from dem.kernels.period import NO_PERIOD, Period
from dem.kernels.pushing_apart import clearance, deepest_in_pairs, spread_out
from dem.model import DiscModel

StratumAt = Callable[[np.ndarray, np.ndarray], np.ndarray]

ROW = np.sqrt(0.75)  # height of a row of a triangular lattice over its spacing
OVERLAP = 0.01  # of the mean radius, that random packings are left with at most
SWEEPS = 4000  # that push discs apart, at most
WALL_ROWS = 4  # by which side walls are higher than the surface


@dataclass(frozen=True)
class Packing:
    """Holds initial positions and radii of discs, with their boundary.

    Attributes
    ----------
    x, z (n,) : coordinates of the centres (m)
    radius (n,) : radii (m)
    layer (n,) : number of the layer of each disc, -1 for boundary discs
    lines (k, 6) : rigid lines, see DiscModel
    period (length, rise) : length (m) of the period, and height (m) by which the ground is higher one period to the
        right
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    layer: np.ndarray
    lines: np.ndarray
    period: tuple[float, float] | None = None

    @property
    def free(self) -> np.ndarray:
        """Return a mask of the discs that can move."""
        return self.layer >= 0

    def discs(
        self, materials: DiscMaterials, *, gravity: tuple[float, float] = (0.0, 0.0), skin: float | None = None
    ) -> DiscModel:
        """Return the packing as a model, see `DiscModel.create`."""
        geometry = DiscGeometry(self.x, self.z, self.radius, self.layer)
        boundary = DiscBoundary(self.lines, period=self.period)
        return DiscModel.create(geometry, materials, boundary, gravity=gravity, skin=skin)


def lattice_box(columns: int, rows: int, radius: float) -> Packing:
    """Arrange rows with alternately columns - 1 and columns discs, from the bottom, in a box of boundary discs without
    a lid.

    133 columns and 24 rows give the 3180 elements and 189 boundary elements of the paper (Sec. 3(3)). All discs are in
    layer 0.
    """
    if columns < 3 or rows < 1:
        raise ValueError(f"a box needs at least 3 columns and a row, not {columns} and {rows}")
    step = 2.0 * radius
    xs, zs, layers = [], [], []
    for row in range(-1, rows + WALL_ROWS):
        shift = 0.5 * ((row + 1) % 2)
        count = columns - (row + 1) % 2
        inside = (np.arange(count) + shift) * step
        sides = np.array([-1.0 + shift, count + shift]) * step
        line = np.concatenate([inside if row < rows else [], sides if row >= 0 else []])
        xs.append(line)
        zs.append(np.full(len(line), row * ROW * step))
        moving = count if 0 <= row < rows else 0
        layers.append(np.where(np.arange(len(line)) < moving, 0, -1))
    low, left, right = -ROW * step - radius, -step - radius, columns * step + radius
    high = 1e3 * step * rows
    lines = np.array([
        [0.5 * (left + right), low, 0.0, 1.0, left - right, right - left],
        [left, low, 1.0, 0.0, -4.0 * radius, high],
        [right, low, -1.0, 0.0, -high, 4.0 * radius],
    ])  # fmt: skip
    x, z, layer = np.concatenate(xs), np.concatenate(zs), np.concatenate(layers).astype(np.int32)
    return Packing(x, z, np.full(len(x), radius), layer, lines)


def triangular_lattice(outline: np.ndarray, stratum_at: StratumAt, radius: float, *, angle: float = 0.0) -> Packing:
    """Arrange equal discs on a triangular lattice whose rows are inclined by `angle` (rad); all discs that are entirely
    inside the outline.

    outline: (n, 2) polygon (m); stratum_at: number of the stratum at points x, z; radius: radius of the discs (m).
    Raises ValueError if no disc is inside.
    """
    outline = _checked_outline(outline)
    c, s = np.cos(angle), np.sin(angle)
    rotated = outline @ np.array([[c, -s], [s, c]])
    low, high = rotated.min(axis=0) + radius, rotated.max(axis=0) - radius
    row = np.arange(max(0, int((high[1] - low[1]) / (2.0 * radius * ROW) + 1e-9) + 1))
    column = np.arange(max(0, int((high[0] - low[0]) / (2.0 * radius) + 1e-9) + 1))
    u = (low[0] + 2.0 * radius * (column[None, :] + 0.5 * (row[:, None] % 2))).ravel()
    v = np.repeat(low[1] + 2.0 * radius * ROW * row, len(column))
    x, z = c * u - s * v, s * u + c * v
    inside = clearance(x, z, outline) >= radius * (1.0 - 1e-9)
    if not inside.any():
        raise ValueError(f"no disc of radius {radius} m fits into the outline")
    x, z = x[inside], z[inside]
    return _with_boundary(x, z, np.full(len(x), radius), outline, stratum_at)


def random_packing(
    outline: np.ndarray,
    stratum_at: StratumAt,
    radius: float,
    *,
    spread: float = 0.2,
    porosity: float = 0.2,
    seed: int = 0,
) -> Packing:
    """Pack discs of random radii at random places; they grow in steps and are pushed apart until overlaps are small.

    Parameters
    ----------
    outline (n, 2) : corners of a polygon (m), counter-clockwise; edges to the left are the free surface
    stratum_at : function of x and z (m) of n places; numbers (n,) of their strata, -1 outside
    radius : mean radius (m)
    spread : half the width of the uniform distribution of radii over the mean
    porosity : area of the voids over the area of the outline
    seed : seed of the random numbers; equal seeds give equal packings

    Returns
    -------
    The discs inside the outline, then boundary discs of mean radius outside its walls, with rigid lines. No overlap is
    larger than `OVERLAP` times the mean radius.

    Raises
    ------
    ValueError
        If the discs do not fit (packings in the plane jam at a porosity of about 0.16), the outline is no polygon, or
        spread or porosity is out of range.
    """
    outline = _checked_outline(outline)
    x, z, sizes = _grown_discs(outline, outline, NO_PERIOD, (radius, spread, porosity), seed)
    return _with_boundary(x, z, sizes, outline, stratum_at)


def periodic_packing(
    lower: np.ndarray,
    upper: np.ndarray,
    stratum_at: StratumAt,
    radius: float,
    *,
    spread: float = 0.2,
    porosity: float = 0.2,
    seed: int = 0,
) -> Packing:
    """Pack discs of random size, as `random_packing` does, in ground whose right side continues at its left side.

    There are neither boundary discs nor rigid lines.

    Parameters
    ----------
    lower, upper (n, 2) : corners of base and surface from left to right (m), between the same two x, both with the same
        rise from end to end
    stratum_at, radius, spread, porosity, seed : as of `random_packing`

    Returns
    -------
    The discs, with length and rise of the period (m).

    Raises
    ------
    ValueError
        If the discs do not fit, or if one line rises by more than the other from end to end.
    """
    length, rise = upper[-1] - upper[0]
    if not np.allclose(lower[-1] - lower[0], (length, rise)):
        raise ValueError("periodic ground: expected the same rise from left to right at the base and at the surface")
    shift = np.array([length, rise])
    walls = np.vstack([_with_images(lower, shift), _with_images(upper, shift)[::-1]])
    outline = np.vstack([lower, upper[::-1]])
    period = Period(float(length), float(rise))
    x, z, sizes = _grown_discs(outline, walls, period, (radius, spread, porosity), seed)
    layer = _known_strata(x, z, stratum_at)
    return Packing(x, z, sizes, layer, np.zeros((0, 6)), (float(length), float(rise)))


def _with_images(line: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return a line with its images one period to the left and one to the right."""
    return np.vstack([line - shift, line[1:], line[1:] + shift])


def _grown_discs(
    outline: np.ndarray, walls: np.ndarray, period: Period, grains: tuple[float, float, float], seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return positions and radii of discs of random size in an outline, pushed apart until overlaps are small.

    outline, walls: polygons (m) in which discs are initially placed, and which they may not leave; they differ for
    periodic ground; grains: mean radius (m), spread and porosity.
    """
    radius, spread, porosity = grains
    if not (0.0 <= spread < 1.0 and 0.0 < porosity < 1.0):
        raise ValueError(f"a spread of {spread} or a porosity of {porosity} is not possible: both are between 0 and 1")
    rng = np.random.default_rng(seed)
    room = _area(outline) * (1.0 - porosity)
    count = round(room / (np.pi * radius**2 * (1.0 + spread**2 / 3.0)))
    if count < 1:
        raise ValueError(f"no disc of radius {radius} m fits into the outline")
    sizes = radius * rng.uniform(1.0 - spread, 1.0 + spread, count)
    sizes *= np.sqrt(room / np.sum(np.pi * sizes**2))
    x, z = _scatter(rng, outline, count)
    fixed = np.zeros(count, bool)
    left = float(outline[:, 0].min())
    deepest = np.inf
    for sweep in range(0, SWEEPS, 10):
        grown = sizes * min(1.0, 0.5 + 1.25 * sweep / SWEEPS)
        i, j = pairs_within(x, z, grown, fixed, 0.5 * radius, period)
        spread_out(x, z, grown, i, j, walls, 10, period)
        x, z = brought_back(x, z, left, period)
        deepest = max(deepest_in_pairs(x, z, grown, i, j, period), float(np.max(grown - clearance(x, z, walls))))
        if grown[0] == sizes[0] and deepest <= OVERLAP * radius:
            break
    if deepest > OVERLAP * radius:
        raise ValueError(
            f"{count} discs for a porosity of {porosity:g} still overlap by {deepest / radius:.3g} of their mean "
            f"radius after {SWEEPS} sweeps, {OVERLAP:g} is allowed: use a larger porosity, or a wider spread"
        )
    return x, z, sizes


def brought_back(x: np.ndarray, z: np.ndarray, left: float, period: Period) -> tuple[np.ndarray, np.ndarray]:
    """Return the images of positions in the period that begins at a given x.

    Parameters
    ----------
    x, z (n,) : positions (m)
    left : x at which the period begins (m)
    period : length along x and rise along z of a period (m)

    Returns
    -------
    x and z (n,) of the images (m); the positions themselves if the period is infinite.
    """
    if period.length == NO_PERIOD.length:
        return x, z
    times = np.floor((x - left) / period.length)
    return x - times * period.length, z - times * period.rise


def one_stratum(x: np.ndarray, _z: np.ndarray) -> np.ndarray:
    """Return stratum 0 for every place: the ``stratum_at`` of homogeneous ground.

    Parameters
    ----------
    x, _z (n,) : places (m)

    Returns
    -------
    Zeros (n,).
    """
    return np.zeros(len(x), np.int32)


def densest(pack: Callable[[float], Packing], porosities: Iterable[float]) -> Packing:
    """Return the packing of the first of some rising porosities at which the discs fit.

    Parameters
    ----------
    pack : function of a porosity that makes a packing, or raises ValueError if the discs do not fit
    porosities : porosities to be tried, in this order

    Returns
    -------
    The packing.

    Raises
    ------
    ValueError
        If the discs fit at no porosity; the error is that of the last porosity.
    """
    for porosity in porosities:
        try:
            return pack(porosity)
        except ValueError as error:
            refused = error
    raise refused


def boundary(outline: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres (n, 2) of boundary discs outside the walls, `WALL_ROWS` rows higher at the sides, and rigid
    lines.

    Boundary discs are a diameter apart or a little less. At convex corners the lines extend past each other.
    """
    outline = _checked_outline(outline)
    edge = np.roll(outline, -1, axis=0) - outline
    length = np.hypot(*edge.T)
    keep = length > 1e-9
    corners, edge, length = outline[keep], edge[keep], length[keep]
    along = edge / length[:, None]
    outward = np.column_stack([along[:, 1], -along[:, 0]])
    wall = along[:, 0] > -1e-9  # a vertical side runs neither way, and a vertical step of the surface is no wall
    on_top = ~wall
    wall &= ~(np.roll(on_top, 1) & np.roll(on_top, -1))
    higher = WALL_ROWS * 2.0 * radius * ROW
    far = 10.0 * float(np.ptp(outline[:, 1])) + 100.0 * radius
    centres, lines = [], []
    n = len(corners)
    for k in np.flatnonzero(wall):
        before, after = (k - 1) % n, (k + 1) % n
        start, end = 0.0, length[k]
        open_start, open_end = not wall[before], not wall[after]
        # offset lines of neighbouring walls meet further out at corners that point outwards, further in at others
        reach = [radius * _half_angle_tangent(along[a], along[b]) for a, b in ((before, k), (k, after))]
        start -= higher if open_start else reach[0]
        end += higher if open_end else reach[1]
        pieces = max(1, int(np.ceil((end - start) / (2.0 * radius) - 1e-9)))
        # the end of a wall is the beginning of the next one
        spots = np.linspace(start, end, pieces + 1)[: None if open_end else -1]
        centres.append(corners[k] + radius * outward[k] + spots[:, None] * along[k])
        past = [far if is_open else max(0.0, 4.0 * radius if r >= 0.0 else 2.0 * r)
                for is_open, r in zip((open_start, open_end), reach, strict=True)]  # fmt: skip
        point = corners[k] + 2.0 * radius * outward[k]
        lines.append([*point, *-outward[k], -length[k] - past[1], past[0]])
    return np.concatenate(centres), np.array(lines)


def _half_angle_tangent(first: np.ndarray, second: np.ndarray) -> float:
    """Return the tangent of half the angle between two edges, positive at convex corners."""
    cross = first[0] * second[1] - first[1] * second[0]
    return float(cross / (1.0 + first @ second))


def _with_boundary(
    x: np.ndarray, z: np.ndarray, radius: np.ndarray, outline: np.ndarray, stratum_at: StratumAt
) -> Packing:
    layer = _known_strata(x, z, stratum_at)
    mean = float(radius.mean())
    centres, lines = boundary(outline, mean)
    return Packing(
        np.concatenate([x, centres[:, 0]]), np.concatenate([z, centres[:, 1]]),
        np.concatenate([radius, np.full(len(centres), mean)]),
        np.concatenate([layer, np.full(len(centres), -1, np.int32)]), lines,
    )  # fmt: skip


def _known_strata(x: np.ndarray, z: np.ndarray, stratum_at: StratumAt) -> np.ndarray:
    """Return the strata of discs; discs outside all strata get the stratum of the nearest disc inside one."""
    layer = np.asarray(stratum_at(x, z), np.int32)
    if (layer < 0).all():
        raise ValueError("stratum_at gives no stratum for any disc inside the outline")
    for a in np.flatnonzero(layer < 0):
        known = np.flatnonzero(layer >= 0)
        layer[a] = layer[known[np.argmin((x[known] - x[a]) ** 2 + (z[known] - z[a]) ** 2)]]
    return layer


def _area(outline: np.ndarray) -> float:
    x, z = outline.T
    return 0.5 * float(np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


def _checked_outline(outline: np.ndarray) -> np.ndarray:
    outline = np.ascontiguousarray(outline, float)
    if outline.ndim != 2 or outline.shape[1] != 2 or len(outline) < 3 or not np.isfinite(outline).all():
        raise ValueError("outline: expected at least three finite corners (n, 2)")
    if not _area(outline) > 0.0:
        raise ValueError("outline: expected corners in counter-clockwise order, which enclose an area")
    return outline


def _scatter(rng: np.random.Generator, outline: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return evenly spaced points in the outline, by Roberts's R2 sequence from a random start, each shifted a little.

    The points are evenly spaced because pushing discs apart removes density variations over many discs only very
    slowly.
    """
    low, high = outline.min(axis=0), outline.max(axis=0)
    plastic = 1.32471795724474602596  # root of x**3 = x + 1
    start, n = rng.uniform(size=2), 0
    points = np.zeros((0, 2))
    share = _area(outline) / float(np.prod(high - low))
    total = int(count / share) + 1
    shift = 0.25 * np.sqrt(_area(outline) / count)
    while len(points) < count:
        k = np.arange(n, n + total)[:, None]
        more = low + (start + k * np.array([1.0 / plastic, 1.0 / plastic**2])) % 1.0 * (high - low)
        more += rng.uniform(-shift, shift, more.shape)
        points = np.concatenate([points, more[clearance(more[:, 0], more[:, 1], outline) > 0.0]])
        n, total = n + total, 16
    return points[:count, 0].copy(), points[:count, 1].copy()
