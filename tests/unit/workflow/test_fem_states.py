"""Tests of reading the states and the mesh of the finite elements from the folder of a run."""

from pathlib import Path

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.quad_mesh import save
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.sections import slope
from workflow.results.mesh_grids import StoredGrid
from workflow.results.stored_mesh import FEM_FILE, PATH_FILE, path_mesh
from workflow.run.record import Entry, Record
from workflow.run.store import Store


def test_a_run_without_a_mesh_of_the_path_has_the_fields_of_its_last_mesh(tmp_path: Path) -> None:
    """Before the path had a mesh of its own, it was followed on the last mesh."""
    section, store = Section.parse(slope()), Store(tmp_path)
    last, first = (generate(section, MeshSettings(size=size)) for size in (4.0, 6.0))
    with store.writing(FEM_FILE) as path:
        save(last, path)
    np.testing.assert_array_equal(path_mesh(section, store, last.method).cells, last.cells)
    with store.writing(PATH_FILE) as path:
        save(first, path)
    np.testing.assert_array_equal(path_mesh(section, store, last.method).cells, first.cells)
    record = Record(store)  # an older version computed the folder again, and left this file as it is
    record.put("fem", Entry({}, "done", files={FEM_FILE: 1, "fem/fields_0.vtu": 1}))
    np.testing.assert_array_equal(path_mesh(section, store, last.method).cells, last.cells)
    record.put("fem", Entry({}, "done", files={FEM_FILE: 1, PATH_FILE: 1}))
    np.testing.assert_array_equal(path_mesh(section, store, last.method).cells, first.cells)


def test_a_missing_file_of_fields_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"fields_0\.vtu(.|\n)*there is no such file"):
        StoredGrid(tmp_path / "fields_0.vtu")
