"""Paints cells of a mesh into an image of exactly a window, by matplotlib alone.

matplotlib takes a tenth of the time of VTK for some thousand flat cells, and half a second less to load. Failure zones
of the continuum and discs are rendered by pyvista (``canvas.render``).
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from PIL import Image

from workflow.figures.canvas import DPI, INK, LEFT, RIGHT, SAMPLES, WIDTH, Window, image_size

BORDER = 72.0 / DPI  # width of the lines round a mesh (points): one pixel


def painted(window: Window, paint: Callable[[Axes], object], exaggeration: int = 1) -> np.ndarray:
    """Paint what ``paint`` adds to axes in metres as an image (height, width, 3) of exactly the window.

    Heights are multiplied by ``exaggeration``. The image is painted twice as large and averaged: cells are painted with
    hard edges, since soft edges of two adjacent cells would leave a pale line between them.
    """
    size = np.array(image_size(window, round((RIGHT - LEFT) * WIDTH), exaggeration))
    dpi = SAMPLES * DPI
    figure = Figure(figsize=tuple((SAMPLES * size + 1e-6) / dpi), dpi=dpi, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(window.left, window.right)
    axes.set_ylim(window.bottom, window.top)
    axes.set_autoscale_on(False)
    paint(axes)
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    return np.asarray(image.reduce(SAMPLES))


def fill_cells(
    axes: Axes, points: np.ndarray, cells: np.ndarray, colours: Sequence[str], classes: np.ndarray, **edges: Any
) -> None:
    """Fill cells (m, corners) of ``points`` (n, 2) in m, each in the one of ``colours`` that belongs to its class.

    ``axes``: the diagram; ``classes`` (m,): class of each cell; ``edges``: edgecolors and linewidths (points) of the
    cells; without them no edges are drawn.
    """
    colour = to_rgba_array(list(colours))[classes]
    lines = edges or {"edgecolors": "face", "linewidths": 0.0}
    axes.add_collection(PolyCollection(points[cells], facecolors=colour, antialiaseds=False, **lines), autolim=False)


def shade_cells(
    axes: Axes, points: np.ndarray, cells: np.ndarray, values: np.ndarray, colours: str, limits: tuple[float, float]
) -> None:
    """Colour cells (m, corners) of ``points`` (n, 2) in m by ``values`` (n,) at the points, linear between them.

    ``axes``: the diagram; ``colours``: name of the colour map; ``limits``: values at its two ends.
    """
    triangles = np.concatenate([cells[:, [0, k, k + 1]] for k in range(1, cells.shape[1] - 1)])
    low, high = limits
    axes.tripcolor(
        Triangulation(*points.T, triangles), values, shading="gouraud", cmap=colours, vmin=low, vmax=high
    )  # fmt: skip


def draw_border(axes: Axes, points: np.ndarray, cells: np.ndarray, width: float = BORDER) -> None:
    """Draw into ``axes`` the edges of cells (m, corners) of ``points`` (n, 2) in m that have a cell on one side only;
    ``width`` in points."""
    edges = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    axes.add_collection(LineCollection(points[edges[count == 1]], colors=INK, linewidths=width), autolim=False)
