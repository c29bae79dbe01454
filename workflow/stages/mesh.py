"""Defines the stage `mesh`: the quadrilaterals of a section, their files and their pictures."""

import shutil

from workflow.run.stage import Job, Stage

MESH_FILE = "the mesh given"  # name of a given mesh in messages


def work(job: Job) -> None:
    """Mesh the section, or read a given mesh; writes mesh/section.msh and mesh/section.vtu.

    Raises InputError if the settings do not fit, BadMeshError if there is no usable mesh.
    """
    from meshes.gmsh_model import generate
    from workflow.results.mesh_grids import grid_of
    from workflow.results.stored_mesh import GMSH_FILE, VTK_FILE, given_mesh

    job.progress("meshing", None)
    with job.store.writing(GMSH_FILE) as path:
        if job.mesh_file is None:
            mesh = generate(job.config.section, job.config.mesh, path)
        else:
            mesh = given_mesh(job.config.section, job.mesh_file)
            shutil.copyfile(job.mesh_file, path)
    grid = grid_of(job.config.section, mesh)
    grid.add_texts("method", [mesh.method])
    job.store.write_grid(VTK_FILE, grid)
    quality = mesh.quality()
    smallest = quality.smallest_scaled_jacobian
    job.progress(f"{quality.quadrilaterals} quadrilaterals, smallest scaled Jacobian {smallest:.3f}", None)


def draw(job: Job) -> None:
    """Draw the section, its weights and pore pressures, and its mesh."""
    from workflow.figures.ground import mesh_sheet, sheet_with_borings
    from workflow.figures.weights import weights_sheet
    from workflow.results.stored_mesh import stored_mesh

    section, store = job.config.section, job.store
    store.save("figures/section.png", sheet_with_borings(job.config))
    store.save("figures/weights.png", weights_sheet(section))
    store.save("figures/mesh.png", mesh_sheet(section, stored_mesh(section, store)))


STAGE = Stage(
    name="mesh",
    description="mesh of quadrilaterals",
    work=work,
    draw=draw,
    drawn_after=True,
    reads=("mesh",),
    files=lambda job: {MESH_FILE: job.mesh_file} if job.mesh_file else {},
    results=("mesh/section.msh", "mesh/section.vtu"),
    pictures=("figures/section.png", "figures/weights.png", "figures/mesh.png"),
)
