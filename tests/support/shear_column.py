"""Computes an infinite slope as a shear column: every layer is elastic up to its strength, and has its inertia.

The limit for rigid ground is Newmark's block. Rathje & Bray (1999, Earthquake Eng. Struct. Dyn. 28, 1303) and (2000, J.
Geotech. Geoenviron. Eng. 126, 1002) call this a coupled analysis: deformable ground oscillates, and slides farther
under the same shaking. Shear stress is positive if it acts upslope on the ground above.
"""

from pathlib import Path

import numpy as np
from numba import njit

from docs.verify.slides.case import UniformSlope
from docs.verify.slides.points import CELLS_BELOW, POISSON, YOUNG, cell_size
from docs.verify.slides.shaking import shaking_of_slope
from fem.mpm.ground import FASTEST_WAVE
from meshes.section.quantity import GRAVITY

SPRINGS = 120  # in the height of the column
REST_TIME = 10.0  # s after the shaking
LARGE_STRENGTH = 1e8  # Pa: strength of ground that does not liquefy


def crust_slide(wanted: UniformSlope, folder: Path) -> float:
    """Return the displacement of the crust along the slope (m), with firm ground of the thickness that the material
    points have.

    Parameters
    ----------
    wanted : the slope; its residual strength is a share of the effective normal stress
    folder : folder of its record
    """
    firm, (weak, crust) = CELLS_BELOW * cell_size(wanted) * np.cos(wanted.angle), wanted.thickness
    height = (firm + weak + crust) / SPRINGS
    middle = (np.arange(SPRINGS) + 0.5) * height
    normal = wanted.density * GRAVITY * np.cos(wanted.angle) * (firm + weak + crust - middle)
    liquefied = (middle > firm) & (middle < firm + weak)
    strength = np.where(liquefied, wanted.left.residual * normal, LARGE_STRENGTH)
    waves = wanted.density * FASTEST_WAVE**2 * (1.0 - 2.0 * POISSON) / (2.0 * (1.0 - POISSON))
    shear = min(YOUNG / (2.0 * (1.0 + POISSON)), waves)
    time, acceleration = shaking_of_slope(wanted, folder)
    step = 0.5 * height / np.sqrt(shear / wanted.density)
    instants = np.arange(0.0, time[-1] + REST_TIME, step)
    felt = np.interp(instants, time, acceleration, right=0.0) * np.cos(wanted.angle) + GRAVITY * np.sin(wanted.angle)
    at_rest = wanted.density * GRAVITY * np.sin(wanted.angle) * (firm + weak + crust - middle)
    return float(_slid(felt, step, height, wanted.density, shear, strength, at_rest))


@njit(cache=True)
def _slid(
    felt: np.ndarray, dt: float, height: float, density: float, shear: float, strength: np.ndarray, stress: np.ndarray
) -> float:
    """Return the displacement of the top (m) under accelerations ``felt`` (m/s²) at intervals dt; ``stress`` (Pa) is
    changed."""
    n = len(stress)
    speed, top = np.zeros(n + 1), 0.0
    for driving in felt:
        for k in range(1, n + 1):
            above, mass = (stress[k], density * height) if k < n else (0.0, 0.5 * density * height)
            speed[k] += dt * ((above - stress[k - 1]) / mass + driving)
        for k in range(n):
            trial = stress[k] + shear * dt * (speed[k + 1] - speed[k]) / height
            stress[k] = min(max(trial, -strength[k]), strength[k])
        top += dt * speed[n]
    return top
