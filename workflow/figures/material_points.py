"""Draws the slides by material points: the surface before and after, case by case."""

import numpy as np
from matplotlib.lines import Line2D

from workflow.config import Config
from workflow.figures.canvas import CONTINUUM, INK, Sheet
from workflow.results.cases import alike
from workflow.results.lengths import metres
from workflow.results.material_points import PointSlidesAnswer

ROOM = 0.3  # of the height of the ground, above and below its surface in the picture


def seen_from_above(surface: np.ndarray, cell: float) -> np.ndarray:
    """Return the surface (n, 2) of material points: the highest point in every half a ``cell`` (m) along x."""
    _, place = np.unique(np.floor(2.0 * surface[:, 0] / cell), return_inverse=True)
    order = np.lexsort((surface[:, 1], place.ravel()))
    return surface[order][np.append(np.diff(place.ravel()[order]) > 0, True)]


def profiles(config: Config, answer: PointSlidesAnswer) -> Sheet:
    """Draw the surface of every case before and after its slide by the material point method, x and elevation in m."""
    title = f"{config.section.heading}: slides by the material point method, cells of {answer.cell_m:.2g} m"
    groups = alike(answer.cases)
    sheet = Sheet(title, [0.16] * len(groups), "", 1)
    heights = np.concatenate([np.array(case.surface_before)[:, 1] for case in answer.cases.values()])
    margin = ROOM * (heights.max() - heights.min()) + answer.cell_m
    for view, (numbers, case) in enumerate(groups.items()):
        last = view == len(groups) - 1
        name = f"{config.called(*numbers)}: largest slide {metres(case.slide_max_m)}; {case.reason}"
        axes = sheet.plot(view, "distance x (m)" if last else "", "elevation (m)", name)
        before, after = np.array(case.surface_before), seen_from_above(np.array(case.surface_after), answer.cell_m)
        axes.plot(*after.T, color=CONTINUUM, linewidth=1.3)
        axes.plot(*before.T, color=INK, linewidth=0.9, linestyle=(0, (4, 2)))
        axes.set_xlim(before[0, 0], before[-1, 0])
        axes.set_ylim(heights.min() - margin, heights.max() + margin)  # alike in all cases
        sheet.state_exaggeration(view)
    handles = [
        Line2D([], [], color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label="surface before"),
        Line2D([], [], color=CONTINUUM, linewidth=1.3, label="surface after"),
    ]
    sheet.legend(handles, 2)
    return sheet
