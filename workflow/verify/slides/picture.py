"""A picture of a known slide: its surface before and after, and how far it was measured to run."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from workflow.figures.canvas import INK
from workflow.verify.picture import DPI, save_in_few_colours
from workflow.verify.slides.case import Column, SlideCase
from workflow.verify.slides.record import SlideAnswer

SIZE = (3.2, 1.25)
BEFORE, AFTER, MEASURED = "#9a9a9a", "#c0392b", "#1f6fb2"


def draw(case: SlideCase, answer: SlideAnswer, path: Path) -> None:
    """Write the picture as a PNG of few colours: grey before, red after, a blue bar where the front was measured."""
    figure = Figure(figsize=SIZE, dpi=DPI)
    axes = figure.add_axes((0.02, 0.04, 0.96, 0.92))
    before, after = np.array(answer.before).reshape(-1, 2), np.array(answer.after).reshape(-1, 2)
    low = min((float(line[:, 1].min()) for line in (before, after) if len(line)), default=0.0)
    if isinstance(case.known.problem, Column):
        low = 0.0
    for line, colour in ((before, BEFORE), (after, AFTER)):
        if len(line):
            axes.fill_between(line[:, 0], low, line[:, 1], color=colour, alpha=0.25, linewidth=0)
            axes.plot(*line.T, color=colour, linewidth=1.0)
    if isinstance(case.known.problem, Column):
        problem = case.known.problem
        size = problem.height if problem.weight_over_strength > 0.0 else problem.width
        ends = [problem.width + size * end for end in case.measured]
        axes.axvspan(ends[0] - 0.2 * problem.radius, ends[1] + 0.2 * problem.radius, color=MEASURED, alpha=0.6)
    elif case.measured[1] > 0.0 and len(after):
        start = float(after[len(after) // 2, 0])
        top = float(np.max(before[:, 1])) if len(before) else 1.0
        axes.plot([start, start + case.measured[1]], [top, top], color=MEASURED, linewidth=2.0)
    axes.axhline(low, color=INK, linewidth=0.6)
    axes.set_aspect("equal", adjustable="datalim")
    axes.axis("off")
    save_in_few_colours(figure, path)
