"""Defines the stage `triggering`: which strata the earthquake liquefies, by the blow counts of the borings."""

from workflow.earthquake.triggering.assessment import assess
from workflow.results.triggering import TriggeringAnswer
from workflow.run.stage import Job, Stage

PICTURE = "figures/triggering.png"


def work(job: Job) -> None:
    """Compute F_L at every blow count; writes triggering.json. Raises InputError."""
    config = job.config
    assessment = assess(config.section, config.earthquake, config.triggering)
    TriggeringAnswer.of(config, assessment).write(job.store)


def draw(job: Job) -> None:
    """Draw blow counts and F_L with depth."""
    from workflow.figures import triggering

    job.store.save(PICTURE, triggering.draw(job.config.section, TriggeringAnswer.read(job.store)))


STAGE = Stage(
    name="triggering",
    description="which strata liquefy",
    work=work,
    draw=draw,
    drawn_after=True,
    reads=("earthquake", "triggering"),
    ignores=lambda config: ("earthquake.record",),
    files=lambda job: job.config.files("earthquake"),
    results=(TriggeringAnswer.FILE,),
    read=TriggeringAnswer.read,
    pictures=(PICTURE,),
    unwanted=lambda config: "" if config.triggering.borings else "no borings are given (triggering.borings)",
)
