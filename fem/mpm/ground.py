"""Fills a section with material points on a grid, and sets their boundary conditions and initial stress.

A few cells of rigid ground surround the section: below its base, so that the base is rough, and beyond its sides, as in
the rigid box of the discs. Beyond smooth sides the rigid ground is as high as the surface at the end of the section,
and ground that slides over the end moves on it. Where the sides are free-field, the rigid ground beyond them is removed
once the ground is at rest: its pressure continues to act as a force on the points next to the side, which are held
vertically. Below the lowest layer that liquefies at such a side the rigid ground remains, so that ground that slides
out does not fall off an edge. Coordinates of points and grid are those of the section less an `offset`. Rows of nodes
are parallel to layers that liquefy: a shear band across the cells of a horizontal grid has 1 to 3 % more strength,
which halves slides near yield. The grid is laid by the section, not by the axes of coordinates: columns of nodes begin
at its left end, and the lowest edge of its liquefying layers lies between two rows, where knot spans end, in cells of
any size. If no layer liquefies, the base is at a row.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.continuum.shallow_failure import ShallowFailure
from fem.kernels import grid_motion
from fem.kernels import point_stress as law
from fem.mpm.grid import BackgroundGrid
from fem.mpm.points import MaterialPoints, PointSoil
from fem.mpm.pore_water import ROUNDING, between_sides, uplift
from fem.settings import Sides
from meshes.section.alike_sides import has_alike_sides
from meshes.section.earth_pressure import active_pressure
from meshes.section.layering import middles
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.sides import interfaces_at, lowest_liquefied

LENGTH_TOLERANCE = 1e-6  # m
# Width (cells) beside a free-field side in which the ground can hardly settle, and which is no part of the surface.
FIXED_STRIP = 1.25
SMALLEST_FORCE = 1e-3  # N/m: on unloaded points of free-field sides, which are identified by a force other than zero
BORDER = 3  # cells of rigid ground around the section
ROOM_BEYOND_SIDES = 0.25  # of the width of the section: space beyond free-field sides
HEADROOM = 6  # cells above its highest point
THINNEST_CRUST = 0.25  # of a cell: ground above a liquefying stratum that is thinner does not count as a crust
COLUMNS = 1000  # of a section, in which the thickness of the crust is measured
RIGID_COHESION = 1e15  # Pa: cohesion of that ground
STEEPEST_ROW = 0.3  # slope up to which rows of nodes follow layers
THINNEST_LAYER = 0.25  # of the spacing of points: a layer that is thinner in a column has none there
# m/s: stiffer ground is given the stiffness with which compression waves travel so fast, since the time step is as long
# as waves allow. With 250 m/s ground that is shaken above a weak layer oscillates, and slides up to half as far again.
FASTEST_WAVE = 500.0
# Above it a nearly incompressible skeleton makes waves fast and pressures rough, and slides no different.
LARGEST_POISSON = 0.45


@dataclass(frozen=True, eq=False)
class PointGround:
    """Holds a section as material points, with the background grid.

    Attributes
    ----------
    section : the section
    points : material points of the section and of the rigid ground around it (stratum -1)
    grid : the grid on which they move
    offset (2,) : origin of the grid in the coordinates of the section (m)
    surface (k,) : numbers in ``points`` of the points at the surface, from left to right
    effective (n,) : vertical effective stress of each point before the earthquake (Pa), compression positive
    consolidated (n,) : vertical effective stress with only the share of surcharges to which the ground has consolidated
        (Pa); residual strength ratios refer to this stress
    softened : strata whose stiffness was reduced, see ``FASTEST_WAVE``
    sides : boundary condition of the sides
    room : length (m) of floor beyond each free-field or smooth side, over which ground that leaves the section can
        slide; 0 for other sides
    firm_faces : cohesionless faces that have an apparent cohesion (`fem.mpm.faces`)
    """

    section: Section
    points: MaterialPoints
    grid: BackgroundGrid
    offset: np.ndarray
    surface: np.ndarray
    effective: np.ndarray
    consolidated: np.ndarray
    softened: tuple[str, ...]
    sides: Sides
    room: float = 0.0
    firm_faces: tuple[ShallowFailure, ...] = ()

    @property
    def crust(self) -> float:
        """Return the median thickness (m) of the ground above the uppermost stratum that liquefies; inf if no stratum
        liquefies.

        Places where this ground is thinner than a quarter of a cell, which is half the spacing of the points, are
        disregarded.
        """
        layering, liquefies = self.section.layering, [bool(s.liquefies_in) for s in self.section.strata]
        x = middles(*self.section.extent, COLUMNS)
        levels = layering.interfaces(x)
        wet = (levels[:, :-1] - levels[:, 1:] > layering.tolerance) & liquefies
        thickness = (levels[:, 0] - levels[np.arange(len(x)), wet.argmax(axis=1)])[wet.any(axis=1)]
        covered = thickness[thickness > THINNEST_CRUST * self.grid.cell]
        return float(np.median(covered)) if len(covered) else np.inf


def ground_of(section: Section, cells: int, sides: Sides = "fixed") -> PointGround:
    """Fill a section with material points, four to a cell.

    Columns of points are filled from the base to the surface layer by layer, so that the area of every layer and the
    surface are exact. Stress follows from the weight of the column above, with K0 = ν / (1 - ν); it is not yet in
    equilibrium. Sides are rigid and rough; `with_free_sides` makes them free-field where ``sides`` are. Smooth sides
    hold nodes horizontally up to the surface.

    Parameters
    ----------
    section : the ground
    cells : about the number of cells of the grid inside the section
    sides : boundary condition of the sides; periodic sides are treated as free-field unless both sides have the same
        layers, at the same or at another height

    Returns
    -------
    The points with their grid, before equilibrium.
    """
    left, right = section.extent
    width, ends = right - left, (section.layering.left[0], section.layering.right[-1])
    periodic = sides == "periodic" and has_alike_sides(section.strata, section.layering)
    if sides == "periodic" and not periodic:
        sides = "free-field"
    slope = float(ends[1][-1] - ends[0][-1]) / width if periodic else _dip(section)
    area = float(section.layering.areas().sum())
    cell = width / max(8, round(width / np.sqrt(area / cells) - ROUNDING))
    spacing = 0.5 * cell
    room = round(ROOM_BEYOND_SIDES * width / cell) if sides in ("free-field", "smooth") else 0
    ends_there = periodic or sides == "smooth"
    floor_at = _lowest_slip if sides == "free-field" else _base
    x, top, bottom, stratum = _columns(section, spacing, 0 if ends_there else BORDER + room, floor_at)
    places, volumes, owners, is_top = _fill(x, top, bottom, stratum, spacing)
    inside = (places[:, 0] > left) & (places[:, 0] < right) & (owners >= 0)
    margin = 0 if periodic else BORDER + room + 2
    beyond = np.array(
        [[left - room * cell, ends[0][0]], [right + room * cell, ends[1][0]]]
    )  # to which ground may slide
    heights = np.vstack([places, beyond]) @ [-slope, 1.0] + slope * (left - margin * cell)
    row = _row_of_nodes(section, slope, cell) - slope * (0.5 * width + margin * cell)
    floor = row + np.floor((heights.min() - row) / cell + ROUNDING) * cell - 2.0 * cell
    offset = np.array([left - margin * cell, floor])
    shape = (round(width / cell) + (0 if periodic else 2 * margin + 1), int((heights.max() - floor) / cell) + HEADROOM)
    effective, consolidated = _effective(section, places, owners)
    soil, softened = _soil(section, places, owners, inside)
    number = np.where(inside, owners, -1)
    points = MaterialPoints.of(places - offset, volumes, soil, number)
    surface = np.flatnonzero(is_top & inside)
    _add_surcharges(section, points, places, surface, spacing)
    poisson = np.array([s.poissons_ratio for s in section.strata])[np.maximum(owners, 0)]
    points.stress[:, 1] = -effective
    points.stress[:, 0] = -effective * poisson / (1.0 - poisson)
    grid = _grid(section, cell, slope, shape, offset, "fixed" if sides == "free-field" else sides)
    return PointGround(section, points, grid, offset, surface, effective, consolidated, softened, sides, room * cell)


def with_free_sides(ground: PointGround, order: np.ndarray) -> PointGround:
    """Return the ground at rest without the rigid ground beyond its sides; the pressure of the removed ground becomes a
    force on the points next to the sides.

    ``order`` (n,): original numbers of the points in their present order.
    """
    section, cell = ground.section, ground.grid.cell
    points, (left, right) = ground.points.subset(np.argsort(order)), section.extent
    places = points.x + ground.offset
    base = _base(section, places[:, 0])
    floor = np.where((places[:, 0] < left) | (places[:, 0] > right), _lowest_slip(section, places[:, 0]), base)
    remaining = (points.stratum >= 0) | (places[:, 1] < floor)
    points.stress[(points.stratum < 0) & ((places[:, 0] < left) | (places[:, 0] > right))] = 0.0  # nothing weighs on it
    height = points.state[:, law.VOLUME] / (0.5 * cell)
    for inwards, distance in ((1.0, places[:, 0] - left), (-1.0, right - places[:, 0])):
        above = places[:, 1] > _lowest_slip(section, places[:, 0])
        at_side = np.flatnonzero((points.stratum >= 0) & (distance < 0.5 * cell) & above)
        pressure = _side_pressure(points, at_side, ground.effective[at_side])
        points.side[at_side] = inwards * np.maximum(pressure * height[at_side], SMALLEST_FORCE)
    free = np.minimum(places[:, 0] - left, right - places[:, 0])[ground.surface] > FIXED_STRIP * cell
    return replace(
        ground,
        points=points.subset(remaining),
        grid=_grid(section, cell, ground.grid.slope, ground.grid.shape, ground.offset, "free-field"),
        surface=(np.cumsum(remaining) - 1)[ground.surface[free]],
        effective=ground.effective[remaining],
        consolidated=ground.consolidated[remaining],
    )


def _side_pressure(points: MaterialPoints, at_side: np.ndarray, effective: np.ndarray) -> np.ndarray:
    """Return the effective horizontal pressure (k,) in Pa of the ground beyond a side on the points ``at_side``.

    It is K0 σ_v, with K0 = ν / (1 - ν), and at least the active pressure, without which cohesionless ground would flow
    out. The stress of the ground between rigid sides is no such pressure: a slope leans on its lower side, which would
    support it for ever. ``effective`` (k,): vertical effective stress σ_v of the points (Pa).
    """
    bulk, shear, sine, strength = points.properties[at_side][:, [law.BULK, law.SHEAR, law.SIN_PHI, law.STRENGTH]].T
    return np.maximum((bulk - shear) / (bulk + shear) * effective, active_pressure(effective, sine, strength))


def _row_of_nodes(section: Section, slope: float, cell: float) -> float:
    """Return the elevation (m) of a row of nodes in the middle of the section: half a cell above the lowest edge of
    strata that liquefy, of which the median height counts, or at the base if none liquefies."""
    layering, (left, right) = section.layering, section.extent
    x = middles(left, right, COLUMNS)
    levels = layering.interfaces(x)
    liquefies = np.array([bool(stratum.liquefies_in) for stratum in section.strata])
    wet = (levels[:, :-1] - levels[:, 1:] > layering.tolerance) & liquefies
    lowest = wet.shape[1] - np.argmax(wet[:, ::-1], axis=1)
    liquefied = wet.any(axis=1)
    line = np.where(liquefied, levels[np.arange(len(x)), lowest], levels[:, -1]) - slope * (x - 0.5 * (left + right))
    return float(np.median(line[liquefied])) + 0.5 * cell if liquefied.any() else float(np.median(line))


def _dip(section: Section) -> float:
    """Return the median slope dz/dx over the length of the lower edges of strata that liquefy, at most `STEEPEST_ROW`;
    0 if no stratum liquefies."""
    layering = section.layering
    liquefies = np.array([bool(stratum.liquefies_in) for stratum in section.strata])
    liquefying_present = layering.present() & liquefies
    slopes = ((layering.right - layering.left)[:, 1:] / layering.width[:, None])[liquefying_present]
    if not len(slopes):
        return 0.0
    length, order = (
        np.broadcast_to(layering.width[:, None], liquefying_present.shape)[liquefying_present],
        np.argsort(slopes),
    )
    reached = np.cumsum(length[order]) - 0.5 * length[order]
    return float(np.clip(np.interp(0.5 * length.sum(), reached, slopes[order]), -STEEPEST_ROW, STEEPEST_ROW))


def _base(section: Section, x: np.ndarray) -> np.ndarray:
    """Return the elevation (n,) of the base at x (m); beyond a side, that at the side."""
    left, right = section.extent
    return section.layering.interface(-1, np.clip(x, left + LENGTH_TOLERANCE, right - LENGTH_TOLERANCE))


def _lowest_slip(section: Section, x: np.ndarray) -> np.ndarray:
    """Return the elevation (n,) at x (m) of the surface on which the ground beyond the nearest side slides, which
    continues the lower edge of the lowest stratum that liquefies at this side. It is the base if none liquefies."""
    (left, right), base = section.extent, _base(section, x)
    out, wet = base.copy(), [k for k, stratum in enumerate(section.strata) if stratum.liquefies_in]
    for at_right, side, interval in ((False, left, 0), (True, right, -1)):
        foot, nearest = lowest_liquefied(section, at_right, wet), (x > 0.5 * (left + right)) == at_right
        if foot is not None:
            layering = section.layering
            interface = int(np.flatnonzero(interfaces_at(section, at_right) == foot)[0])
            rise = layering.right[interval, interface] - layering.left[interval, interface]
            line = foot + rise / layering.width[interval] * (x - side)
            out[nearest] = np.maximum(line, base)[nearest]
    return out


def _columns(
    section: Section, spacing: float, margin: int, floor_at: Callable[[Section, np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the columns of points: x (m), and for the layers of each column their tops (m), bottoms (m) and strata
    (columns, layers).

    The last layer is the rigid ground below the base (stratum -1). The rigid ground continues for ``margin`` cells
    beyond the sides, where ``floor_at`` gives its surface, the layers above for ``BORDER`` cells.
    """
    left, right = section.extent
    extra = 2 * margin
    x = left + spacing * (np.arange(-extra, round((right - left) / spacing) + extra) + 0.5)
    at = np.clip(x, left + 0.5 * spacing, right - 0.5 * spacing)
    levels = _levels(section, at, spacing)
    beyond = np.maximum(left - x, x - right) > 2 * BORDER * spacing
    floor = levels[:, -1:] - 2 * BORDER * spacing
    levels[beyond] = floor_at(section, x[beyond])[:, None]
    top, bottom = levels, np.hstack([levels[:, 1:], floor])
    owner = np.append(np.arange(levels.shape[1] - 1), -1)
    return x, top, bottom, np.broadcast_to(owner, top.shape)


def _levels(section: Section, x: np.ndarray, width: float) -> np.ndarray:
    """Return the elevations (n, interfaces) of the interfaces at x (m); at a step, the mean of both sides, so that a
    column of some width (m) has the areas of both, and the mirrored section the mirrored columns."""
    layering, aside = section.layering, ROUNDING * width
    return 0.5 * (layering.interfaces(x, x - aside) + layering.interfaces(x, x + aside))


def _fill(
    x: np.ndarray, top: np.ndarray, bottom: np.ndarray, owner: np.ndarray, spacing: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return places (n, 2), areas (n,) and strata (n,) of the points of columns, and the numbers of the highest point
    of each column.
    """
    places, volumes, owners, is_top = [], [], [], []
    for column, at in enumerate(x):
        first = True
        for high, low, stratum in zip(top[column], bottom[column], owner[column], strict=True):
            if high - low < (THINNEST_LAYER - ROUNDING) * spacing:
                continue
            count = max(1, round((high - low) / spacing - ROUNDING))
            z = high - (high - low) * (np.arange(count) + 0.5) / count
            places.append(np.column_stack([np.full(count, at), z]))
            volumes.append(np.full(count, spacing * (high - low) / count))
            owners.append(np.full(count, stratum))
            is_top.append(np.arange(count) == (0 if first else -1))
            first = False
    return np.vstack(places), np.concatenate(volumes), np.concatenate(owners), np.concatenate(is_top)


def _effective(section: Section, places: np.ndarray, owners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertical effective stress (n,) of the column above each point (Pa): with all of the surcharges, and
    with the share to which the ground has consolidated. Points below the base have the stresses at the base.
    """
    points_inside = between_sides(section, places)
    points_inside[:, 1] = np.maximum(points_inside[:, 1], section.layering.interface(-1, points_inside[:, 0]))
    stratum = np.where(owners < 0, section.layering.strata - 1, owners)
    effective_stress = section.surface_loads.vertical_effective(points_inside, stratum)
    return effective_stress, section.cohesion_field.effective_stress(points_inside, points_inside, stratum)


def _add_surcharges(
    section: Section, points: MaterialPoints, places: np.ndarray, surface: np.ndarray, spacing: float
) -> None:
    """Add surcharges to the points of the surface: their weight, and the mass that shakes."""
    x, mass = places[surface, 0], points.state[surface, law.MASS]
    weighs = points.properties[surface, law.WEIGHT_RATIO] * mass
    for load in section.surcharges:
        surcharge = load.at(x, x) * spacing / GRAVITY
        weighs, mass = weighs + surcharge, mass + load.seismic_share * surcharge
    points.state[surface, law.MASS], points.properties[surface, law.WEIGHT_RATIO] = mass, weighs / mass


def _soil(
    section: Section, places: np.ndarray, owners: np.ndarray, inside: np.ndarray
) -> tuple[PointSoil, tuple[str, ...]]:
    """Return the soil properties of the points. Rigid ground has stiffness and weight of the adjacent stratum, or of
    the lowest one."""
    strata = section.strata
    k = np.where(owners < 0, len(strata) - 1, owners)

    def of(values: list[float]) -> np.ndarray:
        return np.array(values, dtype=float)[k]

    mass = [max(s.density_seismic, s.density_ordinary, 1.0) for s in strata]
    poisson = [min(s.poissons_ratio, LARGEST_POISSON) for s in strata]
    young, softened = [], []
    for s, nu, rho in zip(strata, poisson, mass, strict=True):
        largest_stiffness = rho * FASTEST_WAVE**2 * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)
        young.append(min(s.youngs_modulus, largest_stiffness))
        if s.youngs_modulus > largest_stiffness:
            softened.append(s.name)
    cohesion = np.where(inside, section.cohesion_field.at(places, places, k), RIGID_COHESION)
    friction = np.where(inside, of([s.friction_angle for s in strata]), 0.0)
    tension = np.where(inside, of([np.inf if s.tension is None else s.tension for s in strata]), np.inf)
    weight = of([s.density_ordinary / rho for s, rho in zip(strata, mass, strict=True)])
    return PointSoil(of(mass), of(young), of(poisson), cohesion, friction, tension, weight), tuple(softened)


def _grid(
    section: Section, cell: float, slope: float, shape: tuple[int, int], offset: np.ndarray, sides: Sides
) -> BackgroundGrid:
    """Return the background grid of a section. Nodes well inside the rigid ground are fixed, and pore water acts by its
    pressure gradient."""
    left, right = section.extent
    x = offset[0] + cell * np.arange(shape[0])
    z = offset[1] + cell * np.arange(shape[1]) + slope * (x - offset[0])[:, None]
    at = np.clip(x, left + 1e-9 * (right - left), right - 1e-9 * (right - left))
    levels = _levels(section, at, cell)
    base = levels[:, -1]
    support = np.full(shape, grid_motion.FREE, dtype=np.int8)
    if sides == "smooth":
        below = z < levels[:, :1] + cell - LENGTH_TOLERANCE  # up to the first row of nodes that is not in the ground
        beyond = np.maximum(left - x, x - right)[:, None]
        support[below & (beyond > -LENGTH_TOLERANCE)] = grid_motion.WALL
        reached = (
            np.where(z < levels[:, :1] - LENGTH_TOLERANCE, 1.5, 0.5) * cell
        )  # up to there the ground inside slides along it
        support[below & (beyond > reached)] = grid_motion.FIXED
    support[z < base[:, None] - (BORDER - 1 - ROUNDING) * cell] = grid_motion.FIXED
    if sides == "free-field":
        support[:2] = support[-2:] = grid_motion.FIXED
    elif sides == "fixed":
        reach = (BORDER - 1 - ROUNDING) * cell
        support[(x < left - reach) | (x > right + reach)] = grid_motion.FIXED
    support[:, -2:] = grid_motion.FIXED
    return BackgroundGrid(cell, support, uplift(section, cell, x, z, sides == "periodic"), sides == "periodic", slope)
