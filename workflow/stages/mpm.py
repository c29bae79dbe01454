"""Defines the stage `mpm`: every case of liquefaction by the material point method, for comparison with the discs."""

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meshes.executor import Tell
from meshes.section.cutting import shown_name
from meshes.section.polyline import downhill
from workflow.config import Config
from workflow.results.answer import SectionLabel, line
from workflow.results.material_points import WARNING, PointCase, PointSlidesAnswer
from workflow.run.stage import Job, Stage, unless_it_liquefies
from workflow.run.store import Store
from workflow.stages.liquefaction import first_equal, liquefying, remaining, resolved_inputs
from workflow.stages.slide import files, of_the_record

if TYPE_CHECKING:
    from fem.mpm import PointGround, PointSlide, PointSlider, SlideProgramme

FOLDER = "mpm"  # of its files
SMALLEST_DOUBTED_SLIDE = 0.05  # m: the energies of a smaller slide are those of ground that oscillates
THIN_CRUST = 0.9  # of a cell: a slide below a thinner crust was off by a factor of up to 2
CELLS_STEP = 100  # to a multiple of which the cells that a crust wants are rounded up
COARSE_RATIO = 2  # times larger cells, with which the errors by their size and by the decay of velocities are found
TIME_TOLERANCE = 1e-6  # s: sums of steps are off by less
NEAR_END_SHARE = 0.95  # progress of a slide from which it may come to rest
REST_DELAY = 1.0  # s after the end of Kh from which the ground may come to rest


@dataclass(frozen=True, eq=False)
class PointRun:
    """Specifies one slide by material points, which starts from ground at rest: the case, the damping rate (1/s) of
    velocities that the grid cannot resolve, and whether the cells have the size in the settings or are coarse."""

    config: Config
    slider: "PointSlider"
    number: int
    decay: float
    store: Store | None = None
    coarse: bool = False

    @property
    def name(self) -> str:
        """Return the name of the case, with the differences if it is not the governing slide."""
        from fem.mpm.slide import DECAY_RATES

        called = self.config.called(self.number)
        if not self.coarse:
            return called
        slower = "" if self.decay == DECAY_RATES[0] else ", velocities decaying slower"
        return f"{called}, error estimate in cells {COARSE_RATIO} times larger{slower}"

    @property
    def checkpoint(self) -> Path | None:
        """Return the checkpoint file of this slide."""
        name = f"mpm/checkpoint_{self.number}_{self.decay:g}{'_coarse' if self.coarse else ''}.npz"
        return None if self.store is None else self.store.folder / name


def work(job: Job) -> None:
    """Compute the slides of the requested cases, or of all; writes mpm/slides.json and a picture.

    If the method is not applicable, the answer has the reason.
    """
    from fem.mpm.slide import DECAY_RATES
    from workflow.results.disc_grids import copy_frames, write_collection

    config = job.config
    wanted = [n for n in liquefying(config) if job.cases is None or n in job.cases]
    job.progress("material points come to rest under their weight", 0.0)
    try:
        slider, far = at_rest(config)
        coarse, _ = at_rest(config, COARSE_RATIO**2)
    except FloatingPointError as error:
        PointSlidesAnswer(section=SectionLabel.of(config.section), not_possible=str(error)).write(job.store)
        return
    alike = alike_by_strength(config, wanted)
    runs = [
        run
        for number in dict.fromkeys(alike.values())
        for run in (
            PointRun(config, slider, number, DECAY_RATES[0], job.store),
            *(PointRun(config, coarse, number, decay, job.store, coarse=True) for decay in DECAY_RATES),
        )
    ]
    shares, costs = [0.0] * len(runs), [COARSE_RATIO**-3 if run.coarse else 1.0 for run in runs]

    def heard(place: int, message: tuple[float, float, float]) -> None:
        shares[place], time, slide = message
        run = runs[place]  # in coarse cells other ground may slide farther, which is no result
        said = f"{run.name}: t = {time:.1f} s" + ("" if run.coarse else f", slide {slide:.2f} m")
        job.progress(said, sum(share * cost for share, cost in zip(shares, costs, strict=True)) / sum(costs))

    slides: dict[int, list[PointSlide]] = {}
    for run, slide in zip(runs, job.executor.compute(slide_of_points, runs, heard), strict=True):
        slides.setdefault(run.number, []).append(slide)
    ground = slider.ground
    PointSlidesAnswer(
        section=SectionLabel.of(config.section),
        points=int((ground.points.stratum >= 0).sum()),
        cell_m=ground.grid.cell,
        settled_by_m=far,
        softened=ground.softened,
        sides=ground.sides,
        cases={number: _answer(slides[alike[number]], ground) for number in wanted},
    ).write(job.store)
    job.store.remove(job.store.matching(["mpm/checkpoint_*"]))
    for number in wanted:
        if alike[number] != number:
            copy_frames(job.store, f"case{alike[number]}", f"case{number}", FOLDER)
        write_collection(job.store, f"case{number}", FOLDER)
    draw(job)


def alike_by_strength(config: Config, wanted: Sequence[int]) -> dict[int, int]:
    """For every case, return the first case in which the same layers keep the same strength. Material points do not
    depend on the other numbers of a case, so that such cases have the same slide.
    """
    remains = remaining(config)
    return first_equal({n: (tuple(remains[n].items()), config.cases[n - 1].volumetric_strain) for n in wanted})


def draw(job: Job) -> None:
    """Draw the surface of every case before and after, every case at its end, and its animation."""
    from workflow.figures.slides import point_profiles
    from workflow.stages.case_pictures import POINTS, case_pictures, draw_cases

    config, store, answer = job.config, job.store, PointSlidesAnswer.read(job.store)
    if answer.cases:
        store.save("figures/mpm.png", point_profiles(config, answer))
    job.executor.compute(draw_cases, case_pictures(config, store, POINTS, answer.cases))


def at_rest(config: Config, fewer: int = 1) -> "tuple[PointSlider, float]":
    """Return the material points of a section at rest under their weight, and their displacement on the way (m).

    The number of cells is the number in the settings divided by ``fewer``. Raises FloatingPointError if the ground has
    no equilibrium.
    """
    from fem.mpm.faces import with_firm_faces
    from fem.mpm.ground import ground_of
    from fem.mpm.slide import PointSlider

    ground = ground_of(config.section, config.slide.mpm_cells // fewer, config.sides_of_slides)
    slider = PointSlider(with_firm_faces(ground, config.fem), downhill(config.section.ground))
    return slider, slider.settle()


def slide_of_points(run: PointRun, tell: Tell) -> "PointSlide":
    """Compute a slide; ``tell`` is called with the finished share, the time (s) and the largest slide (m)."""
    from fem.mpm.slide import CHECK_INTERVAL, DECAY_RATES
    from fem.mpm.slide_record import earliest_rest

    programme, slider = programme_of(run.config, run.number), copy.deepcopy(run.slider)
    every = max(programme.duration / (run.config.slide.frames - 1), CHECK_INTERVAL)
    films = run.store if run.decay == DECAY_RATES[0] and not run.coarse else None

    def frame(number: int) -> None:
        from workflow.results.disc_grids import frame_file, write_points

        if films is not None:
            write_points(films, frame_file(f"case{run.number}", number, FOLDER), slider)

    least = min(earliest_rest(programme.rest_from), programme.duration)

    def look(time: float, slide: np.ndarray) -> None:
        tell((min(time / least, NEAR_END_SHARE), time, float(np.abs(slide).max())))
        if (time + TIME_TOLERANCE) % every < CHECK_INTERVAL - TIME_TOLERANCE:
            frame(int((time + TIME_TOLERANCE) / every))

    frame(0)
    followed = slider.run(programme, look, run.decay, run.checkpoint)
    frame(math.ceil((slider.engine.time - CHECK_INTERVAL) / every))  # the last one, if it is as late
    return followed


def programme_of(config: Config, number: int) -> "SlideProgramme":
    """Return loading of the ground and onset of liquefaction: a constant Kh, or a record, as for the discs."""
    from dem.slides.drive import LEAD_TIME, constant_kh_in_time
    from fem.mpm.slide import SlideProgramme
    from meshes.section.base_impedance import base_impedance
    from meshes.section.quantity import GRAVITY
    from workflow.stages.shaking import shaking_of

    settings, onset = config.slide, config.slide.onset_of("soil")
    case, remains = config.cases[number - 1], remaining(config)[number]
    strata = list(remains)
    shaking = shaking_of(config, strata)
    if shaking is not None:
        time, acceleration = shaking.time - shaking.time[0], shaking.acceleration
        last = max([float(time[-1]), *(start + onset for start in shaking.onsets.values())])
        return SlideProgramme(
            lambda t: np.interp(t, time, acceleration, right=0.0), dict(shaking.onsets), remains, onset, last,
            float(time[-1]) + settings.duration, settings.still, case.volumetric_strain,
            0.0 if shaking.of_the_base else base_impedance(config.section),
        )  # fmt: skip
    lead = LEAD_TIME["soil"]
    liquefied_at = lead + onset
    ends_at = None if settings.kh_seconds is None else liquefied_at + settings.kh_seconds
    times, kh = constant_kh_in_time(settings, downhill(config.section.ground), "soil")
    rest_from = liquefied_at if ends_at is None else ends_at + REST_DELAY
    return SlideProgramme(
        lambda t: GRAVITY * np.interp(t, times, kh), dict.fromkeys(strata, lead), remains, onset, rest_from,
        settings.duration, settings.still, case.volumetric_strain,
    )  # fmt: skip


def numerical_interval(slides: Sequence["PointSlide"]) -> tuple[float, float]:
    """Return the interval (m) of the largest slide by its numerical error, from the governing slide and from the slides
    in coarse cells with both damping rates.

    Slides converge with the first power of the size of the cells, so that the second slide gives the limit of fine
    cells (Richardson's extrapolation). The third slide shows the influence of the damping rate. All are compared where
    the governing slide is largest: in coarse cells other ground may slide farther, above layers thinner than a cell.
    """
    counts = slides[0]
    place = int(np.argmax(np.abs(counts.slide[-1])))
    x, sign = counts.surface_before[place, 0], 1.0 if counts.slide[-1][place] >= 0.0 else -1.0
    largest, coarse, slower = (sign * float(np.interp(x, each.surface_before[:, 0], each.slide[-1])) for each in slides)
    finer = largest + (largest - coarse) / (COARSE_RATIO - 1)
    ends = largest, max(largest + slower - coarse, 0.0), max(finer, 0.0)
    return min(ends), max(ends)


def _answer(slides: Sequence["PointSlide"], ground: "PointGround") -> PointCase:
    """Return the slide of a case with its error: its governing slide, and the slides for `numerical_interval`."""
    counts = slides[0]
    slide, settlement = counts.slide[-1], counts.settlement[-1]
    uphill_first = downhill(ground.section.ground) > 0  # of level ends, too, where slides count to the right
    thirds = [np.array_split(values if uphill_first else values[::-1], 3) for values in (slide, settlement)]
    names = ("uphill", "middle", "downhill")
    low, high = numerical_interval(slides)
    return PointCase(
        slide_max_m=counts.slide_max,
        slide_max_low_m=low,
        slide_max_high_m=high,
        slide_max_at_x_m=float(counts.surface_before[int(np.argmax(np.abs(slide))), 0]),
        **{f"slide_{name}_m": float(np.median(part)) for name, part in zip(names, thirds[0], strict=True)},
        **{f"settlement_{name}_m": float(np.median(part)) for name, part in zip(names, thirds[1], strict=True)},
        settlement_crest_m=float(counts.surface_before[:, 1].max() - counts.surface_after[:, 1].max()),
        settled=counts.settled,
        reason=counts.reason,
        seconds_simulated=counts.times[-1],
        transfer_loss_share=counts.transfer_loss_share,
        energy_lost_share=counts.energy_lost_share,
        stopped_by=counts.stopped_by,
        notes=tuple(_notes(counts, ground)),
        surface_before=line(counts.surface_before),
        surface_after=line(counts.surface_after[np.argsort(counts.surface_after[:, 0])]),
        slide_along=line(np.column_stack([counts.surface_before[:, 0], slide])),
    )


def _notes(slide: "PointSlide", ground: "PointGround") -> Iterator[str]:
    """Yield what a reader needs to judge the numbers of a slide."""
    from fem.mpm.slide import ENERGY_TOLERANCE

    lost = 100.0 * slide.energy_lost_share
    if abs(slide.energy_lost_share) > ENERGY_TOLERANCE and slide.slide_max > SMALLEST_DOUBTED_SLIDE:
        how = (
            "lost, so that the slide is a low estimate"
            if lost > 0.0
            else "gained, so that the slide is a high estimate"
        )
        yield f"{WARNING}{abs(lost):.0f} % of the energy is {how}"
    if slide.stopped_by and ground.sides == "fixed":
        yield f"the slide reached the {slide.stopped_by} side of the section, which stopped it"
    if ground.crust < THIN_CRUST * slide.cell:
        wanted = int(CELLS_STEP * np.ceil(ground.section.layering.areas().sum() / ground.crust**2 / CELLS_STEP))
        yield (
            f"{WARNING}the ground above the liquefied strata is {ground.crust:.2g} m thick, less than a cell, so that "
            f"its slide is not resolved; check with {wanted} cells (slide.mpm_cells)"
        )
    if ground.softened:
        listed = ", ".join(f'"{name}"' for name in ground.softened)
        single = len(ground.softened) == 1
        yield (
            f"{listed} {'has' if single else 'have'} a reduced stiffness, so that longer time steps are stable; "
            f"{'its strength is' if single else 'their strengths are'} unchanged"
        )
    for face in ground.firm_faces:
        yield (
            f'the cohesionless face of "{shown_name(face.stratum)}" from x = {face.start:.0f} to {face.end:.0f} m has '
            "an apparent cohesion, since without it the points on it do not come to rest before the slide"
        )


STAGE = Stage(
    name="mpm",
    description="slides of the continuum by material points",
    work=work,
    draw=draw,
    needs=("mesh",),
    reads=(
        "slide.kh", "slide.kh_seconds", "slide.kh_towards", "slide.kh_cycles", "slide.kh_period", "slide.unit",
        "slide.component",
        "slide.scale", "slide.frames", "slide.liquefies_at", "slide.onset", "slide.still", "slide.duration",
        "slide.mpm_cells", "slide.mpm_sides", "fem.sides", "fem.direction", "fem.least_depth", "fem.vertical",
        "site_response",
    ),
    ignores=of_the_record,
    takes=resolved_inputs,
    files=files,
    concurrent_after=("mesh",),
    results=(PointSlidesAnswer.FILE, "mpm/case*.pvd", "mpm/case*/*.vtp"),
    read=PointSlidesAnswer.read,
    pictures=("figures/mpm*.png", "figures/mpm*.webp"),
    leftovers=("mpm/checkpoint_*", "mpm/case*", "mpm/case*/*"),
    partial=lambda job: job.cases is not None,
    unwanted=lambda config: unless_it_liquefies(config) or ("" if "mpm" in config.slide.methods else "slide.methods"),
)  # fmt: skip
