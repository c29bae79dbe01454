"""Finds the critical slip circle of a section by Bishop's simplified method, and applies Spencer's method to the same
circle.

All circles through two points of the ground are tried on a grid, then on ever finer grids around the best circle. The
search is for the least factor of safety, or for the least Kh at which the factor is 1, in both directions.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshes.section.section import Section
from meshes.section.simplified import needed
from meshes.section.tension_crack import TensionCrack
from workflow.estimates.slice_methods import bishop_critical_kh, bishop_factor, spencer_critical_kh, spencer_factor
from workflow.estimates.slices import LEFT, RIGHT, Slices, divide, loaded_by_crack

GROUND_POINTS, CIRCLES_PER_PAIR = 41, 16  # points of the ground, and circles through a pair of them, on the first grid
# The corners of the ground are points of the first grid, too. Of a surveyed ground with hundreds of points it has only
# those that the shape needs, and more of its circles are refined, since their ends are between the others.
MOST_CORNERS, SMALLEST_BEND = 80, 1e-4  # the latter as a share of the height of the section
SLICES, FINE_SLICES = 40, 200  # of a circle on the first grids, and on the last ones
# Circles that are refined, and how often, with either number of slices.
COARSE_CIRCLES, COARSE_CIRCLES_OF_MANY_CORNERS, COARSE_ROUNDS = 6, 30, 3
FINE_CIRCLES, FINE_ROUNDS = 2, 4
STEP_REDUCTION = 0.45  # ratio of consecutive steps
CIRCLES_AT_A_TIME = 4000  # circles at a time, on the first grid
FEW_POINTS = 8  # intervals between the points of a circle that are checked first
STEEPEST_BASE = np.radians(80.0)  # inclination of the base: steeper bases would be in tension
OUT, INTO = np.radians((30.0, 60.0))  # slopes at which a slip surface that ends below the ground is taken to it
# Shallower circles than this share of the height of the section, and than this depth (m), are the infinite slope's.
LEAST_DEPTH, LARGEST_LEAST_DEPTH = 0.02, 1.0
EDGE_SHARE = 1e-7  # of the length of the section, by which at least a circle reaches over the edge of a crest
LEVEL_SHARE = 1e-7  # of the length of the section, by which heights differ in level ground
FEWEST_POINTS = 3  # of a slip surface

NO_CRACK = TensionCrack()


@dataclass(frozen=True, eq=False)
class SlipCircle:
    """Holds a slip circle with its factors of safety or critical Kh.

    Attributes
    ----------
    towards : the side of the section to which it slides, "left" or "right"
    centre : (x, z) of its centre (m)
    radius : radius (m)
    surface (n, 2) : points of the slip surface from left to right (m), including the tension crack
    kh : seismic coefficient to which ``bishop`` and ``spencer`` belong if they are factors of safety; None if they are
        critical Kh
    bishop : factor of safety, or critical Kh, by Bishop's simplified method
    spencer : factor of safety, or critical Kh, by Spencer's method on the same circle; None if forces and moments do
        not balance
    frictionless : whether no base has friction; normal forces then have no moment about the centre, and strength alone
        gives the factor by every method that balances moments
    """

    towards: Literal["left", "right"]
    centre: tuple[float, float]
    radius: float
    surface: np.ndarray
    kh: float | None
    bishop: float
    spencer: float | None
    frictionless: bool = False


def critical_circle(
    section: Section,
    towards: int,
    kh: float | None = 0.0,
    least_depth: float = 0.0,
    vertical: float = 0.0,
    crest: tuple[float, float] | None = None,
    crack: TensionCrack = NO_CRACK,
) -> SlipCircle | None:
    """Find, towards one side, the slip circle with the least factor of safety or with the least critical Kh.

    Parameters
    ----------
    section : strata cut at the water, as `Section.parse` returns them
    towards : LEFT or RIGHT, the side to which the mass slides
    kh : horizontal seismic coefficient at which the factor of safety is sought; None to seek the least Kh at which the
        factor is 1, with excess pore pressures by shaking
    least_depth : smallest depth of circles (m); at least 2 % of the height of the section, or 1 m of a higher one
    vertical : vertical seismic coefficient, positive upwards
    crest (left, right) : positions x (m) of the ends of a crest, of which at least a part has to slide; None for any
        circle
    crack : depth of the crack at which circles end, and the water in it

    Returns
    -------
    The circle; None if no circle slides.
    """
    depth = max(least_depth, min(LEAST_DEPTH * float(np.ptp(section.outline()[:, 1])), LARGEST_LEAST_DEPTH))
    return _CircleSearch(section, towards, kh, depth, vertical, crest, crack).run()


def surface_balance(
    section: Section, line: np.ndarray, towards: int, kh: float | None = 0.0, vertical: float = 0.0
) -> float | None:
    """Return Spencer's factor of safety, or critical Kh, of any slip surface.

    Parameters
    ----------
    section : strata cut at the water
    line (n, 2) : points of the slip surface (m), x ascending; its ends are extended to the ground
    towards : LEFT or RIGHT, the side to which the mass slides
    kh, vertical : as for `critical_circle`

    Returns
    -------
    Factor of safety or critical Kh; None if forces and moments do not balance.
    """
    line = _to_the_ground(section, line, towards)
    x = np.linspace(line[0, 0], line[-1, 0], FINE_SLICES + 1)
    z = np.minimum(np.interp(x, *line.T), section.layering.interface(0, x))
    slices = divide(section, x[None], z[None], towards, seismic=kh != 0.0, vertical=vertical)
    return _by_spencer(slices, kh)


def least_balance(section: Section, line: np.ndarray, kh: float | None = 0.0, vertical: float = 0.0) -> float | None:
    """Return the smaller of Spencer's factors of safety, or critical Kh, of a slip surface towards both sides.

    Parameters
    ----------
    section, line, kh, vertical : as for `surface_balance`

    Returns
    -------
    Factor of safety or critical Kh; None for a line of fewer than three points, or if forces and moments balance
    towards neither side.
    """
    if len(line) < FEWEST_POINTS:
        return None
    balances = (surface_balance(section, line, side, kh, vertical) for side in (LEFT, RIGHT))
    return min((value for value in balances if value is not None), default=None)


def _by_spencer(slices: Slices, kh: float | None) -> float | None:
    """Return Spencer's factor of safety of one surface at a Kh, or its critical Kh if ``kh`` is None."""
    if kh is None:
        return None if (balance := spencer_critical_kh(slices)) is None else balance.kh
    return None if (balance := spencer_factor(slices, kh)) is None else balance.factor


def _to_the_ground(section: Section, line: np.ndarray, towards: int) -> np.ndarray:
    """Return a slip surface whose ends are extended to the ground at the toe and at the crest."""
    angles = (OUT, INTO) if towards == LEFT else (INTO, OUT)
    left, right = section.extent
    ground = section.layering.interface(0, line[[0, -1], 0])
    reach = np.maximum(ground - line[[0, -1], 1], 0.0) / np.tan(angles)
    ends = np.clip(line[[0, -1], 0] + reach * [-1.0, 1.0], left, right)
    heights = section.layering.interface(0, ends)
    inside = (line[:, 0] > ends[0]) & (line[:, 0] < ends[1])
    return np.vstack([[ends[0], heights[0]], line[inside], [ends[1], heights[1]]])


def _corners(section: Section) -> np.ndarray:
    """Return the corners (n, 2) of the ground between which it is nearly straight; all corners if these are few."""
    ground, height = section.ground, float(np.ptp(section.outline()[:, 1]))
    corners, bend = ground, SMALLEST_BEND * height
    while len(corners) > MOST_CORNERS and bend < height:
        corners = ground[needed(ground, bend)]
        bend *= 1.5
    return corners


@dataclass(frozen=True, eq=False)
class _CircleSearch:
    section: Section
    towards: int
    kh: float | None
    depth: float
    vertical: float
    crest: tuple[float, float] | None
    crack: TensionCrack

    def run(self) -> SlipCircle | None:
        """Return the circle with the smallest critical Kh or factor of safety; None if no circle has one."""
        # On few slices a circle may be none that is too steep, or above a corner of the ground, on many: if no circle
        # is left, many slices are taken from the beginning.
        searches = map(self._refined, (SLICES, FINE_SLICES))  # the second only if the first leaves none
        results = (self._result(best[k : k + 1]) for best in searches for k in range(len(best)))
        return next((circle for circle in results if circle is not None), None)

    def _refined(self, coarse_slices: int) -> np.ndarray:
        """Return the circles with the smallest values that are left on many slices, the first grids on so many
        slices."""
        many = len(self.section.ground) > MOST_CORNERS
        most_coarse = COARSE_CIRCLES_OF_MANY_CORNERS if many else COARSE_CIRCLES
        best = self._best(self._grid(), coarse_slices, most_coarse)
        left, right = self.section.extent
        step = np.array(
            [(right - left) / (GROUND_POINTS - 1), (right - left) / (GROUND_POINTS - 1), 1.0 / CIRCLES_PER_PAIR]
        )
        offsets = np.stack(np.meshgrid(*[[-1.0, -0.5, 0.0, 0.5, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        coarse, fine = (coarse_slices, most_coarse), (FINE_SLICES, FINE_CIRCLES)
        for number, most in [coarse] * COARSE_ROUNDS + [fine] * FINE_ROUNDS:
            if not len(best):
                break
            around = (best[:most, None, :] + offsets * step).reshape(-1, 3)
            best = self._best(np.concatenate([best, around]), number, most)
            step *= STEP_REDUCTION
        return best

    def _grid(self) -> np.ndarray:
        ends = np.linspace(*self.section.extent, GROUND_POINTS)
        ends = np.unique(np.concatenate([ends, _corners(self.section)[:, 0]]))
        bulges = (np.arange(CIRCLES_PER_PAIR) + 0.5) / CIRCLES_PER_PAIR
        first, last, bulge = np.meshgrid(ends, ends, bulges, indexing="ij")
        ordered = first < last
        return np.stack([first[ordered], last[ordered], bulge[ordered]], axis=1)

    def _best(self, circles: np.ndarray, number: int, most: int) -> np.ndarray:
        """Return the circles with the smallest factors of safety or critical Kh, each on ``number`` slices, in their
        order, at the ``most``."""
        batch = CIRCLES_AT_A_TIME * SLICES // number
        value = np.concatenate([self._values(circles[k : k + batch], number) for k in range(0, len(circles), batch)])
        order = np.argsort(np.where(np.isfinite(value), value, np.inf), kind="stable")
        return circles[order[: min(most, int(np.isfinite(value).sum()))]]

    def _values(self, circles: np.ndarray, number: int) -> np.ndarray:
        value = np.full(len(circles), np.nan)
        valid, x, z, centre, radius = self._surfaces(circles, number)
        if len(valid):
            value[valid] = self._bishop(self._divided(x, z), centre, radius)
        return value

    def _bishop(self, slices: Slices, centre: np.ndarray, radius: np.ndarray) -> np.ndarray:
        mirrored = -self.towards * centre[:, 0]
        if self.kh is None:
            return bishop_critical_kh(slices, mirrored, centre[:, 1], radius)
        return bishop_factor(slices, mirrored, centre[:, 1], radius, self.kh)

    def _divided(self, x: np.ndarray, z: np.ndarray) -> Slices:
        slices = divide(self.section, x, z, self.towards, seismic=self.kh != 0.0, vertical=self.vertical)
        if self.crack.bottom is None:
            return slices
        return loaded_by_crack(slices, self.section, self.crack, (x[:, self._head], z[:, self._head]), self.towards)

    @property
    def _head(self) -> int:
        """Return the index of the upper end of a slip surface: the last point for a mass that slides to the left."""
        return -1 if self.towards == LEFT else 0

    def _surfaces(self, circles: np.ndarray, number: int) -> tuple[np.ndarray, ...]:
        """Return the indices of the valid circles, and for each of them the corners x, z (circles, number + 1) of the
        slices, the centre (circles, 2) and the radius. A valid circle is everywhere below the ground and above the base
        of the section, deep enough, and nowhere vertical.
        """
        layering = self.section.layering
        left, right = self.section.extent
        first, last, bulge = circles.T
        ends = layering.interface(0, np.stack([first, last], axis=1).ravel()).reshape(-1, 2)
        sound = (
            (first >= left) & (last <= right) & (last - first > 1e-6 * (right - left)) & (bulge > 0.0) & (bulge <= 1.0)
        )
        if self.crack.bottom is not None:  # it opens where the ground falls or is level, but for rounding
            sound &= self.towards * (ends[:, 1] - ends[:, 0]) < LEVEL_SHARE * (right - left)
            ends[:, self._head] -= self.crack.depth(self.section, (first, last)[self._head])
        half = 0.5 * np.hypot(last - first, ends[:, 1] - ends[:, 0])
        if self.crest is not None:
            edge = EDGE_SHARE * (right - left)
            sound &= (first < self.crest[1] - edge) & (last > self.crest[0] + edge)
        half, sagitta = np.where(sound, half, 1.0), np.where(sound, bulge * half, 0.5)
        radius = (half**2 + sagitta**2) / (2.0 * sagitta)
        to_centre = (radius - sagitta) / half  # times half the chord, turned by a right angle
        middle = np.stack([0.5 * (first + last), ends.mean(axis=1)], axis=1)
        chord = 0.5 * np.stack([last - first, ends[:, 1] - ends[:, 0]], axis=1)
        centre = middle + to_centre[:, None] * np.stack([-chord[:, 1], chord[:, 0]], axis=1)
        sound &= centre[:, 1] - ends.max(axis=1) >= np.cos(STEEPEST_BASE) * radius
        valid, shares = np.flatnonzero(sound), np.linspace(0.0, 1.0, number + 1)
        # Few points first: most circles of the first grid leave the ground or the section at one of them.
        for share in (shares[:: number // FEW_POINTS], shares):
            x = first[valid, None] + share * (last - first)[valid, None]
            reach = radius[valid, None] ** 2 - (x - centre[valid, :1]) ** 2
            z = centre[valid, 1:] - np.sqrt(np.maximum(reach, 0.0))
            ground, base = (layering.interface(k, x.ravel()).reshape(x.shape) for k in (0, -1))
            near = 1e-6 * half[valid, None]
            inside = np.all(ground - z >= -near, axis=1) & np.all(z - base >= -near, axis=1)
            if share is shares:
                inside &= (ground - z).max(axis=1) >= self.depth
            valid = valid[inside]
        return valid, x[inside], np.minimum(z, ground)[inside], centre[valid], radius[valid]

    def _result(self, best: np.ndarray) -> SlipCircle | None:
        valid, x, z, centre, radius = self._surfaces(best, FINE_SLICES)
        if not len(valid):
            return None
        slices = self._divided(x, z)
        bishop = float(self._bishop(slices, centre, radius)[0])
        if not np.isfinite(bishop):
            return None
        surface = np.column_stack([x[0], z[0]])
        if self.crack.bottom is not None:  # up the crack to the ground
            head = surface[[self._head]] + [0.0, float(self.crack.depth(self.section, surface[self._head, :1])[0])]
            surface = np.vstack([surface, head] if self.towards == LEFT else [head, surface])
        return SlipCircle(
            towards="left" if self.towards == LEFT else "right",
            centre=(float(centre[0, 0]), float(centre[0, 1])),
            radius=float(radius[0]),
            surface=surface,
            kh=self.kh,
            bishop=bishop,
            spencer=_by_spencer(slices, self.kh),
            frictionless=not slices.friction.any(),
        )
