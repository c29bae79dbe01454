"""A small picture of a case: its layers in colour, in true proportions."""

import io
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from meshes.section.section import Section
from workflow.figures.canvas import INK, soil_colours

# Small enough that a hundred and fifty of them weigh less than half a megabyte.
WIDTH, DPI, COLOURS = 220, 72, 16
TALLEST, FLATTEST = 0.6, 0.22


def draw(section: Section, path: Path) -> None:
    """Write the picture as a PNG of few colours."""
    outline = section.outline()
    wide, high = np.ptp(outline, axis=0)
    shape = float(np.clip(high / wide, FLATTEST, TALLEST))
    figure = Figure(figsize=(WIDTH / DPI, shape * WIDTH / DPI), dpi=DPI)
    axes = figure.add_axes((0.01, 0.02, 0.98, 0.96))
    for k, colour in enumerate(soil_colours([stratum.name for stratum in section.strata])):
        for polygon in section.layering.polygons(k):
            axes.fill(*np.transpose(polygon), facecolor=colour, edgecolor=INK, linewidth=0.5)
    axes.set_aspect("equal")
    axes.axis("off")
    save_in_few_colours(figure, path)


def save_in_few_colours(figure: Figure, path: Path) -> None:
    """Write a figure as a small PNG."""
    drawn = io.BytesIO()
    FigureCanvasAgg(figure).print_png(drawn)
    Image.open(drawn).convert("RGB").quantize(COLOURS).save(path, optimize=True)
