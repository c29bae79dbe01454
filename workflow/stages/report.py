"""Defines the stage `report`: the pictures of several stages, summary.json and report.html."""

import time

from workflow.config import FILES, Config
from workflow.results.summary import Summary
from workflow.run.stage import Job, Stage
from workflow.stages import NAMES

REPORT, PDF = "report.html", "report.pdf"


def work(job: Job) -> None:
    """Report all results that belong to the input; writes summary.json, report.html and pictures."""
    from workflow.figures.comparison import draw_all
    from workflow.report.page import page
    from workflow.report.summary import summary
    from workflow.results.results import Results

    start = time.perf_counter()
    results = Results.of(job)
    job.progress("pictures", None)
    draw_all(results)
    job.progress("report", 0.5)
    job.store.remove([PDF])  # that of an earlier report
    data = summary(results, time.perf_counter() - start)
    text = page(results, data)
    data.write(job.store)
    job.store.write_text(REPORT, text)


def draw(job: Job) -> None:
    """Draw the pictures of several stages."""
    from workflow.figures.comparison import draw_all
    from workflow.results.results import Results

    draw_all(Results.of(job))


STAGE = Stage(
    name="report",
    description="pictures of several stages, summary and report",
    work=work,
    draw=draw,
    needs=NAMES[:-1],
    reads=tuple(Config.tables()),  # the report lists every setting that differs from its default
    ignores=lambda config: [f"{table}.{key}" for table, key in FILES],
    files=lambda job: job.config.files(),  # their contents count, not their places
    results=(Summary.FILE, REPORT),
    read=Summary.read,
    pictures=(
        "figures/front.png",
        "figures/curves.png",
        "figures/slip_surfaces.png",
        "figures/calibration.png",
        "figures/sliding_block.png",
        "figures/displacements.png",
    ),
    of_all=True,
)
