"""Draws the borings of a section side by side: strata, blow counts or cone resistances, and F_L with depth."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from meshes.section.cutting import whole_soil
from meshes.section.overburden import water_level
from meshes.section.section import Section
from workflow.figures.canvas import CONTINUUM, CRITICAL, INK, WATER, Frames
from workflow.figures.colours import soil_colours
from workflow.figures.ground import foot
from workflow.results.triggering import TestPart, TriggeringAnswer

BORINGS_IN_ROW = 4  # borings in a row of the picture
MOST_BLOWS, MOST_RESISTANCE, MOST_FACTOR = 50.0, 30.0, 2.0  # MPa is the unit of the second
ROW = 4.4  # inches
THINNEST_NAMED = 0.04  # of the depth that is shown: thinner strata have no room for their name


def draw(section: Section, answer: TriggeringAnswer) -> Frames:
    """Draw every boring in two frames: N or qc in the strata, and F_L.

    Parameters
    ----------
    section : the section, with its water
    answer : assessment of every blow count or cone reading

    Returns
    -------
    The picture.
    """
    names = [boring.name for boring in answer.borings]
    rows = -(-len(names) // BORINGS_IN_ROW)
    magnitude = "" if answer.magnitude is None else f", M {answer.magnitude:g}"
    title = f"{section.heading}: {answer.method}, {answer.motion.median_gal:.0f} gal{magnitude}"
    picture = Frames(ROW * rows + 0.9, title)
    across = min(len(names), BORINGS_IN_ROW)
    frames = picture.figure.subplots(rows, 2 * across, sharey=False, squeeze=False, width_ratios=[1.0, 1.0] * across)
    deepest = 1.15 * max(test.depth_m for test in answer.tests)
    for number in range(rows * across):
        row, column = divmod(number, across)
        pair = (frames[row, 2 * column], frames[row, 2 * column + 1])
        if number >= len(names):
            for axes in pair:
                axes.set_axis_off()
            continue
        _boring(section, [test for test in answer.tests if test.boring == names[number]], answer, pair, deepest)
    style: dict[str, Any] = {"marker": "o", "markersize": 3.5, "linewidth": 1.0}
    handles = [
        Line2D([], [], color=CONTINUUM, label="measured, and F_L of 1 or more", **style),
        Line2D([], [], color=CRITICAL, label="F_L below 1", **style),
        Line2D([], [], color=WATER, linewidth=1.4, linestyle=(0, (6, 3)), label="water table"),
    ]
    picture.figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=7.5, frameon=False)
    if note := foot(section):
        picture.figure.supxlabel(note, fontsize=7, color=INK, x=0.02, ha="left")
    return picture


def _boring(
    section: Section, tests: list[TestPart], answer: TriggeringAnswer, pair: tuple[Axes, Axes], deepest: float
) -> None:
    """Draw one boring. All borings are drawn to the same depth (m), for comparison."""
    x = tests[0].x_m
    levels = section.layering.interfaces(np.array([x]))[0]
    depths = levels[0] - levels
    blows, factors = pair
    for axes in pair:
        for k, colour in enumerate(soil_colours([stratum.name for stratum in section.strata])):
            if depths[k + 1] > depths[k]:
                axes.axhspan(depths[k], depths[k + 1], color=colour, alpha=0.75, linewidth=0)
        water = water_level(section, x)
        if water is not None:
            axes.axhline(levels[0] - water, color=WATER, linewidth=1.4, linestyle=(0, (6, 3)))
        axes.set_ylim(deepest, 0.0)
        axes.tick_params(labelsize=7, colors=INK)
        axes.grid(color="white", linewidth=0.5)
    _name_strata(section, depths, deepest, factors)
    at = [test.depth_m for test in tests]
    cone = any(test.qc_Pa is not None for test in tests)
    most = MOST_RESISTANCE if cone else MOST_BLOWS
    values = [(test.qc_Pa or 0.0) / 1e6 if cone else test.N or 0.0 for test in tests]
    blows.plot(np.minimum(values, most), at, color=CONTINUUM, marker="" if cone else "o", markersize=3.5)
    blows.set_xlim(0.0, 1.05 * most)
    blows.set_xlabel("cone resistance qc (MPa)" if cone else "blow count N", fontsize=8, color=INK, parse_math=False)
    blows.set_ylabel("depth (m)", fontsize=8, color=INK)
    potential = next(boring.potential for boring in answer.borings if boring.name == tests[0].boring)
    blows.set_title(f"{tests[0].boring}, x = {x:g} m", fontsize=8.5, loc="left", color=INK, parse_math=False)
    factors.set_title(f"index P_L = {potential:.1f}", fontsize=8.5, loc="left", color=INK)
    for test in tests:
        if test.factor is not None:
            colour = CRITICAL if test.factor < 1.0 else CONTINUUM
            factors.plot([test.factor, test.factor], [test.top_m, test.bottom_m], color=colour, linewidth=1.0)
            factors.plot(test.factor, test.depth_m, color=colour, marker="o", markersize=3.5)
    factors.axvline(1.0, color=INK, linewidth=0.9)
    factors.set_xlim(0.0, MOST_FACTOR + 0.1)
    factors.set_xlabel(f"F_L (drawn up to {MOST_FACTOR:g})", fontsize=8, color=INK)
    factors.set_yticklabels([])


def _name_strata(section: Section, depths: np.ndarray, deepest: float, axes: Axes) -> None:
    """Write the names of the strata where they are thick enough."""
    for stratum, top, bottom in zip(section.strata, depths[:-1], depths[1:], strict=True):
        if min(bottom, deepest) - top > THINNEST_NAMED * deepest:
            name = whole_soil(stratum.name)
            axes.annotate(
                name, (0.95, top), (0, -3), xycoords=("axes fraction", "data"), textcoords="offset points",
                fontsize=6, va="top", ha="right", color=INK, parse_math=False, annotation_clip=False,
                bbox={"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none"}, zorder=4.0,
            )  # fmt: skip
