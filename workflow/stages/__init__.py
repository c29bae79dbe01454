"""The stages of a run, one file each, which ends with its STAGE; heavy packages are only imported inside functions.

So the program starts quickly, and each command needs only the packages that it uses; the files are imported when STAGES
is first used. Work that is too long for one file, or common to two stages, is in other files: bearing,
calibrated_discs, liquefied_slides, random_packings, sliding.
"""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshes.errors import InputError

if TYPE_CHECKING:
    from workflow.run.stage import Job, Stage

    STAGES: tuple[Stage, ...]

# In the order in which they run: each is the name of a stage and of its module here.
NAMES = (
    "triggering", "response", "mesh", "fem", "variants", "bounds", "slices", "faces", "residual", "liquefied", "mpm",
    "calibrate", "slide", "report",
)  # fmt: skip


def command_of(stage: str) -> str:
    """The command that runs a stage; `noshiro run` if the stage has no command."""
    return {"triggering": "liquefaction", "mpm": "slide"}.get(stage, stage)


def __getattr__(name: str) -> Any:
    """Import STAGES, the declarations of all stages, when they are first used (PEP 562)."""
    if name != "STAGES":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    declared = globals()["STAGES"] = tuple(import_module(f"{__name__}.{stage}").STAGE for stage in NAMES)
    return declared


def stored_job(folder: Path) -> "Job":
    """The job of the run in a folder; raises InputError if it holds no run."""
    from workflow.config.after_triggering import load_config
    from workflow.run.record import Record
    from workflow.run.stage import Job
    from workflow.run.store import Store
    from workflow.stages.mesh import MESH_FILE

    path = folder / "section.toml"
    if not path.is_file():
        expected = "expected a folder that noshiro wrote, such as runs/my_slope"
        lacking = "is a file" if folder.is_file() else "holds no run: there is no section.toml"
        raise InputError(str(folder), [f"{lacking}; {expected}"])
    store = Store(folder)
    left = Record(store)["mesh"]
    has_own_mesh = left is not None and MESH_FILE in left.inputs
    declared = globals().get("STAGES") or __getattr__("STAGES")
    mesh_file = folder / "mesh/section.msh" if has_own_mesh else None
    return Job(load_config(path), store, declared, mesh_file=mesh_file)
