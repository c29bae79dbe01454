"""Draws single pictures of a run: one field at one Kh, as a file or in a window."""

import ctypes
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
import pyvista as pv
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from dem.ground import ground_of
from dem.model import DiscModel
from fem.continuum.fields import FieldState
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from workflow.figures import discs
from workflow.figures import fem as fem_figures
from workflow.figures.canvas import INK, Renderer, Sheet, Window
from workflow.figures.ground import foot, heights_in_words
from workflow.figures.raster import draw_border, painted, shade_cells
from workflow.results.discs import SETS, RecordedDiscs
from workflow.results.fem_states import FemResults
from workflow.results.results import Results
from workflow.run.stage import Job

State = TypeVar("State", FieldState, RecordedDiscs)

SAME_KH = 5e-4  # Kh is given with three digits


@dataclass(frozen=True)
class Field:
    """Holds a field of a state: its name with the unit, its values by cell or by point, and its colours."""

    label: str
    values: Callable[[FieldState], np.ndarray]
    colours: str = "viridis"
    by_point: bool = False


def _stress(component: int) -> Callable[[FieldState], np.ndarray]:
    return lambda state: state.stress[:, component] / 1e3


FIELDS: Mapping[str, Field] = {
    "displacement": Field("displacement (m)", lambda state: np.hypot(*state.displacement.T), by_point=True),
    "displacement_x": Field("displacement to the right (m)", lambda state: state.displacement[:, 0], by_point=True),
    "displacement_z": Field("displacement upwards (m)", lambda state: state.displacement[:, 1], by_point=True),
    "mobilised": Field("mobilised strength (-)", lambda state: state.mobilised, "YlOrRd"),
    "shear_strain": Field("largest shear strain (-)", lambda state: state.shear_strain, "magma_r"),
    "plastic_shear_strain": Field("plastic shear strain (-)", lambda state: state.plastic_shear_strain, "magma_r"),
    "stress_xx": Field("stress xx (kPa), tension positive", _stress(0)),
    "stress_yy": Field("stress yy (kPa), tension positive", _stress(1)),
    "stress_zz": Field("stress zz (kPa), tension positive", _stress(2)),
    "stress_xy": Field("stress xy (kPa)", _stress(3)),
}


def draw(job: Job, field: str | None, at: float | None) -> list[Path]:
    """Draw one field of the states at one Kh.

    Parameters
    ----------
    job : section, settings and folder of the run
    field : name of a field of the finite elements or of the discs; None for the usual picture of the finite elements
    at : Kh (-) of the states, to 0.0005; None for all states

    Returns
    -------
    Paths of the pictures.

    Raises
    ------
    InputError : There is no such field, no state at that Kh, or no result of this input.
    """
    if field in discs.FIELDS:
        return _draw_discs(job, field, at)
    results = _results(job)
    chosen = _field(field) if field else None
    paths = []
    for state in _at(results.states, at, "fem.kh"):
        if field is None or chosen is None:
            name = fem_figures.picture_of(state)
            with Renderer() as renderer:
                views = fem_figures.views_of(results.mesh, state, renderer)
            sheet = fem_figures.state_sheet(job.config, results, state, views)
        elif state.past_equilibrium and at is None:
            continue  # it would show the last state once more
        else:
            name = f"figures/field_{field}_kh_{state.kh:.3f}.png"
            sheet = _sheet(job, results.mesh, state, chosen)
        paths.append(job.store.save(name, sheet))
    return paths


def _draw_discs(job: Job, field: str, at: float | None) -> list[Path]:
    """Draw a field of the discs, before calibration and after it; raises InputError if there are none of this input."""
    results = Results.of(job)
    if results.dem is None:
        reason = results.missing.get("calibrate", "the stage calibrate ended without an answer")
        raise InputError(str(job.store.folder), [f"has no discs: {reason}"])
    states = _at(results.dem.states, at, "dem.kh")
    ground = ground_of(job.config.section, job.config.dem)
    paths = []
    for state in states:
        model = discs.in_section(DiscModel.load(job.store.folder / state.file), ground)
        name = f"figures/field_{field}_{state.set}_kh_{state.kh:.3f}.png"
        words = f"{field.replace('_', ' ')} of the discs {SETS[state.set]}, Kh = {state.kh:g}: {state.verdict}"
        sheet = discs.FIELDS[field](model, f"{job.config.section.heading}: {words}")
        paths.append(job.store.save(name, sheet))
    return paths


def window(job: Job, field: str, at: float | None) -> None:
    """Open a window with a field on the mesh of the finite elements.

    Parameters
    ----------
    job : section, settings and folder of the run
    field : name of a field of the finite elements
    at : Kh (-) of the state, to 0.0005; None for the last state in equilibrium

    Raises
    ------
    InputError : There is no screen, no such field, no state at that Kh, or no result of this input.
    """
    results, chosen = _results(job), _field(field)
    states = _at(results.states, at, "fem.kh")
    missing = no_screen()
    if missing:
        raise InputError(
            "screen",
            [
                f"no window can be opened ({missing}); look at the pictures in "
                f"{job.store.folder / 'figures'}, draw one with noshiro plot {job.store.folder} --field {field}, or "
                f"open {job.store.folder / 'fem/fields.pvd'} in ParaView"
            ],
        )
    state = [state for state in states if not state.past_equilibrium or at is not None][-1]
    title = f"{job.config.section.heading}: {chosen.label}, {state.label}"
    plotter = pv.Plotter(title=title)
    plotter.set_background("white")
    grid = _grid(results.mesh, state, chosen)
    bar = {"title": chosen.label, "color": INK}
    plotter.add_mesh(grid, scalars="shown", cmap=chosen.colours, lighting=False, scalar_bar_args=bar)
    plotter.add_mesh(grid.extract_feature_edges(manifold_edges=False), color=INK)
    plotter.view_xy()
    plotter.show()


def no_screen() -> str:
    """Return the reason why no window can be opened; empty if one can. VTK needs an X server, and only warns if there
    is none."""
    if sys.platform != "linux":
        return ""
    display = os.environ.get("DISPLAY")
    if not display:
        return "DISPLAY is not set"
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return "libX11 is not installed"
    x11.XOpenDisplay.restype = ctypes.c_void_p
    opened = x11.XOpenDisplay(None)
    if opened is None:
        return f"nothing answers at DISPLAY={display}"
    x11.XCloseDisplay(ctypes.c_void_p(opened))
    return ""


def _results(job: Job) -> FemResults:
    """Return the FEM results of the folder; raise InputError if there are none of this input."""
    results = Results.of(job)
    if results.fem is None:
        reason = results.missing.get("fem", "the stage fem ended without an answer")
        raise InputError(str(job.store.folder), [f"holds no FEM results: {reason}"])
    return FemResults.load(job.config.section, job.store)


def _field(name: str) -> Field:
    if name not in FIELDS:
        raise InputError("--field", [f"{name!r}: expected one of {', '.join((*FIELDS, *discs.FIELDS))}"])
    return FIELDS[name]


def _at(states: Sequence[State], at: float | None, setting: str) -> list[State]:
    """Return the states at one Kh, or all of them; raise InputError, with the ``setting`` of the stored Kh, if no state
    is stored at this Kh."""
    wanted = [state for state in states if at is None or abs(state.kh - at) < SAME_KH]
    if not wanted and at is not None:
        stored_kh = ", ".join(dict.fromkeys(f"{state.kh:.3f}" for state in states)) or "none"
        raise InputError(
            "--at", [f"{at:g}: no state is stored at this Kh; expected one of {stored_kh}, or set {setting}"]
        )
    return wanted


def _grid(mesh: QuadMesh, state: FieldState, field: Field) -> pv.UnstructuredGrid:
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    grid = pv.UnstructuredGrid({pv.CellType.QUAD: mesh.cells.astype(np.int64)}, points)
    data = grid.point_data if field.by_point else grid.cell_data
    data["shown"] = np.asarray(field.values(state), dtype=float)
    return grid


def _sheet(job: Job, mesh: QuadMesh, state: FieldState, field: Field) -> Sheet:
    """Return the section in the colours of a field, in true proportions, with its scale."""
    view = Window.around(mesh.points)
    values = np.asarray(field.values(state), dtype=float)
    low, high = float(values.min()), float(values.max())
    high = high if high > low else low + 1.0

    points, cells = mesh.points, mesh.cells
    if not field.by_point:  # each cell has corners of its own
        values, points, cells = np.repeat(values, 4), points[cells].reshape(-1, 2), np.arange(cells.size).reshape(-1, 4)

    def paint(axes: Axes) -> None:
        shade_cells(axes, points, cells, values, field.colours, (low, high))
        draw_border(axes, mesh.points, mesh.cells)

    title = f"{job.config.section.heading}: {field.label}"
    sheet = Sheet(
        title,
        [exaggeration * view.proportion for exaggeration in view.exaggerations()],
        foot(job.config.section),
        legend_rows=3,
    )
    for number, exaggeration in enumerate(view.exaggerations()):
        title = f"FEM, {state.label}; {heights_in_words(exaggeration)}"
        sheet.show(number, painted(view, paint, exaggeration), view, title, exaggeration)
    sheet.colour_bar(ScalarMappable(Normalize(low, high), field.colours), field.label)
    return sheet
