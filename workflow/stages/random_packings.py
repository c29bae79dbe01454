"""The cases once more on random packings that fail at the same Kh: does the lattice make the answer?"""

from collections.abc import Callable
from dataclasses import dataclass

from dem.model import DiscModel
from dem.search.calibration import Calibration, Calibrator, best, sensitivities
from dem.search.equilibrium import Trial
from dem.search.pushover import Continuum
from dem.settings import DemSettings
from dem.slides.liquefaction import Slide
from dem.team import Tell
from workflow.results.answer import Line
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import QUANTITIES, Profile, RandomCase, RandomPackings, Seed, Spread
from workflow.results.journal import Journal
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.settings import Input
from workflow.stages.discs_at_rest import discs_at_rest
from workflow.stages.sliding import Run, slid, task


@dataclass(frozen=True)
class First:
    """What the run itself has computed.

    Attributes
    ----------
    slides : dict of Slide
        Of every case that is wanted, by number.
    seed : Seed or None
        Its packing, where that is a random one.
    """

    slides: dict[int, Slide]
    seed: Seed | None

    @classmethod
    def of(cls, given: Input, slides: dict[int, Slide], store: Store) -> "First":
        """The slides of the calibrated discs, and with which packing they were computed."""
        found = CalibrationAnswer.read(store)
        if given.dem.model == "paper" or found.verdict == "out of reach":
            return cls(slides, None)
        before = found.predicted_kc if found.predicted_kc is not None else found.kc
        return cls(slides, Seed(
            seed=given.dem.seed, kc_before=before, parameter=found.parameter, value=found.value, kc=found.kc,
            verdict=found.verdict, reason=found.reason,
        ))  # fmt: skip


def random_packings(job: Job, continuum: Continuum, first: First) -> RandomPackings:
    """Mean, standard deviation and every value of slide and settlement over the seeds, for each case that is wanted.

    The ``first`` packing is that of the run itself. A seed whose packing cannot be brought to it is named with the
    reason, and not counted. Where a parameter has to be chosen the first seed does, and all others take the same.
    """
    given = job.given
    seeds: list[Seed] = [] if first.seed is None else [first.seed]
    slides = {number: [] if first.seed is None else [slide] for number, slide in first.slides.items()}
    parameter: str = "auto" if given.dem.parameter == "none" else given.dem.parameter
    others = [seed for seed in given.slide.packings(given.dem.model) if first.seed is None or seed != first.seed.seed]
    done = 0

    def heard(place: int, message: str) -> None:
        job.progress(f"random packing, seed {others[done + place]}: {message}", done / len(others))

    chosen = 1 if parameter == "auto" and given.dem.model == "paper" else 0
    for some in (others[:chosen], others[chosen:]):
        wanted = [Packing(given, job.store, continuum, seed, parameter, tuple(slides)) for seed in some]
        for seed, found in job.team(_packed, wanted, heard):
            seeds.append(seed)
            parameter = seed.parameter if given.dem.model == "paper" and seed.parameter != "none" else parameter
            for number, slide in found.items():
                slides[number].append(slide)
        done += len(some)
    return RandomPackings(seeds=tuple(seeds), cases={number: _case(slides[number]) for number in sorted(slides)})


@dataclass(frozen=True)
class Packing:
    """One random packing to be calibrated and let slide, by its seed, in the folder of the run."""

    given: Input
    store: Store
    continuum: Continuum
    seed: int
    parameter: str
    numbers: tuple[int, ...]


def _packed(packing: Packing, tell: Tell) -> tuple[Seed, dict[int, Slide]]:
    """How it was calibrated, and its slides by case; none where it is out of reach."""
    given, store, parameter = packing.given, packing.store, packing.parameter
    dem = given.dem.model_copy(update={"packing": "random", "seed": packing.seed, "parameter": parameter})
    calibrator = _calibrator(given, store, dem, packing.continuum, tell)
    if given.dem.model == "soil" and given.dem.parameter == "none":
        seed = _untouched(packing.seed)
    else:
        found = _calibrated(calibrator, packing.continuum.kc, parameter)
        parameter = found.parameter
        seed = _seed(packing.seed, calibrator, found)
    if seed.verdict == "out of reach":
        return seed, {}
    tell("slides")
    start = calibrator.settled_with(parameter, seed.value)
    tasks = [task(given, f"seed{packing.seed}", number, start, calibrator.ground) for number in packing.numbers]
    return seed, {each.number: slid(Run(given, store, each), lambda _: None) for each in tasks}


def _calibrator(
    given: Input, store: Store, dem: DemSettings, continuum: Continuum, tell: Callable[[str], None]
) -> Calibrator:
    """A calibrator of one random packing at rest, which goes on from what an earlier run found."""
    discs = discs_at_rest(given, store, dem, f"dem/slide_seed{dem.seed}_settled.h5", tell)

    def on_trial(trial: Trial, _model: DiscModel) -> None:
        tell(f"Kh = {trial.kh:.4f} {trial.verdict}")

    journal = Journal(store, f"dem/slide_seed{dem.seed}_trials.jsonl")
    return Calibrator(
        discs.ground, discs.layers, discs.settled, dem, continuum=continuum, known=journal.known(),
        on_search=journal.add, on_trial=on_trial,
    )  # fmt: skip


def _calibrated(calibrator: Calibrator, target: float, parameter: str) -> Calibration:
    """The factor that meets the target; "auto" looks first which parameter moves the critical Kh."""
    base = ("", 1.0, calibrator.search("", 1.0))
    choose = parameter == "auto" and calibrator.settings.model == "paper"
    return best(calibrator, target, parameter, sensitivities(calibrator) if choose else [base])


def _untouched(seed: int) -> Seed:
    """A packing of which no critical Kh was asked for."""
    return Seed(
        seed=seed, kc_before=None, parameter="none", value=1.0, kc=None, verdict="not asked for",
        reason='dem.parameter = "none"',
    )  # fmt: skip


def _seed(seed: int, calibrator: Calibrator, found: Calibration) -> Seed:
    return Seed(
        seed=seed,
        kc_before=calibrator.searches["", 1.0].kc,
        parameter=found.parameter,
        value=found.value,
        kc=found.search.kc,
        verdict=found.verdict,
        reason=found.reason,
    )


def _case(slides: list[Slide]) -> RandomCase:
    """One case over all packings that were calibrated."""
    last = [slide.rows[-1] for slide in slides]
    spreads = {name: Spread.of([getattr(row, name) for row in last]) for name in QUANTITIES}
    surfaces = [(as_line(slide.surface_before), as_line(slide.surface_after)) for slide in slides]
    return RandomCase.model_validate({**spreads, "profile": Profile.of(surfaces) if len(surfaces) > 1 else None})


def as_line(points: list[list[float]]) -> Line:
    """Points of a surface as an answer holds them."""
    return tuple((x, z) for x, z in points)
