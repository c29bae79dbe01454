"""Computes the one-dimensional site response: vertical shear waves in layers on a half-space, equivalent linear.

Time is in s, accelerations in m/s², stresses in Pa, depths in m. In each layer there are an upward wave A and a
downward wave B, computed from the free surface (A = B) down (P. B. Schnabel, J. Lysmer, H. B. Seed, SHAKE, EERC 72-12,
1972).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshes.section.quantity import GRAVITY

SOURCE = "P. B. Schnabel, J. Lysmer, H. B. Seed, SHAKE, EERC 72-12 (1972); curves of M. B. Darendeli (2001)"
ATMOSPHERE = 101_325.0  # Pa
EFFECTIVE_STRAIN_RATIO = 0.65  # of the largest strain, that stiffness and damping are taken at
# Rounds at most; the largest change of a stiffness or a damping at which they end, and up to which there is an answer.
MOST_ITERATIONS, TOLERANCE, LOOSE_TOLERANCE = 150, 0.002, 0.05
# Largest shear strains above which there is a warning, and above which there is no answer.
LARGE_STRAIN, LARGEST_STRAIN = 0.005, 0.015
# Of Darendeli (2001): curvature, the coefficients of his damping, 10 cycles at 1 Hz.
CURVATURE, CYCLES = 0.919, 10.0
SMALLEST_STRAIN = 1e-7


@dataclass(frozen=True)
class ColumnLayer:
    """Holds a layer: thickness (m), density (kg/m³), small-strain V_s (m/s), mean effective stress (Pa), plasticity
    (%)."""

    thickness: float
    density: float
    velocity: float
    mean_stress: float
    plasticity: float = 0.0
    stiffness: float = 1.0  # G over that of small strains
    damping: float = 0.01


@dataclass(frozen=True)
class HalfSpace:
    """Holds the half-space below the layers: density (kg/m³), V_s (m/s), damping."""

    density: float
    velocity: float
    damping: float = 0.01


@dataclass(frozen=True, eq=False)
class Response:
    """Holds the response of the layers.

    Attributes
    ----------
    depth (n + 1,) : depth of the tops of the layers, and of the half-space (m)
    acceleration (n + 1,) : largest acceleration at these depths, either way (m/s²)
    strain (n,) : largest shear strain in the middle of each layer (-)
    stress (n,) : largest shear stress at the bottom of each layer (Pa)
    average (n, t) : average acceleration of the soil above the bottom of each layer, in time (m/s²)
    layers : the layers with their final stiffness and damping
    rounds : number of iterations
    change : largest relative change of a stiffness or a damping by one more iteration
    """

    depth: np.ndarray
    acceleration: np.ndarray
    strain: np.ndarray
    stress: np.ndarray
    average: np.ndarray
    layers: tuple[ColumnLayer, ...]
    rounds: int
    change: float

    @property
    def warning(self) -> str:
        """Return the warning about the validity of the response, a sentence without its full stop; empty without
        any."""
        return warning(float(self.strain.max()))

    @property
    def k_max(self) -> np.ndarray:
        """Return the largest average acceleration over g above the bottom of each layer (Makdisi & Seed 1978)."""
        return np.abs(self.average).max(axis=1) / GRAVITY


def stiffness_and_damping(strain: float, mean_stress: float, plasticity: float) -> tuple[float, float]:
    """Return G/G_max and damping at a shear strain, of normally consolidated soil (Darendeli 2001).

    G/G_max = 1/(1 + (γ/γ_r)^0.919), γ_r = (0.0352 + 0.0010 PI) σ'^0.3483 in percent, σ' in atmospheres. Damping is the
    scaled damping by Masing's rule plus the damping at very small strain.
    """
    pressure = max(mean_stress, 1e3) / ATMOSPHERE
    reference = (0.0352 + 0.0010 * plasticity) * pressure**0.3483  # %
    gamma = 100.0 * max(strain, SMALLEST_STRAIN)
    ratio = 1.0 / (1.0 + (gamma / reference) ** CURVATURE)
    a = CURVATURE
    loop = gamma - reference * np.log((gamma + reference) / reference)
    masing = 100.0 / np.pi * (4.0 * loop / (gamma**2 / (gamma + reference)) - 2.0)
    first = -1.1143 * a**2 + 1.8618 * a + 0.2523
    second = 0.0805 * a**2 - 0.0710 * a - 0.0095
    third = -0.0005 * a**2 + 0.0002 * a + 0.0003
    masing = first * masing + second * masing**2 + third * masing**3
    scale = 0.6329 - 0.0057 * np.log(CYCLES)
    least = (0.8005 + 0.0129 * plasticity) * pressure**-0.2889
    return float(ratio), float(0.01 * (scale * ratio**0.1 * masing + least))


def waves(
    layers: Sequence[ColumnLayer], base: HalfSpace, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the upward and downward waves (n + 1, w) for A = B = 1 at the surface, and the wave numbers (n + 1, w)."""
    velocity = [layer.velocity * np.sqrt(layer.stiffness * (1.0 + 2j * layer.damping)) for layer in layers]
    velocity.append(base.velocity * np.sqrt(1.0 + 2j * base.damping))
    density = [*(layer.density for layer in layers), base.density]
    number = np.array([omega / v for v in velocity])
    up, down = np.ones_like(number), np.ones_like(number)
    for j, layer in enumerate(layers):
        ratio = density[j] * velocity[j] / (density[j + 1] * velocity[j + 1])
        following, back = (
            up[j] * np.exp(1j * number[j] * layer.thickness),
            down[j] * np.exp(-1j * number[j] * layer.thickness),
        )
        up[j + 1] = 0.5 * ((1.0 + ratio) * following + (1.0 - ratio) * back)
        down[j + 1] = 0.5 * ((1.0 - ratio) * following + (1.0 + ratio) * back)
    return up, down, number


def response(layers: Sequence[ColumnLayer], base: HalfSpace, step: float, outcrop: np.ndarray) -> Response:
    """Compute the response of layers to a motion of the half-space at an outcrop.

    Stiffness and damping are those at 0.65 of the largest strain of each layer, found by iteration as in SHAKE, until
    they change by less than 0.2 %. Under strong motions the iteration converges slowly; then a change of a few per cent
    is accepted, as in SHAKE (5 to 10 %: Schnabel, Lysmer & Seed 1972).

    Parameters
    ----------
    layers : the layers from the surface down
    base : half-space below the layers
    step : time step (s)
    outcrop (t,) : acceleration (m/s²) of the half-space at an outcrop

    Raises
    ------
    ValueError : if one more iteration would still change a stiffness or a damping by more than 5 %
    """
    motion = _Motion.of(step, outcrop)
    now = best = tuple(layers)
    least = np.inf
    for rounds in range(1, MOST_ITERATIONS + 1):  # noqa: B007  # reported below
        curves = _curves(now, _strain(now, base, motion))
        change = max(_change(new, old) for new, old in zip(curves, now, strict=True))
        if change < least:
            best, least = curves, change
        if change < TOLERANCE:
            break
        now = curves
    if least > LOOSE_TOLERANCE:
        raise ValueError(
            f"stiffness and damping still change by {100.0 * least:.1f} % after {MOST_ITERATIONS} iterations; 5 % is "
            "accepted"
        )
    return _response(best, base, motion, rounds, least)


def warning(strain: float) -> str:
    """Return the warning about layers whose shear strain is too large for equivalent linear analysis; empty if there
    are none."""
    if strain <= LARGE_STRAIN:
        return ""
    message = f"the largest shear strain is {100.0 * strain:.3g} %"
    if strain <= LARGEST_STRAIN:
        return (
            f"{message}, above {100.0 * LARGE_STRAIN:g} %: equivalent linear layers have one stiffness and one damping "
            "for all of the record, and soften motions of high frequency too much"
        )
    return (
        f"{message}, above {100.0 * LARGEST_STRAIN:g} %: equivalent linear layers are not valid there, since the "
        f"strength of the soil does not limit their stresses; acceleration, k_max and strain are not a prediction, and "
        f"a nonlinear analysis is needed"
    )


def _curves(layers: Sequence[ColumnLayer], strain: np.ndarray) -> tuple[ColumnLayer, ...]:
    """Return the layers with stiffness and damping at 0.65 of their largest strains."""
    pairs = [stiffness_and_damping(EFFECTIVE_STRAIN_RATIO * g, layer.mean_stress, layer.plasticity)
             for g, layer in zip(strain, layers, strict=True)]  # fmt: skip
    return tuple(replace(layer, stiffness=r, damping=d) for layer, (r, d) in zip(layers, pairs, strict=True))


def _change(new: ColumnLayer, old: ColumnLayer) -> float:
    return max(abs(new.stiffness / old.stiffness - 1.0), abs(new.damping / old.damping - 1.0))


@dataclass(frozen=True, eq=False)
class _Motion:
    """Holds the outcrop motion by frequency: angular frequencies, spectrum, and number of time steps."""

    omega: np.ndarray
    spectrum: np.ndarray
    count: int
    length: int

    @classmethod
    def of(cls, step: float, outcrop: np.ndarray) -> "_Motion":
        count = 1 << int(np.ceil(np.log2(2 * len(outcrop))))  # so that the end does not come round to the beginning
        omega = 2.0 * np.pi * np.fft.rfftfreq(count, step)
        return cls(omega, np.fft.rfft(outcrop, count), count, len(outcrop))

    def in_time(self, transfer: np.ndarray) -> np.ndarray:
        """Return the motion in time (rows, t) after a transfer function was applied to the motion."""
        return np.asarray(np.fft.irfft(transfer * self.spectrum, self.count)[:, : self.length])


def _strain(layers: Sequence[ColumnLayer], base: HalfSpace, motion: _Motion) -> np.ndarray:
    omega = motion.omega
    up, down, number = waves(layers, base, omega)
    half = np.array([0.5 * layer.thickness for layer in layers])[:, None]
    per = 1.0 / (2.0 * up[-1])  # the outcrop moves twice the wave that comes up in the half-space
    turn = np.exp(1j * number[:-1] * half)
    slope = 1j * number[:-1] * (up[:-1] * turn - down[:-1] / turn) * per
    with np.errstate(divide="ignore", invalid="ignore"):
        strain = np.where(omega > 0.0, slope / -(omega**2), 0.0)
    return np.asarray(np.abs(motion.in_time(strain)).max(axis=1))


def _response(layers: Sequence[ColumnLayer], base: HalfSpace, motion: _Motion, rounds: int, change: float) -> Response:
    """Return the response of the layers; the shear stress at a depth is the inertia of the mass above it."""
    omega = motion.omega
    up, down, number = waves(layers, base, omega)
    per = 1.0 / (2.0 * up[-1])
    thick = np.array([layer.thickness for layer in layers])
    weight = np.cumsum(thick * [layer.density for layer in layers])  # kg/m² above each bottom
    moved = np.empty((len(layers), len(omega)), dtype=complex)
    for j, layer in enumerate(layers):
        turn = np.exp(1j * number[j] * layer.thickness)
        with np.errstate(divide="ignore", invalid="ignore"):
            integral = (up[j] * (turn - 1.0) - down[j] * (1.0 / turn - 1.0)) / (1j * number[j])
        moved[j] = layer.density * np.where(omega > 0.0, integral, (up[j] + down[j]) * layer.thickness)
    stress = motion.in_time(np.cumsum(moved, axis=0) * per)
    return Response(
        np.concatenate([[0.0], np.cumsum(thick)]),
        np.abs(motion.in_time((up + down) * per)).max(axis=1),
        _strain(layers, base, motion),
        np.abs(stress).max(axis=1),
        stress / weight[:, None],
        tuple(layers),
        rounds,
        change,
    )
