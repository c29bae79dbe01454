"""The discs of a sample: all stages of a run up to `slide`, of which a few numbers are kept."""

from pathlib import Path
from tempfile import TemporaryDirectory

from meshes.errors import InputError
from workflow.results.cases import CasesAnswer
from workflow.run import pipeline
from workflow.run.plan import Choice, Decision
from workflow.run.progress import Progress, silent
from workflow.run.record import Entry
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages import calibrate, fem, mesh, slide
from workflow.study.sample import Numbers, Sample

STAGES = (mesh.STAGE, fem.STAGE, calibrate.STAGE, slide.STAGE)
SLIDES = (
    "slide_uphill_m", "slide_middle_m", "slide_downhill_m", "slide_max_m", "settlement_uphill_m",
    "settlement_middle_m", "settlement_downhill_m", "crack_opening_m",
)  # fmt: skip


def discs(given: Sample) -> Numbers:
    """How far every case slides: all stages of a run up to `slide`, in a folder that goes once the numbers are known.

    Raises NoAnswerError where the discs cannot be calibrated.
    """
    read = Input.parse(given.data)
    if not any(stratum.liquefies_in for stratum in read.strata):
        raise InputError(read.name, ["no stratum liquefies in any case; expected liquefies_in in one at least"])
    with TemporaryDirectory(prefix="noshiro-") as beside:
        store = Store(Path(given.folder or beside))
        job = Job(read, store, STAGES)
        pipeline.execute(job, Choice(tuple(stage.name for stage in job.stages)), _Silence(), "noshiro study")
        answer = CasesAnswer.read(store)
        cases = answer.sets[answer.first_set]
        numbers = {
            f"case{number}_{name}": getattr(case, name) for number, case in sorted(cases.items()) for name in SLIDES
        }
        store.remove(["**/*"])
    return Numbers(numbers=numbers)


class _Silence:
    """Nobody listens to the stages of a sample."""

    def begin(self, decision: Decision) -> Progress:
        return silent

    def end(self, decision: Decision, entry: Entry) -> None: ...

    def skip(self, decision: Decision, why: str) -> None: ...
