"""The stage `mpm`: every case of liquefaction by the material point method, a second opinion beside the discs."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from meshes.errors import NoAnswerError
from meshes.section.section import Section
from workflow.config import Config
from workflow.results.answer import SectionLabel
from workflow.results.material_points import PointCase, PointSlidesAnswer
from workflow.run.stage import Job, Stage
from workflow.stages.liquefaction import cases_as_data, liquefying, lowest_factors

if TYPE_CHECKING:
    from dem.settings import Case
    from fem.mpm.slide import PointSlide, SlideProgramme
    from fem.search.liquefied_ground import Remains

LEAD = 2.0  # s in which Kh comes on before anything liquefies, as for the discs
AFTER = 1.0  # s after Kh has gone, from which on the ground may come to rest


def work(job: Job) -> None:
    """Slides of the cases asked for, or of all; leaves mpm/slides.json and a picture.

    Raises NoAnswerError for ground that bears loads.
    """
    config, store = job.config, job.store
    if config.section.surcharges:
        raise NoAnswerError(
            "the material point method does not carry loads on the ground", "leave them out, or slide discs alone"
        )
    wanted = [n for n in liquefying(config) if job.cases is None or n in job.cases]
    found: dict[int, PointCase] = {}
    about: tuple[int, float, float, tuple[str, ...]] = (0, 0.0, 0.0, ())
    for number in wanted:
        slides = []
        for affine_flip in (True, False):
            slide, about = _slid(job, number, affine_flip, len(found), len(wanted))
            slides.append(slide)
        found[number] = _answer(slides[0], slides[1], about[3])
    points, cell, far, softened = about
    PointSlidesAnswer(
        section=SectionLabel.of(config.section),
        points=points,
        cell_m=cell,
        settled_by_m=far,
        softened=softened,
        cases=found,
    ).write(store)
    draw(job)


def draw(job: Job) -> None:
    """Draw the surface of every case before and after, beside that of the discs where there is one."""
    from workflow.figures.material_points import profiles

    answer = PointSlidesAnswer.read(job.store)
    if answer.cases:
        with job.store.writing("figures/mpm.png") as path:
            profiles(job.config, answer, path)


def _slid(
    job: Job, number: int, affine_flip: bool, done: int, count: int
) -> "tuple[PointSlide, tuple[int, float, float, tuple[str, ...]]]":
    """One slide with one transfer, and the ground's points, cell, movement in coming to rest, softened strata."""
    config = job.config
    name = "affine FLIP" if affine_flip else "APIC"

    def told(share: float, time: float, slide: np.ndarray) -> None:
        share = (done + 0.5 * ((not affine_flip) + share)) / count
        job.progress(f"{config.called(number)}, {name}: {time:.1f} s, slide {slide.max():.2f} m", share)

    return slide_of_points(config, number, affine_flip, told)


def slide_of_points(
    config: Config,
    number: int,
    affine_flip: bool = True,
    told: Callable[[float, float, np.ndarray], None] | None = None,
) -> "tuple[PointSlide, tuple[int, float, float, tuple[str, ...]]]":
    """One case by material points.

    Parameters
    ----------
    config : Config
        The section, and the strength that is left in its cases.
    number : int
        Of the case, from 1.
    affine_flip : bool
        Whether velocities go over by affine FLIP; by APIC otherwise.
    told : callable or None
        Hears at every look of the share of the time that is done, of the time (s), and of the slide (k,) in m.

    Returns
    -------
    PointSlide, (int, float, float, tuple of str)
        The slide; and how many points there are, the side of a cell (m), how far the ground moved in coming to rest
        (m), and the strata that were made less stiff.

    Raises
    ------
    FloatingPointError
        Where the ground has no equilibrium under its weight.
    """
    from fem.continuum.loads import downhill
    from fem.mpm.ground import ground_of
    from fem.mpm.slide import PointSlider

    case, strata = config.cases[number - 1], liquefying(config)[number]
    ground = ground_of(config.section, config.slide.mpm_cells)
    remains = {k: _remains(config.section, case, k) for k in strata}
    slider = PointSlider(ground, downhill(config.section), remains, case.volumetric_strain, affine_flip=affine_flip)
    far = slider.settle()
    programme = programme_of(config, strata)

    def look(time: float, slide: np.ndarray) -> None:
        if told is not None:
            told(min(time / programme.duration, 1.0), time, slide)

    found = slider.run(programme, look)
    return found, (len(ground.points.x), ground.grid.cell, far, ground.softened)


def _remains(section: Section, case: "Case", stratum: int) -> "Remains":
    from fem.search.liquefied_ground import Remains

    name = section.strata[stratum].name
    return Remains(case.cohesion, case.friction, case.residual_of(name), case.strength_of(name))


def programme_of(config: Config, strata: list[int]) -> "SlideProgramme":
    """What shakes the ground and when strata liquefy: Kh that is held, or a record, as for the discs."""
    from fem.mpm.slide import SlideProgramme
    from meshes.section.quantity import GRAVITY
    from workflow.stages.shaking import shaking_of

    settings, onset = config.slide, config.slide.onset_of("soil")
    shaking = shaking_of(config, strata)
    if shaking is not None:
        time, push = shaking.time - shaking.time[0], shaking.push
        last = max([float(time[-1]), *(start + onset for start in shaking.onsets.values())])
        return SlideProgramme(
            lambda t: np.interp(t, time, push, right=0.0), dict(shaking.onsets), onset, last,
            float(time[-1]) + settings.duration, settings.still,
        )  # fmt: skip
    held = settings.kh_seconds

    def push_at(t: np.ndarray) -> np.ndarray:
        rise = 0.5 - 0.5 * np.cos(np.pi * np.clip(t / LEAD, 0.0, 1.0))
        return settings.kh * GRAVITY * rise * (np.ones_like(t) if held is None else t < held)

    calm = LEAD + onset if held is None else max(LEAD + onset, held + AFTER)
    return SlideProgramme(push_at, dict.fromkeys(strata, LEAD), onset, calm, settings.duration, settings.still)


def _answer(counts: "PointSlide", other: "PointSlide", softened: tuple[str, ...]) -> PointCase:
    """A case as its answer holds it, from the slides by affine FLIP and by APIC."""
    from fem.mpm.slide import LOSS

    slide, settlement = counts.slide[-1], counts.settlement[-1]
    uphill_first = counts.before[0, 1] >= counts.before[-1, 1]
    thirds = [np.array_split(values if uphill_first else values[::-1], 3) for values in (slide, settlement)]
    names = ("uphill", "middle", "downhill")
    notes = []
    lost = 100.0 * counts.transfer_loss_share
    if abs(counts.transfer_loss_share) > LOSS:
        how = "lost, so that the slide is a low estimate" if lost > 0.0 else "gained, so that the slide is a high one"
        notes.append(f"{abs(lost):.0f} % of the energy is {how}: between points and grid; APIC gives the other end")
    if counts.stopped_by:
        notes.append(f"the slide ran up against the {counts.stopped_by} side of the section, which held it")
    if softened:
        listed = ", ".join(f'"{name}"' for name in softened)
        notes.append(f"{listed} were made less stiff, so that waves allow longer steps; strengths are as given")
    largest = int(np.argmax(slide))
    return PointCase(
        slide_max_m=counts.slide_max,
        slide_max_low_m=min(counts.slide_max, other.slide_max),
        slide_max_high_m=max(counts.slide_max, other.slide_max),
        slide_max_at_x_m=float(counts.before[largest, 0]),
        **{f"slide_{name}_m": float(np.median(part)) for name, part in zip(names, thirds[0], strict=True)},
        **{f"settlement_{name}_m": float(np.median(part)) for name, part in zip(names, thirds[1], strict=True)},
        settlement_crest_m=float(counts.before[:, 1].max() - counts.after[:, 1].max()),
        settled=counts.settled,
        reason=counts.reason,
        seconds_simulated=counts.times[-1],
        transfer_loss_share=counts.transfer_loss_share,
        stopped_by=counts.stopped_by,
        notes=tuple(notes),
        surface_before=_line(counts.before),
        surface_after=_line(counts.after[np.argsort(counts.after[:, 0])]),
        slide_along=_line(np.column_stack([counts.before[:, 0], slide])),
    )


def _line(points: np.ndarray) -> tuple[tuple[float, float], ...]:
    return tuple((float(x), float(z)) for x, z in points)


def taken(config: Config) -> dict[str, object]:
    """The cases as they come to, and where a record decides when strata liquefy, at which share of its peak."""
    decides = (config.slide.accelerogram or config.slide.kh_cycles) and config.slide.liquefies_at == "F_L"
    return {"what liquefies": cases_as_data(config)} | ({"its F_L": lowest_factors(config)} if decides else {})


STAGE = Stage(
    name="mpm",
    what="slides of the continuum by material points",
    work=work,
    draw=draw,
    needs=("mesh",),
    reads=(
        "slide.kh", "slide.kh_seconds", "slide.kh_cycles", "slide.kh_period", "slide.accelerogram", "slide.unit",
        "slide.scale", "slide.liquefies_at", "slide.onset", "slide.still", "slide.duration", "slide.mpm_cells",
    ),
    takes=taken,
    beside=("mesh",),
    results=(PointSlidesAnswer.FILE,),
    read=PointSlidesAnswer.read,
    pictures=("figures/mpm.png",),
    partial=lambda job: job.cases is not None,
    wanted=lambda config: "mpm" in config.slide.judges and config.section.liquefies,
)  # fmt: skip
