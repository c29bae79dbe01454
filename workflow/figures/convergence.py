"""Numbers over ever smaller discs and steps, with their intervals and what they tend to."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from workflow.figures.canvas import CONTINUUM, CRITICAL, DPI, INK, WIDTH, save
from workflow.results.convergence import Series

HEIGHT = 2.2  # inches of a row of frames
ACROSS = 4


def draw(series: Sequence[Series], title: str, path: Path) -> None:
    """A frame for each series; the limit on the axis, in red where it has not converged."""
    rows = -(-len(series) // ACROSS)
    figure = Figure(figsize=(WIDTH / DPI, HEIGHT * rows + 0.4), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=11, weight="bold", color=INK, x=0.02, ha="left", parse_math=False)
    frames = np.ravel([figure.subplots(rows, ACROSS, squeeze=False)])
    for axes in frames[len(series) :]:
        axes.set_visible(False)
    for axes, quantity in zip(frames, series, strict=False):
        halves = [half or 0.0 for half in quantity.half_ci95]
        axes.errorbar(
            quantity.sizes, quantity.values, yerr=halves, fmt="o", color=CONTINUUM, markersize=3.5, linewidth=0.9
        )
        sizes = np.linspace(0.0, quantity.sizes[0], 60)
        ends = (quantity.sizes[-1], quantity.values[-1])
        power = quantity.order or 1.0
        rise = (ends[1] - quantity.limit) / ends[0] ** power
        axes.plot(sizes, quantity.limit + rise * sizes**power, color=CONTINUUM, linewidth=0.8, linestyle=(0, (4, 2)))
        axes.plot(
            0.0, quantity.limit, "D", color=CONTINUUM if quantity.converged else CRITICAL, markersize=4, clip_on=False
        )
        axes.set_title(
            f"{quantity.name}\n{quantity.verdict.split(':')[0]}", fontsize=6.5, loc="left", color=INK, parse_math=False
        )
        axes.set_xlabel(
            "radius (m)" if quantity.over == "radius" else "step over the stable one", fontsize=7, color=INK
        )
        axes.set_xlim(left=0.0)
        axes.tick_params(labelsize=6.5, colors=INK)
        axes.grid(color="#dddddd", linewidth=0.5)
    save(figure, path)
