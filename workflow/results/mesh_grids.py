"""Converts the quadrilaterals of a section to VTK grids, with the name of the section."""

from collections.abc import Sequence

import numpy as np
import pyvista as pv
from vtkmodules.vtkCommonCore import vtkStringArray

from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


def unstructured(mesh: QuadMesh) -> pv.UnstructuredGrid:
    """Return the mesh for VTK, with the index of the stratum in every cell and the names as field data."""
    points = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    grid = pv.UnstructuredGrid({pv.CellType.QUAD: mesh.cells.astype(np.int64)}, points)
    grid.cell_data["stratum"] = mesh.stratum.astype(np.int32)
    add_texts(grid, "strata", mesh.strata)
    return grid


def grid_of(section: Section, mesh: QuadMesh) -> pv.UnstructuredGrid:
    """Return the mesh for VTK files, with the name of its section and whether the section is a reconstruction."""
    grid = unstructured(mesh)
    add_texts(grid, "section", [section.heading])
    if section.reconstruction:
        add_texts(grid, "reconstruction", [section.reconstruction_note])
    return grid


def add_texts(grid: pv.UnstructuredGrid, name: str, texts: Sequence[str]) -> None:
    """Add texts as a named field array; the function of pyvista takes ASCII only."""
    array = vtkStringArray()
    array.SetName(name)
    for text in texts:
        array.InsertNextValue(text)
    grid.GetFieldData().AddArray(array)
