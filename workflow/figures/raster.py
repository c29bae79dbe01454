"""Paints cells of a mesh and discs into an image of exactly a window."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection, PolyCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from PIL import Image

from meshes.quad_mesh import QuadMesh
from meshes.triangles import TriMesh
from workflow.figures.canvas import DPI, INK, LEFT, RIGHT, TALLEST, WIDTH, Window

SAMPLES = 2  # pixels that are painted for one of the picture, each way
BORDER = 72.0 / DPI  # width of the lines round a mesh (points): one pixel


def image_size(window: Window, width: int, exaggeration: int) -> tuple[int, int]:
    """Return width and height (pixels) of the image of a window that is at most ``width`` wide; the image of a tall
    window is narrower."""
    proportion = exaggeration * window.proportion
    width = max(2, round(width * min(1.0, TALLEST / proportion)))
    return width, max(2, round(width * proportion))


def painted(
    window: Window,
    paint: Callable[[Axes], object],
    exaggeration: int = 1,
    width: int = round((RIGHT - LEFT) * WIDTH),
) -> np.ndarray:
    """Paint what ``paint`` adds to axes in metres as an image (height, width, 3) of exactly the window.

    Heights are multiplied by ``exaggeration``. The image is ``width`` pixels wide, or less for a tall window. It is
    painted twice as large and averaged: cells are painted with hard edges, since soft edges of two adjacent cells would
    leave a pale line between them.
    """
    size = np.array(image_size(window, width, exaggeration))
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


def fill_classes(
    axes: Axes,
    mesh: QuadMesh | TriMesh,
    values: np.ndarray,
    limits: Sequence[float],
    colours: Sequence[str],
    **edges: Any,
) -> None:
    """Fill the cells of a ``mesh`` in the one of ``colours`` between whose ``limits`` their ``values`` (m,) lie, and
    draw its border. ``axes``, ``edges``: as for `fill_cells`."""
    fill_cells(axes, mesh.points, mesh.cells, colours, np.digitize(values, limits[1:-1]), **edges)
    draw_border(axes, mesh.points, mesh.cells, 0.5 * BORDER)


def draw_outline(axes: Axes, mesh: QuadMesh | TriMesh) -> None:
    """Draw into ``axes`` a mesh as one pale area with its border."""
    fill_cells(axes, mesh.points, mesh.cells, ["#efece4"], np.zeros(len(mesh.cells), dtype=np.int64))
    draw_border(axes, mesh.points, mesh.cells)


class Circles(Protocol):
    """Holds the discs to be drawn: centres and radii (m)."""

    @property
    def x(self) -> np.ndarray: ...
    @property
    def z(self) -> np.ndarray: ...
    @property
    def radius(self) -> np.ndarray: ...


def fill_discs(axes: Axes, model: Circles, which: np.ndarray | slice = slice(None), **colours: Any) -> None:
    """Draw the discs of a ``model`` as filled circles into ``axes``.

    ``which``: numbers or mask of the discs; ``colours``: facecolors, or array, norm and cmap, as of a collection of
    matplotlib.
    """
    size = 2.0 * model.radius[which]
    centres = np.column_stack([model.x[which], model.z[which]])
    axes.add_collection(
        EllipseCollection(
            size, size, np.zeros(len(size)), units="xy", offsets=centres, offset_transform=axes.transData,
            linewidths=0.0, **colours,
        ),
        autolim=False,
    )  # fmt: skip
