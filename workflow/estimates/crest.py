"""Finds crests of the ground, which are the top of a structure between its feet, and embankments that stand out on both
sides. Computes the settlement of a crest by a slide and by reconsolidation, and the remaining freeboard.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from meshes.section.polyline import points_at

# Share of the height: ground within this distance below the top belongs to the crest, above the foot to the foot.
CREST_DEPTH = 0.1
LEAST_HEIGHT, LEAST_SHARE = 1.0, 0.2  # m, and of the relief of the section: lower humps are no embankments
LEAST_SLOPE = 0.1  # mean rise over run of a face: hills are flatter


@dataclass(frozen=True)
class Crest:
    """Holds the top of a structure; x in m.

    Attributes
    ----------
    start, end : x of the feet of the structure (m)
    left, right : x of the ends of the crest (m); equal if it is a ridge
    elevation : elevation of the highest point of the crest (m)
    """

    start: float
    end: float
    left: float
    right: float
    elevation: float

    @property
    def width(self) -> float:
        """Return the width of the crest (m)."""
        return self.right - self.left


def crest_between(ground: np.ndarray, start: float, end: float) -> Crest:
    """Find the crest of a structure: the ground around its highest point that is lower by less than 10 % of its height.

    A wall at a foot is a face of the structure if the wall rises towards the structure, as that of a quay.

    Parameters
    ----------
    ground (n, 2) : points of the ground surface (m), x ascending
    start, end : x of the feet of the structure (m), inside the ground
    """
    inside = ground[(ground[:, 0] > start) & (ground[:, 0] < end)]
    points = np.vstack([_at_foot(ground, start, 1), inside, _at_foot(ground, end, -1)])
    z = points[:, 1]
    high = z >= z.max() - CREST_DEPTH * np.ptp(z)
    top = int(np.argmax(z))
    low_left, low_right = np.flatnonzero(~high[:top]), np.flatnonzero(~high[top:])
    first = int(low_left[-1]) + 1 if len(low_left) else 0
    last = top + int(low_right[0]) - 1 if len(low_right) else len(z) - 1
    return Crest(start, end, float(points[first, 0]), float(points[last, 0]), float(z.max()))


def _at_foot(ground: np.ndarray, x: float, inwards: int) -> np.ndarray:
    """Return the ground of a structure at its foot at ``x``, from left to right; ``inwards`` is 1 at the left foot, -1
    at the right one."""
    there = points_at(ground, x)[::inwards]
    foot, top = there[0], there[-1]
    return np.array([foot, top])[::inwards] if foot[1] < top[1] else top[None]


def embankments(ground: np.ndarray) -> tuple[Crest, ...]:
    """Find the crests that stand out on both sides.

    The prominence of a crest is its height above the higher one of two points: the lowest ground on its left and on its
    right, as far as the ground is lower than the crest. The crest belongs to an embankment if its prominence is at
    least 1 m and 20 % of the relief of the section, and both faces are steeper than 1 in 10.

    Parameters
    ----------
    ground : points (n, 2) of the ground surface (m), x ascending

    Returns
    -------
    The crests from left to right; of crests whose embankments overlap only the highest one.
    """
    crests: list[Crest] = []
    for crest in sorted(_standing_out(ground), key=lambda bank: -bank.elevation):
        if all(crest.end <= other.start or crest.start >= other.end for other in crests):
            crests.append(crest)
    return tuple(sorted(crests, key=lambda bank: bank.start))


def _standing_out(ground: np.ndarray) -> Iterator[Crest]:
    z = ground[:, 1]
    least = max(LEAST_HEIGHT, LEAST_SHARE * float(np.ptp(z)))
    for top in range(1, len(z) - 1):
        before, after = z[:top][::-1], z[top + 1 :]  # from the top outwards
        before = before[: int(np.argmax(before >= z[top]))] if (before >= z[top]).any() else before
        after = after[: int(np.argmax(after > z[top]))] if (after > z[top]).any() else after
        if not len(before) or not len(after):
            continue
        base = max(before.min(), after.min())
        height = z[top] - base
        if height < least:
            continue
        start = _foot(ground[: top + 1][::-1], base, height)
        crest = crest_between(ground, start, _foot(ground[top:], base, height))
        run = max(crest.left - crest.start, crest.end - crest.right)
        if height >= LEAST_SLOPE * run:
            yield crest


def _foot(points: np.ndarray, base: float, height: float) -> float:
    """Return x where the ground, followed from the top (the first of the ``points``), reaches the elevation
    ``base``."""
    k = int(np.argmax(points[:, 1] <= base + CREST_DEPTH * height))
    (x0, z0), (x1, z1) = points[k - 1], points[k]
    return float(x1 if z1 >= base - CREST_DEPTH * height else x0 + (x1 - x0) * (z0 - base) / (z0 - z1))


PLACES = 401  # of the crest's width between the feet


def crest_level(surface: np.ndarray, crest: Crest) -> float | None:
    """Return the elevation of the highest ground as wide as the crest between the feet of a structure.

    Water flows over a structure where its highest ground is lower than the water. The level is a mean over the width of
    the crest, because a surface of discs is rough. The highest place counts, because a crest that moved sideways still
    retains water.

    Parameters
    ----------
    surface (n, 2) : points of the ground surface (m), before or after a slide
    crest : the crest as it was before the slide

    Returns
    -------
    Elevation (m); None if the surface does not reach from foot to foot.
    """
    line = surface[np.argsort(surface[:, 0], kind="stable")]
    if not len(line) or line[0, 0] > crest.left or line[-1, 0] < crest.right:
        return None
    start, end = max(crest.start, line[0, 0]), min(crest.end, line[-1, 0])
    places = np.linspace(start, end, PLACES)
    x = np.unique(np.concatenate([places, line[:, 0].clip(start, end), [crest.left, crest.right]]))
    z = np.interp(x, *line.T)
    if crest.width <= 0.0:
        return float(z.max())
    area = np.concatenate([[0.0], np.cumsum(0.5 * (z[1:] + z[:-1]) * np.diff(x))])
    first = x[x <= end - crest.width + 1e-9]
    return float(np.max((np.interp(first + crest.width, x, area) - np.interp(first, x, area)) / crest.width))


def crest_settlement(before: np.ndarray, after: np.ndarray, crest: Crest) -> float | None:
    """Return the decrease of the highest level of a structure by a slide.

    Parameters
    ----------
    before, after : (n, 2) ndarray
        Points of the ground surface (m).
    crest : Crest

    Returns
    -------
    Settlement (m), down positive; None if a surface does not reach over the crest.
    """
    was, became = crest_level(before, crest), crest_level(after, crest)
    return None if was is None or became is None else was - became


def reconsolidation_settlement(thickness: Sequence[float], volumetric_strain: Sequence[float]) -> float:
    """Return the settlement of level ground as the excess pore pressure drains: S = Σ ε_v Δh.

    Only vertical strain is considered (K. Ishihara & M. Yoshimine, Soils and Foundations 32 (1992) 173-188; I. M.
    Idriss & R. W. Boulanger, Soil Liquefaction during Earthquakes, EERI MNO-12, 2008, section 4.4).

    Parameters
    ----------
    thickness : thickness of the liquefied layers below the crest (m)
    volumetric_strain : volumetric strain of each layer (-)

    Returns
    -------
    Settlement (m), down positive.
    """
    return float(sum(h * strain for h, strain in zip(thickness, volumetric_strain, strict=True)))


def freeboard(elevation: float, settlement: float, water: float) -> float:
    """Return the height of a crest above the water after the earthquake.

    Parameters
    ----------
    elevation : elevation of the crest before the earthquake (m)
    settlement : settlement of the crest (m), down positive
    water : elevation of the water beside the structure (m)

    Returns
    -------
    Freeboard (m); negative if water flows over the crest.
    """
    return elevation - settlement - water
