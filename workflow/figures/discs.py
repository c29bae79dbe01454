"""Draws pictures of the discs: layers, states, pore springs, velocities and force chains, in true proportions.

`in_section` converts a model to coordinates of the
section.
"""

import copy
from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

import numpy as np
import pyvista as pv
from matplotlib.artist import Artist
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from dem.engine.forces import contact_forces
from dem.ground import Ground
from dem.model import DiscModel
from meshes.section.cutting import soil_of
from meshes.section.section import Section
from workflow.figures.canvas import INK, Sheet, Window, render
from workflow.figures.colours import soil_colours
from workflow.figures.marks import draw_water, mark_force, side_of

BOUNDARY = "#4a4f55"
PALE = "#e3e6e8"
WHOLE = "#2c7a3f"
CRACKED = "#d0342c"
SPEEDS = "viridis"
DISPLACEMENT_COLOURS = "YlOrRd"
NO_LINE = np.zeros((0, 2))


class Circles(Protocol):
    """Holds the discs to be drawn: centres and radii (m)."""

    @property
    def x(self) -> np.ndarray: ...
    @property
    def z(self) -> np.ndarray: ...
    @property
    def radius(self) -> np.ndarray: ...


def window_of(model: Circles, line: np.ndarray = NO_LINE) -> Window:
    """Return a window of all discs with their radii, the points (n, 2) of a line, and a margin."""
    x, z, r = model.x, model.z, model.radius
    rims = [[(x - r).min(), (z - r).min()], [(x + r).max(), (z + r).max()]]
    return Window.around(np.concatenate([rims, line]), 0.015)


def in_section(model: DiscModel, ground: Ground) -> DiscModel:
    """Return the discs in the coordinates of the section, for drawing.

    Parameters
    ----------
    model : discs in the coordinates of their box, which may be tilted
    ground : transformation from the box to the section

    Returns
    -------
    A copy with places, velocities and rotations in the axes of the section; gravity and rigid lines are not
    transformed.
    """
    view = copy.copy(model)
    view.x, view.z = ground.to_section(model.x, model.z)
    view.vx, view.vz = ground.to_section_axes(model.vx, model.vz)
    view.roll = model.roll - ground.tilt * model.radius
    return view


def discs(model: Circles, which: np.ndarray, height: float = 0.0) -> pv.PolyData:
    """Draw some of the discs as filled circles."""
    if not which.any():
        return pv.PolyData()
    cloud = pv.PolyData(np.column_stack([model.x, model.z, np.full(len(model.x), height)])[which])
    cloud["radius"] = model.radius[which]
    cloud["disc"] = np.flatnonzero(which)
    return cloud.glyph(orient=False, scale="radius", geom=pv.Disc(inner=0.0, outer=1.0, c_res=30))


def draw_strata(plotter: pv.Plotter, model: Circles, stratum: np.ndarray, colours: Sequence[str]) -> None:
    """Draw the discs of a ``model`` into a ``plotter`` in the colours of their strata, and boundary discs (stratum -1)
    dark."""
    for k, colour in enumerate([BOUNDARY, *colours], start=-1):
        mesh = discs(model, stratum == k)
        if mesh.n_points:
            plotter.add_mesh(mesh, color=colour, lighting=False)


def bars(model: DiscModel, which: np.ndarray, width: np.ndarray) -> pv.PolyData:
    """Draw some of the pairs as bars between the centres, above the discs; width in m.

    model: model of the discs; which: numbers of the pairs.
    """
    i, j = model.pair_i[which], model.pair_j[which]
    if not len(i):
        return pv.PolyData()
    a, b = np.array([model.x[i], model.z[i]]).T, np.array([model.x[j], model.z[j]]).T
    along = (b - a) / np.hypot(*(b - a).T)[:, None]
    side = 0.5 * width[which][:, None] * np.column_stack([-along[:, 1], along[:, 0]])
    corners = np.stack([a - side, a + side, b + side, b - side], axis=1).reshape(-1, 2)
    points = np.column_stack([corners, np.full(len(corners), 0.1)])
    faces = np.column_stack([np.full(len(i), 4), np.arange(4 * len(i)).reshape(-1, 4)])
    return pv.PolyData(points, faces=faces.ravel())


def layers(model: DiscModel, title: str = "Discs by layer") -> Sheet:
    """Draw every disc in the colour of its layer, and boundary discs dark. A spoke shows the rotation of a disc.

    Parameters
    ----------
    model : the discs
    title : title above the picture

    Returns
    -------
    The picture.
    """
    window = window_of(model)
    colours = soil_colours([layer.name for layer in model.springs.layers])

    def draw(plotter: pv.Plotter) -> None:
        draw_strata(plotter, model, model.layer, colours)
        tip = model.radius * np.array([np.cos(model.angle), np.sin(model.angle)])
        free = ~model.fixed
        spokes = np.stack([model.x, model.z, model.x + tip[0], model.z + tip[1]], axis=1)[free].reshape(-1, 2)
        lines = np.column_stack([spokes, np.full(len(spokes), 0.1)])
        plotter.add_mesh(pv.line_segments_from_points(lines), color=INK, line_width=1, opacity=0.35, lighting=False)

    counts = np.bincount(model.layer + 1, minlength=len(model.springs.layers) + 1)
    soils: dict[tuple[str, str], int] = {}
    for colour, layer, count in zip(colours, model.springs.layers, counts[1:], strict=True):
        soils[colour, soil_of(layer.name)] = soils.get((colour, soil_of(layer.name)), 0) + int(count)
    handles: list[Artist] = [Patch(color=c, label=f"{soil} ({count})") for (c, soil), count in soils.items() if count]
    if counts[0]:
        handles.append(Patch(color=BOUNDARY, label=f"boundary ({counts[0]})"))
    return _sheet(title, window, draw, model, handles)


def pore_springs(model: DiscModel, title: str = "Pore springs") -> Sheet:
    """Draw intact pore springs (the second springs between discs in the paper's law) in green, cracked ones in red."""
    whole, cracked = model.pore_length > 0.0, model.pore_length < 0.0
    handles = [
        Line2D([], [], color=WHOLE, lw=3, label=f"intact ({whole.sum()})"),
        Line2D([], [], color=CRACKED, lw=3, label=f"cracked ({cracked.sum()})"),
    ]
    return _sheet(title, window_of(model), partial(draw_pore_springs, model=model), model, handles)


def draw_pore_springs(plotter: pv.Plotter, model: DiscModel) -> None:
    """Draw pore springs as bars over pale discs; springs between discs far apart are left out, since they would cross
    the picture.
    """
    plotter.add_mesh(discs(model, np.ones(len(model), bool)), color=PALE, lighting=False)
    near = model.distance() < 1.5 * np.abs(model.pore_length)
    width = np.full(len(model.pair_i), 0.35 * model.radius.mean())
    for which, colour in ((model.pore_length > 0.0, WHOLE), ((model.pore_length < 0.0) & near, CRACKED)):
        mesh = bars(model, which, width)
        if mesh.n_points:
            plotter.add_mesh(mesh, color=colour, lighting=False)


def state(model: DiscModel, before: DiscModel, title: str, section: Section) -> Sheet:
    """Draw the displacement of every disc under a seismic force downslope, as in Figs 12 and 13 of the paper.

    Discs with pore springs have a second view, with these springs.

    Parameters
    ----------
    model : the discs
    before : the discs from which the displacement is measured
    title : title above the picture
    section : the section, with its water

    Returns
    -------
    The picture.
    """
    window = window_of(model)
    far = np.hypot(model.x - before.x, model.z - before.z)
    norm = Normalize(0.0, round_up(float(np.percentile(far[~model.fixed], 99.5))))
    moved = partial(draw_values, model=model, values=far, norm=norm, dark=model.fixed)
    there, cracked = int((model.pore_length != 0.0).sum()), int((model.pore_length < 0.0).sum())
    foot = f"{_count(model)}; {cracked} of {there} pore springs cracked" if there else _count(model)
    sheet = Sheet(title, [window.proportion] * (2 if there else 1), foot, legend_rows=3)
    axes = sheet.show(0, render(window, moved), window, "displacement")
    mark_force(axes, side_of(section, "downhill"))
    wet = draw_water(axes, section)
    if there:  # soil discs have none
        springs = partial(draw_pore_springs, model=model)
        sheet.show(1, render(window, springs), window, "pore springs: green whole, red cracked")
    displacement_scale(sheet, norm)
    if wet:
        sheet.note("Blue, dashed: water table.")
    return sheet


def displacement_scale(sheet: Sheet, norm: Normalize) -> None:
    """Draw the colour bar of displacements, whose range is not stretched by a few discs that roll away."""
    sheet.colour_bar(
        ScalarMappable(norm, DISPLACEMENT_COLOURS),
        "displacement (m); larger displacements have the last colour of the scale",
    )


def round_up(value: float) -> float:
    """Return the next round number above a positive number: 1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten."""
    if not value > 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(step * power for step in (1, 1.5, 2, 3, 4, 5, 6, 8, 10) if step * power >= value * (1 - 1e-9)))


def draw_values(plotter: pv.Plotter, model: Circles, values: np.ndarray, norm: Normalize, dark: np.ndarray) -> None:
    """Draw discs coloured by a value; discs of a mask are dark.

    plotter: plotter that draws; model: model of the discs; values: one value for each disc; norm: norm of the colours;
    dark: mask of the dark discs.
    """
    mesh = discs(model, ~dark)
    mesh["value"] = values[mesh["disc"]]
    plotter.add_mesh(
        mesh,
        scalars="value",
        cmap=DISPLACEMENT_COLOURS,
        clim=(norm.vmin, norm.vmax),
        lighting=False,
        show_scalar_bar=False,
    )
    fixed = discs(model, dark)
    if fixed.n_points:
        plotter.add_mesh(fixed, color=BOUNDARY, lighting=False)


def velocities(model: DiscModel, title: str = "Velocity") -> Sheet:
    """Draw every disc in the colour of its speed, with arrows on some of them."""
    speed = np.hypot(model.vx, model.vz)
    fastest = float(speed.max()) or 1.0
    free = np.flatnonzero(~model.fixed)
    # an arrow for each place of a coarse grid, so that they do not hide each other
    coarse = 6.0 * model.radius.mean()
    cell = np.column_stack([model.x[free] // coarse, model.z[free] // coarse])
    shown = free[np.unique(cell, axis=0, return_index=True)[1]]

    def draw(plotter: pv.Plotter) -> None:
        mesh = discs(model, np.ones(len(model), bool))
        mesh["speed"] = speed[mesh["disc"]]
        plotter.add_mesh(mesh, scalars="speed", cmap=SPEEDS, clim=(0.0, fastest), lighting=False, show_scalar_bar=False)
        arrows = pv.PolyData(np.column_stack([model.x, model.z, np.full(len(model), 0.1)])[shown])
        arrows["v"] = np.column_stack([model.vx, model.vz, np.zeros(len(model))])[shown] * (1.2 * coarse / fastest)
        glyphs = arrows.glyph(orient="v", scale="v", geom=pv.Arrow(tip_radius=0.12, shaft_radius=0.04))
        plotter.add_mesh(glyphs, color="white", lighting=False)

    scale = ScalarMappable(Normalize(0.0, fastest), SPEEDS)
    return _sheet(title, window_of(model), draw, model, [], (scale, "speed (m/s)"))


def force_chains(model: DiscModel, title: str = "Force chains") -> Sheet:
    """Draw bars between touching discs, with widths proportional to the force; pore springs in tension in red."""
    normal = contact_forces(model).normal
    size = np.abs(normal)
    # the strongest few would leave the rest as hairs
    scale = float(np.percentile(size[size > 0.0], 99)) if np.any(size > 0.0) else 1.0
    width = 1.6 * model.radius.mean() * np.minimum(size / scale, 1.0)

    def draw(plotter: pv.Plotter) -> None:
        plotter.add_mesh(discs(model, np.ones(len(model), bool)), color=PALE, lighting=False)
        for which, colour in ((normal > 0.0, INK), (normal < 0.0, CRACKED)):
            mesh = bars(model, which & (size > 0.01 * scale), width)
            if mesh.n_points:
                plotter.add_mesh(mesh, color=colour, lighting=False)

    full = f"{scale / 1e3:,.0f} kN/m"
    handles = [Line2D([], [], color=INK, lw=6, label=f"compression; widest bars {full} and more")]
    if np.any(normal < -0.01 * scale):
        handles.append(Line2D([], [], color=CRACKED, lw=6, label="tension"))
    return _sheet(title, window_of(model), draw, model, handles)


# Fields of discs that can be drawn, by their names in the command: a function of model and title.
FIELDS = {"pore_springs": pore_springs, "velocity": velocities, "force_chains": force_chains}


def _count(model: DiscModel) -> str:
    return f"{int((~model.fixed).sum())} discs, {int(model.fixed.sum())} fixed"


def _sheet(
    title: str,
    window: Window,
    draw: Callable[[pv.Plotter], None],
    model: DiscModel,
    handles: Sequence[Artist],
    scale: tuple[ScalarMappable, str] | None = None,
) -> Sheet:
    """Return a picture of one view with a legend, or with a labelled colour bar."""
    columns = min(6, max(1, len(handles)))
    rows = -(-len(handles) // columns) if handles else 2
    sheet = Sheet(title, [window.proportion], f"{_count(model)}; t = {model.time:.4g} s", rows)
    sheet.show(0, render(window, draw), window)
    if handles:
        sheet.legend(handles, columns)
    if scale is not None:
        sheet.colour_bar(*scale)
    return sheet
