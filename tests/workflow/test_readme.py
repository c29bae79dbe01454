"""What the README shows works as shown, and its numbers are those of `docs/numbers.toml`."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.support import TOP
from tests.support.docs import blocks, program
from workflow.config import Config
from workflow.report.paper import KC

README = (TOP / "README.md").read_text(encoding="utf-8")
SECTION, WET = blocks("toml", README)  # the second one is what a section with water adds to the first


def test_it_is_short() -> None:
    """600 words, and one screen of commands."""
    assert len(README.split()) <= 600
    assert len(SECTION.splitlines()) == 10
    (example,) = blocks("python", README)
    assert len(example.splitlines()) <= 15


def test_its_picture_is_there_and_small() -> None:
    (picture,) = re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)
    assert (TOP / picture).stat().st_size < 200_000


def test_its_numbers_come_from_the_file() -> None:
    """Every number of its sentences, in the order in which they stand."""
    numbers = program("generated").numbers()
    slopes, slides, s13, discs = (numbers[name] for name in ("published", "slides", "s13", "dem_throughput"))
    lines = README[README.index("## What it does") : README.index("## Documentation")]
    matches = re.findall(r"(?<![\w-])\d+(?:\.\d+)?", lines)
    packings = sorted(s13["kc_discs_of_packings"])
    expected = [
        slopes["cases"], slopes["right"], slopes["explained"], slopes["wrong"], slopes["gap_percent"],
        s13["kc_headline"], KC, s13["slide_points_m"], *dict.fromkeys((s13["slide_least_m"], s13["slide_most_m"])), 3,
        packings[0], packings[-1], round(s13["kc_box"], 3), round(s13["kc_box_upper"], 3),
        slides["experiment_within_1_5"], slides["experiment_run"], 1.5, slides["field_within_1_5"], slides["field_run"],
        discs["times_lammps"],
    ]  # fmt: skip
    assert [float(number) for number in matches] == [float(number) for number in expected]


def test_its_time_comes_from_the_file() -> None:
    """That of a first run as a newcomer does it, measured and rounded up."""
    minutes = re.findall(r"`make run` takes up to (\d+) minutes", README)
    assert minutes == [str(program("generated").numbers()["first_run"]["minutes"])]


def test_its_answers_come_from_the_file() -> None:
    first = program("generated").numbers()["readme"]
    (printed,) = blocks("text", README)
    digits = {"kc": 3, "factor": 3, "lower": 4, "upper": 4}
    shown = [f"{first[name]:.{count}f}" for name, count in digits.items()]
    assert re.findall(r"\d\.\d{3,}", printed) == shown
    assert re.findall(r"F_L down to (\d\.\d+)", README) == [f"{first['factor_of_liquefaction']:.2f}"]
    messages = README[README.index("prints 0") : README.index("## What it does")]
    assert re.findall(r"\d\.\d+", messages) == first["script"]


def test_the_section_is_read_and_what_the_script_imports_is_there() -> None:
    assert Config.parse(tomllib.loads(SECTION)).section.name == "my_slope"
    wet = Config.parse(tomllib.loads(SECTION + WET))
    assert wet.section.water_points() is not None
    assert wet.triggering.borings[0].name == "B-1"
    (example,) = blocks("python", README)
    lines = [line for line in example.splitlines() if line.startswith(("import ", "from "))]
    assert len(lines) >= 3
    exec("\n".join(lines), {})


@pytest.mark.slow
def test_the_script_runs(tmp_path: Path) -> None:
    """On the section of the page: elements and bounds as told, discs as near as rounding leaves them."""
    (tmp_path / "my_slope.toml").write_text(SECTION, encoding="utf-8")
    (example,) = blocks("python", README)
    done = subprocess.run(
        [sys.executable, "-c", example], cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False,
        env={**os.environ, "PYTHONPATH": str(TOP)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    values = [float(number) for number in re.findall(r"\d\.\d+", done.stdout)]
    messages = [float(number) for number in program("generated").numbers()["readme"]["script"]]
    assert len(values) == len(messages) == 5
    assert max(abs(a - b) for a, b in zip(values[:4], messages[:4], strict=True)) < 0.002
    assert abs(values[4] - messages[4]) < 0.03
