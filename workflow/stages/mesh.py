"""The stage `mesh`: the quadrilaterals of a section, their files and their pictures."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyvista as pv

from meshes.errors import InputError
from meshes.gmsh_model import generate
from meshes.quad_mesh import QuadMesh, check, read
from workflow.figures import ground as figures
from workflow.run.progress import Progress, silent
from workflow.run.store import Store
from workflow.settings import Input

GMSH_FILE, VTK_FILE = "mesh/section.msh", "mesh/section.vtu"


def mesh_stage(run: Input, store: Store, progress: Progress = silent, given: Path | None = None) -> None:
    """Mesh the section, or take a mesh that is given; leaves mesh/section.msh, mesh/section.vtu and two pictures.

    Raises InputError if the settings do not fit, BadMeshError if there is no usable mesh.
    """
    progress("meshing", None)
    with store.writing(GMSH_FILE) as path:
        if given is None:
            mesh = generate(run, run.mesh, path)
        else:
            mesh = given_mesh(run, given)
            shutil.copyfile(given, path)
    grid = figures.grid_of(run, mesh)
    figures.add_texts(grid, "method", [mesh.method])
    store.write_grid(VTK_FILE, grid)
    quality = mesh.quality()
    progress(f"{quality.quadrilaterals} quadrilaterals, smallest scaled Jacobian "
             f"{quality.smallest_scaled_jacobian:.3f}; pictures", 0.5)  # fmt: skip
    mesh_figures(run, mesh, store)


def given_mesh(run: Input, path: Path) -> QuadMesh:
    """A mesh made elsewhere, its strata in the order of the section; raises InputError if its groups do not fit."""
    mesh = read(path)
    names = [stratum.name for stratum in run.strata]
    problems = [f'there is no surface group "{name}"' for name in names if name not in mesh.strata]
    problems += [f'the surface group "{name}" is no stratum of {run.name}' for name in mesh.strata if name not in names]
    if problems:
        raise InputError(str(path), problems)
    place = np.array([names.index(name) for name in mesh.strata])
    given = replace(mesh, stratum=place[mesh.stratum], strata=tuple(names), method="given")
    check(given)
    return given


def stored_mesh(run: Input, store: Store) -> QuadMesh:
    """The mesh that the stage left; raises InputError if it is not there or not of this section."""
    mesh = given_mesh(run, store.folder / GMSH_FILE)
    method = pv.read(store.folder / VTK_FILE).field_data["method"][0]
    return replace(mesh, method=str(method))


def draw_section(run: Input, store: Store) -> None:
    """Draw the section as it was read: figures/section.png."""
    with store.writing("figures/section.png") as path:
        figures.draw_section(run, path)


def mesh_figures(run: Input, mesh: QuadMesh, store: Store) -> None:
    """Draw the section and its mesh."""
    draw_section(run, store)
    with store.writing("figures/mesh.png") as path:
        figures.draw_mesh(run, mesh, path)
