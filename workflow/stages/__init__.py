"""The stages of a run, one file each, which ends with its STAGE; a file may use heavy packages inside functions only.

So the program starts quickly, and each command needs no more installed than it uses. What is too long for one file
stands beside it: calibrated_discs, liquefied_slides, random_packings, sliding.
"""

from pathlib import Path

from meshes.errors import InputError
from workflow.run.record import Record
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages import bounds, calibrate, fem, mesh, report, slide, triggering, variants

STAGES = tuple(module.STAGE for module in (triggering, mesh, fem, variants, bounds, calibrate, slide, report))


def stored_job(folder: Path) -> Job:
    """What a folder's results were made from; raises InputError if it holds no run."""
    path = folder / "section.toml"
    if not path.is_file():
        raise InputError(str(folder), ["holds no run: there is no section.toml; expected a folder that noshiro wrote"])
    store = Store(folder)
    left = Record(store)["mesh"]
    given = left is not None and mesh.GIVEN in left.inputs
    return Job(Input.load(path), store, STAGES, mesh_file=folder / "mesh/section.msh" if given else None)
