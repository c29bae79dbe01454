"""Provides stress updates as arrays, and trial stresses that return to every region."""

import math

import numpy as np

from fem.kernels import mohr_coulomb as mc

YOUNG = 1e3
# Names of the parts of the yield surface, in the order of their codes.
REGIONS = (
    "elastic", "shear plane", "left edge", "right edge", "tension plane", "tension edge", "shear-tension line", "apex",
    "tension apex", "left corner", "right corner",
)  # fmt: skip
FLOWS = {"associated": (0.6, 0.6), "dilation": (0.6, 0.2), "no dilation": (0.6, 0.0), "Tresca": (0.0, 0.0)}


def updated(table, stress, strain=None, material=None):
    """Return stress, tangent, plastic strain and region for arrays (n, 4) of old stresses and strain increments."""
    stress = np.ascontiguousarray(np.atleast_2d(stress), dtype=float)
    n = len(stress)
    strain = np.zeros((n, 4)) if strain is None else np.ascontiguousarray(np.broadcast_to(strain, (n, 4)))
    material = np.zeros(n, int) if material is None else material
    out = np.empty((n, 4)), np.empty((n, 4, 4)), np.empty((n, 4)), np.empty(n, np.int8)
    mc.update(strain, stress, material, table, *out)
    return out


def many_trials(seed, n):
    """Return trial stresses that return to every region, and strain increments of random direction."""
    random = np.random.default_rng(seed)
    mean, half, zz = random.uniform(-40, 20, n), random.exponential(6, n), random.normal(0, 15, n)
    angle = random.uniform(0, 2 * math.pi, n)
    trial = np.column_stack([mean + half * np.cos(angle), mean - half * np.cos(angle), mean + zz, half * np.sin(angle)])
    direction = random.normal(size=(n, 4))
    return trial, 10 / YOUNG * direction / np.linalg.norm(direction, axis=1)[:, None]


def in_plane(stress):
    """Return the principal stresses a >= b in the plane, for stresses (n, 4)."""
    mean, half = (stress[:, 0] + stress[:, 1]) / 2, (stress[:, 0] - stress[:, 1]) / 2
    radius = np.hypot(half, stress[:, 3])
    return mean + radius, mean - radius
