"""Moves material points in plane strain by the explicit material point method (kernels): from points to grid, motion of
the grid, from grid to points, stress.

Points carry mass, momentum, an affine velocity field and stress; a background grid of square cells with quadratic
B-splines moves them. One step is (Hu et al. 2018, ACM Trans. Graph. 37, 150, eqs. 16 to 18, with D = h² / 4)

    m_i = Σ m N,   p_i = Σ N (m (v + C d) - dt V D⁻¹ σ d + dt m b),   v_i = p_i / m_i + dt f_i / m_i,
    x' = x + dt Σ N v_i,   v' = Σ N v_i + α (v - Σ N v_i(old)),   C' = D⁻¹ Σ N v_i dᵀ + α (C - D⁻¹ Σ N v_i(old) dᵀ),

d from the point to the node. α = 0 is the affine particle-in-cell transfer (APIC, Jiang et al. 2015), which smooths
velocities in every step; α = 1 keeps what the grid cannot resolve (affine FLIP), C as well as v: the C of the grid
alone would lose a share of its energy in every step. Let S be the transfer from the points to the grid and back, which
conserves momentum. `take_off` serves to damp (I - S)^m (v, C), as Hammerquist & Nairn (2017, Comput. Methods Appl.
Mech. Eng. 318, 724) filter velocities: a velocity of which S loses a share ε is reduced by ε^m. The stress of the
points is updated by `point_stress`.

Four points of constant volume leave a knot span, which has two degrees of freedom, no way to deform: it locks (Mast et
al. 2012, J. Comput. Phys. 231, 5351; Coombs et al. 2018, Comput. Methods Appl. Mech. Eng. 333, 1). Therefore at points
of ground that yields without friction the mean stress p approaches that of their knot span by a share ρ of the
difference in each step,

    p' = p + ρ (Σ V p / K) / (Σ V / K) - ρ p,   K of plane strain,

which conserves the volumetric strain of the span. The elastic energy of the span can only decrease; the decrease counts
as dissipated. This averaging of p is the mean dilatation method of Mast et al. and Coombs et al., applied to the stress
instead of the strain, so that the strain of the points is unchanged. A step is about the time in which a wave crosses
0.7 of a cell, so with ρ = 0.1 the averaging takes about the time in which a wave crosses seven cells.

Rows of nodes may be inclined, so that layers are parallel to them: node (i, j) is at (i h, j h + s i h), s the slope of
a row. Splines, d and C are in the coordinates (x, z - s x), in which cells are squares; with J = [[1, 0], [-s, 1]] the
gradient of the velocity is C J, and σ Jᵀ replaces σ in the equations above.

Stress is positive in tension, Pa, [xx, zz, xz]; lengths m, masses kg/m, z upwards. Points are sorted by stripes of
columns; two stripes of even number never write to the same node, nor do two stripes of odd number, so that every sum
has one order for any number of threads.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fem.kernels.grid_motion import NEW_VELOCITY, move_base, move_grid
from fem.kernels.point_stress import (
    BULK,
    DRAINAGE_RATE,
    MASS,
    OPENED_STRAIN,
    SIN_PHI,
    STRENGTH,
    VOLUME,
    WEIGHT_RATIO,
    Floats,
    update_stress,
)
from fem.kernels.spline_transfer import NODE, VELOCITIES, add_to_nodes, collect_nodes

Integers = NDArray[np.int64]

# Of the points in the knot span about the next node to the right and above: volume strain (m²) by the mean stress, and
# compliance (m²/Pa).
SPAN_STRAIN, SPAN_COMPLIANCE = range(2)
SPAN = 2
# Share of the mass around a point within ground, below which a free-field side does not press on the point: 0.6 at an
# even side, less in ground that has come apart.
DETACHED_SHARE = 0.45
RELAXED_SHARE = 0.1  # share ρ of the deviation from the mean stress of the knot span that a point loses in a step
# Sums of a stripe (J/m): work of weight and shaking, energy dissipated by shear, opening and drainage.
EXTERNAL, DISSIPATED = range(2)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _weights(f: float) -> tuple[float, float, float]:
    """Return the quadratic B-spline weights of three nodes; f (0.5 to 1.5) is the distance of the point from the first
    node in cells."""
    return 0.5 * (1.5 - f) ** 2, 0.75 - (f - 1.0) ** 2, 0.5 * (f - 0.5) ** 2


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _apart(f: float, cell: float) -> tuple[float, float, float]:
    """Return the distances (m) of three nodes from a point; f: as in `_weights`."""
    return -f * cell, (1.0 - f) * cell, (2.0 - f) * cell


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def _columns_of(
    i: int, j: int, columns: int, rows: int, periodic: bool, record: int
) -> tuple[np.uint64, np.uint64, np.uint64]:
    """Return the places of the records of node (i, j) and of the nodes in the next two columns."""
    first, second, third = i, i + 1, i + 2
    if periodic:
        first, second, third = first % columns, second % columns, third % columns
    size = np.uint64(record)
    return np.uint64(first * rows + j) * size, np.uint64(second * rows + j) * size, np.uint64(third * rows + j) * size


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _flows(state: Floats, properties: Floats, p: int) -> bool:
    """Return whether the mean stress of a point is relaxed towards that of its knot span, which is done in ground that
    has φ = 0, can yield and is not cracked open.
    """
    return (
        properties[p, SIN_PHI] == 0.0
        and properties[p, STRENGTH] < properties[p, BULK]
        and state[p, OPENED_STRAIN] <= 0.0
    )


@njit(cache=True, nogil=True, error_model="numpy")
def scatter(
    stripes: Integers, offsets: Integers, x: Floats, v: Floats, affine: Floats, stress: Floats, state: Floats,
    heavy: Floats, side: Floats, properties: Floats, cell: float, slope: float, periodic: bool, shaking: float,
    gravity_x: float, gravity_z: float, grid: Floats, spans: Floats,
) -> None:  # fmt: skip
    """Add mass, momentum, force and volume of the points of some stripes to the grid, and their strain to the spans.

    Parameters
    ----------
    stripes : numbers of the stripes, all even or all odd
    offsets (stripes + 1,) : number of the first point of every stripe
    x, v (n, 2) : places (m) and velocities (m/s)
    affine (n, 4) : C of the velocities, row by row (1/s)
    stress (n, 3) : stress [xx, zz, xz], tension positive (Pa)
    state (n, STATE) : volume, mass and strains, see `point_stress`
    heavy (n,) : weight over seismic mass (-)
    side (n,) : horizontal force on points next to a free-field side, a quarter of a cell away, where nodes are held
        vertically; 0 elsewhere (N/m)
    properties (n, PROPERTIES) : properties of the soil, see `point_stress`
    cell : side of a cell (m)
    slope : dz/dx of the rows of nodes (-)
    periodic : whether the sides move alike
    shaking : horizontal acceleration of the whole mass by shaking (m/s²)
    gravity_x, gravity_z : acceleration that acts on ``heavy`` times the mass (m/s²)
    grid (nx, nz, NODE) : record of a node, increased by mass (kg/m), momentum [x, z] (N s/m), force [x, z] (N/m),
        volume (m²), and a number above 0 where the node is fixed vertically; the last number is idle
    spans (nx, nz, SPAN) : strain by the mean stress, and compliance, of the points in a knot span that flow, increased
    """
    inverse, columns, rows = 1.0 / cell, grid.shape[0], grid.shape[1]
    stiff, nodes = 4.0 * inverse * inverse, grid.reshape(-1)
    for stripe in stripes:
        for p in range(offsets[stripe], offsets[stripe + 1]):
            across, up = inverse * x[p, 0], inverse * (x[p, 1] - slope * x[p, 0])
            i, j = math.floor(across - 0.5), math.floor(up - 0.5)
            fx, fz = across - i, up - j
            mass, volume, on_side = state[p, MASS], state[p, VOLUME], abs(side[p])
            k = stiff * volume
            sxx, szz, sxz = k * stress[p, 0], k * stress[p, 1], k * stress[p, 2]
            sxx += 0.25 * cell * stiff * on_side  # the moment of the force on the side about the point
            at_point = (
                mass, mass * v[p, 0], mass * v[p, 1],
                mass * (shaking + heavy[p] * gravity_x) + side[p], mass * heavy[p] * gravity_z, volume, on_side, 0.0,
            )  # fmt: skip
            by_x = (0.0, mass * affine[p, 0], mass * affine[p, 2], -sxx, -sxz, 0.0, 0.0, 0.0)
            by_z = (0.0, mass * affine[p, 1], mass * affine[p, 3], slope * sxx - sxz, slope * sxz - szz, 0.0, 0.0, 0.0)
            if _flows(state, properties, p):
                column, compliance = i % columns if periodic else i, volume / properties[p, BULK]
                spans[column, j, SPAN_STRAIN] += 0.5 * compliance * (stress[p, 0] + stress[p, 1])
                spans[column, j, SPAN_COMPLIANCE] += compliance
            places, dx, dz = _columns_of(i, j, columns, rows, periodic, NODE), _apart(fx, cell), _apart(fz, cell)
            add_to_nodes(nodes, places, _weights(fx), _weights(fz), dx, dz, at_point, by_x, by_z)


@njit(cache=True, nogil=True, error_model="numpy")
def _mass_around(grid: Floats, columns: int, i: int, j: int, fx: float, fz: float, periodic: bool) -> float:
    """Return the mass of the nodes around a point (kg/m), weighted by its splines."""
    across, upwards = _weights(fx), _weights(fz)
    mass = 0.0
    for a in range(3):
        column = (i + a) % columns if periodic else i + a
        for b in range(3):
            mass += across[a] * upwards[b] * grid[column, j + b, 0]
    return mass


@njit(cache=True, nogil=True, error_model="numpy")
def gather(
    stripes: Integers, offsets: Integers, grid: Floats, spans: Floats, velocity: Floats, cell: float, slope: float,
    periodic: bool, dt: float, keep: float, shaking: float, gravity_x: float, gravity_z: float, base: float, x: Floats,
    v: Floats, affine: Floats, stress: Floats, state: Floats, side: Floats, properties: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Move the points of some stripes with the grid, and update their stress. Places are relative to the base.

    Parameters
    ----------
    stripes, offsets, grid, spans : as in `scatter`, after the points of all stripes were added
    velocity (nx, nz, VELOCITIES) : velocities of the nodes, as of `grid_motion.move_grid` (m/s)
    cell, slope, periodic, shaking, gravity_x, gravity_z : as in `scatter`
    dt : time step (s)
    keep : share α, 0 or 1, of the part of its velocity that a point keeps although the grid cannot resolve it
    base : velocity of the base (m/s)
    x, v, affine, stress, state : as in `scatter`; they are changed
    side (n,) : as in `scatter`; becomes 0 where ground has come apart (`DETACHED_SHARE`)
    properties (n, PROPERTIES) : as in `scatter`
    sums (stripes, 2) : increased by the work of weight and shaking, and by the energy dissipated (J/m)
    """
    inverse, columns, rows = 1.0 / cell, velocity.shape[0], velocity.shape[1]
    stiff, nodes = 4.0 * inverse * inverse, velocity.reshape(-1)
    low, high_x, high_z = 2.0 * cell, (columns - 3.0) * cell, (rows - 3.0) * cell
    for stripe in stripes:
        external = dissipated = 0.0
        for p in range(offsets[stripe], offsets[stripe + 1]):
            across, up = inverse * x[p, 0], inverse * (x[p, 1] - slope * x[p, 0])
            i, j = math.floor(across - 0.5), math.floor(up - 0.5)
            fx, fz = across - i, up - j
            places = _columns_of(i, j, columns, rows, periodic, VELOCITIES)
            old_x, old_z, new_x, new_z, oxx, ozx, cxx, czx, oxz, ozz, cxz, czz = collect_nodes(
                nodes, places, _weights(fx), _weights(fz), _apart(fx, cell), _apart(fz, cell)
            )
            cxx, cxz, czx, czz = stiff * cxx, stiff * cxz, stiff * czx, stiff * czz
            affine[p, 0] = cxx + keep * (affine[p, 0] - stiff * oxx)
            affine[p, 1] = cxz + keep * (affine[p, 1] - stiff * oxz)
            affine[p, 2] = czx + keep * (affine[p, 2] - stiff * ozx)
            affine[p, 3] = czz + keep * (affine[p, 3] - stiff * ozz)
            cxx, czx = cxx - slope * cxz, czx - slope * czz
            heavy, mass = properties[p, WEIGHT_RATIO], state[p, MASS]
            middle_x, middle_z = 0.5 * (old_x + new_x), 0.5 * (old_z + new_z)
            external += mass * dt * ((shaking + heavy * gravity_x) * middle_x + heavy * gravity_z * middle_z)
            external += dt * (side[p] * middle_x - 0.25 * cell * abs(side[p]) * cxx)
            v[p, 0] = new_x + keep * (v[p, 0] - old_x)
            v[p, 1] = new_z + keep * (v[p, 1] - old_z)
            x[p, 0] += dt * (new_x - base)
            x[p, 1] += dt * new_z
            if not periodic and not low < x[p, 0] < high_x:
                x[p, 0], v[p, 0] = min(max(x[p, 0], low), high_x), base
            height = x[p, 1] - slope * x[p, 0]
            if not low < height < high_z:
                x[p, 1], v[p, 1] = min(max(height, low), high_z) + slope * x[p, 0], 0.0
            relaxed = 0.0
            if _flows(state, properties, p):
                column = i % columns if periodic else i
                mean = spans[column, j, SPAN_STRAIN] / spans[column, j, SPAN_COMPLIANCE]
                relaxed = RELAXED_SHARE * (mean - 0.5 * (stress[p, 0] + stress[p, 1]))
            if side[p] != 0.0:
                full = cell * cell * mass / state[p, VOLUME]
                if _mass_around(grid, columns, i, j, fx, fz, periodic) < DETACHED_SHARE * full:
                    side[p] = 0.0
            drained = dt * properties[p, DRAINAGE_RATE]
            dissipated += update_stress(
                stress, state, properties, p, dt * cxx, dt * czz, 0.5 * dt * (cxz + czx), 0.5 * dt * (cxz - czx),
                relaxed, drained, dt,
            )  # fmt: skip
        sums[stripe, EXTERNAL] += external
        sums[stripe, DISSIPATED] += dissipated


@njit(cache=True, nogil=True, error_model="numpy")
def take_off(
    stripes: Integers, offsets: Integers, velocity: Floats, cell: float, slope: float, periodic: bool, x: Floats,
    v: Floats, affine: Floats,
) -> None:  # fmt: skip
    """Subtract from the velocities of the points of some stripes the velocity that the grid resolves: (I - S) (v, C).

    Parameters
    ----------
    stripes, offsets, cell, slope, periodic, x : as in `scatter`
    velocity (nx, nz, VELOCITIES) : velocities of the nodes, of which those before the step are subtracted (m/s)
    v (n, 2) : velocities of the points, which are changed (m/s)
    affine (n, 4) : C of the velocities, which is changed (1/s)
    """
    inverse, columns, rows = 1.0 / cell, velocity.shape[0], velocity.shape[1]
    stiff, nodes = 4.0 * inverse * inverse, velocity.reshape(-1)
    for stripe in stripes:
        for p in range(offsets[stripe], offsets[stripe + 1]):
            across, up = inverse * x[p, 0], inverse * (x[p, 1] - slope * x[p, 0])
            i, j = math.floor(across - 0.5), math.floor(up - 0.5)
            fx, fz = across - i, up - j
            places = _columns_of(i, j, columns, rows, periodic, VELOCITIES)
            vx, vz, _, _, cxx, czx, _, _, cxz, czz, _, _ = collect_nodes(
                nodes, places, _weights(fx), _weights(fz), _apart(fx, cell), _apart(fz, cell)
            )
            v[p, 0] -= vx
            v[p, 1] -= vz
            affine[p, 0] -= stiff * cxx
            affine[p, 1] -= stiff * cxz
            affine[p, 2] -= stiff * czx
            affine[p, 3] -= stiff * czz


@njit(cache=True, nogil=True, error_model="numpy")
def advance(
    steps: int, stripes: Integers, offsets: Integers, cell: float, slope: float, periodic: bool, dt: float,
    keep: float, accelerations: Floats, gravity_x: float, gravity_z: float, damping: float, base: Floats,
    uplift: Floats, support: NDArray[np.int8], x: Floats, v: Floats, affine: Floats, stress: Floats, state: Floats,
    side: Floats, properties: Floats, grid: Floats, spans: Floats, velocity: Floats, gained: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Advance the material points by some time steps on one thread.

    Parameters
    ----------
    steps : number of time steps
    stripes, offsets, cell, slope, periodic, gravity_x, gravity_z : as in `scatter`, with all stripes
    dt, keep : as in `gather`
    accelerations (steps,) : horizontal accelerations of the whole mass by shaking (m/s²)
    damping, uplift, support : as in `grid_motion.move_grid`
    base (BASE_FIELDS,) : motion of the base, which is changed
    x, v, affine, stress, state, side : as in `gather`; they are changed
    properties : as in `scatter`
    grid, spans, velocity : work arrays, as in `scatter` and `grid_motion.move_grid`
    gained, sums : energies, increased as by `grid_motion.move_grid` and `gather` (J/m)
    """
    heavy = properties[:, WEIGHT_RATIO].copy()
    for step in range(steps):
        grid[:], spans[:] = 0.0, 0.0
        shaking = accelerations[step]
        for parity in range(2):
            scatter(
                stripes[parity::2], offsets, x, v, affine, stress, state, heavy, side, properties, cell, slope,
                periodic, shaking, gravity_x, gravity_z, grid, spans,
            )  # fmt: skip
        move_base(grid, uplift, support, dt, shaking, base)
        move_grid(0, grid.shape[0], grid, uplift, support, dt, damping, base, velocity, gained)
        gather(
            stripes, offsets, grid, spans, velocity, cell, slope, periodic, dt, keep, shaking, gravity_x, gravity_z,
            base[NEW_VELOCITY], x, v, affine, stress, state, side, properties, sums,
        )  # fmt: skip
