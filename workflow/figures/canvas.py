"""Provides the common parts of pictures: failure zones and discs rendered by pyvista, axes in metres, legends, notes.

A picture has true proportions; a flat section is drawn a second time with exaggerated heights. pyvista renders without
a screen; matplotlib sets the axes, legend and notes.
"""

import os
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FuncFormatter, MaxNLocator
from PIL import Image

from workflow.figures import fonts
from workflow.figures.symbols import SYMBOL, in_mathtext
from workflow.texts.picture_texts import language_of, translated

if TYPE_CHECKING:
    import pyvista as pv

# Without a screen VTK would first complain that there is none; it reads this when it is loaded.
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

COMPRESSION = 3  # of PNG: 6, the default, takes twice the time for a tenth less
WIDTH = 1600  # px
DPI = 160
SAMPLES = 2  # pixels that are rendered for one of the picture, each way
LEFT, RIGHT = 0.062, 0.985  # sides of the views, as shares of the width
INK = "#26323a"
WATER = "#1f6fb2"

# The continuum, the discs, and what is critical, in all curves and lines.
CONTINUUM = "#0b3c6f"
DISCS = "#8e2f8e"
CRITICAL = "#b3202c"

# The tallest view, and the flattest that can be read, as height over width.
TALLEST, FLATTEST = 0.8, 0.1
EXAGGERATIONS = (2, 5, 10, 20, 50, 100, 200, 500, 1000)
UNIT = re.compile(r"(?<=\d) (?=(?:m|kPa|s|%)(?:\W|$))")  # the blank between a number and its unit
LEGEND_ROW = 0.21  # inches
LABEL_EDGE = 4.0  # pixels between the left edge of a picture and a label
LEGEND_ROWS = 16  # in a picture of strata: beyond these a legend is longer than the section is high
TITLE_CHARACTERS, CURVE_CHARACTERS, LEGEND_CHARACTERS, NOTE_CHARACTERS = 95, 120, 150, 88

rcParams["font.family"] = [fonts.PLAIN]


@dataclass(frozen=True)
class Window:
    """Holds the part of the section that a picture shows (m)."""

    left: float
    right: float
    bottom: float
    top: float

    @classmethod
    def around(cls, points: np.ndarray, margin: float = 0.02) -> "Window":
        """Return a window round points (n, 2) with a margin as a share of the width."""
        (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
        gap = margin * (right - left)
        above = min(gap, 0.1 * (top - bottom))
        return cls(left - gap, right + gap, bottom - above, top + above)

    def with_room_for(self, points: np.ndarray) -> "Window":
        """Return the window, enlarged if points (n, 2) lie outside it."""
        if not len(points):
            return self
        (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
        gap = 0.01 * (self.right - self.left)
        return Window(
            min(self.left, left - gap), max(self.right, right + gap), min(self.bottom, bottom), max(self.top, top)
        )

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Return which points (n, 2) in m lie in the window (n,)."""
        x, z = points.T
        return (self.left <= x) & (x <= self.right) & (self.bottom <= z) & (z <= self.top)

    @property
    def proportion(self) -> float:
        """Return the height over width."""
        return (self.top - self.bottom) / (self.right - self.left)

    def exaggerations(self) -> list[int]:
        """Return the exaggeration of heights in each view: 1, and a larger one in a second view if the section is too
        flat."""
        if self.proportion >= FLATTEST:
            return [1]
        return [
            1,
            next((factor for factor in EXAGGERATIONS if factor * self.proportion >= FLATTEST), EXAGGERATIONS[-1]),
        ]


def image_size(window: Window, width: int, exaggeration: int) -> tuple[int, int]:
    """Return width and height (pixels) of the image of a window that is at most ``width`` wide; the image of a tall
    window is narrower."""
    proportion = exaggeration * window.proportion
    width = max(2, round(width * min(1.0, TALLEST / proportion)))
    return width, max(2, round(width * proportion))


class Renderer:
    """Renders images in one window of pyvista, which takes as long to open as an image; used as a context manager."""

    def __enter__(self) -> "Renderer":
        import pyvista as pv

        self._plotter = pv.Plotter(off_screen=True, window_size=[2, 2])
        self._plotter.disable_anti_aliasing()
        return self

    def __exit__(self, *what: object) -> None:
        self._plotter.close()

    def image(
        self,
        window: Window,
        draw: "Callable[[pv.Plotter], object]",
        width: int = round((RIGHT - LEFT) * WIDTH),
        exaggeration: int = 1,
    ) -> np.ndarray:
        """Render what ``draw`` adds to a plotter as an image (height, width, 3) of exactly the window.

        Heights are multiplied by ``exaggeration``. The image is rendered twice as large and averaged: VTK's own
        supersampling takes four times each way, and 0.2 s for a picture.
        """
        plotter = self._plotter
        plotter.suppress_rendering = True  # pyvista renders at every change
        plotter.clear()
        plotter.window_size = [SAMPLES * size for size in image_size(window, width, exaggeration)]
        plotter.set_background("white")
        draw(plotter)
        plotter.set_scale(yscale=exaggeration, render=False)
        x, z = 0.5 * (window.left + window.right), 0.5 * exaggeration * (window.bottom + window.top)
        plotter.camera_position = [(x, z, 1.0), (x, z, 0.0), (0.0, 1.0, 0.0)]
        plotter.camera.parallel_projection = True
        plotter.camera.parallel_scale = 0.5 * exaggeration * (window.top - window.bottom)
        plotter.camera.clipping_range = (0.1, 10.0)
        plotter.suppress_rendering = False
        plotter.render()
        return np.asarray(Image.fromarray(plotter.screenshot(return_img=True)).reduce(SAMPLES))


def render(
    window: Window,
    draw: "Callable[[pv.Plotter], object]",
    width: int = round((RIGHT - LEFT) * WIDTH),
    exaggeration: int = 1,
) -> np.ndarray:
    """Render a single image; ``window``, ``draw``, ``width``, ``exaggeration``: as in `Renderer.image`."""
    with Renderer() as renderer:
        return renderer.image(window, draw, width, exaggeration)


class Drawing:
    """Holds a figure, and writes it."""

    figure: Figure

    def save(self, path: Path | str) -> None:
        """Write the picture as a PNG in the language of its run, with symbols, and with names in every script for which
        there is a font."""
        language = language_of(Path(path))
        for text in _texts(self.figure):
            words = translated(text.get_text(), language)
            if words != text.get_text():
                text.set_text(words)
            if not words.isascii():
                families = fonts.families_for(words)
                text.set_fontfamily(families)
                words = words.translate({ord(character): fonts.UNKNOWN for character in fonts.missing(words)})
                text.set_text(words)
                if len(families) > 1:  # mathtext has the characters of one font
                    continue
            if SYMBOL.search(words):
                text.set_parse_math(True)
                text.set_text(in_mathtext(words))
        self.fit()
        self.figure.savefig(path, format="png", pil_kwargs={"compress_level": COMPRESSION})

    def fit(self) -> None:
        """Make room for texts whose width is known only when they are drawn."""


class Frames(Drawing):
    """Holds a picture of frames, each with axes of its own, below a title."""

    def __init__(self, height: float, title: str = "") -> None:
        """Make a picture without frames; ``height`` in inches."""
        self.figure = Figure(figsize=(WIDTH / DPI, height), dpi=DPI, facecolor="white", layout="constrained")
        FigureCanvasAgg(self.figure)
        if title:
            self.figure.suptitle(title, fontsize=11, weight="bold", color=INK, x=0.02, ha="left", parse_math=False)


class Sheet(Drawing):
    """Holds a picture: rows of views of the same width, with a title, and notes at the foot."""

    def __init__(self, title: str, heights: list[float], foot: str = "", legend_rows: int = 0) -> None:
        """Make a sheet; ``heights`` are the heights of the views over their width; ``legend_rows`` leaves room for so
        many rows of the legend below them."""
        left, right, head, below, between = LEFT, RIGHT, 0.58, 0.45, 0.72
        inches = WIDTH / DPI
        title = textwrap.fill(UNIT.sub("\u00a0", title), TITLE_CHARACTERS)
        head += 0.2 * title.count("\n")
        panels = [min(height, TALLEST) * (right - left) * inches for height in heights]
        foot_room = 0.2 + 0.16 * foot.count("\n") if foot else 0.05
        legend_room = LEGEND_ROW * legend_rows
        total = head + sum(panels) + between * (len(panels) - 1) + below + legend_room + foot_room
        self.figure = Figure(figsize=(inches, total), dpi=DPI, facecolor="white")
        FigureCanvasAgg(self.figure)
        style: dict[str, Any] = {"color": INK, "parse_math": False}
        self.figure.text(left, 1.0 - 0.14 / total, title, fontsize=11, weight="bold", va="top", **style)
        if foot:
            self.figure.text(left, 0.09 / total, foot, fontsize=7, va="bottom", **style)
        self.legend_at = (left, (foot_room + legend_room) / total)
        self.views: list[Axes] = []
        self.curves: list[Axes] = []
        top = total - head
        for panel in panels:
            box = (left, (top - panel) / total, right - left, panel / total)
            self.views.append(self.figure.add_axes(box))
            top -= panel + between

    def show(self, view: int, image: np.ndarray, window: Window, title: str = "", exaggeration: int = 1) -> Axes:
        """Put a rendered image into a view, with axes in metres.

        ``window``: part of the section in the view; ``title``: title above the view; ``exaggeration``: vertical
        exaggeration.
        """
        axes = self.frame(view, window, title, exaggeration)
        extent = (window.left, window.right, window.bottom, window.top)
        axes.imshow(image, extent=extent, aspect=exaggeration, interpolation="nearest")
        return axes

    def frame(self, view: int, window: Window, title: str = "", exaggeration: int = 1) -> Axes:
        """Return a view of a window to draw into, with axes in metres.

        ``title``: title above the view; ``exaggeration``: vertical exaggeration.
        """
        axes = self.views[view]
        axes.set_xlim(window.left, window.right)
        axes.set_ylim(window.bottom, window.top)
        axes.set_aspect(exaggeration)
        axes.set_autoscale_on(False)
        axes.set_anchor("W")
        box = axes.get_position()
        high = box.height * self.figure.get_figheight()
        wide = min(1.0, TALLEST / (exaggeration * window.proportion))
        axes.set_xlabel("distance x (m)", fontsize=8, labelpad=1, color=INK)
        if high > 0.7:
            axes.set_ylabel("elevation (m)", fontsize=8, labelpad=2, color=INK)
        axes.yaxis.set_major_locator(MaxNLocator(nbins=int(np.clip(high / 0.2, 1, 6)), steps=[1, 2, 5, 10]))
        axes.xaxis.set_major_locator(MaxNLocator(nbins=max(1, round(12 * wide)), steps=[1, 2, 2.5, 5, 10]))
        axes.ticklabel_format(style="plain", useOffset=False)
        axes.tick_params(labelsize=8, colors=INK, length=3)
        if title:
            axes.set_title(title, fontsize=9, loc="left", y=1.0, color=INK, pad=3, parse_math=False)
        return axes

    def legend(self, handles: Sequence[Artist], columns: int, below: float = 0.0) -> None:
        """Draw a legend under the views; ``below`` is the number of rows of the legend below the first row."""
        left, top = self.legend_at
        legend = self.figure.legend(
            handles=handles, loc="upper left", ncols=columns, fontsize=7.5,
            bbox_to_anchor=(left, top - below * LEGEND_ROW / self.figure.get_figheight()),
            frameon=False, borderaxespad=0.0, handlelength=2.2, columnspacing=1.4, labelcolor=INK,
        )  # fmt: skip
        for text in legend.get_texts():
            text.set_parse_math(False)

    def colour_bar(self, scale: ScalarMappable, label: str, limits: Sequence[float] | None = None) -> None:
        """Draw a colour bar under the views, on the left; ``limits`` are the limits of its classes, if it has
        classes."""
        left, top = self.legend_at
        height = self.figure.get_figheight()
        box = self.figure.add_axes((left, top - 0.2 / height, 0.42, 0.12 / height))
        if limits is None:
            self.figure.colorbar(scale, cax=box, orientation="horizontal")
        else:
            self.figure.colorbar(scale, cax=box, orientation="horizontal", spacing="uniform", ticks=limits)
            box.set_xticklabels([f"{limit:g}" for limit in limits])
        box.tick_params(labelsize=7, colors=INK, length=2)
        box.set_xlabel(label, fontsize=7, color=INK, labelpad=1, parse_math=False)

    def note(self, text: str) -> None:
        """Draw a note under the views, right of the colour bar."""
        _, top = self.legend_at
        lines = "\n".join(line for part in text.splitlines() for line in textwrap.wrap(part, NOTE_CHARACTERS))
        self.figure.text(0.52, top, lines, fontsize=7.5, color=INK, va="top", parse_math=False)

    def plot(self, view: int, across: str, up: str, title: str = "") -> Axes:
        """Return a view as axes for curves, with labels and a grid.

        ``across``, ``up``: labels of the axes; ``title``: title above the view.
        """
        axes = self.views[view]
        self.curves.append(axes)
        axes.set_xlabel(across, fontsize=8, color=INK, labelpad=2, parse_math=False)
        axes.set_ylabel(up, fontsize=8, color=INK, parse_math=False)
        axes.tick_params(labelsize=8, colors=INK)
        axes.grid(color="#dddddd", linewidth=0.5)
        if title:
            title = textwrap.fill(title, CURVE_CHARACTERS)
            left, low, wide, high = axes.get_position().bounds
            axes.set_position((left, low, wide, high - 0.16 * title.count("\n") / self.figure.get_figheight()))
            axes.set_title(title, fontsize=9, loc="left", y=1.0, color=INK, pad=4, parse_math=False)
        return axes

    def fit(self) -> None:
        """Move the left side of the curves, so that wide numbers at their ticks do not push a label off the picture."""
        if not self.curves:
            return
        renderer = FigureCanvasAgg(self.figure).get_renderer()
        boxes = [box for axes in self.curves if (box := axes.yaxis.get_tightbbox(renderer)) is not None]
        missing = (LABEL_EDGE - min((box.x0 for box in boxes), default=LABEL_EDGE)) / self.figure.bbox.width
        if missing <= 0.0:
            return
        for axes in self.curves:
            left, low, wide, high = axes.get_position().bounds
            axes.set_position((left + missing, low, wide - missing, high))

    def state_exaggeration(self, view: int) -> None:
        """Add to the title of a view of curves how many times heights are drawn larger than distances."""
        axes = self.views[view]
        (left, right), (low, high), box = axes.get_xlim(), axes.get_ylim(), axes.get_window_extent()
        times = box.height * (right - left) / (box.width * (high - low))
        title = f"{axes.get_title(loc='left')}; heights exaggerated {times:.2g} times"
        axes.set_title(title, fontsize=9, loc="left", y=1.0, color=INK, pad=4, parse_math=False)


def _texts(artist: Artist) -> Iterator[Text]:
    """Yield the texts in a figure. Numbers at ticks are left out, since to read them would make matplotlib create the
    ticks twice."""
    if isinstance(artist, Text):
        yield artist
    for part in artist.get_children():
        if isinstance(part, Axis):
            yield part.label
            if isinstance(part.get_major_formatter(), FixedFormatter | FuncFormatter):
                yield from part.get_ticklabels()
        else:
            yield from _texts(part)


def in_classes(limits: Sequence[float], colours: Sequence[str]) -> ScalarMappable:
    """Return a scale of colours, one for each class between two limits."""
    return ScalarMappable(BoundaryNorm(limits, len(colours)), ListedColormap(list(colours)))


def spread(points: np.ndarray, window: Window, across: int = 45) -> np.ndarray:
    """Return the indices of about uniformly spaced points in the window, one for each box of a grid."""
    box = (window.right - window.left) / across
    cells = np.floor((points - [window.left, window.bottom]) / box).astype(np.int64)
    _, first = np.unique(cells[:, 0] * 100_000 + cells[:, 1], return_index=True)
    return first


def legend_columns(handles: Sequence[Artist], most: int = 3) -> int:
    """Return the number of columns of a legend: three, or fewer with long labels."""
    longest = max(len(str(handle.get_label()).encode()) for handle in handles)
    return int(np.clip(LEGEND_CHARACTERS // (longest + 6), 1, most))
