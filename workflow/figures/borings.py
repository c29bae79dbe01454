"""A section made from borings, with the borings on it and their blow counts."""

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from meshes.borings.connect import Connected
from workflow.figures.canvas import DPI, INK, WATER, WIDTH, save, soil_colour

HEIGHT = 5.0  # inches


def draw(found: Connected, title: str, path: Path) -> None:
    """The strata as they are connected, the borings as far as they go, N beside them; heights are exaggerated."""
    figure = Figure(figsize=(WIDTH / DPI, HEIGHT), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    deepest = min(min(one.log.bottom for one in found.borings), float(found.bottoms[-1].min()))
    tops = np.vstack([found.ground, found.bottoms[:-1]])
    bottoms = np.vstack([found.bottoms[:-1], np.full(len(found.x), deepest)])
    for k in range(len(found.names)):
        axes.fill_between(found.x, bottoms[k], tops[k], facecolor=soil_colour(k), edgecolor=INK, linewidth=0.6)
    handles = [Patch(facecolor=soil_colour(k), label=name) for k, name in enumerate(found.names)]
    for one in found.borings:
        log = one.log
        axes.plot([one.x, one.x], [log.bottom, log.ground_level], color=INK, linewidth=2.0)
        top = max(log.ground_level, log.ground_level if log.water_level is None else log.water_level)
        axes.annotate(log.name, (one.x, top), (0, 6), textcoords="offset points", ha="center", fontsize=8)
        for sample in log.samples:
            place = (one.x, log.ground_level - sample.depth)
            axes.plot(*place, "o", color=INK, markersize=3)
            axes.annotate(f"{sample.N:g}", place, (5, -3), textcoords="offset points", fontsize=7, color=INK)
        if log.water_level is not None:
            axes.plot(one.x, log.water_level, marker="v", color=WATER, markersize=7)
    for one in found.soundings:
        ground = float(np.interp(one.x, found.x, found.ground))
        axes.plot([one.x, one.x], [ground - one.log.cones[-1].depth, ground], "--", color=INK, linewidth=1.2)
        axes.annotate(one.log.name, (one.x, ground), (0, 4), textcoords="offset points", ha="center", fontsize=8)
    cones = "; dashed: cones" if found.soundings else ""
    axes.set_title(
        f"{title}: borings with N; triangles: water{cones}", fontsize=11, weight="bold", loc="left", parse_math=False
    )
    axes.set_xlabel("distance x (m)", fontsize=8)
    axes.set_ylabel("elevation (m)", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.margins(x=0.03, y=0.08)
    figure.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=7.5, frameon=False)
    save(figure, path)
