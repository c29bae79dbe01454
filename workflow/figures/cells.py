"""Paints cells of a mesh into axes: in one colour or by a value of each cell, with their edges and their outline."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from meshes.edges import edges_of

GROUND = "#efece4"
SEAM = 0.3  # points: a line in the colour of its cell, without which paper would shine through between two cells


def paint_cells(axes: Axes, points: np.ndarray, cells: np.ndarray, colours: str | np.ndarray) -> None:
    """Fill the cells with one colour, or each cell with a colour of its own.

    ``points``: points (n, 2) of the mesh (m); ``cells``: point numbers (m, corners) of every cell; ``colours``: one
    colour, or the colours (m,) of the cells as texts or (m, 4) as shares of red, green, blue and opacity.
    """
    axes.add_collection(
        PolyCollection(points[cells], facecolors=colours, edgecolors="face", linewidths=SEAM), autolim=False
    )


def paint_classes(
    axes: Axes, points: np.ndarray, cells: np.ndarray, values: np.ndarray, limits: Sequence[float],
    colours: Sequence[str],
) -> None:  # fmt: skip
    """Fill every cell with the colour of the class of its value.

    ``values``: one value (m,) for each cell; ``limits``: limits of the classes, one more than ``colours``; ``points``,
    ``cells``: as in ``paint_cells``.
    """
    paint_cells(axes, points, cells, np.asarray(colours)[np.digitize(values, limits[1:-1])])


def draw_edges(
    axes: Axes, points: np.ndarray, cells: np.ndarray, colour: str, width: float, opacity: float = 1.0
) -> None:
    """Draw the edges of all cells, each once.

    ``width``: width of the lines in points; ``points``, ``cells``: as in ``paint_cells``.
    """
    edges, _ = edges_of(cells)
    _draw(axes, points[edges], colour, width, opacity)


def draw_outline(axes: Axes, points: np.ndarray, cells: np.ndarray, colour: str, width: float) -> None:
    """Draw the edges that belong to one cell only; the arguments are those of ``draw_edges``."""
    edges, of_cell = edges_of(cells)
    _draw(axes, points[edges[np.bincount(of_cell.ravel()) == 1]], colour, width, 1.0)


def _draw(axes: Axes, lines: np.ndarray, colour: str, width: float, opacity: float) -> None:
    axes.add_collection(
        LineCollection(list(lines), colors=colour, linewidths=width, alpha=opacity, capstyle="round"), autolim=False
    )
