"""Draws the unit weights and pore pressures of all analyses."""

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from meshes.pore_loads import corner_pressure
from meshes.section.overburden import computed_water_points
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.triangles import TriMesh, triangulate
from workflow.figures.canvas import INK, WATER, Sheet, Window
from workflow.figures.ground import borders, draw_loads, foot, pressure_of, room_for_loads
from workflow.figures.raster import painted, shade_cells

# Edges of the triangles over the height of the section: pore pressure is linear almost everywhere.
FINE_SPACING = 1.0 / 15.0
WEIGHTS, PRESSURES = "YlOrBr", "Blues"
EQUIPOTENTIALS = 15  # lines of equal head, about
SHARE = 0.93  # of the width of a view without its scale of colours
TICK_DISTANCE = 0.06  # of the scale: weights that lie closer together share a tick


def weights_sheet(section: Section) -> Sheet:
    """Draw unit weights with surcharges, and pore pressure at rest.

    Parameters
    ----------
    section : the ground with its water

    Returns
    -------
    The picture: unit weight on which gravity acts (kN/m³), and pore pressure (kPa) if there is any.
    """
    window = _picture_window(section)
    height = float(np.ptp(section.outline()[:, 1]))
    mesh = triangulate(section, FINE_SPACING * height)
    weights = GRAVITY * np.array([s.density_ordinary for s in section.strata]) / 1e3
    values = {
        "weight": np.repeat(weights[mesh.stratum], 3),
        "pressure": corner_pressure(mesh, section.water_pressure.at_rest).ravel() / 1e3,
    }
    views = ["weight", *(["pressure"] if section.water_pressure.present else [])]
    title = f"{section.heading}: unit weight" + (" and pore pressure" if len(views) > 1 else "")
    heights = [SHARE * exaggeration * window.proportion for exaggeration in window.exaggerations()[-1:]] * len(views)
    sheet = Sheet(title, heights, "\n".join(text for text in (_said(section), foot(section)) if text))
    for number, name in enumerate(views):
        _show(sheet, number, section, window, mesh, values[name], name)
    return sheet


def _picture_window(section: Section) -> Window:
    """Return the window of the picture, which has room for water and loads above the ground."""
    water, outline = section.water_points(), section.outline()
    points = outline if water is None else np.vstack([outline, water])
    return Window.around(np.vstack([points, room_for_loads(section)]), 0.03)


def _show(
    sheet: Sheet, view: int, section: Section, window: Window, mesh: TriMesh, values: np.ndarray, name: str
) -> None:
    """Draw ``values`` (3 triangles,) at the corners of all triangles into a view."""
    most = float(values.max())
    limits = (0.0, most) if name == "pressure" else (0.8 * float(values.min()), most + 0.05)  # room for its tick
    colours = PRESSURES if name == "pressure" else WEIGHTS
    exaggeration = window.exaggerations()[-1]

    corners = mesh.points[mesh.cells].reshape(-1, 2)

    def paint(axes: Axes) -> None:
        shade_cells(axes, corners, np.arange(len(corners)).reshape(-1, 3), values, colours, limits)

    words = "unit weight on which gravity acts (kN/m³)" if name == "weight" else "pore pressure at rest (kPa)"
    exaggeration_words = "" if exaggeration == 1 else f", heights exaggerated {exaggeration} times"
    left, low, wide, high = sheet.views[view].get_position().bounds
    sheet.views[view].set_position((left, low, SHARE * wide, high))
    axes = sheet.show(view, painted(window, paint, exaggeration), window, words + exaggeration_words, exaggeration)
    axes.add_collection(LineCollection(borders(section), colors=INK, linewidths=0.5))
    water, free = section.water_points(), computed_water_points(section)
    if water is not None and free is not None:
        axes.plot(*water.T, color=WATER, linewidth=1.2, linestyle=(0, (6, 3)))
        if section.water is not None:  # a table that is only drawn does not stand on the ground
            x = np.union1d(free[:, 0], section.layering.x)
            x = np.union1d(x, np.linspace(x[0], x[-1], 400))
            ground = section.layering.interface(0, x)
            axes.fill_between(x, ground, np.maximum(np.interp(x, *free.T), ground), color=WATER, alpha=0.2, linewidth=0)
    if name == "weight":
        draw_loads(axes, section)
    elif (flow := section.water_pressure.flow) is not None:
        wet = (flow.head > flow.grid.points[:, 1] - flow.tolerance)[flow.grid.cells].any(axis=1)
        axes.tricontour(
            *flow.grid.points.T, flow.grid.cells[wet], flow.head, EQUIPOTENTIALS, colors=INK, linewidths=0.6
        )
    ticks = None if name == "pressure" else _ticks(values, TICK_DISTANCE * (limits[1] - limits[0]))
    scale = axes.inset_axes((1.012, 0.0, 0.015, 1.0))
    sheet.figure.colorbar(ScalarMappable(Normalize(*limits), colours), cax=scale, ticks=ticks)
    scale.tick_params(labelsize=7, colors=INK, length=2)


def _ticks(weights: np.ndarray, apart: float) -> list[float]:
    """Return the unit weights of the layers (kN/m³) to one digit, the heaviest first, which differ by at least
    ``apart``."""
    ticks: list[float] = []
    for weight in sorted({round(float(weight), 1) for weight in weights}, reverse=True):
        if not ticks or ticks[-1] - weight >= apart:
            ticks.append(weight)
    return ticks


def _said(section: Section) -> str:
    """Return the text of the note below the picture."""
    phrases = []
    for load in section.surcharges:
        phrases.append(f"{pressure_of(load)} from x = {load.start:g} to {load.end:g} m")
    if section.water_pressure.flow is not None:
        phrases.append(
            "steady seepage: thin lines have equal head, the dashed line is free water and the phreatic line"
        )
    if section.water is not None and section.water.after_drawdown is not None:
        phrases.append("pore pressure after the drawdown, dashed the water table before it")
    elif section.water_points() is not None and section.water_pressure.flow is None:
        phrases.append("blue, dashed: water table")
    return textwrap.fill("; ".join(phrases), 180)
