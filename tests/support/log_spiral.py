"""Computes the upper bound of a homogeneous slope by rotation on a logarithmic spiral (Chen 1975; with Kh, Chang, Chen
& Yao 1984; basis of the charts of Michalowski 2002)."""

import math

import numpy as np
from scipy.optimize import minimize

# Points of the spiral; the work of the body between them and the ground is 1e-6 of itself off.
POINTS = 400
STARTING_POINTS = 60


def critical_kh(slope: float, phi: float, strength: float, seed: int = 1) -> float:
    """Return the smallest kc of all spirals through and below the toe of a slope at ``slope`` degrees in ground of
    ``phi`` degrees; ``strength`` is c / γH."""
    draw = np.random.default_rng(seed)

    def tried(shape: np.ndarray) -> float:
        return _kh(shape, math.radians(slope), math.radians(phi), strength)

    # Shallow surfaces turn little: many of the starts, too.
    starts = draw.uniform(
        [0.1, math.log(0.06), 0.0], [math.pi - 0.3, math.log(2.0), 0.8], size=(40 * STARTING_POINTS, 3)
    )
    starts[:, 1] = np.exp(starts[:, 1])
    starts[::2, 2] = 0.0
    best = sorted(starts, key=tried)[:STARTING_POINTS]
    values = [
        minimize(tried, start, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-10}) for start in best[:6]
    ]
    return float(min(result.fun for result in values))


def _kh(shape: np.ndarray, slope: float, phi: float, strength: float) -> float:
    """Return kc of one spiral, inf if the spiral is not admissible; H = 1, γ = 1, toe at (0, 0), crest to the right.

    ``shape``: angle (rad) of the radius to the lower end below the horizontal, angle between the radii to both ends,
    and distance of the exit from the toe, in H. The work of weight and Kh on a rigid rotation equals the dissipation c
    r0² (e^{2Δθ tan φ} - 1) / (2 tan φ).
    """
    down, rotated, before = shape
    if not (0.05 < rotated < math.pi and 0.05 < down < math.pi - 0.02 and 0.0 <= before < 3.0) or down - rotated < -1.5:
        return math.inf
    # The body moves towards smaller x; the radius points to angle θ below the horizontal, from the centre towards +x.
    theta = np.linspace(down - rotated, down, POINTS)
    radius = np.exp((theta - theta[0]) * math.tan(phi))
    shape_x, shape_y = radius * np.cos(theta), -radius * np.sin(theta)
    high = shape_y[0] - shape_y[-1]
    if high <= 1e-3:
        return math.inf
    scale = 1.0 / high
    x = scale * (shape_x - shape_x[-1]) - before
    y = scale * (shape_y - shape_y[-1])
    crest = 1.0 / math.tan(slope) if slope < math.pi / 2 - 1e-9 else 0.0
    ground = np.interp(
        x, [min(x.min(), -4.0), -1e-12, max(crest, 1e-12), max(x.max(), crest) + 1.0], [0.0, 0.0, 1.0, 1.0]
    )
    if x[0] < crest or np.any(y[1:-1] > ground[1:-1] + 1e-9) or np.any(y > 1.0 + 1e-9):
        return math.inf
    centre_x, centre_y = -scale * shape_x[-1] - before, -scale * shape_y[-1]
    outline_x = np.concatenate([x, [0.0, crest]])
    outline_y = np.concatenate([y, [0.0, 1.0]])
    area, first_x, first_y = _moments(outline_x, outline_y)
    weight = first_x - area * centre_x  # moment that turns the body towards the toe
    acceleration = area * centre_y - first_y
    r0 = scale
    grown = 2.0 * rotated * math.tan(phi)
    dissipated = strength * r0**2 * (rotated if phi < 1e-9 else math.expm1(grown) / (2.0 * math.tan(phi)))
    if acceleration <= 0.0:
        return math.inf
    return (dissipated - weight) / acceleration


def _moments(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Return area and first moments about the axes of a polygon, positive for both orientations."""
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    area = cross.sum() / 2.0
    sign = 1.0 if area > 0.0 else -1.0
    return abs(area), sign * ((x + x1) * cross).sum() / 6.0, sign * ((y + y1) * cross).sum() / 6.0
