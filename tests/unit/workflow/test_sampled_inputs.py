"""Samples of an input: each is an input of its own, whatever it has of water, records, borings and earthquake."""

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from meshes.errors import InputError, NoAnswerError
from tests.support.borings import bored
from tests.support.sections import analysed, slope
from workflow.config.after_triggering import config_after_triggering
from workflow.results.study import StudyAnswer
from workflow.run.store import Store
from workflow.study.parts import PARTS
from workflow.study.study import Study, statistics_of, task_of
from workflow.study.table import SampleRow, SampleTable
from workflow.study.task import Numbers
from workflow.uncertain.sampling import samples

FRICTION = {"strata.loose.friction_angle": {"normal": ["32 deg", "2 deg"]}}


def record(folder: Path) -> str:
    """A burst of 0.3 g at 2 Hz in a file."""
    time = np.arange(0.0, 4.0, 0.01)
    burst = 0.3 * np.sin(4.0 * np.pi * time) * np.exp(-(((time - 2.0) / 0.8) ** 2))
    path = folder / "rock.csv"
    path.write_text("time (s), a (g)\n" + "\n".join(f"{t:.2f}, {a:.9f}" for t, a in zip(time, burst, strict=True)))
    return str(path)


def plain(folder: Path) -> dict[str, Any]:
    return bored()


def water(folder: Path) -> dict[str, Any]:
    """Water with its pressure, which cuts the loose sand in two."""
    data = bored()
    data["water"] = {"table": data.pop("water_table")}
    for stratum in data["strata"]:
        del stratum["density_ordinary"], stratum["density_seismic"]
        stratum |= {"density": "1.7 t/m^3", "density_saturated": "1.9 t/m^3"}
    return data


def cones(folder: Path) -> dict[str, Any]:
    data = water(folder)
    tests = [{"depth": 1.5 + 0.5 * k, "qc": "2.5 MPa" if k < 9 else "18 MPa", "fs": "15 kPa"} for k in range(12)]
    data["triggering"] = {"method": "boulanger_idriss_2014", "borings": [{"name": "C-1", "x": 50.0, "cpt": tests}]}
    return data


def residual(folder: Path) -> dict[str, Any]:
    """Four cases: one of the slide's own, three of the blow counts; and pore pressure in what does not liquefy."""
    data = water(folder)
    data["triggering"] |= {"cases": ["median", "low strength", "high strength"], "pore_pressure": True}
    return {**data, "slide": {"cases": [{"stiffness": 0.1}]}}


def shaking(folder: Path) -> dict[str, Any]:
    data, file = water(folder), record(folder)
    data["earthquake"] = {"magnitude": 7.5, "record": file}
    data["site_response"] = {"record": file, "slip_depth": 5.0}
    return {**data, "slide": {"kh": "k_max"}, "sliding_block": {"accelerogram": file}}


KINDS = (plain, water, cones, residual, shaking)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_a_sample_is_the_same_input_where_it_is_computed(kind: Any, part: Any, tmp_path: Path) -> None:
    read = analysed({**kind(tmp_path), "uncertain": FRICTION, "study": {"samples": 4}})
    for drawn in samples(read.uncertain, read.study, read.reach):
        sample = config_after_triggering(read.with_drawn(drawn))
        there = analysed(task_of(sample, part, Store(tmp_path)).argument.data)
        assert kind is plain or any(stratum.liquefiable for stratum in sample.section.strata)
        if part.name == "slide":
            assert there.cases == sample.cases
            assert [item.liquefies_in for item in there.section.strata] == [
                entry.liquefies_in for entry in sample.section.strata
            ]
            assert there.slide.kh == sample.slide.kh
        for here, of_sample in zip(there.section.strata, sample.section.strata, strict=True):
            loose = {"liquefies_in": sample.section.strata[0].liquefies_in}
            assert here.model_copy(update=loose) == of_sample.model_copy(update=loose)


def test_a_part_that_reads_no_borings_is_not_computed_again_for_others(tmp_path: Path) -> None:
    def prints(data: dict[str, Any]) -> dict[str, str]:
        read = analysed(data)
        return {part.name: task_of(read, part, Store(tmp_path)).fingerprint for part in PARTS}

    before, after = prints(water(tmp_path)), prints({**water(tmp_path), "earthquake": {"magnitude": 6.5,
                                                                    "peak_acceleration": "300 gal"}})  # fmt: skip
    assert {name for name in before if before[name] != after[name]} == {"slide"}


def test_the_mean_acceleration_of_a_sample_is_that_of_its_own_ground(tmp_path: Path) -> None:
    stiffness = {"strata.*.youngs_modulus": {"uniform": [0.5, 2.0], "does": "factor"}}
    read = analysed({**shaking(tmp_path), "uncertain": stiffness})
    soft, stiff = (
        config_after_triggering(read.with_drawn({"strata.*.youngs_modulus": factor})) for factor in (0.5, 2.0)
    )
    assert soft.slide.kh != stiff.slide.kh


@pytest.mark.parametrize(("mean", "deviation"), [(5.0, 3.0), (10.0, 5.0)])
def test_a_normal_strength_is_cut_off_at_zero_and_a_person_hears_how_much_of_it(mean: float, deviation: float) -> None:
    read = analysed({
        **slope(), "uncertain": {"strata.upper.cohesion": {"normal": [f"{mean} kPa", f"{deviation} kPa"]}},
        "study": {"samples": 64},
    })  # fmt: skip
    drawn = [sample["strata.upper.cohesion"] for sample in samples(read.uncertain, read.study, read.reach)]
    exact = stats.truncnorm(-mean / deviation, math.inf, mean, deviation)
    assert min(drawn) >= 0.0
    assert stats.kstest(drawn, exact.cdf).statistic < 0.04
    share = 100.0 * float(stats.norm.cdf(-mean / deviation))
    (notice,) = [text for text in read.notices if text.startswith("uncertain")]
    assert f"{share:.2g} % of its normal distribution lie below 0.0 kPa and are cut off" in notice


@pytest.mark.parametrize(
    ("path", "distribution", "words"),
    [
        ("strata.upper.cohesion", {"uniform": ["-1 kPa", "30 kPa"]}, "it reaches -1 kPa: out of range"),
        ("strata.upper.poissons_ratio", {"triangular": [0.2, 0.3, 0.6]}, "a Poisson's ratio from 0 to below 0.5"),
        ("strata.upper.friction_angle", {"list": ["95 deg", "25 deg"]}, "'95 deg' in its list"),
        ("slide.kh", {"normal": [0.2, 0.1], "truncation": [-0.5, 0.5]}, "it reaches -0.5: expected at least 0"),
    ],
)  # fmt: skip
def test_an_end_that_was_written_down_and_cannot_be_is_refused(
    path: str, distribution: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError) as caught:
        analysed({**slope(), "uncertain": {path: distribution}})
    assert len(caught.value.problems) == 1
    assert words in caught.value.problems[0]
    assert caught.value.problems[0].startswith(f'uncertain, "{path}": ')


PATHS = {
    "strata.loose.cohesion": (0.0, 30.0, " kPa"),
    "strata.loose.friction_angle": (0.0, 50.0, " deg"),
    "strata.loose.poissons_ratio": (0.05, 0.45, ""),
    "strata.dense.youngs_modulus": (1.0, 100.0, " MPa"),
    "earthquake.peak_acceleration": (0.05, 1.0, " g"),
    "slide.kh": (0.0, 0.5, ""),
}
# a mean of 0 is a person's input; what cannot be judged as such is a median beyond what soils have
SMALLEST = {"strata.loose.cohesion": 1.0, "slide.kh": 0.01}


@settings(max_examples=10, deadline=None)
@given(data=st.data(), path=st.sampled_from(sorted(PATHS)), spread=st.floats(0.05, 3.0))
def test_whatever_is_drawn_is_an_input(data: st.DataObject, path: str, spread: float) -> None:
    """However wide a distribution is about a sound mean: no sample is refused for the value that was drawn."""
    low, high, unit = PATHS[path]
    mean = data.draw(st.floats(max(low, SMALLEST.get(path, 0.05 * high)), high))
    law = {"normal": [f"{mean}{unit}" if unit else mean, f"{spread * mean}{unit}" if unit else spread * mean]}
    read = analysed({**bored(), "uncertain": {path: law}, "study": {"samples": 16}})
    for drawn in samples(read.uncertain, read.study, read.reach):
        read.with_drawn(drawn)


def test_what_is_drawn_is_not_judged_as_what_a_person_writes() -> None:
    data = copy.deepcopy(slope())
    data["uncertain"] = {"strata.upper.cohesion": {"uniform": ["0 kPa", "6 kPa"]}}
    read = analysed(data)
    assert read.with_drawn({"strata.upper.cohesion": 0.0415}).section.strata[0].cohesion == pytest.approx(41.5)
    data["strata"][0]["cohesion"] = "0.0415 kPa"
    with pytest.raises(InputError, match="is implausible"):
        analysed(data)
    data["uncertain"] = {"strata.upper.cohesion": {"uniform": ["0.03 kPa", "0.05 kPa"]}}  # its median is a person's
    with pytest.raises(InputError, match="is implausible"):
        analysed(data)


def answer_of(rows: list[SampleRow], parts: tuple[str, ...]) -> StudyAnswer:
    read = analysed({**slope(), "uncertain": {"strata.upper.cohesion": {"uniform": ["1 kPa", "6 kPa"]}}})
    return statistics_of(read, SampleTable({"strata.upper.cohesion": "kPa"}, rows), parts)


def test_a_part_without_any_answer_is_told_with_its_reason_once() -> None:
    drawn = {"strata.upper.cohesion": 2.0}
    rows = [
        SampleRow(drawn, Numbers(numbers={"kc": 0.1}), f"slide: the discs fail at {0.1234 + 0.01 * k:.4f}", ("fem",))
        for k in range(3)
    ]
    answer = answer_of(rows, ("fem", "slide"))
    assert answer.parts_without_answer == ("slide",)
    assert [(failure.samples, failure.reason) for failure in answer.failures] == [
        (3, "slide: the discs fail at 0.1234")
    ]
    with pytest.raises(NoAnswerError, match="slide: none of 3 samples has an answer; 3 of them: slide: the discs fail"):
        Study(SampleTable({"strata.upper.cohesion": "kPa"}, rows), answer).refuse_parts_without_answer()
    answer = answer_of([*rows, SampleRow(drawn, Numbers(numbers={}), "", ("fem", "slide"))], ("fem", "slide"))
    assert answer.parts_without_answer == ()
