"""Draws pictures of the finite element analysis: displacement and mobilised strength at each Kh, and the equilibrium
path under rising Kh."""

from typing import TYPE_CHECKING, NamedTuple, assert_never

import numpy as np
from matplotlib.axes import Axes

from fem.continuum.fields import FieldState
from fem.continuum.strength import flow_of
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from workflow.config import Config
from workflow.figures.canvas import CONTINUUM, CRITICAL, INK, Renderer, Sheet, Window, in_classes, spread
from workflow.figures.ground import Overlay, foot, section_sheet
from workflow.figures.marks import draw_water, mark_force
from workflow.figures.raster import draw_border, fill_cells, painted
from workflow.results.answer import FORCE
from workflow.results.continuum import FailureAnswer, FemAnswer
from workflow.results.fem_states import FemResults
from workflow.run.store import Store

if TYPE_CHECKING:
    import pyvista as pv

# Mobilised over available shear strength: pale where much is in reserve, red at failure.
MOBILISED = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.99, 1.0)
MOBILISED_COLOURS = ("#f4f1e6", "#e6e4c6", "#d9d49a", "#e9c46a", "#f0a04b", "#e2703a", "#b3202c")
SLIP = "#111111"
EDGES = "#8a8578"
MOST_CELLS_WITH_EDGES = 5000  # of more cells the edges would hide the colours
ARROWS = 36  # across the section
SAFETY = "figures/fem_safety.png"
DASHES = ((0, ()), (0, (5, 2)), (0, (2, 2)), (0, (1, 2)))


def draw_all(config: Config, results: FemResults, store: Store) -> None:
    """Draw all pictures of the finite elements, and remove older ones.

    The pictures are fem_kh_*.png for every requested state, fem_plateau.png, fem_curve.png, and fem_safety.png with the
    slip surfaces of factors of safety, if there are any.

    Parameters
    ----------
    config : section, and settings of the analysis
    results : mesh, states, critical Kh and equilibrium path
    store : folder of the run
    """
    drawn: dict[int, Views] = {}
    names = ["figures/fem_curve.png"]
    with Renderer() as renderer:
        for state in results.states:
            same = id(state.displacement)  # what is past equilibrium shows the plateau's state
            if same not in drawn:
                drawn[same] = views_of(results.mesh, state, renderer)
            names.append(picture_of(state))
            store.save(names[-1], state_sheet(config, results, state, drawn[same]))
    store.save(names[0], _curve_sheet(config, results.answer))
    if slips := _slip_surfaces(results.answer):
        names.append(SAFETY)
        store.save(SAFETY, section_sheet(config.section, "FEM, slip surface at the factor of safety", slips))
    store.remove(sorted(set(store.matching(["figures/fem_kh_*.png", "figures/fem_plateau.png", SAFETY])) - set(names)))


def draw_failure(config: Config, answer: FailureAnswer, store: Store) -> None:
    """Draw fem_safety.png, the slip surface of ground that fails without a seismic force; remove pictures of states.

    Parameters
    ----------
    config : section
    answer : factor of safety, with its slip surface if there is one
    store : folder of the run
    """
    label = f"slip surface, F_s = {answer.factor:.2f} at Kh = 0"
    slips = [Overlay(np.array(answer.slip_surface), CONTINUUM, (0, ()), label)] if answer.slip_surface else []
    store.save(SAFETY, section_sheet(config.section, "FEM, slip surface at the factor of safety", slips))
    store.remove(["figures/fem_kh_*.png", "figures/fem_plateau.png", "figures/fem_curve.png"])


def _slip_surfaces(answer: FemAnswer) -> list[Overlay]:
    """Return the slip surface of the ground with its strength divided by each factor of safety."""
    factors = [factor for factor in answer.safety_factors if factor.slip_surface]
    return [
        Overlay(
            np.array(result.slip_surface),
            CONTINUUM,
            DASHES[number % len(DASHES)],
            f"slip surface, F_s = {result.factor:.2f} at Kh = {result.kh:g}",
        )
        for number, result in enumerate(factors)
    ]


def picture_of(state: FieldState) -> str:
    """Return the name of the picture of a state."""
    is_end = not state.past_equilibrium and not state.label.startswith("Kh = ")
    return "figures/fem_plateau.png" if is_end else f"figures/fem_kh_{state.kh:.3f}.png"


def conditions(config: Config, element: str) -> str:
    """Return the conditions of a critical Kh, for the foot of its picture."""
    flow = _flow_in_words(config)
    kv = f", Kv = {config.fem.vertical:g}" if config.fem.vertical else ""
    direction = config.fem.direction
    direction_words = "downslope and upslope; the smaller Kh counts" if direction == "both" else FORCE[direction]
    return f"{config.fem.sides} sides, {flow}, {element} element, seismic force {direction_words}{kv}"


def _flow_in_words(config: Config) -> str:
    flow = flow_of(config.section.strata, config.fem.flow)
    match flow:
        case "associated":
            return "ψ = φ"
        case "davis":
            return f"Davis's estimate for ψ = {_dilations(config.section)}"
        case "non-associated":
            return f"the given ψ ({_dilations(config.section)})"
    assert_never(flow)


def _dilations(section: Section) -> str:
    angles = sorted({round(float(np.degrees(s.dilation)), 1) for s in section.strata})
    return "°, ".join(f"{angle:g}" for angle in angles) + "°"


class Views(NamedTuple):
    """Holds the rendered views of a state, the places of its arrows, and their scale."""

    outline: np.ndarray
    arrow_nodes: np.ndarray
    safety: np.ndarray
    stretch: float
    largest: float
    window: Window


def views_of(mesh: QuadMesh, state: FieldState, renderer: Renderer) -> Views:
    """Render the views of a state."""
    largest = float(np.hypot(*state.displacement.T).max())
    stretch = nice_number(0.06 * float(np.ptp(mesh.points[:, 0])) / largest) if largest > 0.0 else 1.0
    arrow_nodes = spread(mesh.points, Window.around(mesh.points), ARROWS)
    tips = mesh.points[arrow_nodes] + stretch * state.displacement[arrow_nodes]
    window = Window.around(np.vstack([mesh.points, tips]))

    def outline(axes: Axes) -> None:
        fill_cells(axes, mesh.points, mesh.cells, ["#efece4"], np.zeros(len(mesh.cells), dtype=np.int64))
        draw_border(axes, mesh.points, mesh.cells)

    def failure_zones(plotter: "pv.Plotter") -> None:
        import pyvista as pv

        points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
        grid = pv.UnstructuredGrid({pv.CellType.QUAD: mesh.cells.astype(np.int64)}, points)
        grid.cell_data["mobilised strength"] = np.digitize(state.mobilised, MOBILISED[1:-1])
        plotter.add_mesh(
            grid, cmap=list(MOBILISED_COLOURS), clim=(-0.5, len(MOBILISED_COLOURS) - 0.5), lighting=False,
            show_scalar_bar=False, show_edges=len(mesh.cells) < MOST_CELLS_WITH_EDGES, edge_color=EDGES, line_width=0.5,
        )  # fmt: skip

    return Views(painted(window, outline), arrow_nodes, renderer.image(window, failure_zones), stretch, largest, window)


def state_sheet(config: Config, results: FemResults, state: FieldState, views: Views) -> Sheet:
    """Draw a ``state`` of the finite elements in its ``views``; ``results``: results of the finite elements, with the
    slip surface; ``config``: inputs, with the section."""
    window, slip = views.window, results.slip_surface(state)
    label = state.label
    if results.answer.end_reason == "limit load":
        label = label.replace("plateau", "end of the path")
    title = f"{config.section.heading}: FEM, {label}"
    sheet = Sheet(title, [window.proportion, window.proportion], foot(config.section), legend_rows=3)
    shown = f"displacement since gravity, drawn {views.stretch:g} times as long; largest {views.largest:.3g} m"
    first = sheet.show(0, views.outline, window, shown)
    x, z = results.mesh.points[views.arrow_nodes].T
    u, v = views.stretch * state.displacement[views.arrow_nodes].T
    first.quiver(x, z, u, v, color=CONTINUUM, angles="xy", scale_units="xy", scale=1.0, width=0.0016, minlength=0.6)
    axes = sheet.show(
        1,
        views.safety,
        window,
        "mobilised strength τ / (c + σ'n tan φ) on the worst plane",
    )
    mark_force(first, results.answer.towards if state.kh else None)
    draw_water(first, config.section)
    wet = draw_water(axes, config.section)
    if len(slip):
        surface = Overlay(slip, SLIP, (0, (2, 2)), "slip surface")
        marker = surface.marker(window.right - window.left)
        axes.plot(*slip.T, color=SLIP, linewidth=1.2, linestyle=surface.dashes, marker=marker, markersize=4.0)
    scale = "mobilised / available shear strength (-); 1: failure"
    sheet.colour_bar(in_classes(MOBILISED, MOBILISED_COLOURS), scale, MOBILISED)
    note = f"{conditions(config, results.answer.element)}."
    if len(slip):
        note += " Dot: the ground fails first in a few cells." if marker else " Black, dashed: slip surface."
    if wet:
        note += " Blue, dashed: water table."
    if state.past_equilibrium:
        note += f"\nThere is no equilibrium at Kh = {state.kh:g}: shown is the last state of the path."
    sheet.note(note)
    return sheet


def nice_number(value: float) -> float:
    """Return the largest of 1, 2, 5 times a power of ten that is not above a value.

    Parameters
    ----------
    value : a positive number

    Returns
    -------
    The number in the unit of the value.
    """
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(k * power for k in (1.0, 2.0, 5.0) if k * power <= value * (1 + 1e-9)))


def _most(answer: FemAnswer) -> str:
    """Return the upper limit of the critical Kh if the limit differs from the critical Kh in the digits shown."""
    most = f"{answer.kc_upper:.3f}"
    return f", at most {most}" if most != f"{answer.kc:.3f}" else ""


def _curve_sheet(config: Config, answer: FemAnswer) -> Sheet:
    sheet = Sheet(f"{config.section.heading}: FEM, rising Kh", [0.42], foot(config.section), legend_rows=2)
    axes = sheet.plot(
        0,
        "mean horizontal displacement, weighted by seismic mass (cm)",
        "seismic coefficient Kh (-)",
        f"critical Kh = {answer.kc:.3f}{_most(answer)}: {answer.end_reason}; {conditions(config, answer.element)}",
    )
    moving = [step for step in answer.curve if not step.at_rest]
    resting = [step for step in answer.curve if step.balanced]
    path = axes.plot(
        [0.0, *(100 * s.displacement for s in moving)], [0.0, *(s.factor for s in moving)],
        color=CONTINUUM, marker="o", markersize=2.5, linewidth=1.2, label="path, every step converged",
    )  # fmt: skip
    at_rest = axes.plot(
        [100 * s.displacement for s in resting], [s.factor for s in resting], "s",
        color=INK, markersize=3.5, label="at rest, without overstress",
    )  # fmt: skip
    bracket = ""
    if not answer.by_limit_analysis:
        bracket = ", and its bracket"
        axes.axhspan(answer.kc_lower, answer.kc_upper, color=CRITICAL, alpha=0.15, linewidth=0)
    critical = axes.axhline(answer.kc, color=CRITICAL, linewidth=1.0, label=f"critical Kh{bracket}")
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    sheet.legend([*path, critical, *(at_rest if resting else [])], 3)
    return sheet
