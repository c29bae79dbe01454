"""Returns a trial stress to the Mohr-Coulomb surface with tension cut-off, and computes its consistent tangent
(kernels).

The return is done in principal stresses, where the surface is made of planes, so that every return has a
closed form and needs no iteration. Signs, components and units are those of `mohr_coulomb`, from which this module is
called. With principal stresses s1 >= s2 >= s3, cohesion c, friction angle phi and dilation angle psi,

    f = (1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi <= 0,     with flow along dg/ds,
    g = (1 + sin psi) s1 - (1 - sin psi) s3,
    s1 <= T  where there is a cut-off (Rankine), with associated flow.

The trial stress x goes to one of these parts of the surface:

    SHEAR_PLANE   f = 0, s1 > s2 > s3      TENSION_PLANE   s1 = T > s2
    LEFT_EDGE     f = 0, s1 = s2           TENSION_EDGE    s1 = s2 = T
    RIGHT_EDGE    f = 0, s2 = s3           TENSION_APEX    s1 = s2 = s3 = T
    APEX          s = c cot phi            SHEAR_TENSION   f = 0, s1 = T
    LEFT_CORNER   f = 0, s1 = s2 = T       RIGHT_CORNER    f = 0, s1 = T, s2 = s3

With D the elastic stiffness of principal stresses and C = D^-1, the return to a plane of normal n and flow m is s = x -
D m f(x)/(n D m); that to a line of direction a through s0 is s = s0 + a (b C (x - s0))/(b C a), where b is normal to
the flow of both planes (Clausen, Damkilde & Andersen 2006, Int. J. Numer. Meth. Engng 66, 1036; 2007, Computers &
Structures 85, 1795). Of the two edges, the trial stress goes to the one that it reaches first as the plastic multiplier
grows (Sysala, Cermak & Ligursky 2017, ZAMM 97, 1502). With psi = 0 the flow keeps the mean stress, so that a trial
whose mean stress is beyond c cot phi reaches no plane: it goes to the apex, as does with psi > 0 a trial stress beyond
the apex.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.integer]
Returned = tuple[float, float, float, int]

# Parts of the surface: the volume within; planes and lines, which have a tangent of their own; then points.
ELASTIC, SHEAR_PLANE, LEFT_EDGE, RIGHT_EDGE, TENSION_PLANE, TENSION_EDGE, SHEAR_TENSION = range(7)
APEX, TENSION_APEX, LEFT_CORNER, RIGHT_CORNER = range(7, 11)

# Rounding of the trial stress, relative to its size. Within it a state counts as admissible, and a return
# lands on the plane rather than on the edge or point behind it: pure shear with c = 0 and psi = 0 ends
# exactly at the apex, and would otherwise have the tangent of the plane or none at all as the last bit falls.
ROUNDING = 1e-12
# Closer than this, relative to their size, the in-plane principal stresses before and after the return have a
# ratio that is lost to cancellation, and its limit is taken.
COINCIDENCE_TOLERANCE = 1e-9

# Columns of the table of materials.
LAME, SHEAR, COMPLIANCE, POISSON, LATERAL, SIN_PHI, COS_PHI, STRENGTH, SIN_PSI, APEX_STRESS = range(10)
TENSION, MINOR_AT_TENSION, FLOW_1, FLOW_2 = range(10, 14)
LEFT_12, LEFT_3, LEFT_0, RIGHT_1, RIGHT_23, RIGHT_0 = range(14, 20)
# From here on p1 p2 p3 q1 q2 q3 of each plane (principal tangent D + p q) and line (principal tangent p q).
RANK_ONE = 20
COLUMNS = RANK_ONE + 6 * SHEAR_TENSION


@njit(cache=True, nogil=True, error_model="numpy")
def _shear_return(x1: float, x2: float, x3: float, f: float, rounding: float, table: Floats, m: int) -> Returned:
    """Return the principal stresses on the Mohr-Coulomb surface without cut-off, and the code of the part of the
    surface."""
    sin, strength = table[m, SIN_PHI], table[m, STRENGTH]
    s1 = x1 - f * table[m, FLOW_1]
    s2 = x2 - f * table[m, FLOW_2]
    # From f = 0: this keeps the returned stress on the surface to its own rounding, not to that of the trial.
    s3 = ((1 + sin) * s1 - 2 * strength) / (1 - sin)
    region = SHEAR_PLANE
    if s1 < s2 - rounding or s2 < s3 - rounding:
        sin_psi = table[m, SIN_PSI]
        left = (x1 - x2) * (1 - sin_psi) < (x2 - x3) * (1 + sin_psi)
        if left:
            t = table[m, LEFT_12] * (x1 + x2) + table[m, LEFT_3] * x3 - table[m, LEFT_0]
            region = LEFT_EDGE
        else:
            t = table[m, RIGHT_1] * x1 + table[m, RIGHT_23] * (x2 + x3) - table[m, RIGHT_0]
            region = RIGHT_EDGE
        s1 = strength + t * (1 - sin)
        s3 = t * (1 + sin) - strength
        s2 = s1 if left else s3
        if s1 < s3 - rounding:
            region = APEX
    if s1 < s3:  # never with phi = 0: there s1 - s3 = 2 c
        s1 = s2 = s3 = table[m, APEX_STRESS]
    return s1, min(max(s2, s3), s1), s3, region


@njit(cache=True, nogil=True, error_model="numpy")
def _tension_return(x1: float, x2: float, x3: float, rounding: float, table: Floats, m: int) -> Returned:
    """Return the principal stresses on the Rankine surface, and the code of the part of the surface."""
    T = table[m, TENSION]
    lateral = table[m, LATERAL] * (x1 - T)
    if x2 - lateral <= T + rounding:
        return T, min(x2 - lateral, T), x3 - lateral, TENSION_PLANE
    s3 = x3 - table[m, POISSON] * (x1 + x2 - 2 * T)
    if s3 <= T + rounding:
        return T, T, min(s3, T), TENSION_EDGE
    return T, T, T, TENSION_APEX


@njit(cache=True, nogil=True, error_model="numpy")
def _shear_tension_return(x1: float, x2: float, x3: float, rounding: float, table: Floats, m: int) -> Returned:
    """Return the principal stresses where the Mohr-Coulomb surface and the tension cut-off meet, and the code of this
    part of the surface."""
    T, minor = table[m, TENSION], table[m, MINOR_AT_TENSION]
    s2 = x2 - table[m, POISSON] * (x1 + x3 - T - minor)
    if s2 > T + rounding:
        return T, T, minor, LEFT_CORNER
    if s2 < minor - rounding:
        return T, minor, minor, RIGHT_CORNER
    return T, min(max(s2, minor), T), minor, SHEAR_TENSION


@njit(cache=True, nogil=True, error_model="numpy")
def _principal_return(x1: float, x2: float, x3: float, table: Floats, m: int) -> Returned:
    """Return the admissible principal stresses for the trial x1 >= x2 >= x3, and the code of the part of the surface.

    The multipliers of both surfaces solve a complementarity problem whose matrix has positive minors: its determinant
    is 4 G (lame + G) (1 - sin phi) (1 - sin psi). There is therefore one solution, and a return to one surface that
    satisfies the condition of the other surface is this solution.
    """
    sin, strength, T = table[m, SIN_PHI], table[m, STRENGTH], table[m, TENSION]
    rounding = ROUNDING * (max(abs(x1), abs(x3)) + strength)
    f = (1 + sin) * x1 - (1 - sin) * x3 - 2 * strength
    if not (f > rounding or x1 > T + rounding):  # so that NaN stays NaN
        return x1, x2, x3, ELASTIC
    if f > rounding:
        s1, s2, s3, region = _shear_return(x1, x2, x3, f, rounding, table, m)
        if s1 <= T + rounding:
            return s1, s2, s3, region
    s1, s2, s3, region = _tension_return(x1, x2, x3, rounding, table, m)
    if (1 + sin) * s1 - (1 - sin) * s3 - 2 * strength <= rounding:
        return s1, s2, s3, region
    return _shear_tension_return(x1, x2, x3, rounding, table, m)


@njit(cache=True, nogil=True, error_model="numpy")
def _from_order(v1: float, v2: float, v3: float, place: int) -> tuple[float, float, float]:
    """Return the in-plane major, the in-plane minor and the out-of-plane stress (zz) of three principal stresses in
    descending order; zz is number `place` (1, 2 or 3) among them."""
    if place == 3:
        return v1, v2, v3
    if place == 2:
        return v1, v3, v2
    return v2, v3, v1


@njit(cache=True, nogil=True, error_model="numpy")
def _write_tangent(
    out: Floats, i: int, table: Floats, m: int, region: int, place: int, ratio: float, cos: float, sin: float
) -> None:
    """Write the consistent tangent d stress / d strain = e D + p q + (G' - e G) r r, (4, 4) in the axes x, y, z.

    D is the elastic stiffness and G its shear modulus. The factor e is 1 if the returned stress lies within the yield
    surface or on a plane of it, and 0 if it lies on an edge or at a corner. The dyad p q, whose vectors are in the
    table of materials, is the plastic part of the tangent in principal axes on a plane, and the whole of it on an edge;
    it is 0 within the surface and at corners. The vector r is the stress of a unit shear between the in-plane principal
    axes. The stiffness of this shear is G' = G (sa - sb)/(xa - xb), with the in-plane principal stresses sa, sb of the
    returned stress and xa, xb of the trial stress, since the axes turn with the trial stress (de Souza Neto, Peric &
    Owen 2008, Computational Methods for Plasticity, app. A). `ratio` is the quotient (sa - sb)/(xa - xb), or negative
    where xa and xb coincide: the vectors p and q then have equal components in both axes, and the last term is left
    out, since the material is isotropic. `cos` and `sin` are those of twice the angle from x to the in-plane major
    axis.
    """
    lame, shear = table[m, LAME], table[m, SHEAR]
    e = 1.0 if region in (ELASTIC, SHEAR_PLANE, TENSION_PLANE) else 0.0
    pa = pb = pz = qa = qb = qz = 0.0
    if ELASTIC < region <= SHEAR_TENSION:
        k = RANK_ONE + 6 * (region - 1)
        pa, pb, pz = _from_order(table[m, k], table[m, k + 1], table[m, k + 2], place)
        qa, qb, qz = _from_order(table[m, k + 3], table[m, k + 4], table[m, k + 5], place)
    turn = shear * (ratio - e) if ratio >= 0.0 else 0.0

    p_mean, p_half, q_mean, q_half = 0.5 * (pa + pb), 0.5 * (pa - pb), 0.5 * (qa + qb), 0.5 * (qa - qb)
    pxx, pyy, pxy = p_mean + p_half * cos, p_mean - p_half * cos, p_half * sin
    qxx, qyy, qxy = q_mean + q_half * cos, q_mean - q_half * cos, q_half * sin
    direct, side = e * (lame + 2 * shear), e * lame
    turn_ss, turn_sc = turn * sin * sin, turn * sin * cos

    out[i, 0, 0] = direct + pxx * qxx + turn_ss
    out[i, 0, 1] = side + pxx * qyy - turn_ss
    out[i, 0, 2] = side + pxx * qz
    out[i, 0, 3] = pxx * qxy - turn_sc
    out[i, 1, 0] = side + pyy * qxx - turn_ss
    out[i, 1, 1] = direct + pyy * qyy + turn_ss
    out[i, 1, 2] = side + pyy * qz
    out[i, 1, 3] = pyy * qxy + turn_sc
    out[i, 2, 0] = side + pz * qxx
    out[i, 2, 1] = side + pz * qyy
    out[i, 2, 2] = direct + pz * qz
    out[i, 2, 3] = pz * qxy
    out[i, 3, 0] = pxy * qxx - turn_sc
    out[i, 3, 1] = pxy * qyy + turn_sc
    out[i, 3, 2] = pxy * qz
    out[i, 3, 3] = e * shear + pxy * qxy + turn * cos * cos


@njit(cache=True, nogil=True, error_model="numpy")
def _write_plastic_strain(
    out: Floats, i: int, table: Floats, m: int, xx: float, yy: float, zz: float, xy: float, stress: Floats
) -> None:
    """Write the plastic strain C (trial - returned), from the trial components and the returned stress[i]."""
    nu, compliance = table[m, POISSON], table[m, COMPLIANCE]
    dxx, dyy, dzz, dxy = xx - stress[i, 0], yy - stress[i, 1], zz - stress[i, 2], xy - stress[i, 3]
    trace = nu * (dxx + dyy + dzz)
    out[i, 0] = ((1 + nu) * dxx - trace) * compliance
    out[i, 1] = ((1 + nu) * dyy - trace) * compliance
    out[i, 2] = ((1 + nu) * dzz - trace) * compliance
    out[i, 3] = 2 * (1 + nu) * dxy * compliance


@njit(cache=True, nogil=True, error_model="numpy")
def update_points(
    strain: Floats,
    stress_old: Floats,
    material: Integers,
    table: Floats,
    stress: Floats,
    tangent: Floats,
    plastic: Floats,
    regions: NDArray[np.int8],
    with_tangent: bool,
    with_plastic: bool,
    with_regions: bool,
) -> None:
    """Update the stress point by point, for `mohr_coulomb.update`.

    ``strain``: increment (n, 4); ``stress_old``: (n, 4) in Pa; ``material``: (n,) row of ``table``. Fills ``stress``
    (n, 4) and, where ``with_tangent``, ``with_plastic`` and ``with_regions`` say so, ``tangent`` (n, 4, 4), ``plastic``
    strain increment (n, 4) and ``regions`` (n,).
    """
    for i in range(strain.shape[0]):
        m = material[i]
        twice_shear = 2 * table[m, SHEAR]
        volumetric = table[m, LAME] * (strain[i, 0] + strain[i, 1] + strain[i, 2])
        xx = stress_old[i, 0] + volumetric + twice_shear * strain[i, 0]
        yy = stress_old[i, 1] + volumetric + twice_shear * strain[i, 1]
        zz = stress_old[i, 2] + volumetric + twice_shear * strain[i, 2]
        xy = stress_old[i, 3] + table[m, SHEAR] * strain[i, 3]

        centre, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
        radius = math.sqrt(half * half + xy * xy)
        cos, sin = (half / radius, xy / radius) if radius > 0.0 else (1.0, 0.0)
        major, minor = centre + radius, centre - radius
        if zz <= minor:
            place, x1, x2, x3 = 3, major, minor, zz
        elif zz < major:
            place, x1, x2, x3 = 2, major, zz, minor
        else:
            place, x1, x2, x3 = 1, zz, major, minor

        s1, s2, s3, region = _principal_return(x1, x2, x3, table, m)
        ratio = 1.0
        if region == ELASTIC:
            stress[i, 0], stress[i, 1], stress[i, 2], stress[i, 3] = xx, yy, zz, xy
        else:
            sa, sb, sz = _from_order(s1, s2, s3, place)
            mean, radius_new = 0.5 * (sa + sb), 0.5 * (sa - sb)
            stress[i, 0], stress[i, 1] = mean + radius_new * cos, mean - radius_new * cos
            stress[i, 2], stress[i, 3] = sz, radius_new * sin
            ratio = radius_new / radius if radius > COINCIDENCE_TOLERANCE * (abs(x1) + abs(x3)) else -1.0
        if with_tangent:
            _write_tangent(tangent, i, table, m, region, place, ratio, cos, sin)
        if with_plastic:
            _write_plastic_strain(plastic, i, table, m, xx, yy, zz, xy, stress)
        if with_regions:
            regions[i] = region
