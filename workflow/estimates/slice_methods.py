"""Computes the equilibrium of slices: Bishop's simplified method for circles, Spencer's method for any slip surface.

Sources: Bishop 1955, Géotechnique 5(1), 7-17; Spencer 1967, Géotechnique 17(1), 11-26; both in the form of Duncan,
Wright & Brandon 2014, Soil Strength and Slope Stability, chapter 6. Signs and units are those of
`workflow.estimates.slices`; arrays of a surface are (surfaces,).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workflow.estimates.slices import Slices

# cos α + sin α tan φ / F below this makes the normal force of a slice meaningless (Whitman & Bailey 1967). Slices below
# it have the normal force at this value, which is smaller; a circle counts if they bear no more than this share of its
# shear force: a thin layer of gravel at the toe, where the circle leaves the ground steeply. Whatever they bear, the
# factor of safety is then right to this share, by which Bishop's and Spencer's methods differ at most on the critical
# circle of 95 in 100 published slopes with friction (112 slopes: 0.2 % at the median, 1.8 % in 95 of 100, at most 4 %).
LEAST_M_ALPHA, LARGEST_STEEP_SHARE = 0.2, 0.02
STEPS, TOLERANCE = 100, 1e-7
FACTORS = np.geomspace(100.0, 0.02, 60)
LARGEST_KH = 5.0
STEEPEST_SIDE = np.radians(60.0)  # of the forces between slices, by Spencer's method


def bishop_factor(slices: Slices, x: np.ndarray, z: np.ndarray, radius: np.ndarray, kh: float = 0.0) -> np.ndarray:
    """Return the factor of safety of circular slip surfaces by Bishop's simplified method, NaN where no factor was
    found.

    Parameters
    ----------
    slices : Slices
    x, z, radius : (surfaces,) ndarray
        Centre (mirrored x as in ``slices``) and radius of each circle (m).
    kh : float
        Horizontal seismic coefficient, towards the slide.
    """
    driving = -(_moments(slices, x, z) @ np.array([1.0, kh]))
    vertical = slices.vertical + kh * slices.inertia_vertical
    result = np.full(len(x), np.nan)
    # Surfaces whose factor still changes; each surface leaves as soon as its factor is constant.
    moving = np.flatnonzero(driving > 0.0)
    bases, factor = _Bases.of(slices, vertical).of_surfaces(moving), np.ones(len(moving))
    for _ in range(STEPS):
        before, factor = factor, radius[moving] / driving[moving] * bases.shear(factor)[0].sum(axis=1)
        with np.errstate(invalid="ignore"):  # inf - inf, of a factor that grows without limit
            moves = np.abs(factor - before) > TOLERANCE * np.abs(factor)
        if not moves.all():
            result[moving[~moves]] = factor[~moves]
            moving, factor = moving[moves], factor[moves]
            bases = bases.of_surfaces(moves)
        if not len(moving):
            break
    shear, m_alpha = _Bases.of(slices, vertical).shear(np.where(np.isfinite(result), result, 1.0))
    sound = _is_sound(shear, m_alpha) & (result > 0.0) & (result < FACTORS[0])
    return np.where(sound, result, np.nan)


def bishop_critical_kh(slices: Slices, x: np.ndarray, z: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Return the seismic coefficient at which circular slip surfaces have a factor of safety of 1, in closed form.

    With F = 1 the forces of Bishop's simplified method are linear in Kh. The coefficient is NaN if the surface cannot
    slide.

    Parameters
    ----------
    slices, x, z, radius : as for `bishop_factor`; pore pressures are those during shaking
    """
    ones = np.ones(len(x))
    static_part, m_alpha = _Bases.of(slices, slices.vertical).shear(ones)
    without_weight = _Bases.of(slices, 0.0 * slices.vertical).shear(ones)[0]
    seismic_part = _Bases.of(slices, slices.inertia_vertical).shear(ones)[0] - without_weight
    moments = _moments(slices, x, z)
    resisting, added = (
        radius * static_part.sum(axis=1) + moments[:, 0],
        radius * seismic_part.sum(axis=1) + moments[:, 1],
    )
    sound = _is_sound(static_part, m_alpha) & (added < 0.0)
    return np.where(sound, -resisting / np.where(sound, added, 1.0), np.nan)


def _is_sound(shear: np.ndarray, m_alpha: np.ndarray) -> np.ndarray:
    """Return whether the normal forces of circles have a meaning: next to no shear force (surfaces, slices) is borne by
    slices whose ``m_alpha`` is too small."""
    steep = np.where(m_alpha < LEAST_M_ALPHA, np.abs(shear), 0.0).sum(axis=1)
    return steep <= LARGEST_STEEP_SHARE * np.abs(shear.sum(axis=1))


def _moments(slices: Slices, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return moments (surfaces, 2) about the centres, counter-clockwise: the moments of the known forces, and the
    moments of the forces by Kh = 1."""
    right, up = slices.x - x[:, None], slices.z - z[:, None]
    static_part = slices.moment + right * slices.vertical - up * slices.horizontal
    added = slices.inertia_moment + right * slices.inertia_vertical - up * slices.inertia
    return np.stack([static_part.sum(axis=1), added.sum(axis=1)], axis=1)


@dataclass(frozen=True)
class _Bases:
    """Holds what the shear forces at the bases of slices depend on; all arrays are (surfaces, slices).

    Attributes
    ----------
    vertical : known forces on the slice, upwards (N/m)
    sin, cos : of the slope α of the base
    bond : shear strength of the base times its length without the normal force, (c - u tan φ) l (N/m)
    friction : tan φ
    """

    vertical: np.ndarray
    sin: np.ndarray
    cos: np.ndarray
    bond: np.ndarray
    friction: np.ndarray

    @classmethod
    def of(cls, slices: Slices, vertical: np.ndarray) -> "_Bases":
        """Return the bases of slices under the forces ``vertical``."""
        bond = (slices.cohesion - slices.pressure * slices.friction) * slices.length
        return cls(vertical, np.sin(slices.angle), np.cos(slices.angle), bond, slices.friction)

    def of_surfaces(self, surfaces: np.ndarray) -> "_Bases":
        """Return the bases of some surfaces, by index or by a mask."""
        return _Bases(*(part[surfaces] for part in vars(self).values()))

    def shear(self, factor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the shear forces at the bases times F (N/m), from the balance of vertical forces of each slice, and
        m_α."""
        with np.errstate(divide="ignore", invalid="ignore"):  # of a factor that falls to 0: NaN
            m_alpha = self.cos + self.sin * (self.friction / factor[:, None])
            balance = -self.vertical - self.bond * self.sin / factor[:, None]
            normal = balance / np.maximum(m_alpha, LEAST_M_ALPHA)
        return self.bond + normal * self.friction, m_alpha


@dataclass(frozen=True)
class Balance:
    """Holds the equilibrium of one slip surface by Spencer's method.

    Attributes
    ----------
    factor : factor of safety
    kh : seismic coefficient to which the factor belongs
    inclination : inclination θ of the forces between slices (rad), positive if they rise to the right
    """

    factor: float
    kh: float
    inclination: float


def spencer_factor(slices: Slices, kh: float = 0.0) -> Balance | None:
    """Return the factor of safety of one slip surface by Spencer's method.

    Parameters
    ----------
    slices : slices of one slip surface
    kh : horizontal seismic coefficient, towards the slide

    Returns
    -------
    The equilibrium; None if no factor between 0.02 and 100 balances forces and moments.
    """

    def force_balance(theta: float) -> float:
        residual = _residuals(slices, FACTORS, kh, theta)[0]
        changes = np.flatnonzero(residual[1:] * residual[:-1] <= 0.0)
        if not len(changes):
            return np.nan
        first = changes[0]
        return float(
            _root(lambda f: _residuals(slices, np.array([f]), kh, theta)[0][0], FACTORS[first + 1], FACTORS[first])
        )

    balance = _moment_balance(force_balance, lambda f, theta: float(_residuals(slices, np.array([f]), kh, theta)[1][0]))
    return None if balance is None else Balance(balance[0], kh, balance[1])


def spencer_critical_kh(slices: Slices) -> Balance | None:
    """Return the seismic coefficient at which Spencer's factor of safety of one slip surface is 1.

    Parameters
    ----------
    slices : slices of one slip surface, with pore pressures during shaking

    Returns
    -------
    The equilibrium; None if no coefficient between -5 and 5 balances forces and moments.
    """
    ones = np.ones(1)

    def force_balance(theta: float) -> float:
        static_part, seismic = (_residuals(slices, ones, kh, theta)[0][0] for kh in (0.0, 1.0))
        kh = static_part / (static_part - seismic)  # linear in Kh
        return float(kh) if abs(kh) <= LARGEST_KH else np.nan

    balance = _moment_balance(force_balance, lambda kh, theta: float(_residuals(slices, ones, kh, theta)[1][0]))
    return None if balance is None else Balance(1.0, *balance)


def _residuals(slices: Slices, factor: np.ndarray, kh: float, theta: float) -> tuple[np.ndarray, np.ndarray]:
    """Return, for one surface, the sums over the slices of the side forces Q and of their moments, (factors,); NaN if
    the normal force of a slice has no meaning.

    Q is the resultant of both side forces of a slice, at the angle θ. The distance of Q from the middle of the base
    follows from the moments of the known forces.
    """
    up = (slices.vertical + kh * slices.inertia_vertical)[0]
    right = (slices.horizontal + kh * slices.inertia)[0]
    moment = (slices.moment + kh * slices.inertia_moment)[0].sum()
    angle, x, z = slices.angle[0], slices.x[0], slices.z[0]
    tan = slices.friction[0] / factor[:, None]
    along = right * np.cos(angle) + up * np.sin(angle)
    across = -right * np.sin(angle) + up * np.cos(angle)
    bond = (
        slices.cohesion[0] / factor[:, None] * slices.length[0] - (across + slices.pressure[0] * slices.length[0]) * tan
    )
    m_alpha = np.cos(angle - theta) + np.sin(angle - theta) * tan
    side = -(along + bond) / np.maximum(m_alpha, LEAST_M_ALPHA)
    steep = np.where(m_alpha < LEAST_M_ALPHA, np.abs(side), 0.0).sum(axis=1)
    side = np.where((steep <= LARGEST_STEEP_SHARE * np.abs(side).sum(axis=1))[:, None], side, np.nan)
    turning = (side * (x * np.sin(theta) - z * np.cos(theta))).sum(axis=1) - moment
    return side.sum(axis=1), turning


def _moment_balance(
    force_balance: Callable[[float], float], moment: Callable[[float, float], float]
) -> tuple[float, float] | None:
    """Return the factor of safety, and the inclination θ of the side forces, at which forces and moments balance.

    There is none where the method has no solution: on 48 of 319 critical circles of published slopes, most of them
    steep, where the ground at the crest would be in tension, or deep circles that leave the ground steeply. Circles
    beside them have none either, or factors that are much larger.
    """
    angles = np.linspace(-STEEPEST_SIDE, STEEPEST_SIDE, 25)
    values = np.array([force_balance(theta) for theta in angles])
    turning = np.array([moment(value, theta) for value, theta in zip(values, angles, strict=True)])
    changes = np.flatnonzero(turning[1:] * turning[:-1] <= 0.0)
    for k in changes[np.argsort(np.abs(angles[changes]), kind="stable")]:  # the flattest side forces first
        theta = _root(lambda angle: moment(force_balance(angle), angle), angles[k], angles[k + 1], 1e-8)
        if np.isfinite(theta) and np.isfinite(value := force_balance(theta)):
            return value, theta
    return None


def _root(function: Callable[[float], float], low: float, high: float, tolerance: float = 2e-12) -> float:
    """Return the zero of a function of one variable between two ends, by Brent's method; NaN if the function has no
    value somewhere between the ends, where the normal force of a slice has no meaning."""
    from scipy.optimize import brentq  # what only reads answers of slices does without it

    def defined(place: float) -> float:
        if np.isnan(value := function(place)):
            raise _UndefinedError
        return value

    try:
        return float(brentq(defined, low, high, xtol=tolerance))
    except _UndefinedError:
        return np.nan


class _UndefinedError(ArithmeticError):
    """Raised where a function has no value."""
