"""Divides the mass above trial slip surfaces into vertical slices: weights, loads, strength and water at their bases.

Many trial surfaces are divided together: arrays are (surfaces, slices). Lengths are in m, forces in N per m of width,
stresses in Pa; x to the right, elevation upwards. A mass that would slide to the right is mirrored first. Therefore
every mass in this module slides to the left, and the base of a driving slice rises to the right (angle α > 0).
"""

from dataclasses import dataclass, replace

import numpy as np

from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.tension_crack import TensionCrack
from meshes.section.water import Water

LEFT, RIGHT = -1, 1  # where the mass slides to


@dataclass(frozen=True, eq=False)
class Slices:
    """Holds the slices of trial slip surfaces that slide to the left; all arrays are (surfaces, slices).

    Attributes
    ----------
    x, z : middle of the base (m), x mirrored for a mass that slides to the right
    angle : slope α of the base (rad)
    length : length of the base (m)
    vertical, horizontal : known forces (N/m), upwards and to the right, at Kh = 0
    moment : moment of the known forces about the middle of the base at Kh = 0, counter-clockwise (N)
    inertia, inertia_moment : changes of ``horizontal`` and ``moment`` by Kh = 1
    inertia_vertical : change of ``vertical`` by Kh = 1
    cohesion, friction : c (Pa) and tan φ at the base
    pressure : pore pressure (Pa) at the base
    """

    x: np.ndarray
    z: np.ndarray
    angle: np.ndarray
    length: np.ndarray
    vertical: np.ndarray
    horizontal: np.ndarray
    moment: np.ndarray
    inertia: np.ndarray
    inertia_vertical: np.ndarray
    inertia_moment: np.ndarray
    cohesion: np.ndarray
    friction: np.ndarray
    pressure: np.ndarray

    def of(self, surfaces: np.ndarray) -> "Slices":
        """Return the slices of some of the surfaces, by index or by a mask."""
        return Slices(**{name: value[surfaces] for name, value in vars(self).items()})


def divide(
    section: Section, x: np.ndarray, z: np.ndarray, towards: int = LEFT, seismic: bool = False, vertical: float = 0.0
) -> Slices:
    """Divide the ground above trial slip surfaces into slices.

    Parameters
    ----------
    section : strata cut at the water, as `Section.parse` returns them
    x, z (surfaces, slices + 1) : corners of the bases from left to right (m), inside the section and not above the
        ground
    towards : LEFT or RIGHT, the side to which the mass slides and the seismic force acts
    seismic : whether excess pore pressures by shaking act
    vertical : vertical seismic coefficient, positive upwards: times the weight of the seismic mass it is
        subtracted from the weight
    """
    shape = (len(x), x.shape[1] - 1)
    middle, base = 0.5 * (x[:, 1:] + x[:, :-1]), 0.5 * (z[:, 1:] + z[:, :-1])
    width, rise = np.diff(x, axis=1), np.diff(z, axis=1)
    points = np.column_stack([middle.ravel(), base.ravel()])
    levels = section.layering.interfaces(points[:, 0])
    upper, lower = np.maximum(levels[:, :-1], points[:, 1:]), np.maximum(levels[:, 1:], points[:, 1:])
    thickness, height = upper - lower, 0.5 * (upper + lower) - points[:, 1:]
    shakes = GRAVITY * np.array([stratum.density_seismic for stratum in section.strata])
    weighs = GRAVITY * np.array([stratum.density_ordinary for stratum in section.strata]) - vertical * shakes
    mass = thickness * shakes
    traction, inertia, ground = _ground_forces(section, x, towards)
    arm = ground - base
    along = -towards  # x to the left where the mass slides to the right
    stratum = _stratum(levels, points[:, 1])
    cohesion = section.cohesion_field.at(points, points, stratum)
    friction = np.tan([soil.friction_angle for soil in section.strata])[stratum]
    water = section.water_pressure.inside(points, points, stratum, seismic)
    forward = -width * mass.sum(axis=1).reshape(shape)  # the inertia of the soil, to the left

    return Slices(
        x=along * middle,
        z=base,
        angle=np.arctan2(along * rise, width),
        length=np.hypot(width, rise),
        vertical=width * (traction[..., 1] - (thickness @ weighs).reshape(shape)),
        horizontal=width * along * traction[..., 0],
        moment=-arm * width * along * traction[..., 0],
        inertia=forward + width * along * inertia[..., 0],
        inertia_vertical=width * inertia[..., 1],
        inertia_moment=width * (mass * height).sum(axis=1).reshape(shape) - arm * width * along * inertia[..., 0],
        cohesion=cohesion.reshape(shape),
        friction=friction.reshape(shape),
        pressure=water.reshape(shape),
    )


def loaded_by_crack(
    slices: Slices, section: Section, crack: TensionCrack, head: tuple[np.ndarray, np.ndarray], towards: int
) -> Slices:
    """Return the slices with the thrust of the water in tension cracks at their heads.

    Water of depth h has a thrust of γ_w h² / 2 at h / 3 above the bottom of the crack. Under free water with a pressure
    p on the ground the crack is full, and p acts on the whole face of the crack in addition. The thrust does not change
    with Kh.

    Parameters
    ----------
    slices : Slices
    section : Section
    crack : TensionCrack
    head : two (surfaces,) ndarray
        x and elevation (m) of the upper ends of the slip surfaces, which are the bottoms of the cracks.
    towards : int
        LEFT or RIGHT, the side to which the mass slides.
    """
    x, z = head
    depth = section.layering.interface(0, x) - z
    points = np.column_stack([x, z + depth])
    free = section.water_pressure.on_ground(points, points)
    water = np.where(free > 0.0, depth, crack.water_depth(depth))
    gamma = (section.water or Water()).unit_weight
    thrust = free * water + 0.5 * gamma * water**2
    turning = 0.5 * free * water**2 + gamma * water**3 / 6.0  # about the bottom of the crack
    last = -1 if towards == LEFT else 0
    horizontal, moment = slices.horizontal.copy(), slices.moment.copy()
    horizontal[:, last] -= thrust
    moment[:, last] += turning + thrust * (z - slices.z[:, last])
    return replace(slices, horizontal=horizontal, moment=moment)


def _ground_forces(section: Section, x: np.ndarray, towards: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return loads on the ground above slices with corners at ``x``, per horizontal area, and their elevation (m).

    The loads are those of free water at rest and of surcharges, and the changes of both by Kh = 1, each (surfaces,
    slices, 2) in Pa.

    The inclination of the ground above a slice is taken from corner to corner, so that the thrust of free water is
    exact over kinks and steps of the ground, too.
    """
    ground = section.layering.interface(0, x.ravel()).reshape(x.shape)
    middle, height = 0.5 * (x[:, 1:] + x[:, :-1]), 0.5 * (ground[:, 1:] + ground[:, :-1])
    slope = (np.diff(ground, axis=1) / np.diff(x, axis=1)).ravel()
    points = np.column_stack([middle.ravel(), height.ravel()])
    stretch = np.hypot(1.0, slope)[:, None]
    normal = np.column_stack([-slope, np.ones_like(slope)]) / stretch
    loads = section.surface_loads
    hydrostatic = -section.water_pressure.on_ground(points, points)[:, None] * normal
    force = (hydrostatic + loads.dead(points, points, normal)) * stretch
    added = loads.seismic(towards, points, points, normal) * stretch
    return force.reshape(*height.shape, 2), added.reshape(*height.shape, 2), height


def _stratum(levels: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return the stratum at each base: the deepest stratum of non-zero thickness whose top is not below the base."""
    below_top = (z[:, None] <= levels[:, :-1]) & (levels[:, :-1] > levels[:, 1:])
    return below_top.shape[1] - 1 - np.argmax(below_top[:, ::-1], axis=1)
