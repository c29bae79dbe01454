"""Computes the discs of a sample: all stages of a run up to `slide`, of which a few numbers are stored."""

from pathlib import Path
from tempfile import TemporaryDirectory

from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.results.cases import QUANTITIES, CasesAnswer
from workflow.run import pipeline
from workflow.run.plan import Choice, Decision
from workflow.run.progress import Progress, silent
from workflow.run.record import Entry
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages import calibrate, fem, mesh, slide
from workflow.stages.liquefaction import refuse_unless_liquefying
from workflow.study.task import Numbers, StudySample

STAGES = (mesh.STAGE, fem.STAGE, calibrate.STAGE, slide.STAGE)


def discs(sample: StudySample) -> Numbers:
    """Compute the slides of every case: all stages of a run up to `slide`, in a folder that is removed afterwards.

    Raises NoAnswerError if the discs cannot be calibrated.
    """
    config = config_after_triggering(Config.parse(sample.data))
    refuse_unless_liquefying(config.section)
    with TemporaryDirectory(prefix="noshiro-") as folder:
        store = Store(Path(sample.folder or folder))
        job = Job(config, store, STAGES)
        pipeline.execute(job, Choice(tuple(stage.name for stage in job.stages)), _Silence(), "noshiro study")
        answer = CasesAnswer.read(store)
        numbers = _numbers(answer)
        store.remove(["**/*"])
    return numbers


def _numbers(answer: CasesAnswer) -> Numbers:
    """Return the numbers of every case: means over its packings, or the values of the only packing."""
    numbers: dict[str, float | None] = {}
    errors = {}
    over_packings = answer.random.cases if answer.random is not None else {}
    for number, case in sorted(answer.sets[answer.first_set].items()):
        for name in QUANTITIES:
            key = f"case{number}_{name}"
            spread = getattr(over_packings.get(number), name, None)
            numbers[key] = getattr(case, name) if spread is None else spread.mean
            if spread is not None and spread.mean_ci95 is not None:
                errors[key] = 0.5 * (spread.mean_ci95[1] - spread.mean_ci95[0])
    return Numbers(numbers=numbers, errors=errors)


class _Silence:
    """Ignores the messages of the stages while a sample is computed."""

    def begin(self, decision: Decision) -> Progress:
        return silent

    def end(self, decision: Decision, entry: Entry) -> None: ...

    def skip(self, decision: Decision, why: str) -> None: ...
