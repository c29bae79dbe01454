"""The stage `slices`: critical slip circles by Bishop's and Spencer's methods, their file and their picture."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from workflow.results.answer import SectionLabel, line
from workflow.results.slices import CirclePart, FacePart, FactorCircles, SlicesAnswer
from workflow.run.stage import Job, Stage

if TYPE_CHECKING:
    from workflow.estimates.slip_circles import SlipCircle

    Circles = dict[float | None, tuple[SlipCircle, ...]]  # by Kh; those of the critical Kh by None

PICTURE = "figures/slip_circles.png"
LEVEL = 10.0  # a circle with a larger factor of safety slides through level ground: there is no slope on that side
NO_CIRCLE = "no circle slides: the ground is level, or every circle is too shallow or too steep"
NO_FACE = "no circle slides with its crest, for the ground is level there, or every circle is too shallow or too steep"
SOURCE = "Bishop 1955 (simplified method); Spencer 1967; Duncan, Wright & Brandon 2014, chapter 6"


def work(job: Job) -> None:
    """Find the critical circles; leaves fem/slices.json and figures/slip_circles.png."""
    from workflow.estimates.slip_circles import critical_circles

    section, fem = job.config.section, job.config.fem
    wanted = job.config.criteria.factor_of_safety
    whole: Circles = {}
    for kh in (*dict.fromkeys((0.0, *fem.safety_factor_at, *(() if wanted is None else (wanted.kh,)))), None):
        job.progress("critical Kh" if kh is None else f"factor of safety at Kh = {kh:g}", None)
        circles = critical_circles(section, kh, fem.least_depth, fem.vertical, crack=job.config.tension_crack)
        whole[kh] = tuple(circle for circle in circles if kh is None or circle.bishop < LEVEL)
    reason = "" if any(whole.values()) else NO_CIRCLE
    SlicesAnswer(
        section=SectionLabel.of(section),
        factors=tuple(FactorCircles(kh=kh, circles=_parts(circles)) for kh, circles in whole.items() if kh is not None),
        critical=_parts(whole[None]),
        faces=tuple(_faces(job, whole)),
        least_depth=fem.least_depth,
        reason=reason,
        source=SOURCE,
    ).write(job.store)
    if not reason:
        draw(job)


def _faces(job: Job, whole: "Circles") -> Iterator[FacePart]:
    """The faces of all structures, those with which no circle slides among them."""
    from workflow.estimates.slices import LEFT, RIGHT
    from workflow.estimates.structures import face_circle, structures_of

    section, fem, crack = job.config.section, job.config.fem, job.config.tension_crack
    for structure in structures_of(section):
        for side in (LEFT, RIGHT):
            job.progress(f"{structure.name}, towards the {'left' if side == LEFT else 'right'}", None)
            circle_at = {
                kh: face_circle(section, structure, side, circles, kh, fem.least_depth, fem.vertical, crack)
                for kh, circles in whole.items()
            }
            circles = {
                kh: _parts(() if circle is None or (kh is not None and circle.bishop >= LEVEL) else (circle,))
                for kh, circle in circle_at.items()
            }
            crest = structure.crest
            yield FacePart(
                structure=structure.name,
                kind=structure.kind,
                start_m=crest.start,
                end_m=crest.end,
                crest_m=(crest.left, crest.right),
                towards="left" if side == LEFT else "right",
                factors=tuple(FactorCircles(kh=kh, circles=circle) for kh, circle in circles.items() if kh is not None),
                critical=next(iter(circles[None]), None),
                reason="" if any(circles.values()) else NO_FACE,
            )


def draw(job: Job) -> None:
    """Draw the circles again from what is stored."""
    from workflow.figures.slip_circles import draw as draw_circles

    answer = SlicesAnswer.read(job.store)
    if not answer.reason:
        with job.store.writing(PICTURE) as path:
            draw_circles(job.config.section, answer, path)


def _parts(circles: "tuple[SlipCircle, ...]") -> tuple[CirclePart, ...]:
    return tuple(
        CirclePart.taken(circle, centre_m=circle.centre, radius_m=circle.radius, surface_m=line(circle.surface))
        for circle in circles
    )


STAGE = Stage(
    name="slices",
    what="slip circles by Bishop and Spencer",
    work=work,
    draw=draw,
    reads=("fem.safety_factor_at", "fem.least_depth", "fem.vertical", "criteria.factor_of_safety", "tension_crack"),
    takes=lambda config: {"structures": [item.model_dump(mode="json") for item in config.section.structures]},
    results=(SlicesAnswer.FILE,),
    read=SlicesAnswer.read,
    pictures=(PICTURE,),
)
