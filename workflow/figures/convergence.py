"""Draws results over ever smaller discs and time steps, with their intervals and limits."""

from collections.abc import Sequence

import numpy as np

from workflow.figures.canvas import CONTINUUM, CRITICAL, INK, Frames
from workflow.results.study import Series

HEIGHT = 2.2  # inches of a row of frames
ACROSS = 4


def draw(series: Sequence[Series], title: str) -> Frames:
    """Draw a frame for each series, with the limit on the axis; the limit is red if the series has not converged."""
    rows = -(-len(series) // ACROSS)
    picture = Frames(HEIGHT * rows + 0.4, title)
    frames = np.ravel([picture.figure.subplots(rows, ACROSS, squeeze=False)])
    for axes in frames[len(series) :]:
        axes.set_visible(False)
    for axes, row in zip(frames, series, strict=False):
        halves = [half or 0.0 for half in row.half_ci95]
        axes.errorbar(row.sizes, row.values, yerr=halves, fmt="o", color=CONTINUUM, markersize=3.5, linewidth=0.9)
        sizes = np.linspace(0.0, row.sizes[0], 60)
        ends = (row.sizes[-1], row.values[-1])
        power = row.order or 1.0
        rise = (ends[1] - row.limit) / ends[0] ** power
        axes.plot(sizes, row.limit + rise * sizes**power, color=CONTINUUM, linewidth=0.8, linestyle=(0, (4, 2)))
        axes.plot(0.0, row.limit, "D", color=CONTINUUM if row.converged else CRITICAL, markersize=4, clip_on=False)
        axes.set_title(
            f"{row.name}\n{row.verdict.split(':')[0]}", fontsize=6.5, loc="left", color=INK, parse_math=False
        )
        across = "radius (m)" if row.over == "radius" else "time step over the stable step (-)"
        axes.set_xlabel(across, fontsize=7, color=INK)
        axes.set_xlim(left=0.0)
        axes.tick_params(labelsize=6.5, colors=INK)
        axes.grid(color="#dddddd", linewidth=0.5)
    return picture
