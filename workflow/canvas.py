"""The look that all pictures share: the ground rendered by pyvista, its frame in metres drawn round it.

A picture shows true proportions. pyvista renders without a screen; matplotlib sets the axes, legend and notes.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

# Without a screen VTK would first complain that there is none; it reads this when it is loaded.
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
import pyvista as pv

WIDTH = 1600  # px
DPI = 160
INK = "#26323a"
WATER = "#1f6fb2"

# Soils by their place in the section; read against black lines and white paper, and by the colour-blind.
SOILS = (
    "#e8cf9a", "#b5a68c", "#dcb272", "#c8925a", "#b98b6b", "#d7c27f", "#94a58b",
    "#cdb08a", "#8b97a3", "#77707a", "#a9b9a0", "#c9a3a0",
)  # fmt: skip


def soil_colour(index: int) -> str:
    """The colour of the stratum with this index."""
    return SOILS[index % len(SOILS)]


@dataclass(frozen=True)
class Window:
    """The part of the section that a picture shows (m)."""

    left: float
    right: float
    bottom: float
    top: float

    @classmethod
    def around(cls, points: np.ndarray, margin: float = 0.02) -> "Window":
        """A window round points (n, 2) with a margin as a share of the width."""
        (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
        gap = margin * (right - left)
        return cls(left - gap, right + gap, bottom - gap, top + gap)

    @property
    def proportion(self) -> float:
        """Height over width."""
        return (self.top - self.bottom) / (self.right - self.left)


def render(window: Window, draw: Callable[[pv.Plotter], object], width: int = 2 * WIDTH) -> np.ndarray:
    """What ``draw`` puts into a plotter, seen straight on, as an image (height, width, 3) of exactly the window."""
    plotter = pv.Plotter(off_screen=True, window_size=[width, max(2, round(width * window.proportion))])
    try:
        plotter.set_background("white")
        draw(plotter)
        x, z = 0.5 * (window.left + window.right), 0.5 * (window.bottom + window.top)
        plotter.camera_position = [(x, z, 1.0), (x, z, 0.0), (0.0, 1.0, 0.0)]
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = 0.5 * (window.top - window.bottom)
        plotter.camera.clipping_range = (0.1, 10.0)
        return np.asarray(plotter.screenshot(return_img=True))
    finally:
        plotter.close()


class Sheet:
    """One picture: rows of views of the same width, with a title, and notes at the foot."""

    def __init__(self, title: str, heights: list[float], foot: str = "", legend_rows: int = 0) -> None:
        """``heights`` are the heights of the views over their width; ``legend_rows`` leaves room below them."""
        left, right, head, below, between = 0.062, 0.985, 0.58, 0.45, 0.72
        inches = WIDTH / DPI
        panels = [height * (right - left) * inches for height in heights]
        foot_room = 0.2 + 0.16 * foot.count("\n") if foot else 0.05
        legend_room = 0.21 * legend_rows
        total = head + sum(panels) + between * (len(panels) - 1) + below + legend_room + foot_room
        self.figure = Figure(figsize=(inches, total), dpi=DPI, facecolor="white")
        FigureCanvasAgg(self.figure)
        self.figure.text(left, 1.0 - 0.14 / total, title, fontsize=11, weight="bold", color=INK, va="top")
        if foot:
            self.figure.text(left, 0.09 / total, foot, fontsize=7, color=INK, va="bottom")
        self.legend_at = (left, (foot_room + legend_room) / total)
        self.views: list[Axes] = []
        top = total - head
        for panel in panels:
            box = (left, (top - panel) / total, right - left, panel / total)
            self.views.append(self.figure.add_axes(box))
            top -= panel + between

    def show(self, view: int, image: np.ndarray, window: Window, title: str = "") -> Axes:
        """Put a rendered image into a view, with axes in metres."""
        axes = self.views[view]
        axes.imshow(image, extent=(window.left, window.right, window.bottom, window.top), aspect="equal")
        axes.set_xlabel("distance x (m)", fontsize=8, labelpad=1, color=INK)
        axes.set_ylabel("elevation (m)", fontsize=8, labelpad=2, color=INK)
        axes.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10], integer=True))
        axes.xaxis.set_major_locator(MaxNLocator(nbins=12, steps=[1, 2, 2.5, 5, 10]))
        axes.tick_params(labelsize=8, colors=INK, right=True, top=False, length=3)
        if title:
            axes.set_title(title, fontsize=9, loc="left", color=INK, pad=3)
        return axes

    def legend(self, handles: list[object], columns: int) -> None:
        """One legend under the views."""
        self.figure.legend(
            handles=handles, loc="upper left", bbox_to_anchor=self.legend_at, ncols=columns, fontsize=7.5,
            frameon=False, borderaxespad=0.0, handlelength=2.2, columnspacing=1.4, labelcolor=INK,
        )  # fmt: skip

    def save(self, path: Path | str) -> None:
        """Write the picture as a PNG."""
        self.figure.savefig(path, format="png")
