"""Pictures of the ground and of its mesh."""

import textwrap
from pathlib import Path

import numpy as np
import pyvista as pv
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path as Outline

from meshes.quadrilaterals import QuadMesh
from meshes.section import Section
from workflow.canvas import INK, WATER, Sheet, Window, render, soil_colour

HATCH = "...."
FOOT_CHARACTERS = 190


def foot(section: Section) -> str:
    """The note at the foot of every picture of a section: that it is a reconstruction, if it is one."""
    text = f"Reconstruction. {section.reconstruction_note}" if section.reconstruction else ""
    return textwrap.fill(text, FOOT_CHARACTERS)


def surfaces(section: Section) -> list[tuple[int, pv.PolyData]]:
    """The strata as flat triangulated surfaces, with their index; a stratum may come in several pieces."""
    pieces = []
    for k in range(len(section.strata)):
        for polygon in section.layering.polygons(k):
            flat = pv.PolyData(
                np.column_stack([polygon, np.zeros(len(polygon))]),
                faces=[len(polygon), *range(len(polygon))],
            )
            pieces.append((k, flat.triangulate()))
    return pieces


def draw_section(section: Section, path: Path) -> None:
    """The layers in colour, the liquefiable ones dotted, the water table, true proportions."""
    window = Window.around(section.outline())

    def draw(plotter: pv.Plotter) -> None:
        for k, surface in surfaces(section):
            plotter.add_mesh(surface, color=soil_colour(k), lighting=False)

    columns = 3
    handles = _legend_of(section)
    rows = -(-len(handles) // columns)
    sheet = Sheet(f"{section.title or section.name}: layers", [window.proportion], foot(section), rows)
    axes = sheet.show(0, render(window, draw), window)
    for k, stratum in enumerate(section.strata):
        for polygon in section.layering.polygons(k):
            closed = np.vstack([polygon, polygon[:1]])
            hatch = HATCH if stratum.liquefiable else None
            axes.add_patch(PathPatch(Outline(closed), facecolor="none", edgecolor=INK, linewidth=0.6, hatch=hatch))
    water = section.water_points()
    if water is not None:
        axes.plot(*water.T, color=WATER, linewidth=1.4, linestyle=(0, (6, 3)))
    sheet.legend(handles, columns)
    sheet.save(path)


def draw_mesh(section: Section, mesh: QuadMesh, path: Path) -> None:
    """The quadrilaterals, coloured by stratum, with their quality."""
    window = Window.around(mesh.points)
    grid = unstructured(mesh)
    colours = [soil_colour(k) for k in range(len(mesh.strata))]
    columns = 3
    handles = _legend_of(section, water=False)
    rows = -(-len(handles) // columns)
    quality = mesh.quality()
    title = (
        f"{section.title or section.name}: mesh of {quality.quadrilaterals} quadrilaterals, {quality.nodes} nodes "
        f"({mesh.method})"
    )
    subtitle = (
        f"smallest scaled Jacobian {quality.smallest_scaled_jacobian:.3f}, worst corner {quality.worst_angle:.1f}°, "
        f"largest aspect ratio {quality.largest_aspect_ratio:.2f}"
    )
    sheet = Sheet(title, [window.proportion], foot(section), rows)
    line_width = float(np.clip(60.0 / np.sqrt(quality.quadrilaterals), 0.4, 2.0))

    def draw(plotter: pv.Plotter) -> None:
        plotter.add_mesh(
            grid, scalars="stratum", cmap=colours, clim=(-0.5, len(colours) - 0.5), lighting=False,
            show_edges=True, edge_color=INK, line_width=line_width, show_scalar_bar=False,
        )  # fmt: skip

    sheet.show(0, render(window, draw), window, subtitle)
    sheet.legend(handles, columns)
    sheet.save(path)


def unstructured(mesh: QuadMesh) -> pv.UnstructuredGrid:
    """The mesh for VTK, with the index of the stratum in every cell and the names as field data."""
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    grid = pv.UnstructuredGrid({pv.CellType.QUAD: mesh.cells.astype(np.int64)}, points)
    grid.cell_data["stratum"] = mesh.stratum.astype(np.int32)
    grid.field_data["strata"] = list(mesh.strata)
    return grid


def _legend_of(section: Section, water: bool = True) -> list[object]:
    handles: list[object] = []
    for k, stratum in enumerate(section.strata):
        label = stratum.name + (f": {stratum.description}" if stratum.description else "")
        if stratum.liquefiable:
            label += " (liquefiable)"
        hatch = HATCH if stratum.liquefiable and water else None
        handles.append(Patch(facecolor=soil_colour(k), edgecolor=INK, linewidth=0.6, hatch=hatch, label=label))
    if water and section.water_table is not None:
        handles.append(Line2D([], [], color=WATER, linewidth=1.4, linestyle=(0, (6, 3)), label="water table"))
    return handles
