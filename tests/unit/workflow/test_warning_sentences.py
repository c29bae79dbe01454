"""Warnings of the report: failed calibration, notes of cases, and differences of discs and continuum."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from tests.support import dem_fixture
from tests.support.answers import fem, liquefying_config, report_text, results, warned
from tests.support.sections import analysed, assessment, slope
from workflow.config import Config
from workflow.earthquake.site_response import warning as strain_warning
from workflow.report.warnings import _of_cases, _unresolved, merged_notes
from workflow.results.cases import CasesAnswer
from workflow.results.continuum import PathStep
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.triggering import TriggeringAnswer


@pytest.fixture
def run() -> Config:
    return liquefying_config()


def test_what_is_doubtful_is_told(run: Config) -> None:
    guessed = analysed({**slope(), "reconstruction": True, "reconstruction_note": "drawn from memory"})
    calibration = dem_fixture.calibration(0.24, True)
    discs = dem_fixture.critical(guessed, 0.24)
    warnings = warned(results(guessed, dem=discs, calibration=calibration))
    assert warnings[0] == "The ground is a reconstruction. Confirm the depths of the layers by borings."
    assert "only with the stiffness of the contacts multiplied by 0.0075." in warnings[1]
    assert warnings[-1].startswith("The discs are in rows, which must climb over each other to slide.")
    model = discs.model.model_copy(update={"packing": "random"})
    loose = warned(results(guessed, dem=discs.model_copy(update={"model": model}), calibration=calibration))
    assert "rows" not in " ".join(loose)
    slid = CasesAnswer(sets={"calibrated": {3: dem_fixture.case(0.1, 3.0)}}, random=None)
    assert "discs calibrated to the critical Kh of the finite" in report_text(
        results(run, calibration=calibration, cases=slid)
    )
    out_of_reach = results(run, calibration=dem_fixture.calibration(0.24, False), cases=slid)
    assert "discs whose calibration failed, with the critical Kh nearest to that of the finite elements" in report_text(
        out_of_reach
    )
    [failed] = [item for item in warned(out_of_reach) if item.startswith("Calibration")]
    assert failed.startswith("Calibration failed, since no factor on the strength of the discs gives the critical Kh")


def test_notes_that_say_the_same_of_cases_are_one_warning() -> None:
    """With a range where their numbers differ, and the remedy of the first; numbers in names are no numbers."""
    notes = {
        1: (
            "1.2 % of the area is gone: beyond 3 m²",
            'stratum "layer 4" is 2.4 m thick: take less',
            "sand of Ac1 is thin",
        ),
        2: ("it slides 10 m within 20 s, a flow failure: mind", "3.4 % of the area is gone: beyond 8 m²"),
        3: ("it slides 9.9 m within 20 s, a flow failure: mind", 'stratum "layer 5" is 2.4 m thick: take less'),
    }
    assert list(merged_notes(notes)) == [
        "it slides 9.9 to 10 m within 20 s, a flow failure (cases 2 and 3): mind",
        "1.2 to 3.4 % of the area is gone (cases 1 and 2): beyond 3 m²",
        'stratum "layer 4" is 2.4 m thick (case 1): take less',
        'stratum "layer 5" is 2.4 m thick (case 3): take less',
        "sand of Ac1 is thin (case 1)",
    ]


def test_a_target_of_the_discs_that_is_not_sharp_is_told(run: Config) -> None:
    """Where the path of the continuum went on far above its last equilibrium."""
    step = PathStep(
        length=1.0, displacement=0.02, factor=0.16, iterations=3, residual=0.0, plastic_share=0.3, cutbacks=0,
        at_rest=False, balanced=True,
    )  # fmt: skip
    like = DemCounterpart.of(fem(run, 0.16).model_copy(update={"curve": (step,)}))
    result = results(run, dem=dem_fixture.critical(run, 0.16), dem_counterpart=like)
    assert not any("boundary conditions of the discs" in item for item in warned(result))
    wide = like.model_copy(update={"kc_upper": 0.226, "flow": "non-associated"})
    warnings = warned(results(run, dem=dem_fixture.critical(run, 0.16), dem_counterpart=wide))
    assert (
        "of the discs (free-field sides, non-associated flow with the given ψ) fail between Kh = 0.160 and 0.226, "
        "so that discs that fail" in warnings[0]
    )


def test_discs_that_fail_elsewhere_than_the_continuum_are_told(run: Config) -> None:
    discs = dem_fixture.critical(run, 0.16)

    def message(**slip: object) -> list[str]:
        surfaces = discs.slip_surface.model_copy(update=slip)
        return warned(results(run, dem=discs.model_copy(update={"slip_surface": surfaces})))

    height = float(run.section.outline()[:, 1].max() - run.section.outline()[:, 1].min())
    assert any("m apart vertically on average" in warning for warning in message(mean_distance_m=0.3 * height))
    assert not any("m apart vertically on average" in warning for warning in message(mean_distance_m=0.2 * height))
    messages = message(mean_distance_m=None, dem=((0.0, 1.0), (9.0, 1.0)), fem=((20.0, 1.0), (31.0, 1.0)))
    assert any("from x = 0 to 9 m, the finite elements from 20 to 31 m" in warning for warning in messages)
    assert not any("Discs fail from" in warning for warning in message(mean_distance_m=None, fem=()))


def test_discs_that_fail_below_their_critical_kh_where_it_is_held_are_told(run: Config) -> None:
    """Those of the fixture fail at 0.3."""
    assert (
        "calibrated discs fail under a constant Kh = 0.3, below their critical Kh of 0.360 under prescribed"
        in " ".join(warned(results(run, dem=dem_fixture.critical(run, 0.36))))
    )
    assert not any("constant Kh" in item for item in warned(results(run, dem=dem_fixture.critical(run, 0.24))))


def test_a_slide_of_material_points_that_its_cells_leave_open_is_told(run: Config) -> None:
    """S-13: 0.96 m in its cells, 2 m in cells twice as large: 0 to 0.96 m, which only a column of a table said."""

    def warned_of(low: float, most: float, high: float) -> list[str]:
        case = SimpleNamespace(slide_max_m=most, slide_max_low_m=low, slide_max_high_m=high)
        both = cast(Any, SimpleNamespace(mpm=SimpleNamespace(cases={1: case, 2: case})))
        return list(_unresolved(both))

    assert warned_of(0.0, 0.96, 0.96) == [
        "by its numerical error alone the slide by material points is 0 to 0.96 m (cases 1 and 2): take more cells "
        "(slide.mpm_cells)"
    ]
    assert warned_of(0.6, 0.96, 0.96) == []
    assert len(warned_of(0.9, 0.96, 2.1)) == 1
    assert warned_of(0.0, 0.05, 0.05) == []


def test_slides_of_discs_without_a_second_opinion_by_points_are_warned_of() -> None:
    """Gravel at its angle of repose had slides by discs alone, of which only a section of the report told."""
    case = SimpleNamespace(escaped=False, notes=())

    def warned_of(reason: str) -> list[str]:
        points = SimpleNamespace(cases={}, not_possible=reason)
        return list(_of_cases(cast(Any, SimpleNamespace(case_set=lambda: ("", {1: case}), mpm=points))))

    assert warned_of("") == []
    [warning] = warned_of("the ground does not come to rest")
    assert warning.startswith("the material point method cannot compute the slides, so that those of the discs")


def test_a_large_strain_in_the_response_is_observed_before_the_colon(run: Config) -> None:
    """ "Response of the layers to r.EW." stood as the observation, and the strain as its remedy."""
    response = cast(Any, SimpleNamespace(record="r.EW", warning=strain_warning(0.0062)))
    [sentence] = [item for item in warned(results(run, response=response)) if "r.EW" in item]
    assert sentence.startswith(
        "In the response of the layers to r.EW the largest shear strain is 0.62 %, above 0.5 %. "
    )


@pytest.mark.parametrize(
    ("blows", "share", "reported"), [((4, 40), 0.6, True), ((4, 40), 0.3, False), ((40, 40), 0.6, False)]
)
def test_a_stratum_that_liquefies_in_a_part_too_small_to_count_is_reported(
    blows: tuple[int, int], share: float, reported: bool
) -> None:
    """Tailings with F_L below 1 in 45 % of them, and P_L of 22 at one boring, had a run without a word of it."""
    tests = [[{"depth": depth, "N": count, "fines": 5} for depth in (4.0, 6.0)] for count in blows]
    data = {
        **slope(),
        "water": {"table": [[0, 18], [100, 9]]},
        "earthquake": {"magnitude": 7.5, "peak_acceleration": "0.2 g"},
        "triggering": {
            "share": share,
            "borings": [{"name": f"B{x}", "x": x, "spt": spt} for x, spt in zip((30, 70), tests, strict=True)],
        },
    }
    for stratum in data["strata"]:
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3", "liquefies_in": "triggered"}
        del stratum["density_ordinary"], stratum["density_seismic"]
    data["strata"] = [{**data["strata"][1], "name": "sand"}]
    config = analysed(data)
    answer = TriggeringAnswer.of(config, assessment(config))
    texts = [text for text in warned(results(config, triggering=answer)) if "from which a stratum counts" in text]
    assert bool(texts) == reported
    assert all('% of "sand" below water, less than the 60 % from' in text for text in texts)
