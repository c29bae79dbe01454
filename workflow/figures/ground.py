"""Draws pictures of the ground and of its mesh."""

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Transform

from meshes.quad_mesh import QuadMesh
from meshes.section.cutting import CRACKED, soil_numbers, soil_of
from meshes.section.section import Section
from meshes.section.surcharge import Surcharge
from workflow.config import Config
from workflow.figures.canvas import (
    DPI,
    INK,
    LEFT,
    LEGEND_CHARACTERS,
    LEGEND_ROWS,
    RIGHT,
    WATER,
    WIDTH,
    Sheet,
    Window,
    legend_columns,
)
from workflow.figures.colours import soil_colours
from workflow.figures.marks import LOWERED, TABLE, Towards, draw_water, mark_force

HATCH = "...."
SURVEYED = (0, (1, 3))  # dashes of the ends of the ground that was given
LEAST_NUMBERED = 0.02  # of the height of a section: a thinner part of a soil has no number if another part has it
CRACK_ENDS = (0, (6, 2, 1, 2))  # dashes of the bottom of tension cracks
WALL = "#7a1fa2"  # colour of cut-off walls
NUMBER_SIZE = 6.5  # points
NAME_ABOVE = 15.0  # of the name of a boring over the ground (points): clear of the numbers of thin layers there
HALO = [withStroke(linewidth=2.5, foreground="white")]
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)  # of a part of a stratum, where its number may stand
LABEL_SPACING = 0.015  # of the width: from number to number above the ground
FOOT_CHARACTERS = 190
LEAST_LINE = 0.01  # of the width: a shorter line is drawn as a dot
ARROW = 0.03  # of the width: the largest surcharge
Boring = tuple[str, float, float]  # name, x (m) and depth (m)


def foot(section: Section) -> str:
    """Return the note at the foot of every picture of a section, which states that the section is a reconstruction, if
    it is one."""
    text = f"Reconstruction. {section.reconstruction_note}" if section.reconstruction else ""
    return textwrap.fill(text, FOOT_CHARACTERS)


class Overlay(NamedTuple):
    """Holds a line drawn over a section: its points (n, 2) in m, colour, dash pattern, and label."""

    points: np.ndarray
    colour: str
    dashes: tuple[int, tuple[int, ...]]
    label: str

    def marker(self, width: float) -> str:
        """Return the marker of the points in a section of a ``width`` (m): a line that is too short to be seen, such as
        the slip surface of a few cells, is a dot."""
        return "o" if len(self.points) and np.ptp(self.points, axis=0).max() < LEAST_LINE * width else ""


def mark_borings(axes: Axes, section: Section, borings: Iterable[Boring]) -> None:
    """Draw borings, each with its name, x (m) and depth (m), from the ground down."""
    for name, x, depth in borings:
        top = float(np.interp(x, *section.ground.T))
        axes.plot([x, x], [top - depth, top], color=INK, linewidth=1.6)
        axes.annotate(
            name, (x, top), (0, NAME_ABOVE), textcoords="offset points", fontsize=NUMBER_SIZE, ha="center", color=INK,
            path_effects=HALO, parse_math=False,
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 1.6, "shrinkA": 0.0, "shrinkB": 0.0},
        )  # fmt: skip


def sheet_with_borings(config: Config) -> Sheet:
    """Draw the section with the borings of its table [triggering].

    Parameters
    ----------
    config : section and borings

    Returns
    -------
    The picture; borings reach down to their deepest test.
    """
    borings = [(boring.name, boring.x, max(boring.depths)) for boring in config.triggering.borings]
    return section_sheet(config.section, borings=borings)


def section_sheet(
    section: Section,
    title: str = "layers",
    lines: Sequence[Overlay] = (),
    borings: Sequence[Boring] = (),
    force: Towards | None = None,
) -> Sheet:
    """Draw the layers in colour, liquefying ones dotted, the water table, borings, and lines over them, in true
    proportions.

    ``section``: the section; ``title``: title above the picture; ``borings``: each with its name, x (m) and depth (m);
    ``force``: side towards which the seismic force acts.
    """
    outline = section.outline()
    points_per_metre = (RIGHT - LEFT) * WIDTH / DPI * 72.0 / np.ptp(outline[:, 0])
    names = (NAME_ABOVE if borings else 0.0) + 2.0 * NUMBER_SIZE  # above the ground (points)
    room = np.array([0.0, names / points_per_metre])
    window = Window.around(np.vstack([outline, outline.max(axis=0) + room, room_for_loads(section)]))
    handles = _legend_of(section)
    width = float(np.ptp(outline[:, 0]))
    handles += [
        Line2D(
            [], [], color=line.colour, linewidth=2.0, linestyle=line.dashes, marker=line.marker(width), label=line.label
        )
        for line in lines
    ]
    sheet = _sheet(section, f"{section.heading}: {title}", window, handles)
    line_width = float(np.clip(30.0 / len(section.strata), 0.05, 0.6))  # many lines would hide the colours
    for view, exaggeration in enumerate(window.exaggerations()):
        axes = sheet.frame(view, window, heights_in_words(exaggeration), exaggeration)
        for k, (stratum, colour) in enumerate(zip(section.strata, _colours(section), strict=True)):
            hatch = HATCH if stratum.liquefiable else None
            for polygon in section.layering.polygons(k):
                closed = Outline(np.vstack([polygon, polygon[:1]]))
                axes.add_patch(PathPatch(closed, facecolor=colour, hatch=hatch, edgecolor=INK, linewidth=0.0))
        axes.add_collection(LineCollection(borders(section), colors=INK, linewidths=line_width))
        _number_strata(axes, section, _lines_over(section, lines, borings))
        draw_loads(axes, section)
        if section.given_extent != section.extent:
            for x in section.given_extent:  # what lies beyond was not surveyed
                axes.axvline(x, color=INK, linewidth=0.8, linestyle=SURVEYED)
        draw_water(axes, section)
        _draw_walls(axes, section)
        axes.add_collection(LineCollection(crack_bottoms(section), colors=INK, linewidths=1.2, linestyle=CRACK_ENDS))
        for line in lines:
            style: dict[str, Any] = {
                "color": line.colour,
                "linewidth": 2.0,
                "linestyle": line.dashes,
                "marker": line.marker(width),
            }
            axes.plot(*line.points.T, **style)
        mark_borings(axes, section, borings)
    mark_force(sheet.views[0], force)
    return sheet


def mesh_sheet(section: Section, mesh: QuadMesh) -> Sheet:
    """Draw the quadrilaterals, coloured by stratum, with their quality.

    Parameters
    ----------
    section : the ground
    mesh : mesh of the section

    Returns
    -------
    The picture; a flat section has a second view with exaggerated heights.
    """
    from workflow.figures.raster import fill_cells, painted

    window = Window.around(mesh.points)
    colours = soil_colours(mesh.strata)
    quality = mesh.quality()
    title = f"{section.heading}: mesh of {quality.quadrilaterals} quadrilaterals, {quality.nodes} nodes ({mesh.method})"
    subtitle = (
        f"smallest scaled Jacobian {quality.smallest_scaled_jacobian:.3f}, angles from {quality.smallest_angle:.0f}° "
        f"to {quality.largest_angle:.0f}°, largest aspect ratio {quality.largest_aspect_ratio:.2f}"
    )
    line_width = float(np.clip(60.0 / np.sqrt(quality.quadrilaterals), 0.4, 2.0))
    # Where cells are but a few pixels, full lines would hide the colours.
    pixels = WIDTH * float(np.sqrt(mesh.stratum_areas().sum() / len(mesh.cells))) / (window.right - window.left)
    opacity = float(np.clip(pixels / 8.0, 0.15, 1.0))

    edges = {"edgecolors": to_rgba(INK, opacity), "linewidths": 0.5 * line_width * 72.0 / DPI}

    def paint(axes: Axes) -> None:
        fill_cells(axes, mesh.points, mesh.cells, colours, mesh.stratum, **edges)

    sheet = _sheet(section, title, window, _legend_of(section, water=False))
    for view, exaggeration in enumerate(window.exaggerations()):
        text = f"{heights_in_words(exaggeration)}; {subtitle}" if view == 0 else heights_in_words(exaggeration)
        sheet.show(view, painted(window, paint, exaggeration), window, text, exaggeration)
    return sheet


def _sheet(section: Section, title: str, window: Window, handles: list[Artist]) -> Sheet:
    """Return a sheet with a view for every exaggeration of the window, its legend and the note on a reconstruction."""
    columns = legend_columns(handles)
    heights = [exaggeration * window.proportion for exaggeration in window.exaggerations()]
    sheet = Sheet(title, heights, foot(section), -(-len(handles) // columns))
    sheet.legend(handles, columns)
    return sheet


def _colours(section: Section) -> list[str]:
    return soil_colours([stratum.name for stratum in section.strata])


def borders(section: Section) -> list[np.ndarray]:
    """Return the edges (2, 2) of the strata (m), without the vertical edges between two parts of one soil."""
    layers = section.layering
    numbers = np.array([*soil_numbers([stratum.name for stratum in section.strata]), -1])
    outlines = [polygon for k in range(layers.strata) for polygon in layers.polygons(k)]
    edges = np.concatenate([np.stack([outline, np.roll(outline, -1, axis=0)], axis=1) for outline in outlines])
    middle = edges.mean(axis=1)
    outside = [
        numbers[layers.stratum_at(middle[:, 0] + side, middle[:, 1])] for side in (-layers.tolerance, layers.tolerance)
    ]
    seam = (edges[:, 0, 0] == edges[:, 1, 0]) & (outside[0] == outside[1])
    return list(edges[~seam])


def crack_bottoms(section: Section) -> list[np.ndarray]:
    """Return the bottom of the tension cracks, a line (2, 2) in m in every column of layers that has cracks."""
    layers = section.layering
    cracked = np.array([CRACKED in stratum.name for stratum in section.strata])
    there = cracked & layers.present()
    lowest = len(cracked) - 1 - np.argmax(there[:, ::-1], axis=1)
    columns = np.flatnonzero(there.any(axis=1))
    x, below = layers.x[columns], lowest[columns] + 1
    left, right = layers.left[columns, below], layers.right[columns, below]
    ends = np.stack([np.column_stack([x, left]), np.column_stack([x + layers.width[columns], right])], axis=1)
    return list(ends)


def room_for_loads(section: Section) -> np.ndarray:
    """Return points (n, 2) in m above the ground, for which a picture with arrows of surcharges needs space; empty
    without surcharges.
    """
    above = ARROW * float(np.ptp(section.ground[:, 0])) * np.array([0.0, 1.0])
    return section.ground + above if section.surcharges else np.zeros((0, 2))


def pressure_of(load: Surcharge) -> str:
    """Return the pressure of a surcharge at its ends, in kPa, in words."""
    return " to ".join(dict.fromkeys(f"{end / 1e3:.4g}" for end in load.pressure)) + " kPa"


def draw_loads(axes: Axes, section: Section) -> None:
    """Draw surcharges as arrows on the ground; the length of an arrow is proportional to the pressure."""
    largest = max((max(load.pressure) for load in section.surcharges), default=0.0)
    for load in section.surcharges:
        x = np.linspace(load.start, load.end, 8)
        ground = np.interp(x, *section.ground.T)
        long = ARROW * float(np.ptp(section.ground[:, 0])) * load.at(x, np.full(8, 0.5 * (load.start + load.end)))
        axes.quiver(
            x, ground + long / largest, np.zeros(8), -long / largest, angles="xy", scale_units="xy", scale=1.0,
            color=INK, width=0.0012,
        )  # fmt: skip


def _draw_walls(axes: Axes, section: Section) -> None:
    """Draw the cut-off walls, from the ground down."""
    for wall in section.water.cutoffs if section.water is not None else ():
        axes.plot([wall.x, wall.x], [np.interp(wall.x, *section.ground.T), wall.bottom], color=WALL, linewidth=2.5)


def _lines_over(section: Section, lines: Sequence[Overlay], borings: Sequence[Boring]) -> list[np.ndarray]:
    """Return the lines (k, 2) in m that are drawn over the layers: slip surfaces, surfaces and borings."""
    tops = [float(np.interp(x, *section.ground.T)) for _, x, _ in borings]
    drilled = [np.array([[x, top - depth], [x, top]]) for (_, x, depth), top in zip(borings, tops, strict=True)]
    return [*(np.asarray(line.points, float).reshape(-1, 2) for line in lines), *drilled]


def _clearance(to_pixels: Transform, place: tuple[float, float], lines: Sequence[np.ndarray]) -> float:
    """Return the distance (points) of a place to the nearest of some lines, all in m; ``to_pixels``: transform of the
    axes."""
    least, at = np.inf, to_pixels.transform(place)
    for line in lines:
        seen = (to_pixels.transform(line) - at) * 72.0 / DPI
        begin, along = seen[:-1], np.diff(seen, axis=0)
        share = -(begin * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12)
        nearest = begin + np.clip(share, 0.0, 1.0)[:, None] * along
        least = min(least, float(np.hypot(*nearest.T).min(initial=np.inf)))
    return least


def _number_strata(axes: Axes, section: Section, lines: Sequence[np.ndarray] = ()) -> None:
    """Write the number of every stratum where it is thickest, so that layers can be distinguished without colours, too.
    A number in a stratum stands clear of the ``lines`` over it if there is such a place in this part of the stratum.

    A number that is higher than its stratum would cover the lines of the stratum. The number of a stratum that is too
    thin is written above the ground instead, at the end of a line from the stratum.
    """
    layers, to_pixels = section.layering, axes.transData.get_affine()  # the axes compose it anew at each call
    at_left, at_right = layers.thickness()
    numbers = soil_numbers([stratum.name for stratum in section.strata])
    points_per_metre = np.ptp(axes.transData.transform([(0.0, 0.0), (0.0, 1.0)])[:, 1]) * 72.0 / DPI
    width, thin = float(layers.width.sum()), 0
    thickness = 0.5 * (at_left + at_right)
    places = np.argmax(thickness * np.minimum(layers.width, 0.1 * width)[:, None], axis=0)
    thickest = thickness[places, np.arange(len(places))]
    thick = thickest >= LEAST_NUMBERED * np.ptp(section.outline()[:, 1])
    elsewhere = {numbers[k] for k in np.flatnonzero(thick)}
    style: dict[str, Any] = {"fontsize": NUMBER_SIZE, "color": INK, "ha": "center",
                             "path_effects": [withStroke(linewidth=2.0, foreground="white")]}  # fmt: skip
    for k in range(len(section.strata)):
        best = int(places[k])
        if not thick[k] and (numbers[k] in elsewhere or thickest[k] <= 0.0):
            continue
        elsewhere.add(numbers[k])
        fits = thickest[k] * points_per_metre > 1.3 * NUMBER_SIZE
        offset = (
            0.0 if fits else (1 + thin) * LABEL_SPACING * width / layers.width[best]
        )  # clear of the numbers that fit

        def middle(share: float, column: int = best, stratum: int = k) -> tuple[float, float]:
            levels = (1.0 - share) * layers.left[column] + share * layers.right[column]
            return layers.x[column] + share * layers.width[column], float(0.5 * levels[stratum : stratum + 2].sum())

        x, z = middle(min(0.5 + offset, 0.95))
        if fits:
            x, z = next((at for at in map(middle, SHARES) if _clearance(to_pixels, at, lines) > NUMBER_SIZE), (x, z))
            axes.text(x, z, str(numbers[k] + 1), va="center", **style)
            continue
        ground = float(np.interp(x, *section.ground.T))
        axes.annotate(
            str(numbers[k] + 1), (x, z), (0.0, (ground - z) * points_per_metre + 4.0),
            textcoords="offset points", va="bottom",
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.5, "shrinkA": 0.0, "shrinkB": 0.0}, **style,
        )  # fmt: skip
        axes.plot(x, z, marker=".", markersize=2.5, color=INK)
        thin += 1


def heights_in_words(much: int) -> str:
    """Return how many times the heights of a view are exaggerated."""
    return "true proportions" if much == 1 else f"heights exaggerated {much} times"


def _legend_of(section: Section, water: bool = True) -> list[Artist]:
    """Return the legend entries for the strata for which there is room, and for water unless the picture is one of a
    mesh."""
    handles: list[Artist] = []
    numbers, colours = soil_numbers([stratum.name for stratum in section.strata]), _colours(section)
    for k in sorted({numbers.index(number) for number in numbers}):  # the first part of every soil
        stratum, number = section.strata[k], numbers[k] + 1
        label = soil_of(stratum.name) + (f": {stratum.description}" if stratum.description else "")
        if water and not stratum.name.startswith(str(number)):  # the number that stands in the picture
            label = f"{number}: {label}"
        if stratum.liquefiable:
            label += " (liquefiable)"
        label = textwrap.shorten(label, LEGEND_CHARACTERS - 10, placeholder=" ...")
        label = " " + label if label.startswith("_") else label  # matplotlib hides labels that begin with _
        hatch = HATCH if stratum.liquefiable and water else None
        handles.append(Patch(facecolor=colours[k], edgecolor=INK, linewidth=0.6, hatch=hatch, label=label))
    room = LEGEND_ROWS * legend_columns(handles)
    if len(handles) > room:
        remainder = f"and {len(handles) - room + 1} more, down to {soil_of(section.strata[-1].name)}"
        handles = [*handles[: room - 1], Patch(facecolor="none", label=remainder)]
    if water and section.water_points() is not None:
        lowered = section.water_points_after_drawdown() is not None
        label = "water table before the drawdown" if lowered else "water table"
        handles.append(Line2D([], [], color=WATER, linewidth=1.4, linestyle=TABLE, label=label))
        if lowered:
            label = "water table after the drawdown"
            handles.append(Line2D([], [], color=WATER, linewidth=1.4, linestyle=LOWERED, label=label))
    if water and section.water is not None and section.water.cutoffs:
        handles.append(Line2D([], [], color=WALL, linewidth=2.5, label="cut-off wall"))
    if water and any(CRACKED in stratum.name for stratum in section.strata):
        label = "bottom of the tension cracks"
        handles.append(Line2D([], [], color=INK, linewidth=1.2, linestyle=CRACK_ENDS, label=label))
    if water and section.given_extent != section.extent:
        handles.append(Line2D([], [], color=INK, linewidth=0.8, linestyle=SURVEYED, label="ends of the given ground"))
    if water and section.surcharges:
        label = "surcharge " + ", ".join(dict.fromkeys(map(pressure_of, section.surcharges)))
        handles.append(Line2D([], [], color=INK, marker=r"$\downarrow$", linestyle="none", label=label))
    return handles
