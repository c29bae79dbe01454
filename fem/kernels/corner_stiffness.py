"""Eliminates the unknowns that an interior-point method has at one corner of a cell (kernels).

At a corner the strain rate q = [volume, difference, shear] and its conjugate multiplier m, which is minus the stress,
obey q + C m = g with a compliance C of three rows. In ground with friction C = U⁻¹ W² U⁻¹, where U = diag(1, sin φ, sin
φ) and W² is the matrix of ``corner_cones.py``. In ground with φ = 0 the volume is constant, and the dissipation t is
eliminated; C then has a small compliance δ of the volume, whose effect iterative refinement removes. A tension cut-off
adds its own compliance, as for springs in series.

Rows and columns of the equations are in this order: [load, volume of clay, cones of corners, cones of cut-offs, scalar
cut-offs] and [velocities, t of clay, opening rates of scalar cut-offs, opening rates of cut-off cones]. ``clay``,
``single`` and ``triple`` (k,) number the corners of φ = 0, the corners whose tension cut-off is one scalar constraint
(one opening rate), and the corners whose cut-off is a cone (three opening rates), -1 elsewhere; ``sine`` (k,) is sin φ,
or 1 where φ = 0.
"""

import math

import numpy as np
from numba import njit

# Smallest pivot of a compliance, as a share of its diagonal.
LEAST_PIVOT = 1e-15
# Largest η² of which the compliance δ of clay is a share. Where liquefied ground flows η² is 5,000, and with a share of
# it volume strain rates of 1e-6 remained that refinement did not remove: 9 of 60 programs of clay failed that do not.
LARGEST_SQUARE = 1e-3


@njit(cache=True, nogil=True, error_model="numpy")
def stiffnesses(
    axis: np.ndarray, size: np.ndarray, lone: np.ndarray, sine: np.ndarray, clay: np.ndarray, single: np.ndarray,
    triple: np.ndarray, torn_sine: float, soft: float, out: np.ndarray,
) -> None:  # fmt: skip
    """Compute C⁻¹ of all corners.

    Parameters
    ----------
    axis (cones, 3) : w of the cones: of the k corners, then of the cut-offs that are cones
    size (cones,) : η of the cones
    lone (singles,) : w² of the scalar constraints of cut-offs
    sine, clay, single, triple (k,) : slopes of the cones and numbers of the corners, see above
    torn_sine : sin φ of the cones of tension cut-offs
    soft : compliance δ of the volume of clay over η², or over `LARGEST_SQUARE` if η² is larger
    out (k, 3, 3) : set to C⁻¹
    """
    corners = len(sine)
    c, low = np.empty((3, 3)), np.zeros((3, 3))
    for k in range(corners):
        if single[k] < 0 and triple[k] < 0:
            _stiffness(axis[k], size[k] * size[k], sine[k], clay[k] >= 0, soft, out[k])
            continue
        c[:] = 0.0
        _add_compliance(axis[k], size[k] * size[k], sine[k], clay[k] >= 0, soft, c)
        if single[k] >= 0:
            c[0, 0] += 4.0 * lone[single[k]]
        else:
            other = corners + triple[k]
            _add_compliance(axis[other], size[other] * size[other], torn_sine, False, soft, c)
        _invert(c, low, out[k])


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _stiffness(w: np.ndarray, much: float, sine: float, is_clay: bool, soft: float, out: np.ndarray) -> None:
    """Compute C⁻¹ (3, 3) in closed form, without cancellation of digits."""
    if is_clay:
        scale = sine * sine / (much * (1.0 + 2.0 * (w[1] * w[1] + w[2] * w[2])))
        out[0, 0] = sine * sine / (soft * min(much, LARGEST_SQUARE))
        out[0, 1] = out[0, 2] = 0.0
        out[1, 1], out[2, 2] = scale * (1.0 + 2.0 * w[2] * w[2]), scale * (1.0 + 2.0 * w[1] * w[1])
        out[1, 2] = -2.0 * scale * w[1] * w[2]
    else:
        out[0, 0] = (2.0 * w[0] * w[0] - 1.0) / much
        out[0, 1], out[0, 2] = -2.0 * w[0] * w[1] * sine / much, -2.0 * w[0] * w[2] * sine / much
        out[1, 1] = (2.0 * w[1] * w[1] + 1.0) * sine * sine / much
        out[2, 2] = (2.0 * w[2] * w[2] + 1.0) * sine * sine / much
        out[1, 2] = 2.0 * w[1] * w[2] * sine * sine / much
    out[1, 0], out[2, 0], out[2, 1] = out[0, 1], out[0, 2], out[1, 2]


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _add_compliance(w: np.ndarray, much: float, sine: float, is_clay: bool, soft: float, c: np.ndarray) -> None:
    """Add the compliance C (3, 3) of one cone to ``c``."""
    scale = much / (sine * sine)
    c[1, 1] += scale * (2.0 * w[1] * w[1] + 1.0)
    c[2, 2] += scale * (2.0 * w[2] * w[2] + 1.0)
    c[1, 2] += scale * 2.0 * w[1] * w[2]
    if is_clay:
        c[0, 0] += soft * min(much, LARGEST_SQUARE) / (sine * sine)
    else:
        c[0, 0] += much * (2.0 * w[0] * w[0] - 1.0)
        c[0, 1] += much * 2.0 * w[0] * w[1] / sine
        c[0, 2] += much * 2.0 * w[0] * w[2] / sine


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _invert(c: np.ndarray, low: np.ndarray, out: np.ndarray) -> None:
    """Invert a compliance matrix, of which the upper triangle is given, by its Cholesky factor."""
    for j in range(3):
        for i in range(j, 3):
            value = c[j, i]
            for p in range(j):
                value -= low[i, p] * low[j, p]
            if i == j:
                low[j, j] = math.sqrt(max(value, LEAST_PIVOT * c[j, j]))
            else:
                low[i, j] = value / low[j, j]
    a, b, d = 1.0 / low[0, 0], 1.0 / low[1, 1], 1.0 / low[2, 2]
    e, f = -low[1, 0] * a * b, -low[2, 1] * b * d
    g = -(low[2, 0] * a + low[2, 1] * e) * d
    out[0, 0], out[1, 1], out[2, 2] = a * a + e * e + g * g, b * b + f * f, d * d
    out[0, 1] = out[1, 0] = e * b + g * f
    out[0, 2] = out[2, 0] = g * d
    out[1, 2] = out[2, 1] = f * d


@njit(cache=True, nogil=True, error_model="numpy")
def condense(
    ry: np.ndarray, rz: np.ndarray, stiffness: np.ndarray, square: np.ndarray, lone: np.ndarray, sine: np.ndarray,
    clay: np.ndarray, single: np.ndarray, triple: np.ndarray, torn_sine: float, velocities: int, clays: int,
    openings: int, g: np.ndarray, force: np.ndarray,
) -> None:  # fmt: skip
    """Eliminate the unknowns of the corners from right-hand sides: compute g, and the force C⁻¹ g.

    Parameters
    ----------
    ry (columns,) : right-hand sides of the columns, in the order above
    rz (rows,) : right-hand sides of the rows, in the order above
    stiffness (k, 3, 3) : C⁻¹ of `stiffnesses`
    square (cones, 3, 3) : W² of the cones
    lone, sine, clay, single, triple, torn_sine : as in `stiffnesses`
    velocities, clays : numbers of velocities and of clay corners
    openings : first column of the opening rates of cut-off cones
    g (k, 3) : set to the right-hand sides of q + C m = g
    force (k, 3) : set to C⁻¹ g, the multipliers m at zero strain rates, whose forces act on the velocities
    """
    corners, first = len(sine), 1 + clays
    tears, lones = first + 3 * corners, first + 3 * len(square)
    for k in range(corners):
        at = first + 3 * k
        much = -1.0 / sine[k]
        if clay[k] >= 0:
            z0 = -ry[velocities + clay[k]]
            g[k, 0] = rz[1 + clay[k]]
            g[k, 1], g[k, 2] = much * (rz[at + 1] + square[k, 1, 0] * z0), much * (rz[at + 2] + square[k, 2, 0] * z0)
        else:
            g[k, 0], g[k, 1], g[k, 2] = -rz[at], much * rz[at + 1], much * rz[at + 2]
        if single[k] >= 0:
            p = single[k]
            g[k, 0] += 2.0 * (lone[p] * ry[velocities + clays + p] - rz[lones + p])
        elif triple[k] >= 0:
            p, at = corners + triple[k], tears + 3 * triple[k]
            y = openings + 3 * triple[k]
            a0, a1 = 0.5 * (ry[y] + ry[y + 1]), 0.5 * (ry[y] - ry[y + 1]) / torn_sine
            a2 = ry[y + 2] / torn_sine
            for i in range(3):
                value = square[p, i, 0] * a0 + square[p, i, 1] * a1 + square[p, i, 2] * a2 - rz[at + i]
                g[k, i] += value if i == 0 else value / torn_sine
        for i in range(3):
            force[k, i] = stiffness[k, i, 0] * g[k, 0] + stiffness[k, i, 1] * g[k, 1] + stiffness[k, i, 2] * g[k, 2]


@njit(cache=True, nogil=True, error_model="numpy")
def expand(
    rates: np.ndarray, g: np.ndarray, ry: np.ndarray, rz: np.ndarray, stiffness: np.ndarray, square: np.ndarray,
    lone: np.ndarray, sine: np.ndarray, clay: np.ndarray, single: np.ndarray, triple: np.ndarray, torn_sine: float,
    velocities: int, clays: int, openings: int, dy: np.ndarray, dz: np.ndarray,
) -> None:  # fmt: skip
    """Compute the unknowns that `condense` eliminated, from the strain rates of the solution.

    Parameters
    ----------
    rates (k, 3) : strain rates q of the solved velocities, [volume, difference, shear]
    g (k, 3) : result of `condense`
    ry, rz, stiffness, square, lone, sine, clay, single, triple, torn_sine : as in `condense`
    velocities, clays, openings : as in `condense`
    dy (columns,) : entries after the velocities are set
    dz (rows,) : entries are set, except that of the load
    """
    corners, first = len(sine), 1 + clays
    tears, lones = first + 3 * corners, first + 3 * len(square)
    m = np.empty(3)
    for k in range(corners):
        a, b, c = g[k, 0] - rates[k, 0], g[k, 1] - rates[k, 1], g[k, 2] - rates[k, 2]
        for i in range(3):
            m[i] = stiffness[k, i, 0] * a + stiffness[k, i, 1] * b + stiffness[k, i, 2] * c
        at = first + 3 * k
        dz[at + 1], dz[at + 2] = m[1] / sine[k], m[2] / sine[k]
        if clay[k] >= 0:
            dz[1 + clay[k]] = -m[0]
            dz[at] = -ry[velocities + clay[k]]
            dy[velocities + clay[k]] = -rz[at] - (
                square[k, 0, 0] * dz[at] + square[k, 0, 1] * dz[at + 1] + square[k, 0, 2] * dz[at + 2]
            )
        else:
            dz[at] = m[0]
        if single[k] >= 0:
            p = single[k]
            y = velocities + clays + p
            dz[lones + p] = 2.0 * m[0] - ry[y]
            dy[y] = -rz[lones + p] - lone[p] * dz[lones + p]
        elif triple[k] >= 0:
            p, at = corners + triple[k], tears + 3 * triple[k]
            y = openings + 3 * triple[k]
            dz[at] = m[0] - 0.5 * (ry[y] + ry[y + 1])
            dz[at + 1] = (m[1] - 0.5 * (ry[y] - ry[y + 1])) / torn_sine
            dz[at + 2] = (m[2] - ry[y + 2]) / torn_sine
            for i in range(3):
                m[i] = -rz[at + i] - (
                    square[p, i, 0] * dz[at] + square[p, i, 1] * dz[at + 1] + square[p, i, 2] * dz[at + 2]
                )
            m[1], m[2] = m[1] / torn_sine, m[2] / torn_sine
            dy[y], dy[y + 1], dy[y + 2] = 0.5 * (m[0] + m[1]), 0.5 * (m[0] - m[1]), m[2]


@njit(cache=True, nogil=True, error_model="numpy")
def add_stiffnesses(
    stiffness: np.ndarray, starts: np.ndarray, rows: np.ndarray, places: np.ndarray, first: np.ndarray,
    values: np.ndarray,
) -> None:  # fmt: skip
    """Add Σ Bᵀ C⁻¹ B of all corners to the lower triangle of the stiffness matrix.

    Parameters
    ----------
    stiffness (k, 3, 3) : C⁻¹ of the corners
    starts (k + 1,) : the columns of B of corner i are ``rows[starts[i] : starts[i + 1]]``, in the order of their
        velocities
    rows (entries, 3) : columns of B (1/m)
    places (pairs,) : entries of the triangle to which the products belong, row by row of a lower triangle for each
        corner
    first (k + 1,) : the places of corner i begin at ``first[i]``
    values (entries of the triangle,) : increased by the products
    """
    most = 0
    for k in range(len(starts) - 1):
        most = max(most, starts[k + 1] - starts[k])
    work = np.empty((most, 3))
    for k in range(len(starts) - 1):
        begin, count, place = starts[k], starts[k + 1] - starts[k], first[k]
        d = stiffness[k]
        for j in range(count):
            b0, b1, b2 = rows[begin + j, 0], rows[begin + j, 1], rows[begin + j, 2]
            for i in range(3):
                work[j, i] = d[i, 0] * b0 + d[i, 1] * b1 + d[i, 2] * b2
        for i in range(count):
            b0, b1, b2 = rows[begin + i, 0], rows[begin + i, 1], rows[begin + i, 2]
            for j in range(i + 1):
                values[places[place]] += b0 * work[j, 0] + b1 * work[j, 1] + b2 * work[j, 2]
                place += 1
