"""The stage `report`: the pictures of several stages, summary.json and report.html."""

import time

from workflow.figures import comparison as report_figures
from workflow.report.page import page
from workflow.report.summary import summary
from workflow.results.results import Results
from workflow.stages import Job

SUMMARY, REPORT = "summary.json", "report.html"


def report_stage(job: Job) -> None:
    """Tell all that is there and belongs to the input; leaves summary.json, report.html and pictures."""
    start = time.perf_counter()
    results = Results.of(job)
    job.progress("pictures", None)
    report_figures.draw_all(results)
    job.progress("report", 0.5)
    data = summary(results, time.perf_counter() - start)
    text = page(results, data)
    job.store.write_json(SUMMARY, data)
    job.store.write_text(REPORT, text)
