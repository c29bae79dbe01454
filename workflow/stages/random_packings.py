"""Computes the cases on random packings of the same critical Kh, which show the influence of the packing."""

from collections.abc import Sequence
from dataclasses import dataclass

from dem.search.calibration import calibrated
from dem.search.pushover import Continuum
from dem.slides.slide import Slide
from meshes.executor import Tell
from workflow.config import Config
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import QUANTITIES, Profile, RandomCase, RandomPackings, Seed, Spread
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.discs_at_rest import calibrator_for, continuum_for, discs_at_rest
from workflow.stages.sliding import SlideTask, first_alike, slide_of_discs, task

Packed = tuple[Seed, dict[int, Slide]]  # how it was calibrated, and its slides by case


@dataclass(frozen=True)
class RandomPackingsRequest:
    """Holds the random packings that are computed in addition to the packing of the run itself.

    A seed whose packing cannot be calibrated to the critical Kh is named with the reason, and not counted. If the
    parameter of the calibration has to be chosen, the first packing determines it for all others.

    Attributes
    ----------
    config, store : the config, and the folder of the run.
    continuum : the FEM model that the discs are calibrated to.
    numbers : numbers of the cases.
    of_run : packing of the run itself, if it is a random one.
    """

    config: Config
    store: Store
    continuum: Continuum
    numbers: tuple[int, ...]
    of_run: Seed | None

    @classmethod
    def of(cls, config: Config, store: Store, numbers: Sequence[int]) -> "RandomPackingsRequest":
        """Return the random packings that the settings of a run with calibrated discs request."""
        continuum = continuum_for(config, store)
        return cls(config, store, continuum, tuple(numbers), _own_seed(config, CalibrationAnswer.read(store)))

    @property
    def _chooses(self) -> bool:
        return self.config.dem.model == "paper" and self.config.dem.parameter in ("auto", "none")

    def _packings(self, parameter: str) -> list["PackingTask"]:
        seeds = self.config.slide.packings(self.config.dem.model)
        others = [seed for seed in seeds if self.of_run is None or seed != self.of_run.seed]
        first = 1.0 if self.of_run is None else self.of_run.value
        return [
            PackingTask(self.config, self.store, self.continuum, seed, parameter, self.numbers, first)
            for seed in others
        ]

    def first_packings(self) -> list["PackingTask"]:
        """Return the packings that can be computed first: all packings, or only the packing that determines the
        calibrated parameter."""
        parameter = self.config.dem.parameter
        packings = self._packings("auto" if parameter == "none" else parameter)
        return packings[:1] if self._chooses else packings

    def answer(self, job: Job, packings: list["Packed"], own_slides: dict[int, Slide]) -> RandomPackings:
        """Return the mean, standard deviation and every value of slide and settlement over the seeds, for each case.

        ``packings`` are the packings of `first_packings`, ``own_slides`` the slides of the run itself.
        """
        if self._chooses and packings:
            seed = packings[0][0]
            later = self._packings(seed.parameter if seed.parameter != "none" else "auto")[1:]
            packings = [
                *packings,
                *job.executor.compute(
                    calibrated_packing, later, lambda place, message: job.progress(later[place].message(message), None)
                ),
            ]
        seeds, slides = [seed for seed, _ in packings], [slides for _, slides in packings]
        if self.of_run is not None:
            seeds, slides = [self.of_run, *seeds], [own_slides, *slides]
        cases = {number: _case([each[number] for each in slides if number in each]) for number in sorted(self.numbers)}
        return RandomPackings(seeds=tuple(seeds), cases=cases)


def _own_seed(config: Config, calibration: CalibrationAnswer) -> Seed | None:
    """Return the packing of the run itself; None if it is a lattice, or could not be calibrated."""
    if config.dem.model == "paper" or calibration.verdict == "out of reach":
        return None
    before = calibration.predicted_kc if calibration.predicted_kc is not None else calibration.kc
    return Seed.taken(calibration, seed=config.dem.seed, kc_before=before)


@dataclass(frozen=True)
class PackingTask:
    """Holds one random packing, given by its seed, to be calibrated and used for slides in the folder of the run. The
    calibration begins with the factor of the packing of the run itself, ``initial_factor``, which is often near enough.
    """

    config: Config
    store: Store
    continuum: Continuum
    seed: int
    parameter: str
    numbers: tuple[int, ...]
    initial_factor: float = 1.0

    def message(self, text: str) -> str:
        """Return the message of a packing, with its seed."""
        return f"random packing, seed {self.seed}: {text}"


def calibrated_packing(packing: PackingTask, tell: Tell) -> Packed:
    """Compute the calibration of a packing and its slides by case; no slides if the calibration is out of reach."""
    config, store, parameter = packing.config, packing.store, packing.parameter
    dem = config.dem.changed(packing="random", seed=packing.seed, parameter=parameter)
    discs = discs_at_rest(config, store, dem, f"dem/slide_seed{dem.seed}_settled.npz", tell)
    calibrator = calibrator_for(
        discs, store, dem, f"dem/slide_seed{dem.seed}_trials.jsonl",
        lambda trial: tell(f"Kh = {trial.kh:.4f} {trial.verdict}"), packing.continuum,
        until_failed=False,
    )  # fmt: skip
    if config.dem.model == "soil" and config.dem.parameter == "none":
        seed = Seed(
            seed=packing.seed, kc_before=None, parameter="none", value=1.0, kc=None, verdict="not asked for",
            reason='dem.parameter = "none"',
        )  # fmt: skip
    else:
        choose = parameter == "auto" and dem.model == "paper"
        calibration = calibrated(calibrator, packing.continuum, one_at_a_time=choose, first=packing.initial_factor)
        parameter = calibration.parameter
        before = calibrator.searches.get(("", 1.0))
        seed = Seed.taken(
            calibration, seed=packing.seed, kc_before=before.kc if before is not None else None,
            kc=calibration.search.kc,
        )  # fmt: skip
    if seed.verdict == "out of reach":
        return seed, {}
    tell("slides")
    start = calibrator.settled_with(parameter, seed.value)
    tasks = [task(config, f"seed{packing.seed}", number, start, calibrator.ground) for number in packing.numbers]
    alike = first_alike(config, tasks)
    # whether a case is a flow failure is decided by the packing of the run alone
    slides = {
        each: slide_of_discs(
            SlideTask(config, store, each, by_weight=False), _in_words(config.called(each.number), tell)
        )
        for each in dict.fromkeys(alike.values())
    }
    return seed, {each.number: slides[alike[each]] for each in tasks}


def _in_words(case: str, tell: Tell) -> Tell:
    """Return a listener to the progress of the slide of a case, which reports the progress in words."""

    def heard(message: tuple[float, float, float, float]) -> None:
        seconds, slide, *_others = message
        tell(f"{case}: t = {seconds:.1f} s, slide {slide:.2f} m")

    return heard


def _case(slides: list[Slide]) -> RandomCase:
    """Return one case over all packings that were calibrated."""
    last = [slide.rows[-1] for slide in slides]
    spreads = {name: Spread.of([getattr(row, name) for row in last]) for name in QUANTITIES}
    surfaces = [(slide.surface_before, slide.surface_after) for slide in slides]
    return RandomCase.model_validate({**spreads, "profile": Profile.of(surfaces) if len(surfaces) > 1 else None})
