"""Computes the Kh at which a cohesionless face fails in a shallow layer.

Sand without cohesion fails first at its inclined surface, in a layer of no thickness along the face. No mesh resolves
the failure of a layer without thickness, and practitioners want to know the failure of the whole slope. The Kh of the
shallow failure is therefore computed in closed form. Where the shallow failure governs, `face_reinforcement`
strengthens the ground below the face, so that deeper failures are found.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fem.continuum.loads import direction_of, seismic_sign
from fem.settings import FemSettings
from meshes.section.cutting import BELOW_WATER
from meshes.section.layering import Layering
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section

# Inclination (rad) up to which ground counts as level: its Kh equals that of level ground to four digits, and the
# cohesion that would stabilise it is below the margin of stresses from the yield surface.
LEVEL_ANGLE = 1e-4
# Difference (Pa) up to which two pressures count as equal.
PRESSURE_TOLERANCE = 1.0
# Water less than the least depth below a face is taken into account if this part of the face is longer than this
# multiple of the depth.
LONG_WATER_RATIO = 10.0
# If the part is shorter than that but longer than this multiple of the depth, a shallow failure is possible.
SHORT_WATER_RATIO = 3.0
# Difference up to which two angles (rad), or two seismic coefficients, are identical.
ANGLE_TOLERANCE = 1e-9
# Difference up to which two seismic coefficients count as equal, since the pressure of seeping water varies slightly:
# a coefficient, or a share of it if that is more.
KH_TOLERANCE, KH_SHARE = 5e-4, 0.03


@dataclass(frozen=True)
class ShallowFailure:
    """Holds a straight face of a cohesionless stratum that is inclined in the direction of the seismic force.

    The pore pressure gradient below the face is constant.

    Attributes
    ----------
    stratum : name of the stratum
    start, end : horizontal coordinates of both ends (m); ``start`` is the smaller coordinate
    angle : inclination of the face (rad), positive
    kh : critical Kh of the face (-); it is negative if the face fails under its own weight
    ratio : weight less vertical inertia and uplift, over the seismic weight (-)
    seepage : seepage force in the direction of the seismic force, over the seismic weight (-)
    into_water : whether the water table lies below the face, within the least depth, and so reduces the critical Kh of
        the face
    """

    stratum: str
    start: float
    end: float
    angle: float
    kh: float
    ratio: float = 1.0
    seepage: float = 0.0
    into_water: bool = False

    def continues_as(self, other: "ShallowFailure") -> bool:
        """Return whether the neighbouring piece to the right, ``other``, is a face with the same stratum, slope and
        critical Kh."""
        own_properties, other_properties = ((face.angle, face.kh, face.ratio, face.seepage) for face in (self, other))
        adjoins = (self.end, self.stratum, self.into_water) == (other.start, other.stratum, other.into_water)
        return adjoins and bool(np.allclose(own_properties, other_properties, rtol=0.0, atol=ANGLE_TOLERANCE))


class _Piece(NamedTuple):
    """Holds a piece of the ground surface from ``start`` to ``end`` (m) in one ``interval`` between breakpoints of the
    layers. ``number`` is the number of its stratum. ``strata`` are the strata of this soil, two if the water table
    divides the soil.
    """

    start: float
    end: float
    interval: int
    number: int
    strata: int

    @property
    def middle(self) -> float:
        """Return the horizontal coordinate of the middle of the face (m)."""
        return 0.5 * (self.start + self.end)

    def is_long(self, depth: float) -> bool:
        """Return whether the face is long enough that pore pressure down to a ``depth`` (m) below it affects the
        face."""
        return self.end - self.start >= LONG_WATER_RATIO * depth


def shallow_failures(
    section: Section,
    settings: FemSettings,
    friction: Sequence[float] | np.ndarray | None = None,
    excess_pressure: bool = True,
) -> list[ShallowFailure]:
    """Find all cohesionless faces of a section, from left to right, and the Kh at which each of them fails.

    On a face inclined by β a layer of any thickness slides when the resultant of weight γ - Kv γs and seismic force Kh
    γs makes the angle φ with the normal of the face: Kh = (γ / γs - Kv) tan(φ - β), γ the ordinary and γs the seismic
    unit weight (the infinite slope of Skempton & DeLory 1957 with a horizontal acceleration). The pore pressure
    gradient just below the face reduces γ, and its component in the direction of the seismic force reduces Kh γs. Where
    the water table lies less than the least depth below the face, the layer down to the least depth counts instead if
    it slides first. A face ends where its slope, its stratum or its water change. Faces below a surcharge or free water
    do not slide in this way and are left out.

    Parameters
    ----------
    section : the ground
    settings : settings of the finite elements, with the direction of the seismic force, Kv and the least depth (m)
    friction (strata,) : friction angles (rad) that replace those of the strata
    excess_pressure : whether the excess pore pressure by shaking acts

    Returns
    -------
    The faces that are inclined in the direction of the force; none if there are none.
    """
    layers, sign = section.layering, seismic_sign(section, settings)
    faces: list[ShallowFailure] = []
    for piece in _surface_pieces(section, settings.least_depth):
        i, soil = piece.interval, section.strata[piece.number]
        rise = sign * (layers.left[i, 0] - layers.right[i, 0])
        if soil.has_cohesion or rise <= LEVEL_ANGLE * layers.width[i] or soil.density_seismic == 0.0:
            continue
        if _is_stable_anyway(section, piece, excess_pressure):
            continue
        angle = float(np.arctan(rise / layers.width[i]))
        phi = soil.friction_angle if friction is None else friction[piece.number]
        choices = [
            (float(ratio * np.tan(phi - angle) - sign * drawn), ratio, sign * drawn)
            for ratio, drawn in _forces(section, piece, settings, excess_pressure)
        ]
        if not choices:  # where a stratum pinches out, it is thinner than the tolerance of points
            continue
        face = ShallowFailure(
            soil.name, piece.start, piece.end, angle, *min(choices), into_water=max(piece.strata, len(choices)) > 1
        )
        if faces and faces[-1].continues_as(face):
            faces[-1] = replace(faces[-1], end=face.end)
        else:
            faces.append(face)
    return faces


def failing_at_rest(
    section: Section, settings: FemSettings, friction: Sequence[float] | np.ndarray | None = None
) -> list[ShallowFailure]:
    """Find the cohesionless faces inclined against the seismic force that fail by their weight alone.

    Such a face has no stress field in equilibrium without a seismic force, for example because seepage leaves the
    ground there, and fails before the slope fails in the direction of the force.

    Parameters
    ----------
    section, settings, friction : as in `shallow_failures`

    Returns
    -------
    The faces whose Kh, against the direction of the settings, is negative.
    """
    against = settings.changed(direction=direction_of(settings, opposite=True))
    return [face for face in shallow_failures(section, against, friction) if face.kh < 0.0]


def merged_faces(faces: Iterable[ShallowFailure]) -> list[ShallowFailure]:
    """Merge neighbouring faces of one stratum, dry or wet, whose Kh is nearly equal.

    Parameters
    ----------
    faces : faces from left to right, as `shallow_failures` returns them

    Returns
    -------
    The faces; those whose Kh differs by less than 0.0005, or by less than 3 %, are merged into one face, which has the
    smallest Kh.
    """
    failures: list[ShallowFailure] = []
    for face in faces:
        last = failures[-1] if failures else None
        near = last and abs(last.kh - face.kh) < max(KH_TOLERANCE, KH_SHARE * abs(last.kh))
        if last and near and (last.stratum, last.end) == (face.stratum, face.start):
            failures[-1] = replace(min(last, face, key=lambda piece: piece.kh), start=last.start, end=face.end)
        else:
            failures.append(face)
    return failures


def faces_at(section: Section, settings: FemSettings, kh: float) -> list[ShallowFailure]:
    """Return the cohesionless faces that may fail at a Kh.

    Parameters
    ----------
    section : the ground
    settings : settings of the finite elements, with the direction of the seismic force
    kh : seismic coefficient (-)

    Returns
    -------
    The faces inclined in the direction of the seismic force, or in any direction at Kh = 0, where no excess pore
    pressure by shaking acts.
    """
    directions = ("downhill", "uphill") if kh == 0.0 or settings.direction == "both" else (settings.direction,)
    variants = [settings.changed(direction=direction) for direction in directions]
    return [face for variant in variants for face in shallow_failures(section, variant, excess_pressure=kh != 0.0)]


def has_uncounted_water(section: Section, face: ShallowFailure, depth: float) -> bool:
    """Return whether water that the critical Kh of a dry face does not count stands close below a part of the face.

    In such a part, which is short, shallow ground may slip before the face fails.

    Parameters
    ----------
    section : the ground with its water
    face : a cohesionless face
    depth : the least depth (m)

    Returns
    -------
    True if there is pore pressure at the depth below either end of the face, a little inside, and none on the ground
    there; False if the Kh of the face counts water.
    """
    shortest_part = min(SHORT_WATER_RATIO * depth, 0.5 * (face.end - face.start))
    x = np.array([face.start + shortest_part, face.end - shortest_part])
    ground = np.column_stack([x, section.layering.interface(0, x)])
    below, strata = ground - np.array([0.0, depth]), np.full(2, _number(section, face))
    at_rest = section.water_pressure.at_rest
    emerging = (at_rest(below, below, strata) > PRESSURE_TOLERANCE) & (
        at_rest(ground, ground, strata) <= PRESSURE_TOLERANCE
    )
    return not face.into_water and bool(emerging.any())


def least_rolling_factor(
    section: Section, faces: Sequence[ShallowFailure], kh: float, friction: Sequence[float] | np.ndarray
) -> float | None:
    """Return the smallest factor of safety against the shallow failure of cohesionless faces.

    The factor of a face is tan φ / tan(β + atan k) with k = Kh γs / (γ - Kv γs). Seepage out of the face increases k by
    the amount by which it reduces the Kh of the face.

    Parameters
    ----------
    section : the ground
    faces : faces of the section
    kh : seismic coefficient, positive in the direction of the faces (-)
    friction (strata,) : friction angles of the strata (rad)

    Returns
    -------
    The factor (-); None without faces that the forces can move.
    """
    factors = []
    for face in faces:
        driven = face.angle + float(np.arctan2(kh + face.seepage, face.ratio))
        if driven > 0.0:  # else water that seeps in holds it
            factors.append(float(np.tan(friction[_number(section, face)]) / np.tan(min(driven, 0.5 * np.pi))))
    return min(factors, default=None)


def _surface_pieces(section: Section, depth: float) -> Iterator[_Piece]:
    """Yield the pieces of the ground surface from left to right, cut where slope, stratum or water change within a
    ``depth`` (m)."""
    layers = section.layering
    names = [stratum.name for stratum in section.strata]
    surface = np.where(layers.present().any(axis=1), layers.present().argmax(axis=1), -1).tolist()
    x = np.concatenate([layers.x, section.water_pressure.kinks])
    for i, k in enumerate(surface):  # -1 where the base crops out
        depth_margins = [depth - (end[i, 0] - end[i, k + 1]) for end in (layers.left, layers.right)]
        if depth_margins[0] * depth_margins[1] < 0.0:
            x = np.append(x, layers.x[i] + layers.width[i] * depth_margins[0] / (depth_margins[0] - depth_margins[1]))
    x = np.unique(x)
    x = x[np.isin(x, layers.x) | (np.abs(x[:, None] - layers.x).min(axis=1) > layers.tolerance)]
    for start, end in pairwise(x):
        i = int(np.searchsorted(layers.x, 0.5 * (start + end))) - 1
        if (k := surface[i]) < 0:
            continue
        cut_by_water = k + 1 < len(names) and names[k + 1] == names[k] + BELOW_WATER
        yield _Piece(
            float(start), float(end), i, k, 2 if cut_by_water and end - start >= LONG_WATER_RATIO * depth else 1
        )


def _is_stable_anyway(section: Section, piece: _Piece, excess_pressure: bool) -> bool:
    """Return whether a surcharge, or free water above the water table, prevents the shallow failure of a piece of the
    surface.
    """
    water, middle = section.water_pressure, np.array([piece.middle])
    ground = np.column_stack([middle, section.layering.interface(0, middle)])
    if section.surface_loads.dead(ground, ground, np.array([[0.0, 1.0]])).any():
        return True
    inside = water.inside(ground, ground, np.array([piece.number]), excess_pressure)
    return water.present and bool(np.any(water.on_ground(ground, ground) > inside + PRESSURE_TOLERANCE))


def _forces(
    section: Section, piece: _Piece, settings: FemSettings, excess_pressure: bool
) -> Iterator[tuple[float, float]]:
    """Yield two forces over the seismic weight: the weight less Kv and uplift, and the seepage force to the right. The
    first pair are the forces in the soil just below a piece of ground. If the layer down to the least depth reaches
    into water, a second pair are the forces on this whole layer.

    Between the ground surface and the least depth the forces vary linearly, so that a layer of a depth in between never
    slides first.
    """
    layers, water = section.layering, section.water_pressure
    bounds = layers.interfaces(np.array([piece.middle]))[0]
    down, right, seismic = 0.0, 0.0, 0.0
    for k, top, thickness in _sheets(section, piece, bounds, settings.least_depth):
        soil, rise = section.strata[k], np.zeros(2)
        if water.present:
            step = min(0.05 * thickness, 0.05 * (piece.end - piece.start), 0.05 * thickness / _steepness(layers, piece))
            rise = water.slope((piece.middle, top - 0.5 * thickness), k, step, excess_pressure)
        down += thickness * float(soil.density_ordinary - settings.vertical * soil.density_seismic + rise[1] / GRAVITY)
        right -= thickness * float(rise[0]) / GRAVITY
        seismic += thickness * soil.density_seismic
        if seismic > 0.0:
            yield down / seismic, right / seismic


def _sheets(
    section: Section, piece: _Piece, bounds: np.ndarray, least_depth: float
) -> Iterator[tuple[int, float, float]]:
    """Yield stratum, top (m) and thickness (m) of the layers below a piece, down to the least depth. If the part above
    or below the water table is so thin that the section does not divide the stratum, the layer is divided here.
    """
    for k in range(piece.number, piece.number + piece.strata):
        top, lowest = float(bounds[k]), float(max(bounds[k + 1], bounds[0] - least_depth))
        if top <= lowest:
            continue
        level = (
            top
            if piece.strata > 1 or not piece.is_long(least_depth)
            else _head_elevation(section, piece, k, top, lowest)
        )
        for upper, lower in ((top, level), (level, lowest)):
            if upper - lower > section.layering.tolerance:
                yield k, upper, upper - lower


def _head_elevation(section: Section, piece: _Piece, k: int, top: float, lowest: float) -> float:
    """Return the elevation (m) between ``lowest`` and ``top`` above which the pore pressure at rest in stratum k is
    zero; ``top`` if the stratum is entirely wet or entirely dry. Below the returned elevation the pore pressure is
    linear.
    """
    x, water = piece.middle, section.water_pressure
    ends = np.array([[x, top], [x, lowest + 0.1 * (top - lowest)], [x, lowest]])
    above, below, deep = water.at_rest(ends, ends, np.full(3, k))
    if not water.present or above > PRESSURE_TOLERANCE or deep <= PRESSURE_TOLERANCE or deep <= below:
        return top
    return float(np.clip(lowest + 0.1 * (top - lowest) * deep / (deep - below), lowest, top))


def _steepness(layers: Layering, piece: _Piece) -> float:
    """Return the largest slope (-) of any interface in the interval of a piece, or 1."""
    slopes = np.abs(layers.right[piece.interval] - layers.left[piece.interval]) / layers.width[piece.interval]
    return max(1.0, float(slopes.max()))


def _number(section: Section, face: ShallowFailure) -> int:
    return next(k for k, stratum in enumerate(section.strata) if stratum.name == face.stratum)
