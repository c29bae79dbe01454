"""Kh of the slides and its duration come from the earthquake; a distance that its peak overrules is not used."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from tests.support import command_line
from tests.support.borings import bored, test
from tests.support.records import motion, peer
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.equivalent_kh import duration_of_magnitude, significant_duration
from workflow.estimates.comparison import constant_seconds
from workflow.estimates.empirical import empirical
from workflow.settings import Input

LEVEE = {"magnitude": 7.4, "distance": "60 km", "peak_acceleration": "0.25 g"}


def shaken(earthquake: dict[str, Any], **slide: Any) -> Input:
    data = {**bored(), "earthquake": earthquake, **({"slide": slide} if slide else {})}
    data["triggering"]["share"] = 0.2  # so that one of the strata liquefies
    return Input.parse(data)


def test_kh_and_its_seconds_are_those_of_the_earthquake() -> None:
    """0.65 of 0.25 g is 0.1625; log D = 0.432 · 7.4 - 1.83 makes 23.3 s: Kh was 0.1 for ever."""
    given = shaken(LEVEE)
    assert given.slide.kh == pytest.approx(0.1625, abs=6e-4)
    assert given.slide.kh_seconds == pytest.approx(23.3, abs=0.05)
    [pushed] = [text for text in given.notices if text.startswith("slide, kh")]
    assert "of [earthquake]: 0.65 of the peak of 0.25 g" in pushed
    assert "M 7.4, 23.3 s" in pushed
    again = Input.parse(tomllib.loads(given.to_toml()))
    assert (again.slide, again.notices) == (given.slide, given.notices)
    assert given.slide.shaking == f"Kh = {given.slide.kh:g} for 23.3 s"


def test_what_the_slides_are_given_goes_before_the_earthquake(tmp_path: Path) -> None:
    given = shaken(LEVEE, kh=0.1)
    assert (given.slide.kh, given.slide.kh_seconds) == (0.1, None)
    assert not any(text.startswith("slide, kh") for text in given.notices)
    given = shaken(LEVEE, kh_seconds=5.0)
    assert (given.slide.kh, given.slide.kh_seconds) == (shaken(LEVEE).slide.kh, 5.0)
    (tmp_path / "a.AT2").write_text(peer(motion(1, 400, 0.01) / GRAVITY, 0.01, "G"))
    assert shaken(LEVEE, accelerogram=str(tmp_path / "a.AT2")).slide.kh == 0.1
    without = {key: value for key, value in bored().items() if key not in ("earthquake", "triggering")}
    for stratum in without["strata"]:
        stratum["liquefies_in"] = [1]
    assert Input.parse(without).slide.kh == 0.1
    with pytest.raises(InputError, match='kh = "earthquake": expected'):
        Input.parse({**without, "slide": {"kh": "earthquake"}})
    assert shaken(LEVEE, kh="earthquake").slide == shaken(LEVEE).slide


def test_the_block_is_pushed_as_long_as_the_slides() -> None:
    assert constant_seconds(shaken(LEVEE)) == shaken(LEVEE).slide.kh_seconds
    assert constant_seconds(shaken(LEVEE, kh=0.1)) == 10.0
    assert constant_seconds(Input.parse({**bored(), "sliding_block": {"seconds": 4.0}})) == 4.0


def test_a_record_says_how_long(tmp_path: Path) -> None:
    """Constant power from 2 to 12 s: 5 to 95 % of it takes 9 s."""
    time = 0.01 * np.arange(2000)
    values = np.where((time >= 2.0) & (time < 12.0), 2.0 * np.sin(10.0 * np.pi * time), 0.0)
    assert significant_duration(Accelerogram("a", "b", time, values)) == pytest.approx(9.0, abs=0.03)
    (tmp_path / "a.AT2").write_text(peer(values / GRAVITY, 0.01, "G"))
    slide = shaken({"magnitude": 7.4, "record": str(tmp_path / "a.AT2")}).slide
    assert (slide.kh, slide.kh_seconds) == (pytest.approx(0.65 * 2.0 / GRAVITY, abs=1e-3), pytest.approx(9.0, abs=0.06))
    assert duration_of_magnitude(6.5) == pytest.approx(9.51, abs=0.01)


def test_a_sample_of_the_earthquake_pushes_its_own_slides() -> None:
    given = Input.parse({
        **bored(), "earthquake": LEVEE,
        "uncertain": {"earthquake.magnitude": {"normal": [7.4, 0.1]}},
    })  # fmt: skip
    drawn = given.with_drawn({"earthquake.magnitude": 7.0})
    assert drawn.slide.kh_seconds == pytest.approx(10.0 ** (0.432 * 7.0 - 1.83), abs=0.05)


def test_a_peak_that_contradicts_magnitude_and_distance_is_told() -> None:
    """Fukushima & Tanaka (1990) expect 143 gal of M 7.4 at 60 km, one standard deviation 88 to 231; 250 were given."""
    told = shaken(LEVEE).earthquake.contradiction()
    assert "its peak is 245 gal, as given, where 143 gal are expected of M 7.4 at 60 km (88 to 231;" in told
    assert "relations that need the distance are not used" in told
    assert shaken({**LEVEE, "peak_acceleration": "200 gal"}).earthquake.contradiction() == ""
    assert shaken({**LEVEE, "peak_acceleration": "60 gal"}).earthquake.contradiction() != ""
    assert shaken({key: LEVEE[key] for key in ("magnitude", "distance")}).earthquake.contradiction() == ""


@pytest.mark.parametrize(
    ("peak", "told"),
    [
        (0.25, "peak_acceleration is 0.0255 g, a plain number, in m/s^2; check its unit"),
        ("3.5 g", "peak_acceleration is 3.5 g, as written; check its unit"),
        ("0.1 g", ""),
        (2.5, ""),
    ],
)
def test_a_peak_in_another_unit_is_doubted(peak: str | float, told: str) -> None:
    doubts = [
        text for text in shaken({"magnitude": 7.4, "peak_acceleration": peak}).notices if "check its unit" in text
    ]
    assert doubts == ([f"earthquake, {told}"] if told else [])


def test_the_distance_that_was_overruled_is_not_used() -> None:
    data = bored()
    data["triggering"]["borings"][0]["spt"] = [test(3.0, 5, fines=10, d50=0.00025), test(5.0, 6, fines=10, d50=0.00025)]
    data["surface"] = [[0.0, 1.0], [100.0, 0.0]]

    def youd(earthquake: dict[str, Any]) -> Any:
        found = empirical(Input.parse({**data, "earthquake": earthquake}), 0.1, np.zeros((0, 2)))
        return next(one for one in found if one.method.startswith("Youd"))

    assert youd({**LEVEE, "peak_acceleration": "150 gal"}).displacement_m is not None
    overruled = youd(LEVEE)
    assert overruled.displacement_m is None
    assert "the distance of 60 km contradicts the peak acceleration" in overruled.words


def test_the_plan_says_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bored.toml"
    path.write_text(shaken(LEVEE).to_toml())
    assert command_line.run("run", path, "--dry-run", "--out", tmp_path / "run") == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Mind: slide, kh = 0.16" in out
    assert "143 gal are expected" in out
