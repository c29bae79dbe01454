"""Finds the slip surface of a state: the line in the middle of the sheared ground, if the ground moves in a
mechanism."""

import numpy as np
from scipy.interpolate import LinearNDInterpolator

from fem.continuum.fields import FieldState, is_mechanism
from meshes.quad_mesh import QuadMesh
from meshes.slip_line import slip_line

# Points in each column: a band of shear is seldom thinner than a fiftieth of the ground's height.
LEVELS = 100


def slip_surface(mesh: QuadMesh, state: FieldState, columns: int = 100) -> np.ndarray:
    """Return the slip surface (k, 2) in m, between moving ground and ground at rest, see ``slip_line``; empty without a
    mechanism."""
    if not is_mechanism(state):
        return np.zeros((0, 2))
    edges = np.linspace(mesh.points[:, 0].min(), mesh.points[:, 0].max(), columns + 1)
    x = 0.5 * (edges[1:] + edges[:-1])
    base, ground = (_line(mesh, name, x)[:, None] for name in ("base", "surface"))
    z = base + (ground - base) * (np.arange(LEVELS) + 0.5) / LEVELS
    speed = LinearNDInterpolator(mesh.points, np.hypot(*state.displacement.T))
    return slip_line(x, z, speed(np.broadcast_to(x[:, None], z.shape), z))


def _line(mesh: QuadMesh, boundary: str, x: np.ndarray) -> np.ndarray:
    nodes = mesh.points[np.unique(mesh.boundaries[boundary])]
    return np.interp(x, *nodes[np.argsort(nodes[:, 0], kind="stable")].T)
