"""Updates the stress of a material point in plane strain (kernel).

Stress is Mohr-Coulomb without dilation: with t the radius and p the mean of Mohr's circle in the plane (compression
positive) t <= c cos φ + p sin φ, the out-of-plane stress the intermediate one, returned at constant p (de Souza Neto,
Perić & Owen 2008, sec. 8.2, with ψ = 0); a mean tension beyond the apex opens a crack, and the crack has to close
before the ground carries pressure again. With a tension cut-off the largest principal stress opens a crack. Below a
radius of Mohr's circle, ground that strains by its strain potential has a smaller shear modulus and a viscosity.

A point may have a plane of weakness, as the ubiquitous joints of Zienkiewicz & Pande (1977, Int. J. Numer. Anal.
Methods Geomech. 1, 219): the shear stress τ along the plane is at most c_p + σ sin φ_p with the normal stress σ on the
plane (compression positive), its stress-strain law is that of soft ground, and every other strain is that of the ground
around. With n half the difference of the normal stresses along and across the plane, Mohr's circle has the radius
√(n² + τ²); where both limits are exceeded the stress returns to the nearest point of both. The stress rotates with the
plane, which slip along it does not rotate.

Stress is positive in tension, Pa, [xx, zz, xz].
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Properties of a point: Lamé's λ + G (Pa), shear modulus (Pa), c cos φ (Pa), sin φ, largest tensile stress (Pa), rate
# of volumetric strain by drainage (1/s, shrinking positive), weight over seismic mass; smaller shear modulus (Pa) below
# a radius of Mohr's circle (Pa), and viscosity (Pa s) there. Of a plane of weakness: the shear modulus (Pa) of strains
# along it, 0 without a plane; c_p (Pa), sin φ_p, and its slope dz/dx.
BULK, SHEAR, STRENGTH, SIN_PHI, TENSION_LIMIT, DRAINAGE_RATE, WEIGHT_RATIO = range(7)
SOFT_SHEAR, SOFT_RADIUS, VISCOSITY = range(7, 10)
PLANE_SHEAR, PLANE_STRENGTH, PLANE_SINE, PLANE_SLOPE = range(10, 14)
PROPERTIES = 14
# Strain of a crack beyond which the ground is loose and bears no stress until the crack closes: loose points that kept
# the stress along their crack gained energy from the grid. A slide was 4.3 to 5.1 m with strains of 0.15 to 0.02.
LOOSE_STRAIN = 0.02
# A limit of tension above this (Pa) is none, and one above this share of c / tan φ is the apex of the cone.
LEAST_UNLIMITED, CUT_OFF_SHARE = 1e29, 1.0 - 1e-9
# State of a point: volume (m²), mass (kg/m), volumetric strain of open cracks, plastic shear strain; viscous part (Pa)
# of half the difference of the normal stresses, and of the shear stress.
VOLUME, MASS, OPENED_STRAIN, PLASTIC_STRAIN, VISCOUS_HALF_DIFFERENCE, VISCOUS_SHEAR = range(6)
STATE = 6


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _strain_of(radius: float, shear: float, soft: float, knee: float) -> float:
    """Return the elastic shear strain at a radius of Mohr's circle (Pa)."""
    return radius / soft if radius < knee else (knee / soft if knee > 0.0 else 0.0) + (radius - knee) / shear


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _radius_of(strain: float, shear: float, soft: float, knee: float) -> float:
    """Return the radius of Mohr's circle (Pa) at an elastic shear strain. The function is the inverse of
    `_strain_of`."""
    knee_strain = knee / soft if knee > 0.0 else 0.0
    return soft * strain if strain < knee_strain else knee + shear * (strain - knee_strain)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _shear_energy(radius: float, shear: float, soft: float, knee: float) -> float:
    """Return the elastic energy of shear in a unit of volume (J/m³)."""
    below = min(radius, knee)
    return (0.5 * below * below / soft if knee > 0.0 else 0.0) + 0.5 * (radius * radius - below * below) / shear


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _double_rotation(tangent: float) -> tuple[float, float]:
    """Return cosine and sine of twice the angle with this tangent."""
    share = 1.0 / (1.0 + tangent * tangent)
    return (1.0 - tangent * tangent) * share, 2.0 * tangent * share


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def update_stress(
    stress: Floats, state: Floats, properties: Floats, p: int, xx: float, zz: float, xz: float, spin: float,
    relaxed: float, drained: float, dt: float,
) -> float:  # fmt: skip
    """Return the energy dissipated (J/m) as the stress of a point follows a strain increment and a rotation.

    ``stress`` (n, 3), ``state`` (n, STATE), ``properties`` (n, PROPERTIES) of all points; number ``p`` changes;
    ``xx``, ``zz``, ``xz``: strain increment, tensor components; ``spin``: increment of rotation (rad), as Hughes &
    Winget (1980, Int. J. Numer. Methods Eng. 15, 1862) take it; ``relaxed``: change of the mean stress by its knot span
    (Pa); ``drained``: volumetric strain by drainage, shrinking positive; ``dt``: time step (s).
    """
    old_mean, half, cross = 0.5 * (stress[p, 0] + stress[p, 1]), 0.5 * (stress[p, 0] - stress[p, 1]), stress[p, 2]
    on_plane, plane_cos, plane_sin = properties[p, PLANE_SHEAR] > 0.0, 1.0, 0.0
    if on_plane:
        plane_cos, plane_sin = _double_rotation(properties[p, PLANE_SLOPE])
        spin -= xz * plane_cos - 0.5 * (xx - zz) * plane_sin  # slip along the plane does not rotate it
    turn_cos, turn_sin = _double_rotation(0.5 * spin)
    cos, sin = turn_cos * turn_cos - turn_sin * turn_sin, 2.0 * turn_cos * turn_sin
    half, cross = half * cos + cross * sin, cross * cos - half * sin
    # dissipated (slip, viscosity, opening, drainage, softening): work at the mean of both stresses less elastic energy
    lost = 0.5 * (old_mean * (xx + zz) + half * (xx - zz)) + cross * xz
    late_half, late_cross = state[p, VISCOUS_HALF_DIFFERENCE], state[p, VISCOUS_SHEAR]
    half, cross = half - (late_half * cos + late_cross * sin), cross - (late_cross * cos - late_half * sin)
    if not on_plane and properties[p, SOFT_RADIUS] == 0.0 and _has_cut_off(properties, p):
        mean, opened, half, cross, more = _sheared_and_cracked(
            state, properties, p, old_mean, half, cross, xx + zz + drained, xx - zz, 2.0 * xz
        )
    else:
        mean, opened = _mean_stress(properties, p, old_mean, state[p, OPENED_STRAIN], xx + zz + drained, relaxed)
        if on_plane:
            half, cross, more = _sheared_on_plane(
                state, properties, p, mean, half, cross, xx - zz, 2.0 * xz, dt, plane_cos, plane_sin
            )
        elif properties[p, SOFT_RADIUS] > 0.0:
            half, cross, more = _sheared_softly(state, properties, p, mean, half, cross, xx - zz, 2.0 * xz, dt)
        else:
            half, cross, more = _sheared(state, properties, p, mean, half, cross, xx - zz, 2.0 * xz)
    lost += more + 0.5 * (old_mean * old_mean - mean * mean) / properties[p, BULK]
    stress[p, 0], stress[p, 1], stress[p, 2] = mean + half, mean - half, cross
    lost += 0.5 * (mean * (xx + zz) + half * (xx - zz)) + cross * xz
    lost *= state[p, VOLUME]
    # a crack carries no stress, and its volume is none of the ground
    state[p, VOLUME] *= 1.0 + xx + zz - (opened - state[p, OPENED_STRAIN])
    state[p, OPENED_STRAIN] = opened
    return lost


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def _mean_stress(
    properties: Floats, p: int, mean: float, opened: float, volumetric: float, relaxed: float
) -> tuple[float, float]:
    """Return the mean stress (Pa) and the volumetric strain of open cracks after a volumetric strain increment."""
    bulk, limit = properties[p, BULK], properties[p, TENSION_LIMIT]
    if opened > 0.0:
        opened += volumetric
        if opened < 0.0:
            mean, opened = mean + bulk * opened, 0.0
    else:
        mean += bulk * volumetric + relaxed
    if mean > limit:
        mean, opened = limit, opened + (mean - limit) / bulk
    return mean, opened


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def _sheared(
    state: Floats, properties: Floats, p: int, mean: float, half: float, cross: float, stretch: float, slide: float
) -> tuple[float, float, float]:
    """Return half the difference of the normal stresses and the shear stress (Pa), and the elastic energy released
    (J/m³), after an increment of the strains xx - zz and 2 xz of ground with one modulus."""
    shear = properties[p, SHEAR]
    compliance = 1.0 / shear
    lost = 0.5 * (half * half + cross * cross) * compliance
    half, cross = half + shear * stretch, cross + shear * slide
    radius = math.sqrt(half * half + cross * cross)
    strength = max(properties[p, STRENGTH] - mean * properties[p, SIN_PHI], 0.0)
    if radius > strength:
        state[p, PLASTIC_STRAIN] += (radius - strength) * compliance
        scale = strength / radius
        half, cross, radius = half * scale, cross * scale, strength
    return half, cross, lost - 0.5 * radius * radius * compliance


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _has_cut_off(properties: Floats, p: int) -> bool:
    """Return whether the tension of a point is limited to less than that of the apex of the cone, c / tan φ."""
    limit = properties[p, TENSION_LIMIT]
    return limit < LEAST_UNLIMITED and limit * properties[p, SIN_PHI] < CUT_OFF_SHARE * properties[p, STRENGTH]


@njit(cache=True, nogil=True, error_model="numpy")
def _sheared_and_cracked(
    state: Floats, properties: Floats, p: int, mean: float, half: float, cross: float, volumetric: float,
    stretch: float, slide: float,
) -> tuple[float, float, float, float, float]:  # fmt: skip
    """Return the mean stress (Pa) and the strain of open cracks, then the same as `_sheared`, for ground with a tension
    cut-off.

    The largest principal stress is at most the tension limit (Rankine), and opens a crack across its direction. While
    the crack is open this stress stays at the limit, and the ground carries loads along the crack, unless the crack is
    so wide that the ground is loose.
    """
    bulk, shear, limit = properties[p, BULK], properties[p, SHEAR], properties[p, TENSION_LIMIT]
    strength, sine, opened = properties[p, STRENGTH], properties[p, SIN_PHI], state[p, OPENED_STRAIN]
    radius = math.sqrt(half * half + cross * cross)
    lost = 0.5 * radius * radius / shear
    is_loose = opened > LOOSE_STRAIN or (opened > 0.0 and radius == 0.0)
    if is_loose:
        mean, half, cross, limit = 0.0, 0.0, 0.0, 0.0
    cos, sin = (0.0, 0.0) if is_loose or radius == 0.0 else (half / radius, cross / radius)
    mean, half, cross = mean + bulk * volumetric, half + shear * stretch, cross + shear * slide
    if opened > 0.0:  # the crack stays open as far as the stress across it asks for
        modulus = bulk if is_loose else bulk + shear
        change = max((mean + half * cos + cross * sin - limit) / modulus, -opened)
        opened, mean = opened + change, mean - bulk * change
        if is_loose and opened > 0.0:
            return 0.0, opened, 0.0, 0.0, lost
        half, cross = half - shear * change * cos, cross - shear * change * sin
    radius = math.sqrt(half * half + cross * cross)
    opening = max((mean + radius - limit) / (bulk + shear), 0.0)
    left = radius - shear * opening
    if left < 0.0:  # tension in all directions
        opening, left = (mean - limit) / bulk, 0.0
    elif left > strength - (mean - bulk * opening) * sine:
        opening = max((mean - (limit - strength) / (1.0 - sine)) / bulk, 0.0)  # to the stress at both limits
        left = max(strength - (mean - bulk * opening) * sine, 0.0)
        state[p, PLASTIC_STRAIN] += max(radius - shear * opening - left, 0.0) / shear
    scale = left / radius if radius > 0.0 else 0.0
    return mean - bulk * opening, opened + opening, half * scale, cross * scale, lost - 0.5 * left * left / shear


@njit(cache=True, nogil=True, error_model="numpy")
def _sheared_softly(
    state: Floats, properties: Floats, p: int, mean: float, half: float, cross: float, stretch: float, slide: float,
    dt: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Do the same as `_sheared` for ground that strains by its strain potential; ``half``, ``cross`` are without their
    viscous parts, and are returned with them."""
    shear, soft, knee = properties[p, SHEAR], properties[p, SOFT_SHEAR], properties[p, SOFT_RADIUS]
    radius = math.sqrt(half * half + cross * cross)
    lost = _shear_energy(radius, shear, soft, knee)
    compliance = _strain_of(radius, shear, soft, knee) / radius if radius > 0.0 else 0.0
    half, cross = half * compliance + stretch, cross * compliance + slide
    strain = math.sqrt(half * half + cross * cross)
    stiffness = _radius_of(strain, shear, soft, knee) / strain if strain > 0.0 else 0.0
    half, cross = half * stiffness, cross * stiffness
    radius = math.sqrt(half * half + cross * cross)
    strength = max(properties[p, STRENGTH] - mean * properties[p, SIN_PHI], 0.0)
    if radius > strength:
        state[p, PLASTIC_STRAIN] += _strain_of(radius, shear, soft, knee) - _strain_of(strength, shear, soft, knee)
        scale = strength / radius
        half, cross, radius = half * scale, cross * scale, strength
    lost -= _shear_energy(radius, shear, soft, knee)
    rate = properties[p, VISCOSITY] / dt
    late_half, late_cross = half + rate * stretch, cross + rate * slide
    total = math.sqrt(late_half * late_half + late_cross * late_cross)
    scale = strength / total if total > strength else 1.0
    late_half, late_cross = scale * late_half, scale * late_cross
    state[p, VISCOUS_HALF_DIFFERENCE], state[p, VISCOUS_SHEAR] = late_half - half, late_cross - cross
    return late_half, late_cross, lost


@njit(cache=True, nogil=True, error_model="numpy")
def _sheared_on_plane(
    state: Floats, properties: Floats, p: int, mean: float, half: float, cross: float, stretch: float, slide: float,
    dt: float, cos: float, sin: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Do the same as `_sheared_softly` for ground with a plane of weakness; ``cos``, ``sin``: cosine and sine of twice
    the angle of the plane with the horizontal."""
    shear, stiff = properties[p, SHEAR], properties[p, PLANE_SHEAR]
    knee = properties[p, SOFT_RADIUS]
    soft = properties[p, SOFT_SHEAR] if knee > 0.0 else stiff
    along, across = cross * cos - half * sin, half * cos + cross * sin
    stretch, slide = stretch * cos + slide * sin, slide * cos - stretch * sin
    lost = _shear_energy(abs(along), stiff, soft, knee) + 0.5 * across * across / shear
    strain = math.copysign(_strain_of(abs(along), stiff, soft, knee), along) + slide
    along, across = math.copysign(_radius_of(abs(strain), stiff, soft, knee), strain), across + shear * stretch
    strength = max(properties[p, STRENGTH] - mean * properties[p, SIN_PHI], 0.0)
    normal = mean - min(max(across, -strength), strength)
    on_plane = max(properties[p, PLANE_STRENGTH] - normal * properties[p, PLANE_SINE], 0.0)
    slipped, sheared = _nearest(along, across, on_plane, strength)
    state[p, PLASTIC_STRAIN] += abs(across - sheared) / shear
    state[p, PLASTIC_STRAIN] += _strain_of(abs(along), stiff, soft, knee) - _strain_of(abs(slipped), stiff, soft, knee)
    lost -= _shear_energy(abs(slipped), stiff, soft, knee) + 0.5 * sheared * sheared / shear
    viscous = slipped + properties[p, VISCOSITY] / dt * slide
    largest = min(on_plane, math.sqrt(max(strength * strength - sheared * sheared, 0.0)))
    viscous = min(max(viscous, -largest), largest)
    late = viscous - slipped
    state[p, VISCOUS_HALF_DIFFERENCE], state[p, VISCOUS_SHEAR] = -late * sin, late * cos
    return sheared * cos - viscous * sin, sheared * sin + viscous * cos, lost


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _nearest(along: float, across: float, on_plane: float, strength: float) -> tuple[float, float]:
    """Return the nearest point with abs(along) <= on_plane on or in the circle with the radius ``strength``."""
    slipped = min(max(along, -on_plane), on_plane)
    if slipped * slipped + across * across <= strength * strength:
        return slipped, across
    scale = strength / math.sqrt(along * along + across * across)
    if abs(along * scale) <= on_plane:
        return along * scale, across * scale
    return slipped, math.copysign(math.sqrt(strength * strength - slipped * slipped), across)
