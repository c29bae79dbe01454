"""Returns the mesh of a run: the mesh that the stage `mesh` wrote, or a mesh from a file."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh, check, read
from meshes.section.naming import group_names
from meshes.section.section import Section
from workflow.run.record import Record
from workflow.run.store import Store

# The mesh that the finite elements ended with: adapted to the mechanism, or the one that they were given.
FEM_FILE = "fem/section.msh"
# The mesh of the equilibrium path and its fields: the same, or an earlier one of the sequence that ended with it.
PATH_FILE = "fem/path.msh"
GMSH_FILE, VTK_FILE = "mesh/section.msh", "mesh/section.vtu"


def given_mesh(section: Section, path: Path) -> QuadMesh:
    """Read the mesh of a section from a gmsh file.

    Parameters
    ----------
    section : the ground
    path : gmsh file with a surface group for each stratum, named as ``group_names`` does

    Returns
    -------
    The mesh, with the strata in the order of the section and the method "given".

    Raises
    ------
    InputError
        If the file cannot be read, or if its surface groups are not the strata of the section.
    BadMeshError
        If a cell is folded.
    """
    mesh = read(path)
    names = [stratum.name for stratum in section.strata]
    groups = group_names(names)
    problems = [f'there is no surface group "{group}"' for group in groups if group not in mesh.strata]
    problems += [
        f'the surface group "{group}" is no stratum of {section.name}' for group in mesh.strata if group not in groups
    ]
    if problems:
        raise InputError(str(path), problems)
    place = np.array([groups.index(group) for group in mesh.strata])
    ordered = replace(mesh, stratum=place[mesh.stratum], strata=tuple(names), method="given")
    check(ordered)
    return ordered


def stored_mesh(section: Section, store: Store) -> QuadMesh:
    """Return the mesh that the stage `mesh` wrote.

    Parameters
    ----------
    section : the ground
    store : the folder of the run

    Returns
    -------
    The mesh, with its method.

    Raises
    ------
    InputError
        If the mesh is missing or belongs to another section.
    """
    from workflow.results.mesh_grids import StoredGrid

    mesh = given_mesh(section, store.folder / GMSH_FILE)
    return replace(mesh, method=StoredGrid(store.folder / VTK_FILE).text("method"))


def fem_mesh(section: Section, store: Store, method: str) -> QuadMesh:
    """Return the mesh of the critical Kh of the stage `fem`.

    Parameters
    ----------
    section : the ground
    store : the folder of the run
    method : method of the mesh: "mapped", "free" or "given"

    Returns
    -------
    The mesh that was adapted to the mechanism, or the mesh that the stage started with.

    Raises
    ------
    InputError
        As ``stored_mesh`` does.
    """
    return replace(given_mesh(section, store.folder / FEM_FILE), method=method)


def path_mesh(section: Section, store: Store, method: str) -> QuadMesh:
    """Return the mesh of the fields of the stage `fem`; the parameters are those of ``fem_mesh``.

    Older versions of the program followed the path on the last mesh, and wrote that one alone. A mesh of the path that
    the stage did not write belongs to another version of the program.
    """
    entry = Record(store)["fem"]
    is_written = store.has(PATH_FILE) and (entry is None or not entry.files or PATH_FILE in entry.files)
    file = PATH_FILE if is_written else FEM_FILE
    return replace(given_mesh(section, store.folder / file), method=method)
