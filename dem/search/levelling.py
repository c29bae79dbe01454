"""Levels the surface of soil discs to that of the section: discs above the surface are removed, and hollows are filled.

A removed disc leaves a hollow of its size, into which its neighbours slide. Therefore a new disc is added wherever
there is room for it on two other discs. The new disc gets the radius, within the spread of the packing, with which its
top is nearest to the surface. If no new disc fits into a column, one of its discs is exchanged for others. Positions,
radii and order follow from the discs, not from random numbers.
"""

import numpy as np
from scipy.spatial import cKDTree

from dem.model import DiscModel
from dem.packing import Packing
from meshes.section.section import Section

# Mean radii: largest height of the top of a disc above the surface, for remaining and for inserted discs.
LARGEST_PROTRUSION = 0.4
# Mean radii: deviation of a column from the surface above which a disc is exchanged; half a radius is allowed at rest.
EXCHANGE_DEVIATION = 0.3
SEARCH_DEPTH = 4.0  # mean radii below the surface in which supporting discs are searched for
TRIAL_RADII = 9  # per position
NEIGHBOURS = 8  # discs around a position that are considered
INSERTION_OVERLAP = 0.02  # mean radii: overlap of an inserted disc with others, as that of discs at rest under weight


def misfit(section: Section, model: DiscModel, radius: float) -> np.ndarray:
    """Return the height of the discs above the surface of the section, by columns.

    The value of a column, two diameters wide or a little less, is the largest height of the top of one of its discs
    above the surface vertically below this top. (Across a column a face may fall by more than the tolerance.)

    Parameters
    ----------
    section : ground with the surface
    model : the discs; fixed discs, and discs beyond the sides, are left out
    radius : mean radius of the discs (m)

    Returns
    -------
    Height (columns,) in m, negative below the surface; empty columns are left out.
    """
    left, right = section.extent
    free = ~model.fixed & (model.x >= left) & (model.x <= right)
    above = _columns(section, np.column_stack([model.x, model.z, model.radius])[free], radius)
    return above[np.isfinite(above)]


def levelled(section: Section, packing: Packing, radius: float, spread: float) -> Packing:
    """Return the packing without the discs whose tops are above the surface, and with its hollows filled.

    The free discs of this packing have no stratum yet (number 0): the caller assigns each to the stratum in which it
    lies. section: the ground; radius: mean of the discs (m); spread: half the width of the
    range of radii over the mean.
    """
    discs = np.column_stack([packing.x, packing.z, packing.radius])
    fixed, discs = discs[~packing.free], discs[packing.free]
    discs = discs[_heights_above_surface(section, discs) <= LARGEST_PROTRUSION * radius]
    left, right = section.extent
    ends, around = (left, right), fixed
    if packing.period is not None:
        # as far from the sides that discs laid in at one do not reach those at the other
        ends = left + (1.0 + spread) * radius, right - (1.0 + spread) * radius
        around = np.vstack([fixed, _images(np.vstack([fixed, discs]), packing.period, (left, right), radius)])
    laid = _fillings(section, np.vstack([around, discs]), ends, radius, spread)
    discs = _exchanged_discs(section, around, np.vstack([discs, laid]), ends, radius, spread)
    layer = np.append(np.full(len(fixed), -1, np.int32), np.zeros(len(discs), np.int32))
    x, z, size = np.vstack([fixed, discs]).T
    return Packing(x.copy(), z.copy(), size.copy(), layer, packing.lines, packing.period)


def _images(discs: np.ndarray, period: tuple[float, float], extent: tuple[float, float], radius: float) -> np.ndarray:
    """Return images (n, 3) of the discs of periodic ground, in which discs near one side are repeated beyond the
    other."""
    shift = np.array([*period, 0.0])
    near_left, near_right = (
        discs[:, 0] < extent[0] + SEARCH_DEPTH * radius,
        discs[:, 0] > extent[1] - SEARCH_DEPTH * radius,
    )
    return np.vstack([discs[near_left] + shift, discs[near_right] - shift])


def _exchanged_discs(
    section: Section,
    fixed: np.ndarray,
    discs: np.ndarray,
    allowed: tuple[float, float],
    radius: float,
    spread: float,
) -> np.ndarray:
    """Return the discs after one disc of each deviating column is removed and its gap is filled.

    The disc is removed whose exchange brings the column and its neighbours nearest to the surface; no disc is removed
    if no exchange improves them. ``allowed`` is the range of x (m) in which the centres of new discs may lie.
    """
    left, right = section.extent
    above = _columns(section, discs, radius)
    width = (right - left) / len(above)
    for column in np.flatnonzero(np.abs(above) > EXCHANGE_DEVIATION * radius):
        sides = slice(max(0, column - 1), column + 2)
        begin, end = left + column * width, left + (column + 1) * width
        ends = max(allowed[0], begin - width), min(allowed[1], end + width)
        near, around = (
            np.flatnonzero((group[:, 0] > begin - 4.0 * width) & (group[:, 0] < end + 4.0 * width))
            for group in (discs, fixed)
        )
        high = _heights_above_surface(section, discs[near]) > -0.5 * SEARCH_DEPTH * radius
        inside = (discs[near, 0] > begin - radius) & (discs[near, 0] < end + radius)
        least, best = np.abs(_columns(section, discs, radius)[sides]).max(), discs
        for gone in near[high & inside]:
            rest = discs[near[near != gone]]
            laid = _fillings(section, np.vstack([fixed[around], rest]), ends, radius, spread)
            off = np.abs(_columns(section, np.vstack([rest, laid]), radius)[sides]).max()
            if off < least - 1e-9:
                least, best = off, np.vstack([np.delete(discs, gone, axis=0), laid])
        discs = best
    return discs


def _columns(section: Section, discs: np.ndarray, radius: float) -> np.ndarray:
    """Return the height (m) of the discs (x, z, radius) of each column above the surface, minus infinity in empty
    columns."""
    left, right = section.extent
    count = max(1, int(np.ceil((right - left) / (4.0 * radius))))
    column = np.floor((discs[:, 0] - left) / (right - left) * count).astype(int)
    highest = np.full(count, -np.inf)
    np.maximum.at(highest, np.clip(column, 0, count - 1), _heights_above_surface(section, discs))
    return highest


def _fillings(
    section: Section, discs: np.ndarray, ends: tuple[float, float], radius: float, spread: float
) -> np.ndarray:
    """Return the new discs (n, 3: centre and radius) that rest on two others each, those with tops nearest to the
    surface first.

    ``ends`` is the range of x (m) in which the centres of the new discs may lie.
    """
    # behind a steep face discs lie deep below their own surface and yet beside the places at its toe
    lowest = np.min(
        [_surface_at(section, discs[:, 0] + SEARCH_DEPTH * offset) for offset in (-radius, 0.0, radius)], axis=0
    )
    discs_near_surface = discs[discs[:, 1] > lowest - SEARCH_DEPTH * radius]
    sizes = radius * (np.linspace(1.0 - spread, 1.0 + spread, TRIAL_RADII) if spread > 0.0 else np.ones(1))
    laid = np.zeros((0, 3))
    places = _resting_positions(discs_near_surface, np.arange(len(discs_near_surface)), sizes)
    while True:
        at_surface = np.abs(_heights_above_surface(section, places)) <= LARGEST_PROTRUSION * radius
        places = places[at_surface & (places[:, 0] >= ends[0]) & (places[:, 0] <= ends[1])]
        places = places[_fitting(places, discs_near_surface, radius)]
        if not len(places):
            return laid
        away = np.round(np.abs(_heights_above_surface(section, places)), 9)
        best = places[np.lexsort((places[:, 0], away))[:1]]
        laid, discs_near_surface = np.vstack([laid, best]), np.vstack([discs_near_surface, best])
        places = np.vstack(
            [places, _resting_positions(discs_near_surface, np.array([len(discs_near_surface) - 1]), sizes)]
        )


def _resting_positions(discs: np.ndarray, of: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Return the positions of new discs of given radii that rest on one of the discs `of` and on another disc, one on
    either side.
    """
    tree = cKDTree(discs[:, :2])
    reach = 2.0 * sizes.max() + 2.0 * discs[:, 2].max()
    pairs = {
        (min(a, b), max(a, b))
        for a, others in zip(of.tolist(), tree.query_ball_point(discs[of, :2], reach), strict=True)
        for b in others
        if a != b
    }
    if not pairs:
        return np.zeros((0, 3))
    first, second = np.array(sorted(pairs)).T
    swap = discs[first, 0] > discs[second, 0]
    first, second = np.where(swap, second, first), np.where(swap, first, second)
    a, b = discs[first][:, None, :], discs[second][:, None, :]
    size = np.broadcast_to(sizes, (len(first), len(sizes)))
    along = b[..., :2] - a[..., :2]
    apart = np.maximum(np.hypot(along[..., 0], along[..., 1]), 1e-9)
    from_a, from_b = a[..., 2] + size, b[..., 2] + size
    share = (apart**2 + from_a**2 - from_b**2) / (2.0 * apart)
    square = from_a**2 - share**2
    ex, ez = along[..., 0] / apart, along[..., 1] / apart
    height = np.sqrt(np.maximum(square, 0.0))
    x, z = a[..., 0] + share * ex - height * ez, a[..., 1] + share * ez + height * ex
    rests = (square > 0.0) & (x > a[..., 0]) & (x < b[..., 0])
    return np.column_stack([x[rests], z[rests], size[rests]])


def _fitting(places: np.ndarray, discs: np.ndarray, radius: float) -> np.ndarray:
    """Return the mask of new discs that overlap no other disc."""
    apart, near = cKDTree(discs[:, :2]).query(places[:, :2], k=range(1, min(NEIGHBOURS, len(discs)) + 1))
    gap = apart - places[:, 2:] - discs[near, 2]
    return np.asarray(gap.min(axis=1) >= -INSERTION_OVERLAP * radius)


def _heights_above_surface(section: Section, discs: np.ndarray) -> np.ndarray:
    """Return the height (m) of the tops of discs (x, z, radius) above the surface vertically below them, negative below
    it."""
    return np.asarray(discs[:, 1] + discs[:, 2] - _surface_at(section, discs[:, 0]))


def _surface_at(section: Section, x: np.ndarray) -> np.ndarray:
    return np.interp(x, *section.ground.T)
