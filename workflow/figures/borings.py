"""Draws a section made from borings, with the borings on it and their blow counts."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from meshes.borings.connect import ConnectedBorings
from workflow.figures.canvas import INK, WATER, Frames
from workflow.figures.colours import soil_colour

HEIGHT = 5.0  # inches


def draw(connected: ConnectedBorings, title: str) -> Frames:
    """Draw the interpolated strata, and the borings to their depth with blow counts N; heights are exaggerated.

    Parameters
    ----------
    connected : borings, cone penetration tests, and the strata between them
    title : name of the section

    Returns
    -------
    The picture, with a legend of strata, borings, water levels and cones.
    """
    picture = Frames(HEIGHT)
    axes = picture.figure.add_subplot()
    deepest = min(min(boring.log.bottom for boring in connected.borings), float(connected.bottoms[-1].min()))
    tops = np.vstack([connected.ground, connected.bottoms[:-1]])
    bottoms = np.vstack([connected.bottoms[:-1], np.full(len(connected.x), deepest)])
    for k in range(len(connected.names)):
        axes.fill_between(connected.x, bottoms[k], tops[k], facecolor=soil_colour(k), edgecolor=INK, linewidth=0.6)
    handles: list[Artist] = [Patch(facecolor=soil_colour(k), label=name) for k, name in enumerate(connected.names)]
    handles += list(_signs(connected))
    for boring in connected.borings:
        log = boring.log
        axes.plot([boring.x, boring.x], [log.bottom, log.ground_level], color=INK, linewidth=2.0)
        top = max(log.ground_level, log.ground_level if log.water_level is None else log.water_level)
        axes.annotate(log.name, (boring.x, top), (0, 6), textcoords="offset points", ha="center", fontsize=8)
        for sample in log.samples:
            place = (boring.x, log.ground_level - sample.depth)
            axes.plot(*place, "o", color=INK, markersize=3)
            axes.annotate(f"{sample.N:g}", place, (5, -3), textcoords="offset points", fontsize=7, color=INK)
        if log.water_level is not None:
            axes.plot(boring.x, log.water_level, marker="v", color=WATER, markersize=7)
    for boring in connected.soundings:
        ground = float(np.interp(boring.x, connected.x, connected.ground))
        axes.plot([boring.x, boring.x], [ground - boring.log.cones[-1].depth, ground], "--", color=INK, linewidth=1.2)
        axes.annotate(boring.log.name, (boring.x, ground), (0, 4), textcoords="offset points", ha="center", fontsize=8)
    axes.set_title(f"{title}: layers between borings", fontsize=11, weight="bold", loc="left", parse_math=False)
    axes.set_xlabel("distance x (m); heights are exaggerated", fontsize=8)
    axes.set_ylabel("elevation (m)", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.margins(x=0.03, y=0.08)
    picture.figure.legend(handles=handles, loc="outside lower center", ncols=6, fontsize=7.5, frameon=False)
    return picture


def _signs(connected: ConnectedBorings) -> Iterator[Line2D]:
    """Yield the legend entries for blow counts, water and cones, if there are any."""
    logs = [boring.log for boring in connected.borings]
    if any(log.samples for log in logs):
        yield Line2D([], [], color=INK, linewidth=2.0, marker="o", markersize=3, label="boring, with blow counts N")
    if any(log.water_level is not None for log in logs):
        yield Line2D([], [], color=WATER, marker="v", markersize=7, linestyle="none", label="water level in the boring")
    if connected.soundings:
        yield Line2D([], [], color=INK, linewidth=1.2, linestyle="--", label="cone penetration test")
