"""Defines the stage `slide`: slides of the calibrated discs after liquefaction."""

from collections.abc import Mapping
from pathlib import Path

from dem.settings import AVERAGE
from fem.settings import WITHOUT_EFFECT
from workflow.config import Config
from workflow.results.cases import CasesAnswer
from workflow.run.stage import Job, Stage, unless_discs_slide
from workflow.stages.liquefaction import resolved_inputs


def work(job: Job) -> None:
    """Compute the requested cases, from the discs at rest to the end of the slides."""
    from workflow.stages.liquefied_slides import slide_stage

    slide_stage(job)


def draw(job: Job) -> None:
    """Draw every case at its end, its animation, and the histories."""
    from workflow.stages.liquefied_slides import slide_pictures

    slide_pictures(job.config, job.store, job.executor)


def files(job: Job) -> Mapping[str, Path]:
    """Return the file of the record that shakes the slides: the record of the base, or the record of the rock if slides
    use the site response."""
    average = job.config.slide.accelerogram == AVERAGE
    shakes = job.config.files("site_response" if average else "slide")
    return {f"{name}, averaged" if average else name: shakes[name] for name in shakes}


def of_the_record(config: Config) -> tuple[str, ...]:
    """Return the settings of the shaking without effect on slides: paths of files, whose content counts, and the site
    response, unless slides use it.
    """
    unused = () if config.slide.accelerogram == AVERAGE else ("site_response",)
    return ("slide.accelerogram", "site_response.record", *unused)


def ignored(config: Config) -> tuple[str, ...]:
    """Return settings without effect on slides: settings of the shaking; cases, which enter after they are resolved;
    and settings of the output of the calibration.
    """
    return (
        *of_the_record(config), "slide.cases", "slide.methods", "slide.mpm_cells", "dem.kh",
        "dem.element_tests", "dem.out_of_reach", *WITHOUT_EFFECT, *config.dem.without_effect,
    )  # fmt: skip


STAGE = Stage(
    name="slide",
    description="slides after liquefaction",
    work=work,
    draw=draw,
    needs=("calibrate",),
    reads=("dem", "slide", "site_response", "fem.sides"),
    ignores=ignored,
    takes=resolved_inputs,
    files=files,
    results=(CasesAnswer.FILE, "dem/history.csv", "dem/case*.pvd", "dem/case*/*.vtp"),
    read=CasesAnswer.read,
    pictures=("figures/case*.png", "figures/case*.webp", "figures/history.png", "figures/profiles.png"),
    leftovers=("dem/case*", "dem/case*/*", "dem/slide*", "dem/slide*/*", "dem/history.csv"),
    partial=lambda job: job.cases is not None,
    unwanted=unless_discs_slide,
)
