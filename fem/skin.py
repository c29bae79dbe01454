"""The skin of a cohesionless face: the Kh at which its grains roll down, and the search for deeper failures.

Sand without cohesion fails first at its inclined surface, in a layer of no thickness along the face. No mesh resolves
that, and no practitioner means it: wanted is the slope as a whole. So the skin's Kh is found in closed form, and where
it governs, the ground down to ``least_depth`` below such a face is given an apparent cohesion with which it does not
fail by itself; then any failure is one of the ground below, or cuts through it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.loads import push
from fem.settings import FemSettings
from meshes.quad_mesh import QuadMesh
from meshes.section.layering import CENTIMETRE
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, Stratum

# What the name of a strip has behind that of its stratum, before the x at which it begins.
STRIP = ", skin at x = "
# Pressures (Pa) that differ by less are the same.
UNLIKE = 1.0


@dataclass(frozen=True)
class Skin:
    """A straight piece of the surface, falling in the direction of the push, of a stratum without cohesion.

    Attributes
    ----------
    stratum : str
        Name of the stratum.
    start, end : float
        x of both ends in m, ``start`` the smaller one.
    angle : float
        Inclination in rad, above 0.
    kh : float
        Seismic coefficient at which the grains roll down; below 0 if they do so by their own weight.
    ratio : float
        Weight less Kv and uplift over the seismic weight (-).
    seepage : float
        Force of seepage in the direction of the push over the seismic weight (-).
    """

    stratum: str
    start: float
    end: float
    angle: float
    kh: float
    ratio: float = 1.0
    seepage: float = 0.0


def skins(section: Section, settings: FemSettings, friction: Sequence[float] | np.ndarray | None = None) -> list[Skin]:
    """All cohesionless faces of a section from left to right; ``friction`` (rad) takes the place of the strata's φ.

    On a face inclined by β a layer of any thickness slides when weight γ - Kv γs and push Kh γs together make the angle
    φ with its normal: Kh = (γ / γs - Kv) tan(φ - β), γ the ordinary and γs the seismic unit weight (the infinite slope
    of Skempton & DeLory 1957 with a horizontal acceleration). The slope of the pore pressure just below the face is
    taken off γ, and its part in the direction of the push off Kh γs. Faces under a surcharge, or below water that is
    not theirs, are held by it, and are none.
    """
    layers, sign = section.layering, push(section, settings)
    surface_of = [np.flatnonzero(there)[0] for there in layers.present()]
    found: list[Skin] = []
    for i, k in enumerate(surface_of):
        soil = section.strata[k]
        angle = float(np.arctan(sign * (layers.left[i, 0] - layers.right[i, 0]) / layers.width[i]))
        if soil.cohesion + soil.cohesion_increase > 0.0 or angle <= 0.0 or soil.density_seismic == 0.0:
            continue
        phi = soil.friction_angle if friction is None else friction[k]
        seeps, light, held = _water_at(section, i, int(k), settings.least_depth)
        if held:
            continue
        ratio = (soil.density_ordinary - light / GRAVITY) / soil.density_seismic - settings.vertical
        drawn = sign * seeps / (GRAVITY * soil.density_seismic)
        kh = float(ratio * np.tan(phi - angle) - drawn)
        face = Skin(soil.name, float(layers.x[i]), float(layers.x[i + 1]), angle, kh, float(ratio), drawn)
        before = found[-1] if found else None
        if before and (before.end, before.stratum) == (face.start, face.stratum) and abs(before.angle - angle) < 1e-6:
            found[-1] = replace(before, end=face.end)
        else:
            found.append(face)
    return found


def faces_at(section: Section, settings: FemSettings, kh: float) -> list[Skin]:
    """The cohesionless faces that fall in the direction of the push; without shaking, in any."""
    directions = ("downhill", "uphill") if kh == 0.0 else (settings.direction,)
    return [face for d in directions for face in skins(section, settings.model_copy(update={"direction": d}))]


def least_rolling_factor(
    section: Section, faces: Sequence[Skin], kh: float, friction: Sequence[float] | np.ndarray
) -> float | None:
    """The smallest factor of safety of the skins of ``faces`` whose strata have ``friction`` (rad), None without any.

    It is tan φ / tan(β + atan k) with k = Kh γs / (γ - Kv γs). Water that seeps out adds to k what it takes off the
    face's Kh.
    """
    pushes = [float(np.arctan((kh + face.seepage) / face.ratio)) for face in faces]
    tangents = [float(np.tan(friction[_number(section, face)])) for face in faces]
    factors = [t / np.tan(face.angle + p) for face, t, p in zip(faces, tangents, pushes, strict=True)]
    return min(factors, default=None)


def _water_at(section: Section, interval: int, stratum: int, depth: float) -> tuple[float, float, bool]:
    """Seepage force to the right and uplift (N/m³) of the skin of the ground in an interval between breakpoints, and
    whether it is held by what presses on it from outside."""
    layers, water = section.layering, section.water_pressure
    x = 0.5 * float(layers.x[interval] + layers.x[interval + 1])
    z = 0.5 * float(layers.left[interval, 0] + layers.right[interval, 0])
    ground, upwards = np.array([[x, z]]), np.array([[0.0, 1.0]])
    held = bool(section.surface_loads.dead(ground, ground, upwards).any())
    if not water.present:
        return 0.0, 0.0, held
    # Pore pressure is linear below the ground, down to the next layer or to the water table.
    step = min(0.1 * depth, 0.1 * float(layers.left[interval, stratum] - layers.left[interval, stratum + 1]) + 1e-6)
    rise = water.slope((x, z - 1.01 * step), stratum, step)
    inside = water.at_rest(ground, ground, np.array([stratum]))
    held = held or bool(np.any(water.on_ground(ground, ground) > inside + UNLIKE))
    return float(-rise[0]), float(-rise[1]), held


def strengthened(section: Section, faces: Sequence[Skin], settings: FemSettings) -> Section:
    """The section with a stratum of its own for the ground down to the least depth below each of the faces.

    These strata have the soil of the face and an apparent cohesion, Δγ d sin 2β / (2 cos² φ) with Δγ = γ - Kv γs and d
    the least depth, vertically: with it they carry Kh = (γ / γs - Kv) tan φ, at which the same sand would fail on level
    ground. It goes to zero with the inclination; 0.5 m of dry sand of φ = 33° at 1:3 get 3.7 kPa. A stratum that is
    nowhere thicker than that is such a stratum as a whole.
    """
    strips = [(_number(section, face), _strip(section, face, settings)) for face in faces]
    strata: list[Stratum] = []
    for k, stratum in enumerate(section.strata):
        strata += [strip for number, strip in strips if number == k]
        if _left_over(section, k, faces, settings) > CENTIMETRE:
            strata.append(stratum)
    data = section.model_dump(mode="python", exclude_none=True, by_alias=True, include=set(Section.model_fields))
    data["strata"] = [s.model_dump(mode="python", exclude_none=True, by_alias=True) for s in strata]
    return Section.parse(data, section.name)


def without_strips(mesh: QuadMesh, section: Section) -> QuadMesh:
    """A mesh of the ``section`` strengthened, with the strata that the section had before."""
    names = [stratum.name for stratum in section.strata]
    own = [names.index(name if name in names else name.rpartition(STRIP)[0]) for name in mesh.strata]
    return replace(mesh, stratum=np.array(own)[mesh.stratum], strata=tuple(names))


def _number(section: Section, face: Skin) -> int:
    return next(k for k, stratum in enumerate(section.strata) if stratum.name == face.stratum)


def _left_over(section: Section, k: int, faces: Sequence[Skin], settings: FemSettings) -> float:
    """The largest thickness (m) of a stratum outside of the strips below its faces."""
    layers = section.layering
    thickness = np.maximum(layers.left[:, k] - layers.left[:, k + 1], layers.right[:, k] - layers.right[:, k + 1])
    for face in faces:
        if face.stratum == section.strata[k].name:
            below = (layers.x[:-1] >= face.start) & (layers.x[1:] <= face.end)
            thickness = thickness - np.where(below, settings.least_depth, 0.0)
    return float(thickness.max())


def _strip(section: Section, face: Skin, settings: FemSettings) -> Stratum:
    """The ground below a face, down to the least depth or to the bottom of its stratum."""
    layers, k = section.layering, _number(section, face)
    soil = section.strata[k]
    points: list[list[float]] = []
    for i in np.flatnonzero((layers.x[:-1] >= face.start) & (layers.x[1:] <= face.end)):
        x = layers.x[[i, i + 1]]
        ground, bottom = (np.array([layers.left[i, n], layers.right[i, n]]) for n in (0, k + 1))
        over = ground - settings.least_depth - bottom  # what is left of the stratum below the strip
        if over[0] * over[1] < 0.0:
            x = np.insert(x, 1, x[0] + np.diff(x)[0] * over[0] / (over[0] - over[1]))
        level = np.maximum(np.interp(x, x[[0, -1]], ground) - settings.least_depth, np.interp(x, x[[0, -1]], bottom))
        points += [[float(a), float(b)] for a, b in zip(x, level, strict=True) if [float(a), float(b)] not in points]
    i = int(np.flatnonzero((layers.x[:-1] >= face.start) & (layers.x[1:] <= face.end))[0])
    _, light, _ = _water_at(section, i, k, settings.least_depth)
    weight = GRAVITY * (soil.density_ordinary - settings.vertical * soil.density_seismic) - light
    cohesion = weight * settings.least_depth * np.sin(2.0 * face.angle) / (2.0 * np.cos(soil.friction_angle) ** 2)
    data = soil.model_dump(mode="python", exclude_none=True, by_alias=True)
    name = f"{soil.name}{STRIP}{face.start:g} m"
    return Stratum.model_validate({**data, "name": name, "bottom": {"elevation": points}, "cohesion": f"{cohesion} Pa"})
