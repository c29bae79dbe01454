"""Draws pictures of the strict bounds: the mechanism of the upper bound, the stress of the lower bound, and the
triangles."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.patches import Patch

from fem.continuum.load_ends import soil_of_strip
from fem.continuum.loads import Direction
from fem.limit.bound_checks import corner_rates, yield_slack
from fem.limit.bounds import KhBounds
from fem.limit.bracket import Mechanism, StressField
from meshes.section.cutting import soil_of, without_film
from meshes.section.section import Section
from meshes.triangles import TriMesh
from workflow.config import Config
from workflow.figures.canvas import DPI, INK, Sheet, Window, in_classes, legend_columns, spread
from workflow.figures.colours import soil_colours
from workflow.figures.fem import MOBILISED, MOBILISED_COLOURS
from workflow.figures.ground import borders, foot
from workflow.figures.marks import Towards, draw_water, mark_force, side_of
from workflow.figures.raster import BORDER, draw_border, fill_cells, painted
from workflow.results.answer import FORCE
from workflow.run.store import Store

# Dissipation per area over the largest: each class three times the one before.
DISSIPATION = (0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0)
DISSIPATION_COLOURS = ("#f7f5ee", "#e9e4cf", "#e6d5a0", "#eab464", "#e3863c", "#c94a2c", "#7d1128")
ARROWS = "#1f6fb2"
# The points of a mechanism with this share of its largest velocity are what fails. A failure is shown alone, with this
# share of its width on either side and of its height below it, if the picture is narrower than this share of the
# section, and at most so high over its width. What is narrower than LEAST_WIDTH of the section, such as a single node
# that slips, is drawn with the ground around it.
MOVING_VELOCITY, MARGIN, DEPTH, NARROW_WIDTH, LARGEST_HEIGHT, LEAST_WIDTH = 0.02, 0.5, 0.3, 0.6, 0.35, 0.03


def draw_all(config: Config, bounds: KhBounds, store: Store) -> None:
    """Draw bounds_mechanism.png and bounds_stress.png, as far as these bounds exist, and bounds_mesh.png.

    Parameters
    ----------
    config : section, and conditions of the bounds
    bounds : bounds with their mesh, mechanism and stress field
    store : folder of the run
    """
    window = Window.around(config.section.outline())
    if bounds.mechanism:
        store.save("figures/bounds_mechanism.png", _mechanism_sheet(config, bounds, bounds.mechanism, window))
    if bounds.stress:
        store.save("figures/bounds_stress.png", _stress_sheet(config, bounds, bounds.stress, window))
    store.save("figures/bounds_mesh.png", _mesh_sheet(config.section, bounds, window))


def conditions(config: Config, bounds: KhBounds, bound: Mechanism | StressField) -> str:
    """Return the conditions of a bound, for the foot of its picture."""
    kv = f", Kv = {config.fem.vertical:g}" if config.fem.vertical else ""
    return f"{config.fem.sides} sides, ψ = φ, seismic force {FORCE[_direction(bounds, bound)]}{kv}"


def _direction(bounds: KhBounds, bound: Mechanism | StressField) -> Direction:
    """Return the direction of the seismic force of a bound."""
    return next(side.direction for side in bounds.directions if bound in (side.mechanism, side.stress))


def _force(config: Config, bounds: KhBounds, bound: Mechanism | StressField) -> Towards:
    """Return the side towards which the seismic force of a bound acts."""
    return side_of(config.section, _direction(bounds, bound))


def _water_words(section: Section) -> str:
    """Return what the dashed lines of a picture are, for its note."""
    return "" if section.water_points() is None else "\nBlue, dashed: water table."


def yield_use(stress: StressField) -> np.ndarray:
    """Return the mobilised strength (m,) of every cell, at its worst corner: 1 on the yield surface."""
    slack = yield_slack(stress.problem, stress.stress)
    radius = np.hypot(0.5 * (stress.stress[..., 0] - stress.stress[..., 1]), stress.stress[..., 2])
    strength = radius + slack
    return np.max(np.divide(radius, strength, out=np.zeros_like(radius), where=strength > 0.0), axis=1)


def _mechanism_sheet(config: Config, bounds: KhBounds, mechanism: Mechanism, window: Window) -> Sheet:
    problem = mechanism.problem
    density = mechanism.dissipation / problem.mesh.areas
    density = density / max(float(density.max()), 1e-300)
    rates = corner_rates(problem, mechanism.velocity).mean(axis=1)
    shear = np.hypot(rates[:, 0] - rates[:, 1], rates[:, 2])
    mesh = problem.mesh_in_metres
    velocity = np.zeros_like(mesh.points)
    velocity[mesh.cells] = mechanism.velocity[:, :3]
    speed = np.hypot(*velocity.T)
    fastest = float(speed.max())
    window = failure_window(mesh.points[speed > MOVING_VELOCITY * fastest], window)
    stretch = 0.05 * (window.right - window.left) / fastest
    every = spread(mesh.points, window)
    every = every[window.holds(mesh.points[every])]
    window = window.with_room_for(mesh.points[every] + stretch * velocity[every])

    def outline(axes: Axes) -> None:
        fill_cells(axes, mesh.points, mesh.cells, ["#efece4"], np.zeros(len(mesh.cells), dtype=np.int64))
        draw_border(axes, mesh.points, mesh.cells)

    title = f"{config.section.heading}: upper bound, Kh = {mechanism.multiplier:.4f}"
    sheet = Sheet(title, [window.proportion] * 3, foot(config.section), legend_rows=3)
    title = "velocities of the mechanism; their magnitude is arbitrary"
    axes = sheet.show(0, painted(window, outline), window, title)
    _draw_borders(axes, config.section)
    arrows = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.0016, "minlength": 0.6}
    axes.quiver(*mesh.points[every].T, *stretch * velocity[every].T, color=ARROWS, **arrows)
    mark_force(axes, _force(config, bounds, mechanism))
    views = (
        (shear / max(float(shear.max()), 1e-300), "largest shear rate"),
        (
            density,
            "dissipation per area; with ψ = φ, ground without cohesion shears and dilates but dissipates nothing",
        ),
    )
    for view, (values, what) in enumerate(views, start=1):
        image = painted(window, _classes(mesh, values, DISSIPATION, DISSIPATION_COLOURS))
        _draw_borders(sheet.show(view, image, window, what), config.section)
    label = "shear rate and dissipation per area, over the largest value (-)"
    sheet.colour_bar(in_classes(DISSIPATION, DISSIPATION_COLOURS), label, DISSIPATION)
    sheet.note(f"{conditions(config, bounds, mechanism)}{_water_words(config.section)}")
    return sheet


def failure_window(moving: np.ndarray, section: Window) -> Window:
    """Return the window of the picture of a mechanism: the failure and its surroundings if they are narrow, since all
    of the section would leave a few pixels for them, otherwise the section.

    ``moving``: points (n, 2) that fail (m); ``section``: window of the section.
    """
    middle, reach = 0.5 * (moving.min(axis=0) + moving.max(axis=0)), 0.5 * LEAST_WIDTH * (section.right - section.left)
    corners = middle + reach * np.array([[-1.0, -LARGEST_HEIGHT], [1.0, LARGEST_HEIGHT]])
    near = Window.around(np.vstack([moving, corners]), MARGIN)
    bottom = near.bottom - DEPTH * (near.top - near.bottom)
    wider = 0.5 * max(0.0, (near.top - bottom) / LARGEST_HEIGHT - (near.right - near.left))
    left, right = max(section.left, near.left - wider), min(section.right, near.right + wider)
    if right - left > NARROW_WIDTH * (section.right - section.left):
        return section
    return Window(left, right, max(section.bottom, bottom), min(section.top, near.top))


def _stress_sheet(config: Config, bounds: KhBounds, stress: StressField, window: Window) -> Sheet:
    mesh = stress.problem.mesh_in_metres
    title = f"{config.section.heading}: lower bound, Kh = {stress.multiplier:.4f}"
    sheet = Sheet(title, [window.proportion], foot(config.section), legend_rows=3)
    image = painted(window, _classes(mesh, yield_use(stress), MOBILISED, MOBILISED_COLOURS))
    title = "mobilised strength, largest value of each triangle"
    axes = sheet.show(0, image, window, title)
    _draw_borders(axes, config.section)
    mark_force(axes, _force(config, bounds, stress))
    sheet.colour_bar(
        in_classes(MOBILISED, MOBILISED_COLOURS), "radius of Mohr's circle over the largest possible (-)", MOBILISED
    )
    sheet.note(f"{conditions(config, bounds, stress)}{_water_words(config.section)}")
    return sheet


def _mesh_sheet(section: Section, bounds: KhBounds, window: Window) -> Sheet:
    mesh, strata = bounds.mesh, (bounds.section or section).strata
    known = [stratum.name for stratum in section.strata]  # a strengthened face, or a film, has its stratum's colour
    whole = [without_film(layer.name) for layer in strata]
    names = [name if name in known else soil_of_strip(name) for name in whole]
    colours = [soil_colours(known)[known.index(name)] for name in names]
    soils = {soil_of(name): colour for name, colour in zip(names, colours, strict=True)}
    handles = [
        Patch(facecolor=colour, edgecolor=INK, linewidth=0.6, label=f" {soil}") for soil, colour in soils.items()
    ]
    columns = max(legend_columns(handles), 2)

    def paint(axes: Axes) -> None:
        edges = {"edgecolors": to_rgba(INK, 0.6), "linewidths": 0.25 * 72.0 / DPI}
        fill_cells(axes, mesh.points, mesh.cells, colours, mesh.stratum, **edges)

    title = f"{section.heading}: {len(mesh.cells)} triangles of the bounds"
    sheet = Sheet(title, [window.proportion], foot(section), legend_rows=-(-len(handles) // columns))
    sheet.legend(handles, columns)
    sheet.show(0, painted(window, paint), window, "small triangles where the bounds differ")
    return sheet


def _draw_borders(axes: Axes, section: Section) -> None:
    """Draw the borders of the strata as thin lines, so that a reader sees in which strata the ground fails, and the
    water."""
    axes.add_collection(LineCollection(borders(section), colors=INK, linewidths=0.5, alpha=0.7))
    draw_water(axes, section)


def _classes(
    mesh: TriMesh, values: np.ndarray, limits: Sequence[float], colours: Sequence[str]
) -> Callable[[Axes], None]:
    def paint(axes: Axes) -> None:
        fill_cells(axes, mesh.points, mesh.cells, colours, np.digitize(values, limits[1:-1]))
        draw_border(axes, mesh.points, mesh.cells, 0.5 * BORDER)

    return paint
