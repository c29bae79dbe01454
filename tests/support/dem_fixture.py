"""What the stages of the discs leave behind, small and made by hand, for tests of what reads it.

The numbers are those of no computation; they are chosen so that sums can be checked by eye.
"""

import csv
import io
from dataclasses import replace
from typing import Any

import pytest
from matplotlib.figure import Figure
from PIL import Image

import workflow.stages
from workflow.run.errors import NoAnswerError
from workflow.run.progress import Progress
from workflow.run.store import Store
from workflow.settings import Input

SPRINGS = {"springs": "table2", "stiffness_scale": 0.01}


def search(kc: float, largest: float = 0.4) -> dict[str, Any]:
    trials = [
        {"kh": kc - 0.005, "verdict": "stands", "reason": "at rest", "unbalanced_ratio": 1e-5, "kinetic_ratio": 1e-9,
         "displacement_m": 0.05, "elastic_displacement_m": 0.04, "seconds": 3.0},
        {"kh": kc + 0.005, "verdict": "fails", "reason": "keeps moving", "unbalanced_ratio": 0.1, "kinetic_ratio": 0.01,
         "displacement_m": largest, "elastic_displacement_m": 0.04, "seconds": 5.0},
    ]  # fmt: skip
    return {
        "parameters": SPRINGS, "kc": kc, "kc_lower": kc - 0.005, "kc_upper": kc + 0.005, "verdict": "bracketed",
        "reason": "between a state that stands and one that fails", "trials": trials,
        "curve": [[0.0, 0.0], [0.5 * kc, 0.02], [kc - 0.005, 0.05], [kc + 0.005, largest]],
    }  # fmt: skip


def critical(run: Input, kc: float) -> dict[str, Any]:
    names = [stratum.name for stratum in run.strata]
    left, right = run.extent
    level = run.surface[-1][1] - 4.0
    surface = [[left, level], [right, level]]
    states = [
        {"set": which, "kh": kh, "verdict": verdict, "reason": "at rest" if verdict == "stands" else "keeps moving",
         "cracked_share_by_stratum": dict.fromkeys(names, share), "slip_surface": surface,
         "largest_displacement_m": 10 * share}
        for which in ("before", "after")
        for kh, verdict, share in ((0.2, "stands", 0.0), (0.3, "fails", 0.3))
    ]  # fmt: skip
    return {
        "section": {"name": run.name, "sha256": run.sha256(), "reconstruction": run.reconstruction},
        "model": {"packing": "box", "rows": 8, "radius_m": 0.75, "elements": 320, "boundary_elements": 50,
                  "tilt_deg": 2.6, "seed": None, "unbalanced_ratio": 9e-5, "settling_seconds": 1.5},
        "before": search(0.31), "after": search(kc), "states": states,
        "slip_surface": {"dem": surface, "fem": surface, "mean_distance_m": 1.25, "same_stratum_share": 0.75},
    }  # fmt: skip


def calibration(kc: float, reached: bool) -> dict[str, Any]:
    return {
        "target_kc": kc, "tolerance": 0.005, "parameter": "stiffness", "value": 0.0075, "range": [0.002, 0.05],
        "kc": kc, "kc_lower": kc - 0.005, "kc_upper": kc + 0.005,
        "verdict": "calibrated" if reached else "out of reach", "reason": "within 0.005 of the target",
        "sensitivity": [
            {"parameter": name, "value": value, "kc": at, "kc_lower": at - 0.005, "kc_upper": at + 0.005,
             "verdict": "bracketed"}
            for name, value, at in (("stiffness", 0.5, 0.27), ("stiffness", 2.0, 0.4), ("friction", 0.5, 0.3))
        ],
        "trials": [{"value": value, "kc": at, "kc_lower": at - 0.005, "kc_upper": at + 0.005, "seconds": 4.0}
                   for value, at in ((0.005, 0.2), (0.01, 0.31), (0.0075, kc))],
        "element_tests": [
            {"stratum": "upper", "packing": "lattice",
             "soil": {"E_Pa": 3e7, "nu": 0.3, "c_Pa": 15e3, "phi_deg": 25.0},
             "assembly": {"E_Pa": 2.9e7, "nu": 0.26, "c_Pa": None, "phi_deg": 41.0}},
        ],
    }  # fmt: skip


def case(stiffness: float, slide: float) -> dict[str, Any]:
    return {
        "stiffness": stiffness, "settlement_uphill_m": 0.01 / stiffness, "settlement_middle_m": 0.005 / stiffness,
        "settlement_downhill_m": 0.0, "slide_max_m": slide, "slide_max_at_x_m": 30.0, "slides_over_share": slide / 5.9,
        "settled": slide < 4.0, "reason": "at rest" if slide < 4.0 else "the time is over", "escaped": 0,
        "cracked_pore_springs": 12, "crack_opening_m": 0.3, "seconds_simulated": 20.0,
        "surface_before": [[0.0, 20.0], [100.0, 10.0]], "surface_after": [[0.0, 19.5], [100.0, 10.0]],
    }  # fmt: skip


CASES = {"1": case(0.1, 0.6), "2": case(0.02, 3.0), "3": case(0.01, 4.8)}


def draw(store: Store, name: str, title: str) -> None:
    """A small picture."""
    figure = Figure(figsize=(10, 3), dpi=160)
    figure.text(0.5, 0.5, title)
    with store.writing(name) as path:
        figure.savefig(path, format="png")


def calibrate_stage(run: Input, store: Store, progress: Progress, reached: bool = True) -> None:
    """As if calibrated: a journal that grows, then the answer."""
    kc = store.read_json("fem/critical.json")["kc"]
    journal = store.folder / "dem/trials.jsonl"
    journal.parent.mkdir(exist_ok=True)
    with journal.open("a", encoding="utf-8") as file:
        file.write("{}\n")
    progress("Kh = 0.25, unbalanced ratio 3e-3", 0.5)
    store.write_text("dem/settled.h5", "settled")
    store.write_json("dem/critical.json", critical(run, kc))
    store.write_json("dem/calibration.json", calibration(kc, reached))
    for name in ("dem_model", "dem_before_kh_0.20", "dem_after_kh_0.20"):
        draw(store, f"figures/{name}.png", name)
    if not reached:
        raise NoAnswerError("the range of stiffness does not reach it", "widen [dem] range")


def out_of_reach(run: Input, store: Store, progress: Progress) -> None:
    """As if the calibration were out of reach."""
    calibrate_stage(run, store, progress, reached=False)


def slide_stage(run: Input, store: Store, progress: Progress, cases: tuple[int, ...] | None) -> None:
    """As if the cases had been computed."""
    store.read_json("dem/calibration.json")
    wanted = {number: CASES[number] for number in CASES if cases is None or int(number) in cases}
    for number in wanted:
        progress(f"case {number}: slide 1.2 m", 0.5)
        store.write_text(f"dem/case{number}.pvd", "<VTKFile/>")
        store.write_text(f"dem/case{number}/0.vtp", "<VTKFile/>")
        draw(store, f"figures/case{number}.png", f"case {number}")
        with store.writing(f"figures/case{number}.gif") as path:
            Image.new("RGB", (40, 20), "white").save(path, format="GIF")
    table = io.StringIO()
    csv.writer(table).writerow(["set", "case", "time_s"])
    store.write_text("dem/history.csv", table.getvalue())
    spread = {"mean": 0.5, "spread": 0.1, "values": [0.4, 0.6]}
    seeds = [
        {
            "seed": 1,
            "kc_before": 0.4,
            "parameter": "stiffness",
            "value": 0.5,
            "kc": 0.3,
            "verdict": "calibrated",
            "reason": "",
        }
    ]
    random = {"seeds": seeds, "cases": {"1": {"slide_max_m": spread, "settlement_uphill_m": spread}}}
    store.write_json("dem/cases.json", {"sets": {"calibrated": wanted}, "random": random})
    draw(store, "figures/history.png", "history")


def stand_in(patch: pytest.MonkeyPatch, calibrate: Any = calibrate_stage, slide: Any = slide_stage) -> None:
    """Put these in the place of what computes; their pictures cannot be drawn again."""
    patch.setattr("workflow.stages.calibrated_discs.calibrate_stage", calibrate)
    patch.setattr("workflow.stages.liquefied_slides.slide_stage", slide)
    made = (
        replace(stage, draw=None) if stage.name in ("calibrate", "slide") else stage for stage in workflow.stages.STAGES
    )
    patch.setattr("workflow.stages.STAGES", tuple(made))
