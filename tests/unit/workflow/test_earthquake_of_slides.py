"""Kh of the slides and its duration come from the earthquake; a distance that its peak overrules is not used."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dem.slides.drive import cyclic_acceleration
from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from tests.support import command_line
from tests.support.borings import bored, test
from tests.support.newmark import newmark_slide_speed
from tests.support.records import motion, peer
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.config.after_triggering import config_after_triggering
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.equivalent_kh import (
    SHARE_OF_PEAK,
    cycles_of_magnitude,
    cycles_of_record,
    mean_period,
    mean_period_of_record,
)
from workflow.estimates.comparison import block_drive
from workflow.estimates.empirical import empirical
from workflow.estimates.sliding_block import newmark
from workflow.report.tables import parameter_rows
from workflow.stages.liquefaction import lowest_factors
from workflow.stages.shaking import shaking_of
from workflow.study.fragility import block

LEVEE = {"magnitude": 7.4, "distance": "60 km", "peak_acceleration": "0.25 g"}


def with_shaking(earthquake: dict[str, Any], **slide: Any) -> Config:
    data = {**bored(), "earthquake": earthquake, **({"slide": slide} if slide else {})}
    data["triggering"]["share"] = 0.2  # so that one of the strata liquefies
    return analysed(data)


def test_kh_and_its_cycles_are_those_of_the_earthquake() -> None:
    """0.65 of 0.25 g is 0.1625; MSF of M 7.4 is 1.027 and makes 13.9 cycles; ln T = -1 + 0.225 + 0.228 + 0.27."""
    config = with_shaking(LEVEE)
    assert config.slide.kh == pytest.approx(0.1625, abs=6e-4)
    assert config.slide.kh_seconds is None
    assert config.slide.kh_cycles == pytest.approx(13.9, abs=0.06)
    assert config.slide.kh_period == pytest.approx(0.758, abs=6e-3)
    [loaded] = [text for text in config.notices if text.startswith("the Kh of the slides")]
    assert "follows from [earthquake]: 0.65 of the peak of 0.25 g" in loaded
    assert "in both directions in 13.9 cycles of M 7.4" in loaded
    again = analysed(tomllib.loads(config.to_toml()))
    assert (again.slide, again.notices) == (config.slide, config.notices)
    assert list(parameter_rows(again)) == list(parameter_rows(config))  # the source of a stored section is the same
    assert (
        config.slide.shaking
        == f"Kh = {config.slide.kh:g} in both directions (13.9 cycles, period {config.slide.kh_period:g} s)"
    )


def test_an_earthquake_without_a_peak_gives_its_cycles_and_is_asked_for_the_peak() -> None:
    """M 6 has 4.7 cycles, and 15 are those of M 7.5; "give [earthquake]" is no help to who gave one."""
    data = {**slope(), "earthquake": {"magnitude": 6.0}}
    data["strata"][1]["liquefies_in"] = [1]
    config = analysed(data)
    assert (config.slide.kh, config.slide.kh_cycles) == (0.1, round(cycles_of_magnitude(6.0), 1))
    [messages] = [text for text in config.notices if "is assumed, with the cycles of magnitude 6" in text]
    assert messages.startswith("[earthquake] has no peak acceleration;")
    assert ": give the peak, or" in messages
    assert analysed(tomllib.loads(config.to_toml())).notices == config.notices
    [messages] = [
        text for text in analysed({**data, "earthquake": {}}).notices if "is assumed, with the cycles" in text
    ]
    assert messages.startswith("no shaking of the slides is given;")
    assert "magnitude 7.5: give [earthquake]" in messages


@pytest.mark.parametrize("slide", [{"kh": 0.1}, {"kh_seconds": 10.0}, {"kh": 0.1, "kh_cycles": 5.0, "kh_period": 0.5}])
def test_another_push_than_that_of_the_earthquake_is_told(slide: dict[str, Any]) -> None:
    """Kh = 0.1 for ever beside an earthquake of 0.25 g: it counts, and a reader must know."""
    [messages] = [text for text in with_shaking(LEVEE, **slide).notices if "the slides use the given" in text]
    assert "the equivalent of [earthquake] is Kh = 0.163 in both directions (13.9 cycles, period 0.76 s)" in messages
    assert ("Kh = 0.1 in one direction without end" in messages) == (slide == {"kh": 0.1})
    assert not [text for text in with_shaking(LEVEE).notices if "the slides use the given" in text]
    assert not [text for text in with_shaking(LEVEE, kh=0.0).notices if "the slides use the given" in text], (
        "asked for by its name"
    )


def test_a_record_that_is_not_used_beside_another_peak_is_told(tmp_path: Path) -> None:
    record, values = tmp_path / "surface.AT2", motion(1, 400, 0.01)
    record.write_text(peer(0.25 * values / np.abs(values).max(), 0.01, "G"))
    for peak, item in (("0.9 g", True), ("0.25 g", False)):
        notices = with_shaking({**LEVEE, "peak_acceleration": peak, "record": str(record)}).notices
        unlike = [text for text in notices if "whose peak is 0.25 g, is not: give one of them" in text]
        assert bool(unlike) == item
        assert not item or unlike[0].endswith("or scale = 3.6")


def test_cycles_and_period_of_a_magnitude() -> None:
    """15 cycles at M 7.5, by definition; Rathje et al. (2004): 0.53 s for M 6.5 at 2 km on deep soil."""
    assert cycles_of_magnitude(7.5) == pytest.approx(15.0, abs=0.1)
    assert cycles_of_magnitude(6.5) == pytest.approx(6.9, abs=0.1)
    assert mean_period(6.5, 2000.0) == pytest.approx(np.exp(-1.0 + 0.09 + 0.0076 + 0.27))
    assert mean_period(6.5, 2000.0, "rock") == pytest.approx(np.exp(-1.0 + 0.09 + 0.0076))
    assert mean_period(9.0, 2000.0) == mean_period(7.25, 2000.0)


def test_layers_liquefy_when_their_cycles_have_passed() -> None:
    """After F_L^(1/0.34) of the shaking, after a calm in which strength may fade; without counts at once."""
    config = with_shaking(LEVEE)
    [stratum] = [k for k, item in enumerate(config.section.strata) if item.liquefies_in]
    shaking = shaking_of(config, [stratum])
    assert shaking is not None
    factor = lowest_factors(config)[stratum]
    assert factor is not None
    lasts = float(config.slide.kh_cycles or 0.0) * float(config.slide.kh_period or 0.0)
    assert shaking.onsets[stratum] == pytest.approx(lasts * factor ** (1.0 / 0.34))
    assert np.abs(shaking.acceleration[shaking.time < 5.0]).max() == 0.0
    assert np.abs(shaking.acceleration).max() == pytest.approx(config.slide.kh * GRAVITY, rel=2e-3)
    untested = analysed({**_without_borings(), "slide": {"kh": 0.1, "kh_cycles": 8.0, "kh_period": 0.5}})
    rest_from = shaking_of(untested, [0])
    assert rest_from is not None
    assert rest_from.onsets == {0: 0.0}


def test_cycles_want_a_period_and_no_seconds() -> None:
    for slide, item in (
        ({"kh_cycles": 8.0}, "kh_cycles and kh_period: expected both"),
        ({"kh_cycles": 8.0, "kh_period": 0.5, "kh_seconds": 4.0}, "kh_cycles and kh_seconds: expected one"),
        ({"kh_cycles": 8.0, "kh_period": 0.5, "accelerogram": "r.csv"}, "kh_cycles and accelerogram: expected one"),
    ):
        with pytest.raises(InputError, match=item):
            analysed({**_without_borings(), "slide": {"kh": 0.1, **slide}})


def _without_borings() -> dict[str, Any]:
    values = {key: value for key, value in bored().items() if key not in ("earthquake", "triggering")}
    for stratum in values["strata"]:
        stratum["liquefies_in"] = [1]
    return values


def test_what_the_slides_are_given_goes_before_the_earthquake(tmp_path: Path) -> None:
    config = with_shaking(LEVEE, kh=0.1)
    assert (config.slide.kh, config.slide.kh_seconds, config.slide.kh_cycles) == (0.1, None, None)
    assert not any(text.startswith("the Kh of the slides") for text in config.notices)
    config = with_shaking(LEVEE, kh_seconds=5.0)
    assert (config.slide.kh, config.slide.kh_seconds, config.slide.kh_cycles) == (
        with_shaking(LEVEE).slide.kh,
        5.0,
        None,
    )
    both_ways = with_shaking(LEVEE, kh=0.1, kh_cycles="earthquake", kh_period="earthquake").slide
    assert (both_ways.kh, both_ways.kh_cycles) == (0.1, with_shaking(LEVEE).slide.kh_cycles)
    (tmp_path / "a.AT2").write_text(peer(motion(1, 400, 0.01) / GRAVITY, 0.01, "G"))
    assert with_shaking(LEVEE, accelerogram=str(tmp_path / "a.AT2")).slide.kh == 0.1
    without = _without_borings()
    assert analysed(without).slide.kh == 0.1
    with pytest.raises(InputError, match='kh = "earthquake": expected'):
        analysed({**without, "slide": {"kh": "earthquake"}})
    assert with_shaking(LEVEE, kh="earthquake").slide == with_shaking(LEVEE).slide


def test_a_record_and_the_earthquake_do_not_both_shake_the_slides(tmp_path: Path) -> None:
    (tmp_path / "a.AT2").write_text(peer(motion(1, 400, 0.01) / GRAVITY, 0.01, "G"))
    with pytest.raises(InputError, match='kh = "earthquake": expected no accelerogram'):
        with_shaking(LEVEE, kh="earthquake", accelerogram=str(tmp_path / "a.AT2"))


def test_the_kh_of_a_site_response_reverses_in_the_cycles_of_the_earthquake(tmp_path: Path) -> None:
    (tmp_path / "rock.csv").write_text("time (s), a (g)\n0.0, 0.0\n0.1, 0.1\n0.2, -0.1\n0.3, 0.0\n")
    response = {"record": str(tmp_path / "rock.csv"), "slip_depth": "6 m"}
    requested = {"kh": "k_max", "kh_cycles": "earthquake", "kh_period": "earthquake"}
    slide = analysed({**bored(), "earthquake": LEVEE, "site_response": response, "slide": requested}).slide
    alone = analysed({**bored(), "earthquake": LEVEE, "site_response": response, "slide": {"kh": "k_max"}}).slide
    assert (slide.kh, alone.kh_cycles) == (alone.kh, None)
    assert (slide.kh_cycles, slide.kh_period) == (
        with_shaking(LEVEE).slide.kh_cycles,
        with_shaking(LEVEE).slide.kh_period,
    )


def test_samples_of_a_block_that_kh_pushes_for_ever_have_no_slide() -> None:
    """Neither those that it moves nor those that it does not: the mean of the latter would be none at all."""
    config, pulse = with_shaking(LEVEE, kh=0.1), with_shaking(LEVEE, kh=0.1, kh_seconds=2.0)
    assert [block(config, kc) for kc in (0.05, 0.2)] == [None, None]
    assert [block(pulse, kc) for kc in (0.05, 0.2)] == [pytest.approx(9.80665 * 0.01 * 4.0 / 0.1 * 0.5), 0.0]


def test_the_block_is_driven_as_the_slides() -> None:
    both_ways = block_drive(with_shaking(LEVEE))
    assert (both_ways.cycles, both_ways.period) == (
        with_shaking(LEVEE).slide.kh_cycles,
        with_shaking(LEVEE).slide.kh_period,
    )
    fixed = block_drive(with_shaking(LEVEE, kh=0.1))
    assert (fixed.slide(0.09, 0.1), fixed.slide(0.11, 0.1), fixed.description) == (math.inf, 0.0, "constant")
    assert block_drive(analysed({**bored(), "sliding_block": {"seconds": 4.0}})).seconds == 4.0
    # nothing below yield, and far less than a push of one way that lasts as long
    assert both_ways.slide(0.2, 0.16) == 0.0
    assert 0.0 < both_ways.slide(0.04, 0.16) < 0.1 * block_drive(with_shaking(LEVEE, kh_seconds=10.5)).slide(0.04, 0.16)


def test_a_record_counts_beside_the_peak_that_is_its_own(tmp_path: Path) -> None:
    """A peak that says nothing new takes no cycles away; one of another strength does, and it is told."""
    record, values = tmp_path / "surface.AT2", motion(1, 4000, 0.01)
    record.write_text(peer(0.25 * values / np.abs(values).max(), 0.01, "G"))
    data = {"magnitude": 7.4, "record": str(record)}
    alone, same, other = (
        with_shaking(data | peak).slide
        for peak in ({}, {"peak_acceleration": "0.25 g"}, {"peak_acceleration": "0.4 g"})
    )
    assert (same.kh_cycles, same.kh_period) == (alone.kh_cycles, alone.kh_period)
    assert same.kh == pytest.approx(alone.kh, abs=1e-3)
    assert other.kh_cycles == pytest.approx(13.9, abs=0.06) != alone.kh_cycles


def test_the_cycles_of_a_record_are_counted(tmp_path: Path) -> None:
    """10 s of a sine of 5 Hz: 100 half waves of the peak are ½ · 100 · 0.65^(-1/0.34) = 177.5 cycles of 0.2 s."""
    time = 0.01 * np.arange(2000)
    values = np.where((time >= 2.0) & (time < 12.0), 2.0 * np.sin(10.0 * np.pi * time + 0.1), 0.0)
    record = Accelerogram("a", "b", time, values)
    assert cycles_of_record(record) == pytest.approx(177.5, rel=0.02)
    assert mean_period_of_record(record) == pytest.approx(0.2, rel=0.02)
    shaking = np.where((time >= 2.0) & (time < 4.0), 2.0 * np.sin(10.0 * np.pi * time), 0.0)
    (tmp_path / "a.AT2").write_text(peer(shaking / GRAVITY, 0.01, "G"))
    slide = with_shaking({"magnitude": 7.4, "record": str(tmp_path / "a.AT2")}).slide
    assert slide.kh == pytest.approx(0.65 * 2.0 / GRAVITY, abs=1e-3)
    assert slide.kh_cycles == pytest.approx(35.5, rel=0.03)
    assert slide.kh_period == pytest.approx(0.2, abs=0.011)


def test_a_sample_of_the_earthquake_pushes_its_own_slides() -> None:
    config = analysed({
        **bored(), "earthquake": LEVEE,
        "uncertain": {"earthquake.magnitude": {"normal": [7.4, 0.1]}},
    })  # fmt: skip
    drawn = config_after_triggering(config.with_drawn({"earthquake.magnitude": 7.0}))
    assert drawn.slide.kh_cycles == pytest.approx(cycles_of_magnitude(7.0), abs=0.05)


def test_a_peak_that_contradicts_magnitude_and_distance_is_told() -> None:
    """Fukushima & Tanaka (1990) expect 143 gal of M 7.4 at 60 km, one standard deviation 88 to 231; 250 were given."""
    text = with_shaking(LEVEE).earthquake.contradiction()
    assert "[earthquake] is 245 gal, as given, where 143 gal are expected of M 7.4 at 60 km (88 to 231 gal;" in text
    assert "relations that need the distance use the given distance" in text
    assert with_shaking({**LEVEE, "peak_acceleration": "200 gal"}).earthquake.contradiction() == ""
    assert with_shaking({**LEVEE, "peak_acceleration": "60 gal"}).earthquake.contradiction() != ""
    assert with_shaking({key: LEVEE[key] for key in ("magnitude", "distance")}).earthquake.contradiction() == ""


@pytest.mark.parametrize(
    ("peak", "message"),
    [
        (0.25, "peak_acceleration is 0.0255 g, a plain number, in m/s^2; check its unit"),
        ("3.5 g", "peak_acceleration is 3.5 g, as written; check its unit"),
        ("0.1 g", ""),
        (2.5, ""),
    ],
)
def test_a_peak_in_another_unit_is_doubted(peak: str | float, message: str) -> None:
    warnings = [
        text for text in with_shaking({"magnitude": 7.4, "peak_acceleration": peak}).notices if "check its unit" in text
    ]
    assert warnings == ([f"earthquake, {message}"] if message else [])


def test_relations_of_the_distance_take_it_as_given_beside_a_peak_that_contradicts_it() -> None:
    data = bored()
    data["triggering"]["borings"][0]["spt"] = [test(3.0, 5, fines=10, d50=0.00025), test(5.0, 6, fines=10, d50=0.00025)]
    data["surface"] = [[0.0, 1.0], [100.0, 0.0]]

    def youd(earthquake: dict[str, Any]) -> Any:
        config = analysed({**data, "earthquake": earthquake})
        result = empirical(config.section, config, 0.1, np.zeros((0, 2)))
        return next(item for item in result if item.method.startswith("Youd"))

    agreeing, contradicting = youd({**LEVEE, "peak_acceleration": "150 gal"}), youd(LEVEE)
    assert agreeing.displacement_m is not None
    assert contradicting.displacement_m == agreeing.displacement_m  # magnitude and distance alone enter
    assert "contradicts the peak acceleration" not in agreeing.description
    assert contradicting.description.endswith("which contradicts the peak acceleration that other methods take")


@pytest.mark.parametrize(
    ("scale", "earthquake", "factor"),
    [
        (1.0, {"peak_acceleration": "0.25 g"}, ""),
        (1.6, {"peak_acceleration": "0.25 g"}, "1 "),
        (1.0, {"peak_acceleration": "0.4 g"}, "1.6 "),
        (
            0.6,
            {"magnitude": 7.4, "distance": "60 km"},
            "",
        ),  # within one standard deviation of 143 gal, which is 0.582 of 245
        (1.6, {"magnitude": 7.4, "distance": "60 km"}, "0.582 "),
    ],
)
def test_blocks_under_another_peak_than_that_of_the_earthquake_are_told(
    scale: float, earthquake: dict[str, Any], factor: str, tmp_path: Path
) -> None:
    """F_L was of 0.25 g and the slide of a block of 0.4 g, without a word."""
    values = motion(1, 2000, 0.01)
    (tmp_path / "a.AT2").write_text(peer(0.25 * values / np.abs(values).max(), 0.01, "G"))
    block_table = {"accelerogram": str(tmp_path / "a.AT2"), "scale": scale}
    config = analysed({**bored(), "earthquake": {"magnitude": 7.4, **earthquake}, "sliding_block": block_table})
    texts = [text for text in config.notices if "the record of [sliding_block]" in text]
    assert len(texts) == bool(factor)
    assert all(f"sliding_block.scale = {factor}gives both one peak" in text for text in texts)


def test_the_plan_says_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bored.toml"
    path.write_text(with_shaking(LEVEE).to_toml())
    assert command_line.run("run", path, "--dry-run", "--out", tmp_path / "run") == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Note: the Kh of the slides, 0.16" in out
    assert "143 gal are expected" in out


def test_cycles_have_no_mean_velocity_and_slide_a_block_as_a_sine_does() -> None:
    """Eight cycles, and eight hundred against one: Newmark's block slides as far in each whole cycle of a sine.

    A sine of amplitude A that slides from where A sin = ky to where both velocities are equal again; per cycle, found
    here by quadrature.
    """
    kh, ky, period = 0.3, 0.1, 0.8
    time, acceleration = cyclic_acceleration(kh, 8.0, period)
    velocity = np.append(0.0, np.cumsum(0.5 * (acceleration[1:] + acceleration[:-1]) * np.diff(time)))
    largest = kh * GRAVITY * period / (2.0 * np.pi)
    assert np.abs(velocity).max() == pytest.approx(largest, rel=0.01)
    assert abs(velocity[-1]) < 1e-3 * largest
    assert abs(np.mean(velocity)) < 0.02 * largest
    of_a_cycle = (_slid_in(kh, 21.0, period, ky) - _slid_in(kh, 11.0, period, ky)) / 10.0
    assert of_a_cycle == pytest.approx(_of_a_sine(kh, ky, period), rel=5e-3)
    assert _slid_in(kh, 8.0, period, ky) == pytest.approx(8.0 * of_a_cycle, rel=0.05)


def _slid_in(kh: float, cycles: float, period: float, ky: float) -> float:
    return newmark(*cyclic_acceleration(kh, cycles, period), ky).permanent


def _of_a_sine(kh: float, ky: float, period: float) -> float:
    """Slide (m) in a cycle: ∫ v dt, v = ∫ (A sin ωt - ky g) dt from A sin ωt = ky g until v = 0."""
    time = np.linspace(np.arcsin(ky / kh), 2.0 * np.pi + np.arcsin(ky / kh), 200_001) * period / (2.0 * np.pi)
    excess = GRAVITY * (kh * np.sin(2.0 * np.pi * time / period) - ky)
    speed = np.append(0.0, np.cumsum(0.5 * (excess[1:] + excess[:-1]) * np.diff(time)))
    stop = int(np.argmax(speed[1:] <= 0.0)) + 1
    return float(np.sum(0.5 * (speed[1:stop] + speed[: stop - 1]) * np.diff(time[:stop])))


@pytest.mark.parametrize(("share", "ratio"), [(0.1, 1.96), (0.25, 5.6), (0.5, 5.1), (0.7, 0.0)])
def test_cycles_drive_a_block_further_than_records_do(share: float, ratio: float) -> None:
    """Over the median of records, log D (cm) = -2.710 + log[(1 - r)^2.335 r^-1.478] + 0.424 M (Jibson 2007, eq. 7).

    M 7, a peak of 0.35 g, a yield coefficient of r times that; on this slope the block slides one way only.
    """
    magnitude, peak, angle = 7.0, 0.35, np.radians(20.0)
    cycles = cyclic_acceleration(SHARE_OF_PEAK * peak, cycles_of_magnitude(magnitude), mean_period(magnitude))
    slide = newmark_slide_speed(angle, float(np.tan(angle)) + share * peak, *cycles)
    median = 0.01 * 10.0 ** (-2.710 + 0.424 * magnitude) * (1.0 - share) ** 2.335 * share**-1.478
    assert slide / median == pytest.approx(ratio, rel=0.02)


@pytest.mark.parametrize("ratio", [0.02, 0.05, 0.1, 0.2])
@pytest.mark.parametrize(("magnitude", "peak"), [(6.0, 0.25), (6.5, 0.2), (7.0, 0.4), (7.5, 0.25)])
def test_a_block_slides_under_the_cycles_as_far_as_under_records(magnitude: float, peak: float, ratio: float) -> None:
    """Within a factor of two of the median of 2,383 records: E. M. Rathje, G. Saygili, Bull. NZ Soc. Earthq. Eng. 42
    (2009) 18-27: ln D = 4.89 - 4.85 r - 19.64 r² + 42.49 r³ - 29.06 r⁴ + 0.72 ln PGA + 0.89 (M - 6), D in cm, with
    r = ky/PGA.
    """
    polynomial = np.polyval([-29.06, 42.49, -19.64, -4.85, 4.89], ratio)
    median = 0.01 * np.exp(polynomial + 0.72 * np.log(peak) + 0.89 * (magnitude - 6.0))
    time, acceleration = cyclic_acceleration(
        SHARE_OF_PEAK * peak, cycles_of_magnitude(magnitude), mean_period(magnitude)
    )
    assert 0.5 < newmark(time, acceleration, ratio * peak).permanent / median < 2.0
