"""Places the discs of a section: packing, frame of reference and layers.

Positions are given in one of two frames of reference. In the frame of the section x points to the right and z up. In
the frame of the discs u is parallel to their rows: for a "box" the u axis is parallel to the mean ground surface, and
gravity is inclined; for lattice and random packings the two frames are the same.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dem.acceleration import Acceleration, tilted_gravity
from dem.assembly import DiscMaterials
from dem.model import DiscModel
from dem.packing import ROW, Packing, brought_back, densest, lattice_box, random_packing, triangular_lattice
from dem.settings import DemSettings
from dem.springs import LayerSprings, from_strata, table2
from dem.water import added_mass, buoyancy, excess, still_water
from meshes.errors import InputError
from meshes.section.base_impedance import base_impedance
from meshes.section.polyline import downhill
from meshes.section.section import Section

POROSITY_TOLERANCE = 0.1  # above the requested porosity
TAPER = 1e-3  # s: length of the taper at either end of a record


@dataclass(frozen=True)
class Ground:
    """Holds the discs of a section, without loads.

    Attributes
    ----------
    packing : Packing
        Positions, radii and layers of the discs.
    kind : str
        "box", "lattice" or "random".
    radius : float
        Mean radius of the discs (m).
    rows : int
        Number of rows of a box, 0 for other packings.
    tilt : float
        Angle of the u axis of the discs below the horizontal (rad).
    origin : (float, float)
        Position of u = v = 0 in the section (m).
    downhill : int
        +1 if the right end of the surface is the lower one, or both are equally high; -1 if the left end is. Slides and
        their records are positive in this direction.
    section : Section or None
        Section whose water and loads act on the discs; None for discs without them. Its origin is at ``place``.
    fails_towards : int or None
        +1 if the finite elements fail to the right, -1 to the left; None if they have not been computed.
    place : (float, float)
        Position of the origin of ``section`` in the section as it was given (m): soil discs lie in axes that begin at
        its left end and lowest point, so that their motion has the same bits wherever the section lies on its axes.
    """

    packing: Packing
    kind: str
    radius: float
    rows: int
    tilt: float
    origin: tuple[float, float]
    downhill: int
    section: Section | None = None
    fails_towards: int | None = None
    place: tuple[float, float] = (0.0, 0.0)

    def to_section(self, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Transform positions (m) from the frame of the discs to the frame of the section as it was given."""
        dx, dz = self.to_section_axes(u, v)
        return self.origin[0] + dx, self.origin[1] + dz

    def to_local(self, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Transform positions (m) from the frame of the discs to the frame of ``section``, whose origin is at
        ``place``."""
        dx, dz = self.to_section_axes(u, v)
        return self.origin[0] - self.place[0] + dx, self.origin[1] - self.place[1] + dz

    def to_section_axes(self, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Transform vectors from the frame of the discs to the frame of the section."""
        c, s = np.cos(self.tilt), np.sin(self.tilt)
        return c * u + s * v, -s * u + c * v

    def model(self, layers: Sequence[LayerSprings], settings: DemSettings) -> DiscModel:
        """Return the discs at rest, without pore springs, under gravity."""
        gravity = tilted_gravity(self.tilt)
        model = self.packing.discs(DiscMaterials(layers, law=settings.model, mean=settings.mean), gravity=gravity)
        model.place = self.place
        if self.section is not None:
            places = self.to_local(model.x, model.z)
            model.pore_acceleration_x, model.pore_acceleration_z = self._to_disc_axes(
                still_water(self.section, places, model)
            )
            added = added_mass(self.section, places, model)
            if added is not None:
                model.added_mass_x, model.added_mass_z = self._to_disc_axes(added)
        return model

    def weaken(self, model: DiscModel) -> bool:
        """Apply the excess pore pressure by shaking to discs at rest; return False if there is no excess pore
        pressure."""
        added = None if self.section is None else excess(self.section, self.to_local(model.x, model.z), model)
        if added is None:
            return False
        ax, az = self._to_disc_axes(added)
        model.pore_acceleration_x = model.pore_acceleration_x + ax
        model.pore_acceleration_z = model.pore_acceleration_z + az
        return True

    def base_impedance(self) -> float:
        """Return the impedance of the base (kg/s per metre), see `base_impedance`; 0 without a section."""
        return 0.0 if self.section is None else base_impedance(self.section)

    def buoyancy(self, model: DiscModel) -> np.ndarray | None:
        """Return the acceleration (2, n) in m/s2, in the frame of the discs, by buoyancy in still water at the present
        positions. Return None without water, see `dem.water.buoyancy`.
        """
        if self.section is None:
            return None
        places = brought_back(*self.to_local(model.x, model.z), self.section.extent[0], model.repeats)
        felt = buoyancy(self.section, places, model)
        return None if felt is None else np.array(self._to_disc_axes(felt))

    def _to_disc_axes(self, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return vectors (n, 2) in the frame of the discs, from vectors in the frame of the section."""
        c, s = np.cos(self.tilt), np.sin(self.tilt)
        return c * vectors[:, 0] - s * vectors[:, 1], s * vectors[:, 0] + c * vectors[:, 1]

    def horizontal_acceleration(self, times: np.ndarray, acceleration: np.ndarray) -> Acceleration:
        """Return the acceleration of the discs for a horizontal acceleration (m/s2) given at some times (s), positive
        downslope; constant before and after."""
        felt = self.downhill * acceleration
        return Acceleration(times, felt * np.cos(self.tilt), felt * np.sin(self.tilt))

    def recorded_acceleration(self, times: np.ndarray, acceleration: np.ndarray) -> Acceleration:
        """Return the acceleration of the discs for a horizontal acceleration (m/s2) given at some times (s), positive
        downslope; zero before and after."""
        before, after = times[:1] - TAPER, times[-1:] + TAPER
        acceleration = np.concatenate([[0.0], acceleration, [0.0]])
        return self.horizontal_acceleration(np.concatenate([before, times, after]), acceleration)

    @property
    def search_direction(self) -> int:
        """Return the direction of a positive Kh in searches for the critical Kh, +1 to the right or -1 to the left: as
        the finite elements fail, or else downslope."""
        return self.downhill if self.fails_towards is None else self.fails_towards

    def steady(self, kh: float) -> Acceleration:
        """Return the acceleration of a constant Kh; positive is in the direction of the search."""
        return Acceleration.seismic(self.search_direction * kh, tilt=self.tilt)

    def shaking(self, before: float, after: float, start: float, end: float) -> Acceleration:
        """Return the acceleration of a Kh that changes along a half cosine between two times; positive is in the
        direction of the search.

        before, after: Kh before and after the change (-); start, end: times at which the change begins and ends (s).
        """
        change = Acceleration.seismic(self.search_direction * (after - before), tilt=self.tilt, ramp=(start, end))
        before_change = self.steady(before)
        return Acceleration(change.times, change.x + before_change.x[0], change.z + before_change.z[0])


def springs_of(section: Section, settings: DemSettings, radius: float) -> list[LayerSprings]:
    """Return the springs of every stratum before calibration: Table 2, or equations 5 to 13, of the paper.

    Parameters
    ----------
    section : Section
        The strata, from the top down.
    settings : DemSettings
        Kind of springs, their scale, damping and allowed overlap.
    radius : float
        Mean radius of the discs (m).

    Returns
    -------
    list of LayerSprings
        Springs of every stratum.
    """
    if settings.springs == "table2":
        layers = table2()
    else:
        layers = from_strata(
            section.strata, radius, stiffness_scale=settings.stiffness_scale, damping_ratio=settings.damping_ratio
        )
    return [
        replace(layer, name=stratum.name, allowed_overlap=settings.allowed_overlap)
        for layer, stratum in zip(layers, section.strata, strict=True)
    ]


def ground_of(section: Section, settings: DemSettings) -> Ground:
    """Place discs in a section.

    Parameters
    ----------
    section : Section
        The layered ground.
    settings : DemSettings
        Radius and packing: "box", "lattice", "random" or "auto".

    Returns
    -------
    Ground
        The packing and its place in the section.

    Raises
    ------
    InputError
        If the packing does not fit the section.
    """
    radius = settings.mean_radius(section)
    kind = settings.packing
    fits = box_fits(section, radius)
    if kind == "auto":
        kind = "box" if fits else "random"
    if kind == "box" and not fits:
        raise InputError(
            section.name,
            [
                'dem, packing = "box": expected a straight surface with a base parallel to it; take "random", or '
                '"lattice", whose rows run along the mean surface too and are cut to the outline'
            ],
        )
    try:
        return _box(section, radius) if kind == "box" else _cut_packing(section, settings, kind, radius)
    except ValueError as error:
        raise InputError(section.name, [f"dem, packing: {error}"]) from error


def mean_slope(section: Section) -> float:
    """Return the angle (rad) by which the line between the ends of the surface falls to the right."""
    (x0, z0), (x1, z1) = section.ground[0], section.ground[-1]
    return float(np.arctan2(z0 - z1, x1 - x0))


def box_fits(section: Section, radius: float) -> bool:
    """Return whether surface and base are straight and parallel to within the radius of a disc."""
    outline = section.outline()
    tilt = mean_slope(section)
    start = section.ground[0]
    away = (outline - start) @ np.array([np.sin(tilt), np.cos(tilt)])
    left, right = section.extent
    top = away > 0.5 * away.min()
    base = away[~top]
    return bool(np.abs(away[top]).max() < radius and np.ptp(base) < 2.0 * radius and right > left)


def _box(section: Section, radius: float) -> Ground:
    """Return a box with as many columns as fit along the surface and as many rows as fit above the base, centred along
    the surface.
    """
    tilt = mean_slope(section)
    start, end = section.ground[0], section.ground[-1]
    length = float(np.hypot(*(end - start)))
    along, down = np.array([np.cos(tilt), -np.sin(tilt)]), np.array([-np.sin(tilt), -np.cos(tilt)])
    depth = float(np.median([d for d in (section.outline() - start) @ down if d > radius]))
    columns = int(length / (2.0 * radius) + 1e-9)
    rows = int((depth - 2.0 * radius) / (2.0 * radius * ROW) + 1e-9) + 1
    packing = lattice_box(columns, rows, radius)
    rim = packing.z[packing.free].max() + radius
    inset = 0.5 * (length - 2.0 * radius * (columns - 1))
    origin = start + inset * along + rim * down
    ground = Ground(
        packing, "box", radius, rows, tilt, (float(origin[0]), float(origin[1])), downhill(section.ground), section
    )
    free = packing.free
    packing.layer[free] = in_stratum(section, *ground.to_section(packing.x[free], packing.z[free]))
    return ground


def in_stratum(section: Section, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return the stratum of each place; a place outside has the nearest stratum on its vertical line.

    Parameters
    ----------
    section : ground with the strata
    x, z (n,) : places (m); x beyond a side counts as the side

    Returns
    -------
    Number (n,) of the stratum: above the surface the one at the surface, below the base the one at the base.

    Raises
    ------
    ValueError
        If a place lies in no stratum.
    """
    inside = np.clip(x, *section.extent)
    ends = section.layering.interfaces(inside)
    layer = np.asarray(section.stratum_at(inside, np.clip(z, ends[:, -1], ends[:, 0])), np.int32)
    if (layer < 0).any():
        raise ValueError("some discs lie outside of all strata")
    return layer


def _cut_packing(section: Section, settings: DemSettings, kind: str, radius: float) -> Ground:
    """Return a lattice or a random packing cut to the outline."""
    outline = section.outline()
    if kind == "lattice":
        packing = triangular_lattice(outline, section.stratum_at, radius, angle=-mean_slope(section))
    else:
        packing = densest(
            lambda porosity: random_packing(
                outline, section.stratum_at, radius, spread=settings.spread, porosity=porosity, seed=settings.seed
            ),
            settings.porosity + np.arange(0.0, POROSITY_TOLERANCE, 0.01),
        )
    return Ground(packing, kind, radius, 0, 0.0, (0.0, 0.0), downhill(section.ground), section)
