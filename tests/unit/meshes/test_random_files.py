"""Random drawings written by ezdxf and random borings written by python-ags4 come back as what they were made from."""

import math
import tomllib
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pandas
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from python_ags4 import AGS4

from meshes.borings.ags4_file import read_ags4
from meshes.borings.blows import is_refusal
from meshes.borings.connect import ConnectedBorings, connected
from meshes.borings.section_text import text_of
from meshes.drawings.dxf_file import read_dxf
from meshes.section.section import Section

SOIL = {"density": "18 kN/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "cohesion": "10 kPa",
        "friction_angle": "30 deg"}  # fmt: skip
UNITS = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 10: 0.9144, 14: 0.1, 21: 1200 / 3937}  # m, by $INSUNITS
WAYS = ("closed", "bulged", "lines", "open", "unclosed", "space", "spline", "periodic", "block")
ONLY_LENSES = ("bulged", "spline", "periodic", "unclosed")
WIDE = 60.0

FEW = settings.default.max_examples // 5  # files take a second to write and to read


@dataclass
class Drawn:
    """A random drawing: the area (m²) of each name, and how many words, loose lines and water tables it has."""

    path: Path
    areas: dict[str, float]
    loose: int
    water: int


def drawing(seed: int, path: Path) -> Drawn:
    """Layers over the whole width under a slope, with lenses in them, each outline drawn in another way."""
    rng = np.random.default_rng(seed)
    unit = int(rng.choice(list(UNITS)))
    document = ezdxf.new(units=unit)
    space, metre = document.modelspace(), 1.0 / UNITS[unit]
    x = np.sort(np.concatenate([[0.0, WIDE], rng.uniform(5.0, WIDE - 5.0, 3)]))
    lines = [np.sort(rng.uniform(18.0, 30.0, 5))[::-1]]
    for _ in range(int(rng.integers(2, 5))):
        lines.append(lines[-1] - rng.uniform(4.0, 8.0, 5))
    areas: dict[str, float] = {}
    for k, (top, bottom) in enumerate(pairwise(lines)):
        ring = np.vstack([np.column_stack([x, top]), np.column_stack([x, bottom])[::-1]])
        name, way = f"Layer {k}", str(rng.choice([way for way in WAYS if way not in ONLY_LENSES]))
        draw(space, ring * metre, name, way)
        areas[name] = area(ring)
        if rng.random() < 0.6:
            lens_area = draw_lens(space, rng, x, top, bottom, metre, str(rng.choice(["Lens", "Core"])), areas)
            areas[name] -= lens_area
    loose = int(rng.integers(0, 3))
    for _ in range(loose):
        space.add_text("not ground", dxfattribs={"layer": "Words"})
        space.add_line((0, 0), (metre, -metre), dxfattribs={"layer": "Hatching"})
    water = int(rng.integers(0, 3))
    for number in range(water):
        ends = rng.uniform(10.0, 17.0, 2) - 8.0 * number  # lines whose ends meet would be one
        space.add_line(
            (0, ends[0] * metre), ((WIDE - 20.0 * number) * metre, ends[1] * metre), dxfattribs={"layer": "WATER"}
        )
    document.saveas(path, fmt=str(rng.choice(["asc", "bin"])))
    return Drawn(path, areas, loose, water)


def draw_lens(space: Any, rng: np.random.Generator, x: np.ndarray, top: np.ndarray, bottom: np.ndarray, metre: float,
              name: str, areas: dict[str, float]) -> float:  # fmt: skip
    """A lens within a layer, where that has room; returns its area (m²)."""
    half = float(rng.uniform(3.0, 8.0))
    middle = float(rng.uniform(half + 1.0, WIDE - half - 1.0))
    at = np.linspace(middle - half, middle + half, 33)
    high, low = np.interp(at, x, top).min() - 0.5, np.interp(at, x, bottom).max() + 0.5
    if high - low < 0.6:
        return 0.0
    way = str(rng.choice(WAYS))
    centre, rise = 0.5 * (high + low), 0.5 * min(high - low, half)
    ring = np.array(
        [[middle - half, centre], [middle, centre - rise], [middle + half, centre], [middle, centre + rise]]
    )
    draw(space, ring * metre, name, way)
    size = area(ring)
    if way == "bulged":
        chords = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
        angle = 4.0 * math.atan(BULGE)
        size += float((0.5 * (0.5 * chords / math.sin(0.5 * angle)) ** 2 * (angle - math.sin(angle))).sum())
    elif way == "spline":
        size = math.pi * half * rise
    elif way == "periodic":
        size *= PERIODIC
    areas[name] = areas.get(name, 0.0) + size
    return size


BULGE = 0.1
PERIODIC = (
    61 / 90
)  # area of a closed cubic B-spline of four points in a rhombus over that of the rhombus, by integration


def draw(space: Any, ring: np.ndarray, layer: str, way: str) -> None:
    on = {"layer": layer}
    if way == "bulged":
        space.add_lwpolyline([(px, pz, BULGE) for px, pz in ring], format="xyb", close=True, dxfattribs=on)
    elif way == "lines":
        for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            space.add_line(tuple(start), tuple(end), dxfattribs=on)
    elif way == "open":
        space.add_lwpolyline([*map(tuple, ring), tuple(ring[0])], dxfattribs=on)
    elif way == "unclosed":
        space.add_lwpolyline([*map(tuple, ring)], dxfattribs=on)
    elif way == "space":
        space.add_polyline3d([(px, pz, 0.0) for px, pz in ring], close=True, dxfattribs=on)
    elif way == "spline":
        (left, z), right, high = ring[0], ring[2][0], ring[3][1]
        angles = np.linspace(0.0, 2.0 * math.pi, 49)
        a, b = 0.5 * (right - left), high - z
        space.add_spline([(left + a + a * math.cos(t), z + b * math.sin(t), 0) for t in angles], dxfattribs=on)
    elif way == "periodic":  # its knots are not repeated, so that it has no ends
        space.add_spline(dxfattribs=on).set_closed([(px, pz, 0.0) for px, pz in ring])
    elif way == "block":  # mirrored, at half of its size, on the layer on which it is inserted
        block = space.doc.blocks.new_anonymous_block()
        block.add_lwpolyline([(-0.5 * px, 0.5 * pz) for px, pz in ring], close=True, dxfattribs={"layer": "0"})
        space.add_blockref(block.name, (0, 0), dxfattribs={**on, "xscale": -2.0, "yscale": 2.0})
    else:
        space.add_lwpolyline([*map(tuple, ring)], close=True, dxfattribs=on)


def area(ring: np.ndarray) -> float:
    (x, z), (x1, z1) = ring.T, np.roll(ring, -1, axis=0).T
    return abs(float(0.5 * (x * z1 - x1 * z).sum()))


@given(seed=st.integers(0, 100_000))
@settings(max_examples=FEW, deadline=None)
def test_random_drawings_come_back(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    made = drawing(seed, tmp_path_factory.mktemp("dxf") / "drawn.dxf")
    read = read_dxf(made.path, "made")
    data = tomllib.loads(read.text)
    data["strata"] = [stratum | SOIL for stratum in data["strata"]]
    # Not parsed, which thins dense lines: it says so, and has tests of its own.
    section = Section.model_validate({key: value for key, value in data.items() if key != "water"})
    result: dict[str, float] = dict.fromkeys(made.areas, 0.0)
    for stratum, size in zip(section.strata, section.layering.areas(), strict=True):
        result[max((name for name in made.areas if stratum.name.startswith(name)), key=len)] += float(size)
    for name, size in made.areas.items():
        assert result[name] == pytest.approx(size, abs=0.02 * WIDE), (name, read.text)
    text = "\n".join(read.notices)
    assert ("TEXT on layer Words" in text) == (made.loose > 0)
    assert text.count('on layer "Hatching"') == (1 if made.loose else 0)
    assert ("on layer Hatching that lies on another one" in text) == (made.loose == 2)
    assert ("water" in data) == (made.water > 0)
    assert text.count('on layer "WATER"') == max(made.water - 1, 0)


@given(seed=st.integers(0, 100_000))
@settings(max_examples=FEW, deadline=None)
def test_random_lines_come_back(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    """A slope of lines alone, in any order and direction: some go on past the ground, and one of fill ends at it."""
    rng = np.random.default_rng(seed)
    document = ezdxf.new(units=6)
    crest, toe, levels = rng.uniform(14.0, 20.0), rng.uniform(6.0, 9.0), 4.0 - np.cumsum(rng.uniform(0.5, 4.0, 3))
    shoulder, foot = rng.uniform(10.0, 25.0), rng.uniform(30.0, 50.0)
    level = rng.uniform(toe + 1.0, crest - 1.0)  # of the bottom of the fill
    end = shoulder + (foot - shoulder) * (crest - level) / (crest - toe)
    past = rng.choice([0.0, 3.0], (3, 2))
    lines = [
        ("Ground", [(0.0, crest), (shoulder, crest), (foot, toe), (WIDE, toe)]),
        ("Fill", [(0, level), (end, level)]),
    ]
    lines += [(f"Layer {k}", [(-past[k, 0], z), (WIDE + past[k, 1], z)]) for k, z in enumerate(levels)]
    for k in rng.permutation(len(lines)):
        name, points = lines[k]
        document.modelspace().add_lwpolyline(points[:: int(rng.choice([1, -1]))], dxfattribs={"layer": name})
    document.saveas(path := tmp_path_factory.mktemp("dxf") / "lines.dxf")
    read = read_dxf(path, "made")
    data = tomllib.loads(read.text)
    made = Section.model_validate({**data, "strata": [stratum | SOIL for stratum in data["strata"]]})
    fill = (crest - level) * 0.5 * (shoulder + end)
    above = (crest - levels[0]) * shoulder + (0.5 * (crest + toe) - levels[0]) * (foot - shoulder)
    above += (toe - levels[0]) * (WIDE - foot) - fill
    expected = [fill, above, *(-np.diff(levels) * WIDE)]
    assert [stratum.name for stratum in made.strata] == ["Fill", "Layer 0", "Layer 1", "Layer 2"]
    assert made.layering.areas() == pytest.approx(expected, abs=0.01)
    assert not any("ends inside" in text for text in read.notices)


OLD = {"LOCA": "HOLE", "WSTG": "WSTK", "WSTG_DPTH": "WSTK_DEP"}  # names of AGS3
FEET = {"m": 1.0, "ft": 0.3048, "cm": 0.01}
COUNTS = (("4", 4, False), ("12", 12, False), ("31", 31, False), ("50/75mm", 50, True), (">50", 50, True),
          ("N=50 (25 for 60mm/50 for 105mm)", 50, True), ("36 for 200mm", 50, True))  # fmt: skip


def borings(seed: int, path: Path) -> list[dict[str, Any]]:
    """Borings on a line, of layers that are met once or twice, in random units; written by python-ags4, or as AGS3."""
    rng = np.random.default_rng(seed)
    unit = {key: str(rng.choice(list(FEET))) for key in ("LOCA_NATE", "LOCA_GL", "GEOL_TOP", "GEOL_BASE", "ISPT_TOP")}
    made = []
    for k in range(int(rng.integers(2, 6))):
        names: list[str] = []
        for name in rng.choice(["CLAY", "SAND", "SILT"], int(rng.integers(1, 6))):
            names += [] if names and names[-1] == name else [str(name)]
        depths = np.cumsum(np.concatenate([[0.0], rng.uniform(1.0, 4.0, len(names))])).round(2)
        tests = [(round(float(depth), 2), COUNTS[int(rng.integers(len(COUNTS)))])
                 for depth in np.arange(0.7, depths[-1] - 0.5, 1.3)]  # fmt: skip
        water = round(float(rng.uniform(0.0, depths[-1])), 2) if rng.random() < 0.5 else None
        energy = int(rng.integers(40, 90)) if rng.random() < 0.5 else None
        made.append({"name": f"B{k}", "x": 20.0 * k, "level": round(float(rng.uniform(20.0, 30.0)), 2), "names": names,
                     "depths": depths, "tests": tests, "water": water, "energy": energy})  # fmt: skip

    def size(value: float, key: str) -> str:
        return f"{value / FEET[unit.get(key, 'm')]:.6f}"

    rows = {
        "LOCA": (("LOCA_ID", "LOCA_NATE", "LOCA_NATN", "LOCA_GL"),
                 [(b["name"], size(b["x"], "LOCA_NATE"), "5.00", size(b["level"], "LOCA_GL")) for b in made]),
        "GEOL": (("LOCA_ID", "GEOL_TOP", "GEOL_BASE", "GEOL_GEOL"),
                 [(b["name"], size(top, "GEOL_TOP"), size(base, "GEOL_BASE"), name) for b in made
                  for name, (top, base) in zip(b["names"], pairwise(b["depths"]), strict=True)]),
        "ISPT": (("LOCA_ID", "ISPT_TOP", "ISPT_NVAL", "ISPT_REP", "ISPT_ERAT"),
                 [(b["name"], size(top, "ISPT_TOP"), "" if refused else text, text, str(b["energy"] or ""))
                  for b in made for top, (text, _, refused) in b["tests"]]),
        "WSTG": (("LOCA_ID", "WSTG_DPTH"), [(b["name"], f"{b['water']:.2f}") for b in made if b["water"] is not None]),
    }  # fmt: skip
    tables, headings, old = {}, {}, ""
    for group, (keys, data) in rows.items():
        if data:
            units = ["" if key.endswith(("_ID", "GEOL_GEOL", "NVAL", "REP")) else "%" if key.endswith("ERAT") else
                     unit.get(key, "m") for key in keys]  # fmt: skip
            lines = [["UNIT", *units], ["TYPE", *("X" for _ in keys)], *(["DATA", *row] for row in data)]
            tables[group] = pandas.DataFrame(lines, columns=["HEADING", *keys])
            headings[group] = ["HEADING", *keys]
            named = [OLD.get(key, key).replace("LOCA_", "HOLE_") for key in keys]
            old += "".join(",".join(f'"{cell}"' for cell in line) + "\n" for line in (
                [f"**{OLD.get(group, group)}"], [f"*{key}" for key in named], ["<UNITS>", *units[1:]], *data
            ))  # fmt: skip
    if rng.random() < 0.3:
        path.write_text(old, encoding="utf-8")
        return made
    AGS4.dataframe_to_AGS4(tables, headings, str(path), warnings=False)
    return made


@given(seed=st.integers(0, 100_000))
@settings(max_examples=FEW, deadline=None)
def test_random_borings_come_back(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("ags") / "made.ags"
    made = borings(seed, path)
    read = read_ags4(path)
    for boring, log in zip(made, read.logs, strict=True):
        assert (log.name, log.location[0]) == (boring["name"], pytest.approx(boring["x"], abs=1e-4))
        assert [layer.name for layer in log.layers] == boring["names"]
        assert [layer.bottom for layer in log.layers] == pytest.approx(boring["depths"][1:], abs=1e-5)
        assert [sample.depth for sample in log.samples] == pytest.approx(
            [t + 0.3 for t, _ in boring["tests"]], abs=1e-5
        )
        for sample, (_, (_, blows, refused)) in zip(log.samples, boring["tests"], strict=True):
            assert (sample.N, is_refusal(sample.N), sample.energy_ratio) == (blows, refused, boring["energy"])
        water = None if boring["water"] is None else pytest.approx(boring["level"] - boring["water"], abs=1e-5)
        assert log.water_level == water
    refused = sum(test[1][2] for boring in made for test in boring["tests"])
    assert any("a refusal counts as the smallest" in text for text in read.notices) == (refused > 0)
    result = connected(read.logs)
    data = tomllib.loads(text_of(result, "made"))
    Section.parse({**data, "strata": [stratum | SOIL for stratum in data["strata"]]})
    assert ("table" in data["water"]) == any(boring["water"] is not None for boring in made)
    for k, boring in enumerate(made):
        here = column(result, 2 * k)[: len(boring["names"])]
        assert [name for name, _ in here] == boring["names"]
        sizes = np.diff(boring["depths"])
        assert [size for _, size in here[:-1]] == pytest.approx(sizes[:-1], abs=1e-4)
        assert here[-1][1] >= sizes[-1] - 1e-4  # the last layer goes on as deep as other borings have it
    several = any(name[-1].isdigit() for name in result.names)
    assert several == bool(result.notices)


def column(outcome: ConnectedBorings, place: int) -> list[tuple[str, float]]:
    """What the section has at a boring from the top down: names without numbers, and thickness (m)."""
    levels = np.concatenate([[outcome.ground[place]], outcome.bottoms[:, place]])
    return [(name.split(" ")[0], float(a - b)) for name, (a, b) in zip(outcome.names, pairwise(levels), strict=True)
            if a - b > 1e-9]  # fmt: skip
