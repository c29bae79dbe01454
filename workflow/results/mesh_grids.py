"""Writes the quadrilaterals of a section with their fields to VTK files, and reads fields from such files.

The classes of VTK are used directly: pyvista would take three times as long to load.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import VTK_QUAD, vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section


class MeshGrid:
    """Holds the quadrilaterals of a mesh for VTK.

    Every cell has the number of its stratum; the names of the strata are field data.
    """

    def __init__(self, mesh: QuadMesh) -> None:
        self._grid = vtkUnstructuredGrid()
        points, cells = vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(np.column_stack([mesh.points, np.zeros(len(mesh.points))]), deep=True))
        corners = mesh.cells.astype(np.int64)
        starts = corners.shape[1] * np.arange(len(corners) + 1, dtype=np.int64)
        cells.SetData(numpy_to_vtk(starts, deep=True), numpy_to_vtk(corners.ravel(), deep=True))
        self._grid.SetPoints(points)
        self._grid.SetCells(VTK_QUAD, cells)
        self.add_to_cells("stratum", mesh.stratum.astype(np.int32))
        self._grid.GetCellData().SetActiveScalars("stratum")  # what viewers colour the cells by at first
        self.add_texts("strata", mesh.strata)

    def add_to_points(self, name: str, values: np.ndarray) -> None:
        """Add values (points, ...) as a named array."""
        self._grid.GetPointData().AddArray(_named(name, values))

    def add_to_cells(self, name: str, values: np.ndarray) -> None:
        """Add values (cells, ...) as a named array."""
        self._grid.GetCellData().AddArray(_named(name, values))

    def add_texts(self, name: str, texts: Sequence[str]) -> None:
        """Add texts as a named field array."""
        array = vtkStringArray()
        array.SetName(name)
        for text in texts:
            array.InsertNextValue(text)
        self._grid.GetFieldData().AddArray(array)

    def save(self, path: Path) -> None:
        """Write the grid as a file of VTK."""
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(self._grid)
        writer.SetDataModeToBinary()
        writer.Write()


def _named(name: str, values: np.ndarray) -> object:
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


class StoredGrid:
    """Holds the fields of a file that `MeshGrid.save` wrote."""

    def __init__(self, path: Path) -> None:
        if not path.is_file():  # VTK would only print a message
            raise InputError(str(path), ["there is no such file; run the stage that writes this file"])
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(path))
        reader.Update()
        self._grid = reader.GetOutput()

    def of_points(self, name: str) -> np.ndarray:
        """Return values (points, ...) by their name."""
        return np.array(vtk_to_numpy(self._grid.GetPointData().GetArray(name)))

    def of_cells(self, name: str) -> np.ndarray:
        """Return values (cells, ...) by their name."""
        return np.array(vtk_to_numpy(self._grid.GetCellData().GetArray(name)))

    def text(self, name: str) -> str:
        """Return the first text of a named field array."""
        return str(self._grid.GetFieldData().GetAbstractArray(name).GetValue(0))


def grid_of(section: Section, mesh: QuadMesh) -> MeshGrid:
    """Return the mesh for VTK files, with the heading of its section and the note on a reconstruction.

    Parameters
    ----------
    section : section of the mesh
    mesh : its mesh, with lengths in m

    Returns
    -------
    The grid, to which fields can be added.
    """
    grid = MeshGrid(mesh)
    grid.add_texts("section", [section.heading])
    if section.reconstruction:
        grid.add_texts("reconstruction", [section.reconstruction_note])
    return grid
