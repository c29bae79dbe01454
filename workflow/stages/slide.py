"""The stage `slide`: how far the calibrated discs slide once layers have liquefied."""

from collections.abc import Mapping
from pathlib import Path

from dem.settings import AVERAGE
from workflow.results.cases import CasesAnswer
from workflow.run.stage import Job, Stage
from workflow.settings import Input


def work(job: Job) -> None:
    """Every case that is asked for, from the discs at rest to where the ground comes to lie."""
    from workflow.stages.liquefied_slides import slide_stage

    slide_stage(job)


def draw(job: Job) -> None:
    """Draw every case at its end, its animation, and the histories."""
    from workflow.stages.liquefied_slides import slide_pictures

    slide_pictures(job.given, job.store, job.team)


def seconds(given: Input) -> float:
    """Every case, and Kh alone, on every packing, that of the paper among them; each packing is calibrated."""
    packings = 1 + len(given.slide.packings(given.dem.model)) + (1 if given.dem.paper else 0)
    return 3.8 * given.disc_work * packings * (1 + len(given.cases))


def files(job: Job) -> Mapping[str, Path]:
    """The record that shakes the discs: that of the base, or that of the rock where its response does."""
    average = job.given.slide.accelerogram == AVERAGE
    shakes = job.given.files("site_response" if average else "slide")
    return job.given.files("earthquake") | {f"{name}, averaged" if average else name: shakes[name] for name in shakes}


STAGE = Stage(
    name="slide",
    what="slides once layers have liquefied",
    module=__name__,
    work=work,
    draw=draw,
    needs=("calibrate",),
    tables=("dem", "slide", "earthquake", "triggering", "site_response"),
    seconds=seconds,
    ignores=(
        "slide.accelerogram",
        "site_response.record",
        "earthquake.record",
    ),  # what the file holds counts, not where it lies
    files=files,
    results=(CasesAnswer.FILE, "dem/history.csv", "dem/case*.pvd", "dem/case*/*.vtp"),
    read=CasesAnswer.read,
    pictures=("figures/case*.png", "figures/case*.webp", "figures/history.png", "figures/profiles.png"),
    leftovers=("dem/case*", "dem/case*/*", "dem/slide*", "dem/slide*/*", "dem/history.csv"),
    partial=lambda job: job.cases is not None,
)
