"""Computes the quality of quadrilaterals: scaled Jacobian, angles, aspect ratio (definitions of Verdict, Stimpson et
al. 2007)."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Quality:
    """Holds the number of cells of a mesh, and the worst measures of quality among them.

    Attributes
    ----------
    quadrilaterals : number of cells
    nodes : number of corners
    smallest_scaled_jacobian : smallest scaled Jacobian: 1 for a rectangle, 0 or less for a flat or folded cell
    smallest_angle, largest_angle : smallest and largest angle of all corners (deg)
    largest_aspect_ratio : largest aspect ratio: longest edge times perimeter over four times the area, 1 for a square
    """

    quadrilaterals: int
    nodes: int
    smallest_scaled_jacobian: float
    smallest_angle: float
    largest_angle: float
    largest_aspect_ratio: float


def corner_vectors(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges from every corner to the next corner and to the corner before, each (cells, 4, 2)."""
    corners = points[cells]
    return np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners


def corner_angles(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the angles in the corners of quadrilaterals.

    Parameters
    ----------
    points (n, 2) : coordinates (m)
    cells (m, 4) : corners of every cell, counter-clockwise

    Returns
    -------
    Angles (m, 4) in degrees; negative in folded cells.
    """
    following, back = corner_vectors(points, cells)
    cross = following[..., 0] * back[..., 1] - following[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, np.sum(following * back, axis=-1)))


def scaled_jacobians(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the smallest Jacobian over the product of the two edge lengths, over the four corners of each cell
    (cells,).

    A value that is not positive means a corner that is flat or folded, or a cell that turns clockwise.
    """
    following, back = corner_vectors(points, cells)
    jacobian = following[..., 0] * back[..., 1] - following[..., 1] * back[..., 0]
    lengths = np.hypot(following[..., 0], following[..., 1]) * np.hypot(back[..., 0], back[..., 1])
    return np.min(jacobian / np.where(lengths > 0.0, lengths, np.inf), axis=1)


def areas(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the area of every quadrilateral: half the cross product of its diagonals.

    Parameters
    ----------
    points (n, 2) : coordinates (m)
    cells (m, 4) : corners of every cell, counter-clockwise

    Returns
    -------
    Areas (m,) in m²; negative for clockwise cells.
    """
    corners = points[cells]
    diagonal, other_diagonal = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return 0.5 * (diagonal[:, 0] * other_diagonal[:, 1] - diagonal[:, 1] * other_diagonal[:, 0])


def quality(points: np.ndarray, cells: np.ndarray) -> Quality:
    """Return the quality of a mesh of quadrilaterals: points (n, 2), cells (m, 4) counter-clockwise."""
    following, _ = corner_vectors(points, cells)
    angles = corner_angles(points, cells)
    lengths = np.hypot(following[..., 0], following[..., 1])
    aspect = lengths.max(axis=1) * lengths.sum(axis=1) / (4.0 * areas(points, cells))
    return Quality(
        quadrilaterals=len(cells),
        nodes=len(points),
        smallest_scaled_jacobian=float(scaled_jacobians(points, cells).min()),
        smallest_angle=float(angles.min()),
        largest_angle=float(angles.max()),
        largest_aspect_ratio=float(aspect.max()),
    )
