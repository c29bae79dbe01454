"""Updates the Mohr-Coulomb stress and computes its consistent tangent in plane strain, at many points at once.

The law is elastic, perfectly plastic, with non-associated flow and an optional tension cut-off; `return_mapping` has
the equations. Conventions of this module and of `return_mapping`:

* stress is positive in tension, in Pa, with components [xx, yy, zz, xy]; zz is normal to the plane of strain;
* strain has the same components, the last one being the engineering shear strain gamma_xy = 2 eps_xy;
* angles are in radians.
"""

import functools
import itertools
import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem.kernels import return_mapping as rm
from fem.kernels.return_mapping import Floats, Integers

# With fewer points a chunk (0.3 ms) is hardly worth handing to another thread.
SMALLEST_CHUNK = 4096


def table(
    young: ArrayLike,
    poisson: ArrayLike,
    cohesion: ArrayLike,
    friction: ArrayLike,
    dilation: ArrayLike,
    tension: ArrayLike = np.nan,
) -> Floats:
    """Return the constants of m materials for `update`.

    Parameters
    ----------
    young : Young's modulus, a number or (m,) as all arguments (Pa)
    poisson : Poisson's ratio in [0, 0.5)
    cohesion : cohesion (Pa)
    friction : friction angle in [0, π/2) (rad)
    dilation : dilation angle in [0, friction] (rad)
    tension : tensile strength (Pa); NaN or inf for none. One beyond the apex c cot φ never acts.

    Returns
    -------
    A row (COLUMNS,) for each material, of which `return_mapping` has the columns.

    Raises
    ------
    ValueError
        With every bad value of every material.
    """
    properties = (young, poisson, cohesion, friction, dilation, tension)
    E, nu, c, phi, psi, T = (np.array(a, dtype=float) for a in np.broadcast_arrays(*map(np.atleast_1d, properties)))
    T[np.isnan(T)] = np.inf
    _check(E, nu, c, phi, psi, T)

    sin, strength = np.sin(phi), c * np.cos(phi)
    with np.errstate(over="ignore"):
        apex = np.divide(strength, sin, out=np.full_like(c, np.inf), where=sin > 0)
    out = np.zeros((E.size, rm.COLUMNS))
    out[:, rm.LAME], out[:, rm.SHEAR] = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    out[:, rm.COMPLIANCE], out[:, rm.POISSON], out[:, rm.LATERAL] = 1 / E, nu, nu / (1 - nu)
    out[:, rm.SIN_PHI], out[:, rm.COS_PHI], out[:, rm.SIN_PSI] = sin, np.cos(phi), np.sin(psi)
    out[:, rm.STRENGTH], out[:, rm.APEX_STRESS], out[:, rm.TENSION] = strength, apex, T
    out[:, rm.MINOR_AT_TENSION] = ((1 + sin) * T - 2 * strength) / (1 - sin)
    for row in out:
        _add_planes_and_lines(row)
    return out


def _check(E: Floats, nu: Floats, c: Floats, phi: Floats, psi: Floats, T: Floats) -> None:
    rules = (
        (E, (E > 0) & np.isfinite(E), "Young's modulus {} Pa must be positive and finite"),
        (nu, (nu >= 0) & (nu < 0.5), "Poisson's ratio {} must be in [0, 0.5)"),
        (c, (c >= 0) & np.isfinite(c), "cohesion {} Pa must be finite and not negative"),
        (phi, (phi >= 0) & (phi < math.pi / 2), "friction angle {} rad must be in [0, pi/2): in degrees?"),
        (psi, (psi >= 0) & (psi < math.pi / 2), "dilation angle {} rad must be in [0, pi/2): in degrees?"),
        (psi, ~(psi > phi), "dilation angle {} rad must not exceed the friction angle"),
        (T, T >= 0, "tensile strength {} Pa must not be negative; NaN or inf is for none"),
    )
    faults = [
        f"material {m}: " + text.format(f"{values[m]:g}") for values, good, text in rules for m in np.flatnonzero(~good)
    ]
    if faults:
        raise ValueError("; ".join(faults))


def _add_planes_and_lines(row: Floats) -> None:
    """For one material, fill in the constants of the return to each plane and line, and p and q of its principal
    tangent."""
    stiffness = row[rm.LAME] + 2 * row[rm.SHEAR] * np.eye(3)
    compliance = np.linalg.inv(stiffness)

    def keep(region: int, p: Floats, q: Floats) -> None:
        first = rm.RANK_ONE + 6 * (region - 1)
        row[first : first + 6] = *p, *q

    def plane(region: int, normal: Floats, flow: Floats) -> Floats:
        D_n, D_m = stiffness @ normal, stiffness @ flow
        keep(region, -D_m / (normal @ D_m), D_n)
        return D_m / (normal @ D_m)

    def line(region: int, along: Floats, across: Floats) -> Floats:
        C_b = compliance @ across
        keep(region, along / (along @ C_b), across)
        return C_b / (along @ C_b)

    sin, sin_psi, strength = row[rm.SIN_PHI], row[rm.SIN_PSI], row[rm.STRENGTH]
    normal, flow = (np.array([1 + s, 0, s - 1]) for s in (sin, sin_psi))
    row[rm.FLOW_1], row[rm.FLOW_2], _ = plane(rm.SHEAR_PLANE, normal, flow)

    # The edges are drawn from c cos phi (1, 1, -1) and c cos phi (1, -1, -1), which need no apex to exist.
    along, across = (np.array([1 - s, 1 - s, 1 + s]) for s in (sin, sin_psi))
    weight = line(rm.LEFT_EDGE, along, across)
    row[rm.LEFT_12], row[rm.LEFT_3], row[rm.LEFT_0] = weight[0], weight[2], weight @ [1, 1, -1] * strength
    along, across = (np.array([1 - s, 1 + s, 1 + s]) for s in (sin, sin_psi))
    weight = line(rm.RIGHT_EDGE, along, across)
    row[rm.RIGHT_1], row[rm.RIGHT_23], row[rm.RIGHT_0] = weight[0], weight[2], weight @ [1, -1, -1] * strength

    major, intermediate, minor = np.eye(3)
    plane(rm.TENSION_PLANE, major, major)
    line(rm.TENSION_EDGE, minor, minor)
    line(rm.SHEAR_TENSION, intermediate, intermediate)


def update(
    strain_increment: Floats,
    stress_old: Floats,
    material: Integers,
    table: Floats,
    stress: Floats,
    tangent: Floats | None = None,
    plastic_strain_increment: Floats | None = None,
    region: NDArray[np.int8] | None = None,
    threads: int = 1,
) -> None:
    """Update the stress after a strain increment at n points; optional arrays that are not None are filled.

    Parameters
    ----------
    strain_increment (n, 4) : its zz need not be zero, since B-bar averages it over a cell
    stress_old (n, 4) : stress before (Pa); may be the same array as ``stress``
    material (n,) : rows of ``table``, of any integer type
    table (m, COLUMNS) : constants, from the function `table`
    stress (n, 4) : set to the stress after (Pa)
    tangent (n, 4, 4) : set to d stress_i / d strain_increment_j (Pa), which takes half the time
    plastic_strain_increment (n, 4) : set to the plastic part of the increment (-)
    region (n,) : set to the part of the surface, a code of `return_mapping`, int8
    threads : number of threads; the result is the same, to the bit, for any number

    Raises
    ------
    ValueError
        If an array has another shape, type or layout (C-contiguous float64), or if ``material`` points outside the
        table.
    """
    n = len(strain_increment)
    if material.shape != (n,) or material.dtype.kind not in "iu":
        raise ValueError(f"material is {material.dtype} {material.shape}; expected integers of shape {(n,)}")
    if n and not (material.min() >= 0 and material.max() < len(table)):
        raise ValueError(f"material must be in 0 to {len(table) - 1}, the rows of the table")
    _require("table", table, (len(table), rm.COLUMNS))

    points = (strain_increment, stress_old, stress)
    for name, array in zip(("strain_increment", "stress_old", "stress"), points, strict=True):
        _require(name, array, (n, 4))
    # Numba would compile another kernel for None, so what is not wanted is an empty array.
    outputs = (
        _output("tangent", tangent, (n, 4, 4)),
        _output("plastic_strain_increment", plastic_strain_increment, (n, 4)),
        _output("region", region, (n,), np.int8),
    )
    wanted = tangent is not None, plastic_strain_increment is not None, region is not None

    def chunk(first: int, last: int) -> None:
        here = slice(first, last)
        rm.update_points(
            strain_increment[here],
            stress_old[here],
            material[here],
            table,
            stress[here],
            *(array[here] for array in outputs),
            *wanted,
        )

    _in_chunks(chunk, n, threads)


def _in_chunks(work: Callable[[int, int], None], n: int, threads: int) -> None:
    """Call ``work`` for ranges of the n points, one range for each thread; ``work`` is given the first point of a range
    and its end."""
    chunks = max(1, min(threads, n // SMALLEST_CHUNK))
    first, *others = itertools.pairwise(n * k // chunks for k in range(chunks + 1))
    futures = [_pool(len(others)).submit(work, *bounds) for bounds in others]
    work(*first)
    for future in futures:
        future.result()


def _require(name: str, array: NDArray, shape: tuple[int, ...], dtype: type = np.float64) -> None:
    if array.shape != shape or array.dtype != dtype or not array.flags.c_contiguous:
        raise ValueError(f"{name} is {array.dtype} {array.shape}; expected C-contiguous {dtype.__name__} {shape}")


def _output(name: str, array: NDArray | None, shape: tuple[int, ...], dtype: type = np.float64) -> NDArray:
    if array is None:
        return np.empty((0, *shape[1:]), dtype)
    _require(name, array, shape, dtype)
    return array


@functools.cache
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers, thread_name_prefix="mohr-coulomb")


# Threads do not survive a fork: a child must make its own.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_pool.cache_clear)


def _circle(stress: Floats) -> tuple[Floats, Floats]:
    """Return centre and radius of the largest Mohr circle, with the out-of-plane stress zz included."""
    centre = 0.5 * (stress[:, 0] + stress[:, 1])
    radius = np.hypot(0.5 * (stress[:, 0] - stress[:, 1]), stress[:, 3])
    major = np.maximum(centre + radius, stress[:, 2])
    minor = np.minimum(centre - radius, stress[:, 2])
    return 0.5 * (major + minor), 0.5 * (major - minor)


def mobilised_strength(stress: Floats, material: Integers, table: Floats) -> Floats:
    """Return the mobilised strength, the paper's local safety factor: 1 at yield, less than 1 inside the yield surface.

    The mobilised strength is the greatest tau / (c + N tan phi) over all planes through a point.

    N is the normal stress, positive in compression. Where s and t are the centre and radius of the largest
    Mohr circle and A = c - s tan phi, the plane at twice the angle x has t sin x / (A + t tan phi cos x),
    which is greatest at cos x = -(t / A) tan phi:

        t / sqrt(A^2 - t^2 tan^2 phi).

    The tension cut-off is disregarded.

    Parameters
    ----------
    stress (n, 4) : stress, tension positive (Pa)
    material (n,) : rows of ``table``
    table (m, COLUMNS) : constants, from the function `table`

    Returns
    -------
    The mobilised strength (n,) (-). It is infinite if a plane has no strength (A <= t tan phi), as anywhere beyond the
    apex; at the apex, with neither shear nor strength, it is 1.
    """
    s, t = _circle(stress)
    rows = table[material]
    sin, cos, cohesion = rows[:, rm.SIN_PHI], rows[:, rm.COS_PHI], rows[:, rm.STRENGTH]
    strength = cohesion - s * sin
    weakest, strongest = strength - t * sin, strength + t * sin
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(weakest > 0, t * cos / np.sqrt(weakest * strongest), np.inf)
    rounding = rm.ROUNDING * (np.abs(s) + cohesion)
    return np.where((np.abs(strength) <= rounding) & (t <= rounding), 1.0, factor)
