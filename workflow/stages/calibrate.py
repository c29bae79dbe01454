"""Defines the stage `calibrate`: discs of the section, calibrated to the critical Kh of their FEM counterpart."""

from fem.settings import WITHOUT_EFFECT
from meshes.errors import NoAnswerError
from workflow.config import Config
from workflow.results.calibration import CalibrationAnswer
from workflow.results.continuum import FemAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.discs import DiscsAnswer
from workflow.run.stage import Job, Stage, unless_discs_slide


def work(job: Job) -> None:
    """Calibrate the discs. Raises NoAnswerError if there is no critical Kh to calibrate them to."""
    from workflow.stages.calibrated_discs import calibrate_stage

    fem = FemAnswer.read(job.store)
    if fem.verdict == "no failure":
        raise NoAnswerError(
            f"the section does not fail ({fem.reason}), so the discs cannot be calibrated to a critical Kh",
            "raise fem.kh_limit, or use a weaker section",
        )
    calibrate_stage(job.config, job.store, job.progress, job.executor)


def draw(job: Job) -> None:
    """Draw the discs by layer, and their states at every recorded Kh."""
    from workflow.stages.disc_pictures import draw_discs

    draw_discs(job.config, job.store, job.executor)


def ignored(config: Config) -> tuple[str, ...]:
    """Return the settings that do not change calibrated discs."""
    return (*WITHOUT_EFFECT, *config.dem.without_effect)


STAGE = Stage(
    name="calibrate",
    description="discs calibrated to the critical Kh of the finite elements",
    work=work,
    draw=draw,
    needs=("fem",),
    reads=("dem", "fem.rigid_box"),
    ignores=ignored,
    results=(DiscsAnswer.FILE, CalibrationAnswer.FILE, DemCounterpart.FILE, "dem/trials.jsonl", "dem/*.npz"),
    read=lambda store: (DiscsAnswer.read(store), CalibrationAnswer.read(store)),
    pictures=("figures/dem_*.png",),
    leftovers=("dem/**/*",),
    unwanted=unless_discs_slide,
)
