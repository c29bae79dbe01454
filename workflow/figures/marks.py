"""Draws what pictures of a section share: the direction of the seismic force, and the water."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation, Transform, blended_transform_factory

from fem.continuum.loads import Direction, sign_of
from meshes.section.overburden import computed_water_points
from meshes.section.section import Section
from workflow.config import Config
from workflow.figures.canvas import CRITICAL, RIGHT, WATER

Towards = Literal["left", "right", "both"]
ARROW, ARROW_ABOVE = 44.0, 7.0  # length of the arrow of the seismic force, and its height above the view (points)
TABLE, LOWERED = (0, (6, 3)), (0, (2, 2))  # dashes of the water table, and of that after a drawdown


def side_of(section: Section, direction: Direction) -> Towards:
    """Return the side towards which a seismic force downslope or upslope acts."""
    return "right" if sign_of(section, direction) > 0 else "left"


def sides_of_slide(config: Config) -> Towards | None:
    """Return the sides towards which the shaking of the slides acts; None without shaking. Cycles and records act in
    both directions, a constant Kh towards the side of ``kh_towards``, by default downslope."""
    slide = config.slide
    if slide.accelerogram or slide.kh_cycles is not None or slide.kh == "earthquake":
        return "both"
    return (slide.kh_towards or side_of(config.section, "downhill")) if slide.kh else None


def mark_force(axes: Axes, towards: Towards | None) -> None:
    """Draw an arrow in the direction of the seismic force above a view, at the right end of the picture, clear of the
    ground. No arrow is drawn without a seismic force."""
    if towards is None:
        return
    row = blended_transform_factory(axes.figure.transFigure, axes.transAxes)
    tip, tail = (-ARROW, 0.0) if towards == "left" else (0.0, -ARROW)

    def moved(points: float) -> Transform:
        return row + ScaledTranslation(points / 72.0, ARROW_ABOVE / 72.0, axes.figure.dpi_scale_trans)

    axes.annotate(
        "", (RIGHT, 1.0), (RIGHT, 1.0), xycoords=moved(tip), textcoords=moved(tail), annotation_clip=False,
        arrowprops={"arrowstyle": "<|-|>" if towards == "both" else "-|>", "color": CRITICAL, "linewidth": 1.6,
                    "shrinkA": 0.0, "shrinkB": 0.0},
    )  # fmt: skip
    axes.text(RIGHT, 1.0, "Kh", transform=moved(-ARROW - 4.0), fontsize=8, color=CRITICAL, ha="right", va="center")


def draw_water(axes: Axes, section: Section, moved: bool = False) -> Sequence[Line2D]:
    """Draw the water table, the table after a drawdown, and free water. Return the lines, with labels. In a picture of
    ground that has ``moved`` there is no free water, since the surface is another one, and the table is called that
    before the slide."""
    water, lowered = section.water_points(), section.water_points_after_drawdown()
    free = computed_water_points(section)
    if water is None or free is None:
        return []
    if not moved:
        x = np.union1d(section.ground[:, 0], free[:, 0])
        x = np.union1d(x, np.linspace(x[0], x[-1], 2000))
        level, ground = np.interp(x, *free.T), np.interp(x, *section.ground.T)
        axes.fill_between(x, ground, level, where=list(level > ground), color=WATER, alpha=0.25, linewidth=0)
    name = "water table before the slide" if moved else "water table"
    tables = [(water, TABLE, name if lowered is None else "water table before the drawdown")]
    if lowered is not None:
        tables.append((lowered, LOWERED, "water table after the drawdown"))
    return [
        axes.plot(*table.T, color=WATER, linewidth=1.4, linestyle=dashes, label=label)[0]
        for table, dashes, label in tables
    ]
