"""Defines the stage `slices`: critical slip circles by Bishop's and Spencer's methods, their file and their picture."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Literal

from fem.settings import LEVEL
from workflow.results.answer import SectionLabel, line
from workflow.results.slices import (
    CirclePart,
    CirclesAtRest,
    FaceCircle,
    FacePart,
    FactorCircles,
    LongerCircle,
    SlicesAnswer,
)
from workflow.run.stage import Job, Stage

if TYPE_CHECKING:
    from meshes.section.section import Section
    from workflow.config import Config
    from workflow.estimates.slip_circles import SlipCircle

    # the ground and its critical circle, by Kh (None: the critical Kh) and side
    Circles = dict[tuple[float | None, int], tuple[Section, SlipCircle | None]]

PICTURE = "figures/slip_circles.png"
# Factor of safety and critical Kh above which a circle lies in level ground, so that there is no slope on this side.
LEVEL_GROUND_FACTOR, LEVEL_GROUND_KH = 10.0, 2.0
NO_CIRCLE = "no circle slides: the ground is level, or every circle is too shallow or too steep"
NO_FACE = "no circle slides with the crest: the ground is level there, or every circle is too shallow or too steep"
SOURCE = "Bishop 1955 (simplified method); Spencer 1967; Duncan, Wright & Brandon 2014, chapter 6"


def work(job: Job) -> None:
    """Find the critical circles; writes fem/slices.json and figures/slip_circles.png."""
    from workflow.estimates.deeper_circles import ground_of_circles
    from workflow.estimates.slices import LEFT, RIGHT
    from workflow.estimates.weak_layers import strong_blocks, thin_weak_layers

    section, fem, crack = job.config.section, job.config.fem, job.config.tension_crack
    coefficients = dict.fromkeys((0.0, *fem.safety_factor_at, *_criterion_kh(job.config)))
    circles: Circles = {}
    for kh in (*coefficients, None):
        job.progress("critical Kh" if kh is None else f"factor of safety at Kh = {kh:g}", None)
        for side in (LEFT, RIGHT):
            circles[kh, side] = ground_of_circles(section, side, kh, fem.least_depth, fem.vertical, crack)
    critical, *factors = (
        _circle_parts(section, kh, (circles[kh, LEFT], circles[kh, RIGHT])) for kh in (None, *coefficients)
    )
    endless = _is_endless(job.config)
    if not endless:
        critical = tuple(_with_longer(job.config, part) for part in critical)
    reason = "" if critical or any(factors) else NO_CIRCLE
    SlicesAnswer(
        section=SectionLabel.of(section),
        factors=tuple(FactorCircles(kh=kh, circles=parts) for kh, parts in zip(coefficients, factors, strict=True)),
        critical=critical,
        faces=tuple(_faces(job, circles)),
        after_shaking=_after_shaking(job),
        least_depth=fem.least_depth,
        reason=reason,
        weak_layers=thin_weak_layers(section),
        strong_blocks=strong_blocks(section),
        endless=endless,
        source=SOURCE,
    ).write(job.store)
    if not reason:
        draw(job)


def _criterion_kh(config: "Config") -> tuple[float, ...]:
    """Return the Kh at which a criterion requires a factor of safety; empty if there is none, or if it is 0."""
    criterion = config.criteria.factor_of_safety
    return () if criterion is None or criterion.kh == 0.0 else (criterion.kh,)


def _is_endless(config: "Config") -> bool:
    """Return whether the section is a part of an endless slope: its sides are periodic, and one is higher than the
    other."""
    x, z = config.section.ground[[0, -1]].T
    return config.fem.sides == "periodic" and bool(abs(z[1] - z[0]) > LEVEL * (x[1] - x[0]))


def _after_shaking(job: Job) -> CirclesAtRest | None:
    """Return the circles in the ground with the excess pore pressure of shaking; None without such pressure."""
    if not job.config.section.water_pressure.rises_by_shaking:
        return None
    job.progress("factor of safety after shaking", None)
    return circles_at_rest(job.config.section.after_shaking(), job.config)


def circles_at_rest(section: "Section", config: "Config") -> CirclesAtRest:
    """Find the critical circles at Kh = 0 of a ``section`` whose strength or pore pressure differs from that of the
    ``config``, towards either side and for every face of its structures."""
    from workflow.estimates.deeper_circles import ground_of_circles
    from workflow.estimates.slices import LEFT, RIGHT
    from workflow.estimates.structures import face_circle, structures_of

    fem, crack = config.fem, config.tension_crack
    circles = {
        side: ground_of_circles(section, side, 0.0, fem.least_depth, fem.vertical, crack) for side in (LEFT, RIGHT)
    }
    faces = []
    for structure in structures_of(config.section):
        for side, (ground, critical) in circles.items():
            circle = face_circle(ground, structure, side, critical, 0.0, fem.least_depth, fem.vertical, crack)
            for part in _circle_parts(section, 0.0, ((ground, circle),)):
                towards: Literal["left", "right"] = "left" if side == LEFT else "right"
                start, end = structure.crest.start, structure.crest.end
                faces.append(FaceCircle(start_m=start, end_m=end, towards=towards, circle=part))
    return CirclesAtRest(circles=_circle_parts(section, 0.0, circles.values()), faces=tuple(faces))


def _faces(job: Job, whole: "Circles") -> Iterator[FacePart]:
    """Yield the faces of all structures, including those without slip circles."""
    from fem.continuum.strength import is_dilating_fully, with_davis_strength
    from workflow.estimates.slices import LEFT, RIGHT
    from workflow.estimates.structures import face_circle, structures_of

    section, fem, crack = job.config.section, job.config.fem, job.config.tension_crack
    weak = None if is_dilating_fully(section.strata) else with_davis_strength(section)
    for structure in structures_of(section):
        for side in (LEFT, RIGHT):
            towards: Literal["left", "right"] = "left" if side == LEFT else "right"
            job.progress(f"{structure.name}, towards the {towards}", None)
            parts: dict[float | None, tuple[CirclePart, ...]] = {}
            for kh, ground, circle in ((kh, *of) for (kh, of_side), of in whole.items() if of_side == side):
                face = face_circle(ground, structure, side, circle, kh, fem.least_depth, fem.vertical, crack)
                parts[kh] = _circle_parts(section, kh, ((ground, face),))
            davis: dict[float | None, CirclePart | None] = {}
            for kh in (0.0, None) if weak is not None and any(parts.values()) else ():
                job.progress(f"{structure.name}, towards the {towards}, Davis's strength", None)
                assert weak is not None
                face = face_circle(weak, structure, side, None, kh, fem.least_depth, fem.vertical, crack)
                davis[kh] = next(iter(_circle_parts(section, kh, ((section, face),))), None)
            crest = structure.crest
            yield FacePart(
                structure=structure.name,
                kind=structure.kind,
                start_m=crest.start,
                end_m=crest.end,
                crest_m=(crest.left, crest.right),
                towards=towards,
                factors=tuple(FactorCircles(kh=kh, circles=circles) for kh, circles in parts.items() if kh is not None),
                critical=next(iter(parts[None]), None),
                davis_factor=davis.get(0.0),
                davis_critical=davis.get(None),
                reason="" if any(parts.values()) else NO_FACE,
            )


def _with_longer(config: "Config", part: CirclePart) -> CirclePart:
    """Return the circle with the least critical Kh; if it ends at a side, its answer includes the critical circle of a
    longer section."""
    from workflow.estimates.longer_section import circle_of_longer_section
    from workflow.estimates.slices import LEFT, RIGHT

    towards = LEFT if part.towards == "left" else RIGHT
    ends = (part.surface_m[0][0], part.surface_m[-1][0])
    longer = circle_of_longer_section(
        config.section, ends, part.bishop, towards, config.fem.least_depth, config.fem.vertical, config.tension_crack
    )
    return part if longer is None else part.model_copy(update={"longer": LongerCircle.model_validate(longer)})


def draw(job: Job) -> None:
    """Draw the circles again from stored results."""
    from workflow.figures.slip_circles import circles_sheet

    answer = SlicesAnswer.read(job.store)
    if not answer.reason:
        job.store.save(PICTURE, circles_sheet(job.config.section, answer))


def _circle_parts(
    section: "Section", kh: float | None, circles: "Iterable[tuple[Section, SlipCircle | None]]"
) -> tuple[CirclePart, ...]:
    """Return the critical circles, each with its ground, the smallest value first."""
    parts = [
        CirclePart.taken(
            circle,
            centre_m=circle.centre,
            radius_m=circle.radius,
            surface_m=line(circle.surface),
            strengthened=ground is not section,
        )
        for ground, circle in circles
        if circle is not None and circle.bishop < (LEVEL_GROUND_KH if kh is None else LEVEL_GROUND_FACTOR)
    ]
    return tuple(sorted(parts, key=lambda part: part.bishop))


STAGE = Stage(
    name="slices",
    description="slip circles by Bishop and Spencer",
    work=work,
    draw=draw,
    reads=("fem.safety_factor_at", "fem.least_depth", "fem.sides", "fem.vertical", "tension_crack"),
    ignores=lambda config: ("fem.direction",),  # circles are sought towards both sides
    takes=lambda config: {
        "structures": [item.model_dump(mode="json") for item in config.section.structures],
        "criteria.factor_of_safety": _criterion_kh(config),
    },
    results=(SlicesAnswer.FILE,),
    read=SlicesAnswer.read,
    pictures=(PICTURE,),
)  # fmt: skip
