"""The stage `slices`: critical slip circles by Bishop's and Spencer's methods, their file and their picture."""

from typing import TYPE_CHECKING

from workflow.results.answer import SectionLabel, line
from workflow.results.slices import CirclePart, FactorCircles, SlicesAnswer
from workflow.run.stage import Job, Stage

if TYPE_CHECKING:
    from workflow.estimates.slip_circles import SlipCircle

PICTURE = "figures/slip_circles.png"
SOURCE = "Bishop 1955 (simplified method); Spencer 1967; Duncan, Wright & Brandon 2014, chapter 6"


def work(job: Job) -> None:
    """Find the critical circles; leaves fem/slices.json and figures/slip_circles.png."""
    from workflow.estimates.slip_circles import critical_circles

    section, fem = job.config, job.config.fem
    factors = []
    for kh in dict.fromkeys((0.0, *fem.safety_factor_at)):
        job.progress(f"factor of safety at Kh = {kh:g}", None)
        circles = critical_circles(section.section, kh, fem.least_depth, fem.vertical)
        factors.append(FactorCircles(kh=kh, circles=_parts(circles)))
    job.progress("critical Kh", None)
    critical = _parts(critical_circles(section.section, None, fem.least_depth, fem.vertical))
    found = critical or any(one.circles for one in factors)
    reason = "" if found else "no circle slides: the ground is level, or every circle is too shallow or too steep"
    SlicesAnswer(
        section=SectionLabel.of(job.config.section),
        factors=tuple(factors),
        critical=critical,
        least_depth=fem.least_depth,
        reason=reason,
        source=SOURCE,
    ).write(job.store)
    if not reason:
        draw(job)


def draw(job: Job) -> None:
    """Draw the circles again from what is stored."""
    from workflow.figures.slip_circles import draw as draw_circles

    answer = SlicesAnswer.read(job.store)
    if not answer.reason:
        with job.store.writing(PICTURE) as path:
            draw_circles(job.config.section, answer, path)


def _parts(circles: "tuple[SlipCircle, ...]") -> tuple[CirclePart, ...]:
    return tuple(
        CirclePart(
            towards=circle.towards,
            centre_m=circle.centre,
            radius_m=circle.radius,
            surface_m=line(circle.surface),
            bishop=circle.bishop,
            spencer=circle.spencer,
        )
        for circle in circles
    )


STAGE = Stage(
    name="slices",
    what="slip circles by Bishop and Spencer",
    work=work,
    draw=draw,
    reads=("fem.safety_factor_at", "fem.least_depth", "fem.vertical"),
    results=(SlicesAnswer.FILE,),
    read=SlicesAnswer.read,
    pictures=(PICTURE,),
)
