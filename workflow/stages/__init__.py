"""The stages of a run, each declared once: what it is made from, what it leaves, and the function that does it."""

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workflow.run.errors import NoAnswerError
from workflow.run.progress import Progress, silent
from workflow.run.ranks import Ranks
from workflow.run.store import Store
from workflow.settings import Input


@dataclass(frozen=True)
class Job:
    """All that a stage may need: the input, the folder, who listens, and the options that are no settings."""

    run: Input
    store: Store
    progress: Progress = silent
    mesh_file: Path | None = None
    cases: tuple[int, ...] | None = None
    ranks: Ranks | None = None


@dataclass(frozen=True)
class Stage:
    """One stage. ``work`` computes, writes and draws; ``redraw`` draws again from what is stored, and says if it can.

    ``needs`` are the stages whose results it reads, ``tables`` the settings that matter to it, ``code`` the packages
    and modules whose text is its version. ``results`` and ``pictures`` are patterns of the files that it leaves,
    ``leftovers`` of those it goes on from after a stop, which are removed when they belong to other inputs. Where it is
    not ``wanted`` it is not run, and what it left before is used if it fits.
    """

    name: str
    what: str
    module: str
    needs: tuple[str, ...]
    tables: tuple[str, ...]
    code: tuple[str, ...]
    results: tuple[str, ...]
    pictures: tuple[str, ...]
    work: Callable[[Job], None]
    redraw: Callable[[Job], bool] = lambda job: False
    leftovers: tuple[str, ...] = ()
    wanted: Callable[[Input], bool] = lambda run: True

    @property
    def exists(self) -> bool:
        """Whether this installation has the stage."""
        return importlib.util.find_spec(self.module) is not None


def _mesh(job: Job) -> None:
    from workflow.stages.mesh import mesh_stage

    mesh_stage(job.run, job.store, job.progress, job.mesh_file)


def _mesh_pictures(job: Job) -> bool:
    from workflow.stages.mesh import mesh_figures, stored_mesh

    mesh_figures(job.run, stored_mesh(job.run, job.store), job.store)
    return True


def _fem(job: Job) -> None:
    from workflow.stages.fem import fem_stage
    from workflow.stages.mesh import stored_mesh

    ranks = job.ranks or Ranks()
    mesh = stored_mesh(job.run, job.store)
    ranks.call()
    fem_stage(job.run, mesh, job.store, ranks.comm, job.progress)


def help_compute(job: Job, ranks: Ranks) -> None:
    """What a rank does that is not the first: its share of the finite element analysis, if there is to be one."""
    from workflow.stages.fem import fem_stage
    from workflow.stages.mesh import stored_mesh

    if ranks.called():
        fem_stage(job.run, stored_mesh(job.run, job.store), None, ranks.comm, silent)


def _fem_pictures(job: Job) -> bool:
    from workflow.figures import fem as fem_figures
    from workflow.results.fem_states import FemResults

    fem_figures.draw_all(job.run, FemResults.load(job.run, job.store), job.store)
    return True


def _variants(job: Job) -> None:
    _function("workflow.stages.variants", "variants_stage")(job.run, job.store, job.progress)


def _bounds(job: Job) -> None:
    _function("workflow.stages.bounds", "bounds_stage")(job.run, job.store, job.progress)


def _bounds_wanted(run: Input) -> bool:
    return run.bounds.run


def _calibrate(job: Job) -> None:
    fem = job.store.read_json("fem/critical.json")
    if fem["verdict"] == "no failure":
        raise NoAnswerError(
            f"the section does not fail ({fem['reason']}), so there is no critical Kh to calibrate the discs to",
            "raise fem.kh_limit, or look at a weaker section",
        )
    _function("workflow.stages.calibrate", "calibrate_stage")(job.run, job.store, job.progress)


def _slide(job: Job) -> None:
    _function("workflow.stages.slide", "slide_stage")(job.run, job.store, job.progress, job.cases)


def _pictures_of(stage: str) -> Callable[[Job], bool]:
    """A stage's own function (run, store) that draws its pictures again, where its module has one."""

    def redraw(job: Job) -> bool:
        draw = getattr(importlib.import_module(f"workflow.stages.{stage}"), f"{stage}_pictures", None)
        if draw is None:
            return False
        draw(job.run, job.store)
        return True

    return redraw


def _function(module: str, name: str) -> Callable[..., Any]:
    function: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return function


def _report(job: Job) -> None:
    from workflow.stages.report import report_stage

    report_stage(job)


def _report_pictures(job: Job) -> bool:
    from workflow.figures.comparison import draw_all
    from workflow.results.results import Results

    draw_all(Results.of(job))
    return True


DRAWING = ("workflow.figures.canvas", "workflow.figures.ground")

ALL = (
    Stage(
        "mesh", "mesh of quadrilaterals", "workflow.stages.mesh", (), ("mesh",),
        ("meshes", "workflow.stages.mesh", *DRAWING),
        ("mesh/section.msh", "mesh/section.vtu"), ("figures/section.png", "figures/mesh.png"), _mesh, _mesh_pictures,
    ),
    Stage(
        "fem", "critical Kh by finite elements", "workflow.stages.fem", ("mesh",), ("fem",),
        ("meshes", "fem", "workflow.stages.fem", "workflow.results.fem_states", "workflow.figures.fem", *DRAWING),
        ("fem/critical.json", "fem/fields.pvd", "fem/fields_*.vtu"), ("figures/fem_*.png",), _fem, _fem_pictures,
    ),
    Stage(
        "variants", "on what the critical Kh hangs", "workflow.stages.variants", ("fem",), ("mesh", "fem", "variants"),
        ("meshes", "fem", "workflow.stages.variants"), ("fem/variants.json",), (), _variants,
        wanted=lambda run: bool(run.variants.which),
    ),
    Stage(
        "bounds", "strict bounds of the critical Kh", "workflow.stages.bounds", (), ("fem", "bounds"),
        ("meshes", "fem", "workflow.stages.bounds", *DRAWING),
        ("fem/bounds.json",), ("figures/bounds_*.png",), _bounds,
        _pictures_of("bounds"), wanted=_bounds_wanted,
    ),
    Stage(
        "calibrate", "discs that fail at the same Kh", "workflow.stages.calibrate", ("fem",), ("dem",),
        ("meshes", "dem", "workflow.stages.calibrate", "workflow.figures.discs", *DRAWING),
        ("dem/critical.json", "dem/calibration.json", "dem/trials.jsonl", "dem/*.h5"), ("figures/dem_*.png",),
        _calibrate, _pictures_of("calibrate"), leftovers=("dem/**/*",),
    ),
    Stage(
        "slide", "slides once layers have liquefied", "workflow.stages.slide", ("calibrate",), ("dem", "slide"),
        ("meshes", "dem", "workflow.stages.slide", "workflow.results.disc_grids", "workflow.figures.slides", *DRAWING),
        ("dem/cases.json", "dem/history.csv", "dem/case*.pvd", "dem/case*/*.vtp"),
        ("figures/case*.png", "figures/case*.gif", "figures/history.png"),
        _slide, _pictures_of("slide"),
        leftovers=("dem/case*", "dem/case*/*", "dem/slide*", "dem/slide*/*", "dem/history.csv"),
    ),
    Stage(
        "report", "pictures of all, summary and report", "workflow.stages.report",
        ("mesh", "fem", "variants", "bounds", "calibrate", "slide"), ("sliding_block", "figures"), ("workflow",),
        ("summary.json", "report.html"),
        ("figures/curves.png", "figures/slip_surfaces.png", "figures/calibration.png", "figures/sliding_block.png"),
        _report, _report_pictures,
    ),
)  # fmt: skip


def stages() -> tuple[Stage, ...]:
    """The stages of this installation, in their order."""
    return tuple(stage for stage in ALL if stage.exists)


def by_name(name: str) -> Stage:
    """The stage with a name that is known to exist."""
    return next(stage for stage in stages() if stage.name == name)
