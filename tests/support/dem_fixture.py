"""Provides small hand-made answers of the stages of the discs, for tests of the code that reads them.

The numbers do not follow from a computation; they are chosen so that sums can be checked by eye.
"""

from dataclasses import replace
from typing import Any

import pytest
from matplotlib.figure import Figure
from PIL import Image

from meshes.errors import NoAnswerError
from meshes.executor import Executor
from workflow.config import Config
from workflow.results.answer import SectionLabel
from workflow.results.calibration import (
    AssemblyProperties,
    CalibrationAnswer,
    FactorTrial,
    LayerTest,
    Sensitivity,
    SoilProperties,
)
from workflow.results.cases import CaseAnswer, CasesAnswer, RandomCase, RandomPackings, Seed, Spread
from workflow.results.continuum import FemAnswer
from workflow.results.discs import (
    DiscModelAnswer,
    DiscsAnswer,
    DiscSearch,
    KhTrial,
    Parameters,
    RecordedDiscs,
    SetOfSprings,
    SlipSurfaces,
)
from workflow.results.history import write_histories
from workflow.run.progress import Progress
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages import declared

SPRINGS = Parameters(springs="table2", stiffness_scale=0.01, mean="arithmetic")


def search(kc: float, largest: float = 0.4) -> DiscSearch:
    """Return a search that ended with a bracket of 0.01 around kc."""
    stood = KhTrial(
        kh=kc - 0.005, verdict="stands", reason="at rest", unbalanced_ratio=1e-5, kinetic_ratio=1e-9,
        displacement_m=0.05, elastic_displacement_m=0.04, seconds=3.0,
    )  # fmt: skip
    failed = KhTrial(
        kh=kc + 0.005, verdict="fails", reason="keeps moving", unbalanced_ratio=0.1, kinetic_ratio=0.01,
        displacement_m=largest, elastic_displacement_m=0.04, seconds=5.0,
    )  # fmt: skip
    return DiscSearch(
        parameters=SPRINGS, kc=kc, kc_lower=kc - 0.005, kc_upper=kc + 0.005, verdict="bracketed",
        reason="between a state that stands and one that fails", flexibility_m=0.2, trials=(stood, failed),
        curve=((0.0, 0.0), (0.5 * kc, 0.02), (kc - 0.005, 0.05), (kc + 0.005, largest)),
    )  # fmt: skip


def critical(run: Config, kc: float, cracked_elsewhere: dict[str, float] | None = None) -> DiscsAnswer:
    """Return discs that stand at Kh = 0.2 without a crack, and fail at 0.3 with a third of the pore springs cracked."""
    left, right = run.section.extent
    level = run.section.surface[-1][1] - 4.0
    surface = ((left, level), (right, level))
    sets: tuple[SetOfSprings, ...] = ("before", "after")
    states = tuple(
        RecordedDiscs(
            set=which, kh=kh, verdict="stands" if share == 0.0 else "fails", reason="by hand", unbalanced_ratio=1e-5,
            kinetic_ratio=1e-9, displacement_m=0.05, elastic_displacement_m=None, seconds=3.0, file="dem/none.npz",
            cracked_share_by_stratum={s.name: share for s in run.section.strata} | (cracked_elsewhere or {}),
            slip_surface=surface, largest_displacement_m=10 * share,
        )
        for which in sets
        for kh, share in ((0.2, 0.0), (0.3, 0.3))
    )  # fmt: skip
    return DiscsAnswer(
        section=SectionLabel.of(run.section),
        model=DiscModelAnswer(
            discs="paper",
            packing="box", rows=8, radius_m=0.75, elements=320, boundary_elements=50, tilt_deg=2.6, seed=None,
            porosity=0.1, unbalanced_ratio=9e-5, settling_seconds=1.5, pore_springs=900,
        ),
        before=search(0.31), after=search(kc), states=states,
        slip_surface=SlipSurfaces(
            dem=surface, dem_before=surface, fem=surface, mean_distance_m=1.25, same_stratum_share=0.75, columns=20
        ),
    )  # fmt: skip


def bracket(kc: float) -> dict[str, Any]:
    return {"kc": kc, "kc_lower": kc - 0.005, "kc_upper": kc + 0.005, "verdict": "bracketed", "reason": "by hand",
            "seconds": 4.0}  # fmt: skip


def calibration(kc: float, reached: bool) -> CalibrationAnswer:
    """Return a calibration by a factor on the stiffness, with one successful and one failed element test."""
    tested = LayerTest(
        stratum="upper", packing="lattice",
        soil=SoilProperties(E_Pa=3e7, nu=0.3, c_Pa=15e3, phi_deg=25.0),
        assembly=AssemblyProperties(
            E_Pa=2.9e7, nu=0.26, c_Pa=None, phi_deg=41.0, c_last_Pa=None, phi_last_deg=None, dilation_deg=20.0,
            G_Pa=1e7, c_shear_Pa=None, phi_shear_deg=None, E_2d_Pa=3e7, nu_2d=0.3,
        ),
    )  # fmt: skip
    failed = LayerTest(stratum="upper", packing="random", soil=None, assembly=None, reason="did not come to rest")
    return CalibrationAnswer(
        target_kc=kc, tolerance=0.005, parameter="stiffness", value=0.0075, range=(0.002, 0.05),
        kc=kc, kc_lower=kc - 0.005, kc_upper=kc + 0.005,
        verdict="calibrated" if reached else "out of reach", reason="within 0.005 of the target",
        sensitivity=tuple(
            Sensitivity(parameter=name, value=value, **bracket(at))
            for name, value, at in (("stiffness", 0.5, 0.27), ("stiffness", 2.0, 0.4), ("friction", 0.5, 0.3))
        ),
        trials=tuple(
            FactorTrial(value=value, **bracket(at)) for value, at in ((0.005, 0.2), (0.01, 0.31), (0.0075, kc))
        ),
        element_tests=(tested, failed),
    )  # fmt: skip


def case(stiffness: float, slide: float) -> CaseAnswer:
    return CaseAnswer(
        overlap=0.2,
        area_lost_share=0.0,
        notes=(),
        stiffness=stiffness, settlement_uphill_m=0.01 / stiffness, settlement_middle_m=0.005 / stiffness,
        settlement_downhill_m=0.0, slide_uphill_m=slide, slide_middle_m=0.5 * slide, slide_downhill_m=0.0,
        slide_max_m=slide, slide_max_at_x_m=30.0, slides_over_share=slide / 5.9, slides_over_share_uphill=slide / 5.9,
        slides_over_share_downhill=0.0, settled=slide < 4.0, reason="at rest" if slide < 4.0 else "the time is over",
        escaped=0, cracked_pore_springs=12, crack_opening_m=0.3, seconds_simulated=20.0, step_share=0.3,
        surface_before=((0.0, 20.0), (100.0, 10.0)), surface_after=((0.0, 19.5), (100.0, 10.0)),
    )  # fmt: skip


CASES = {1: case(0.1, 0.6), 2: case(0.02, 3.0), 3: case(0.01, 4.8)}


def draw(store: Store, name: str, title: str) -> None:
    """Write a small picture."""
    figure = Figure(figsize=(10, 3), dpi=160)
    figure.text(0.5, 0.5, title)
    with store.writing(name) as path:
        figure.savefig(path, format="png")


def calibrate_stage(run: Config, store: Store, progress: Progress, executor: Executor, reached: bool = True) -> None:
    """Replace the work of the calibration: write a growing journal, then the answer."""
    kc = FemAnswer.read(store).kc
    journal = store.folder / "dem/trials.jsonl"
    journal.parent.mkdir(exist_ok=True)
    with journal.open("a", encoding="utf-8") as file:
        file.write("{}\n")
    progress("Kh = 0.25, unbalanced ratio 3e-3", 0.5)
    store.write_text("dem/settled.npz", "settled")
    critical(run, kc).write(store)
    calibration(kc, reached).write(store)
    for name in ("dem_model", "dem_before_kh_0.20", "dem_after_kh_0.20"):
        draw(store, f"figures/{name}.png", name)
    if not reached:
        raise NoAnswerError("the range of stiffness does not reach it", "widen [dem] range")


def out_of_reach(run: Config, store: Store, progress: Progress, executor: Executor) -> None:
    """Replace the work of the calibration: report that it is out of reach."""
    calibrate_stage(run, store, progress, executor, reached=False)


def slide_stage(job: Job) -> None:
    """Replace the work of the slides: write the answers of the cases."""
    store, progress, cases = job.store, job.progress, job.cases
    CalibrationAnswer.read(store)
    wanted = {number: CASES[number] for number in CASES if cases is None or number in cases}
    for number in wanted:
        progress(f"case {number}: slide 1.2 m", 0.5)
        store.write_text(f"dem/case{number}.pvd", "<VTKFile/>")
        store.write_text(f"dem/case{number}/0.vtp", "<VTKFile/>")
        draw(store, f"figures/case{number}.png", f"case {number}")
        with store.writing(f"figures/case{number}.webp") as path:
            Image.new("RGB", (40, 20), "white").save(path, format="WEBP")
    write_histories(store, [])
    seed = Seed(seed=1, kc_before=0.4, parameter="stiffness", value=0.5, kc=0.3, verdict="calibrated", reason="")
    spread = Spread(mean=0.5, spread=0.1, values=(0.4, 0.6))
    first = RandomCase(slide_max_m=spread, settlement_uphill_m=spread, settlement_middle_m=spread)
    random = RandomPackings(seeds=(seed,), cases={1: first})
    CasesAnswer(sets={"calibrated": wanted}, random=random).write(store)
    draw(store, "figures/history.png", "history")


def stand_in(patch: pytest.MonkeyPatch, calibrate: Any = calibrate_stage, slide: Any = slide_stage) -> None:
    """Replace the stages that compute by these; their pictures cannot be drawn again."""
    patch.setattr("workflow.stages.calibrated_discs.calibrate_stage", calibrate)
    patch.setattr("workflow.stages.liquefied_slides.slide_stage", slide)
    made = (replace(stage, draw=None) if stage.name in ("calibrate", "slide") else stage for stage in declared.STAGES)
    patch.setattr("workflow.stages.declared.STAGES", tuple(made))
