"""Sections from drawings that others drew, and drawings of sections of any names."""

import tomllib
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from meshes.drawings.dxf_file import layer_names, read_dxf, write_dxf
from meshes.errors import InputError
from meshes.section.section import Section
from meshes.section.simplified import needed
from tests.support import command_line

SAND = [(0, 12), (40, 12), (60, 4), (100, 4), (100, 2), (0, 2)]
CLAY = [(0, 2), (100, 2), (100, -6), (0, -6)]
SOIL = {"density": "18 kN/m^3", "youngs_modulus": "20 MPa", "poissons_ratio": 0.3, "cohesion": "10 kPa",
        "friction_angle": "30 deg"}  # fmt: skip


def drawn(folder: Path, draw: Callable[[Any], None], units: int = 6) -> Path:
    document = ezdxf.new(units=units)
    draw(document.modelspace())
    document.saveas(folder / "drawn.dxf")
    return folder / "drawn.dxf"


def section(path: Path, unit: float | None = None) -> tuple[Section, str]:
    """The section of a drawing with one soil throughout, and what was told of it."""
    made = read_dxf(path, "made", unit)
    data = tomllib.loads(made.text)
    data["strata"] = [stratum | SOIL for stratum in data["strata"]]
    return Section.parse({**data, "water": {}} if "water" not in data else data), "\n".join(made.notices)


def areas(made: Section) -> dict[str, float]:
    return dict(zip([s.name for s in made.strata], map(float, made.layering.areas()), strict=True))


def outlines(space: Any, **more: list[tuple[float, float]]) -> None:
    for layer, points in {"Sand": SAND, "Clay": CLAY, **more}.items():
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})


def test_a_lens_keeps_what_lies_above_it(tmp_path: Path) -> None:
    """A rhombus of 40 m by 2 m in the clay: 40 m²; above it 3 to 4 m of clay, 40 m by 3 m less half of the rhombus."""
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Lens=[(30, -1), (50, 0), (70, -1), (50, -2)])))
    result = areas(made)
    assert result == {"Sand": pytest.approx(600.0), "Clay 1": pytest.approx(100.0), "Lens": pytest.approx(40.0),
                     "Clay 2": pytest.approx(660.0)}  # fmt: skip
    assert made.stratum_at(np.array([50.0]), np.array([1.0]))[0] == list(result).index("Clay 1")
    assert (
        '"Clay" lies above and below other layers, and is divided: from the top down, "Clay 1" and "Clay 2"' in messages
    )


def test_lenses_in_lenses_and_two_on_one_layer(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        outlines(space, Lens=[(20, 1), (80, 1), (80, -4), (20, -4)], Core=[(40, 0), (60, 0), (60, -2), (40, -2)])
        space.add_lwpolyline([(5, 0), (15, 0), (15, -1), (5, -1)], close=True, dxfattribs={"layer": "Core"})

    result = areas(section(drawn(tmp_path, draw))[0])
    for name, area in (("Lens", 260.0), ("Core", 50.0), ("Clay", 490.0)):
        assert sum(size for key, size in result.items() if key.startswith(name)) == pytest.approx(area)


@pytest.mark.parametrize(
    ("units", "unit", "metre"),
    [
        (4, None, 1000.0),
        (2, None, 1 / 0.3048),
        (21, None, 3937 / 1200),
        (4, 1.0, 1.0),
        (0, None, 1.0),
        (0, 0.001, 1000.0),
    ],
)
def test_the_unit_of_a_drawing(units: int, unit: float | None, metre: float, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for layer, points in {"Sand": SAND, "Clay": CLAY}.items():
            scaled = [(x * metre, z * metre) for x, z in points]
            space.add_lwpolyline(scaled, close=True, dxfattribs={"layer": layer})

    made, messages = section(drawn(tmp_path, draw, units), unit)
    assert areas(made) == {"Sand": pytest.approx(600.0, rel=1e-6), "Clay": pytest.approx(800.0, rel=1e-6)}
    assert ("--unit gives another unit" in messages) == (unit is None)


def test_a_drawing_of_a_size_that_no_section_has_asks_for_its_unit(tmp_path: Path) -> None:
    assert (
        "0.1 m wide, its unit 0.001 m: --unit gives another unit"
        in read_dxf(drawn(tmp_path, outlines, 4), "a").notices[1]
    )


def test_arcs_are_chords_within_a_centimetre(tmp_path: Path) -> None:
    """A bulge of tan(θ/4) over a chord of 20 m: the segment has the area r² (θ - sin θ) / 2."""
    bulge = 0.25
    angle = 4.0 * np.arctan(bulge)
    radius = 10.0 / np.sin(0.5 * angle)
    segment = 0.5 * radius**2 * (angle - np.sin(angle))

    def draw(space: Any) -> None:
        points = [(0, 12, 0), (40, 12, bulge), (60, 12, 0), (100, 12, 0), (100, 2, 0), (0, 2, 0)]
        space.add_lwpolyline(points, format="xyb", close=True, dxfattribs={"layer": "Sand"})
        space.add_lwpolyline(CLAY, close=True, dxfattribs={"layer": "Clay"})

    made, _ = section(drawn(tmp_path, draw))
    assert areas(made)["Sand"] == pytest.approx(1000.0 - segment, abs=20.0 * 0.01)
    depth = float(made.layering.interfaces(np.array([50.0]))[0, 0])
    assert depth == pytest.approx(12.0 - bulge * 10.0, abs=0.01)


def test_outlines_of_any_entities(tmp_path: Path) -> None:
    """Lines end to end, a spline through a circle's points, an open polyline, a 3-D one, a block, an ellipse."""

    def draw(space: Any) -> None:
        ring = [*SAND, SAND[0]]
        for start, end in pairwise(ring):
            space.add_line(start, end, dxfattribs={"layer": "Sand"})
        space.add_polyline3d([(x, z, 0.0) for x, z in CLAY], close=True, dxfattribs={"layer": "Clay"})
        angles = np.linspace(0.0, 2.0 * np.pi, 41)
        space.add_spline([(20 + 2 * np.cos(a), -2 + 2 * np.sin(a), 0) for a in angles], dxfattribs={"layer": "Spline"})
        space.add_ellipse((50, -2), (10, 0), ratio=0.2, dxfattribs={"layer": "Ellipse"})
        space.add_lwpolyline([(70, -3), (80, -3), (80, -5), (70, -5)], dxfattribs={"layer": "Open"})
        block = space.doc.blocks.new("PIPE")
        block.add_circle((0, 0), 1.0, dxfattribs={"layer": "0"})
        space.add_blockref("PIPE", (90, -2), dxfattribs={"layer": "Pipe"})
        space.add_text("not ground", dxfattribs={"layer": "Words"})

    made, messages = section(drawn(tmp_path, draw))
    result = areas(made)
    assert result["Sand"] == pytest.approx(600.0)
    for name, area in (("Spline", 4 * np.pi), ("Ellipse", 20 * np.pi), ("Open", 20.0), ("Pipe", np.pi)):
        assert result[name] == pytest.approx(area, rel=0.02)
    assert (
        'the LWPOLYLINE on layer "Open", x = 70 to 80 m, is open, and is closed by a straight line of 2 m' in messages
    )
    assert "not used: 1 × TEXT on layer Words" in messages


@pytest.mark.parametrize("axis", [0, 1])
def test_a_section_that_stands_upright_in_space(axis: int, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for layer, points in {"Sand": SAND, "Clay": CLAY}.items():
            place = [(x, 7.0, z) if axis == 0 else (0.6 * x, 0.8 * x, z) for x, z in points]
            space.add_polyline3d(place, close=True, dxfattribs={"layer": layer})

    assert areas(section(drawn(tmp_path, draw))[0]) == {"Sand": pytest.approx(600.0), "Clay": pytest.approx(800.0)}


def test_gaps_overlaps_and_what_is_covered_are_told(tmp_path: Path) -> None:
    raised = [(x, 3.0 if z == 2 else z) for x, z in SAND]
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Sand=raised)))
    assert (
        'between "Sand" and "Clay" there is a gap, up to 1 m high from x = 0 to 100 m: it is filled with "Clay"'
        in messages
    )
    assert areas(made) == {"Sand": pytest.approx(500.0), "Clay": pytest.approx(900.0)}
    lowered = [(x, 1.0 if z == 2 else z) for x, z in SAND]
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Sand=lowered)))
    assert '"Sand" and "Clay" overlap by 100 m² from x = 0 to 100 m: this area is given to "Sand"' in messages
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Again=SAND)))
    assert 'the outline on layer "Again" is covered by other outlines, and not used' in messages
    apart = [(0, 12), (40, 12), (40, -6), (0, -6)]
    with pytest.raises(InputError, match="nothing is drawn from x = 40 to 50 m"):
        section(drawn(tmp_path, lambda s: outlines(s, Sand=apart, Clay=[(50, 2), (100, 2), (100, -6), (50, -6)])))


def test_lines_alone_are_the_ground_and_bottoms(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for layer, points in {"Clay": CLAY[2:], "Ground": SAND[:4], "Sand": CLAY[:2]}.items():
            space.add_lwpolyline(points, dxfattribs={"layer": layer})

    made, messages = section(drawn(tmp_path, draw))
    assert areas(made) == {"Sand": pytest.approx(600.0), "Clay": pytest.approx(800.0)}
    assert 'the highest line, on layer "Ground", is the ground' in messages


@pytest.mark.parametrize(("layer", "doubted"), [("CLAY_TOP", True), ("Top of clay", True), ("Topsoil", False)])
def test_a_line_whose_name_says_that_it_is_a_top_is_doubted(layer: str, doubted: bool, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for name, points in {"Ground": SAND[:4], layer: CLAY[:2], "Base": CLAY[2:]}.items():
            space.add_lwpolyline(points, dxfattribs={"layer": name})

    messages = section(drawn(tmp_path, draw))[1]
    assert (
        f'the name of layer "{layer}" contains the word top, and its line is read as a bottom' in messages
    ) == doubted


def test_the_longest_water_line_counts_and_others_are_told(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        outlines(space)
        space.add_line((30, 6), (10, 7), dxfattribs={"layer": "WATER"})
        space.add_line((30, 6), (100, 3), dxfattribs={"layer": "WATER"})
        space.add_lwpolyline([(0, 1), (50, 1)], dxfattribs={"layer": "water low"})
        space.add_lwpolyline([(0, -1), (50, -1)], dxfattribs={"layer": "Fault"})

    made, messages = section(drawn(tmp_path, draw))
    assert np.allclose(made.water_points(), [[0, 7], [10, 7], [30, 6], [100, 3]])
    assert "the water table is drawn from x = 10 to 100 m, and continues level to x = 0 m" in messages
    assert 'not used: a LWPOLYLINE on layer "water low", x = 0 to 50 m, beside the longer water table' in messages
    assert (
        'not used: a LWPOLYLINE on layer "Fault", x = 0 to 50 m: this line is neither closed nor a water table'
        in messages
    )


def test_a_drawing_in_millimetres_that_does_not_say_so_is_doubted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for layer, points in {"Sand": SAND, "Clay": CLAY}.items():
            space.add_lwpolyline([(1e3 * x, 1e3 * z) for x, z in points], close=True, dxfattribs={"layer": layer})

    path = drawn(tmp_path, draw)
    assert "100,000 m wide, its unit 1 m: --unit gives another unit" in section(path)[1]


NAMES = ("Sand/silt (1)", "Ton, weich – ü β/γ", "sand", "SAND", "WATER", "0", "砂／シルト", "a<b>c=d|e?f*g;h:i\\j`k")


def test_names_that_a_layer_cannot_have_come_back(tmp_path: Path) -> None:
    strata = [{"name": name, **SOIL, "bottom": {"elevation": 10.0 - k}} for k, name in enumerate(NAMES)]
    ground = Section.parse(
        {"name": "names", "surface": [[0, 12], [30, 11]], "base": {"elevation": 3.0}, "strata": strata}
    )
    messages = write_dxf(ground, tmp_path / "names.dxf")
    assert any('stratum "Sand/silt (1)" is on layer "Sand／silt (1)"' in text for text in messages)
    assert len({name.casefold() for name in layer_names(NAMES)}) == len(NAMES)
    again, _ = section(tmp_path / "names.dxf")
    assert areas(again) == {key: pytest.approx(value) for key, value in areas(ground).items()}


def test_strata_that_water_cuts_are_drawn_as_in_their_file(tmp_path: Path) -> None:
    soil = {**{key: value for key, value in SOIL.items() if not key.startswith("density")}, "density": "18 kN/m^3"}
    sand = {"name": "Sand", **soil, "density_saturated": "20 kN/m^3"}
    clay = {"name": "Clay", **soil, "density_saturated": "19 kN/m^3"}
    ground = Section.parse({
        "name": "cut", "surface": [[0, 12], [40, 12], [60, 4], [100, 4]], "base": {"elevation": -6.0},
        "water": {"table": [[0, 9], [100, 1]]}, "strata": [{**sand, "bottom": {"elevation": 2.0}}, clay],
    })  # fmt: skip
    assert len(ground.strata) == 4
    assert write_dxf(ground, tmp_path / "cut.dxf") == []
    assert [load["name"] for load in tomllib.loads(read_dxf(tmp_path / "cut.dxf", "made").text)["strata"]] == [
        "Sand",
        "Clay",
    ]
    again, _ = section(tmp_path / "cut.dxf")
    assert areas(again) == {key: pytest.approx(value) for key, value in areas(ground).items()}
    assert np.allclose(again.water_points(), [[0, 9], [100, 1]])


def test_a_section_of_any_names_is_drawn_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slash.toml"
    text = "\n".join(
        f"{key} = {value!r}" if isinstance(value, float) else f'{key} = "{value}"' for key, value in SOIL.items()
    )
    path.write_text('name = "slash"\nsurface = [[0.0, 12.0], [40.0, 12.0]]\nbase = { elevation = -6.0 }\n'
                    f'[[strata]]\nname = "Sand/silt (1)"\n{text}\n', encoding="utf-8")  # fmt: skip
    assert command_line.run("section", path, "-o", tmp_path / "slash.dxf") == 0
    assert "a drawing layer cannot have the name of the stratum" in capsys.readouterr().out
    assert command_line.run("section", tmp_path / "slash.dxf", "-o", tmp_path / "again.toml", "--unit", "mm") == 0
    assert "0.04 m wide, its unit 0.001 m" in capsys.readouterr().out


def test_needed_points_keep_a_line_within_the_tolerance() -> None:
    x = np.linspace(0.0, 10.0, 2001)
    line = np.column_stack([x, np.sin(x)])
    for tolerance in (1e-4, 0.01, 0.2):
        keep = needed(line, tolerance)
        assert np.abs(np.interp(x, *line[keep].T) - line[:, 1]).max() <= tolerance
    assert keep.sum() < 12
    step = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.9], [2.0, 0.9]])
    assert needed(step, 1.0).all()


def test_lines_with_a_closed_lens_are_strata_with_a_zone(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for points in (SAND[:4], CLAY[:2], CLAY[2:]):
            space.add_lwpolyline(points, dxfattribs={"layer": "0"})
        space.add_line((0, 12), (0, -6), dxfattribs={"layer": "Side"})
        space.add_lwpolyline([(30, -1), (50, 0), (70, -1), (50, -2)], close=True, dxfattribs={"layer": "Lens"})

    read = read_dxf(drawn(tmp_path, draw), "made")
    data = tomllib.loads(read.text)
    assert [stratum["name"] for stratum in data["strata"]] == ["0 1", "0 2"]
    assert data["zones"] == [{"name": "Lens", "points": [[30, -1], [50, 0], [70, -1], [50, -2]]}]
    text = "\n".join(read.notices)
    assert "lines of the drawing continue beyond its outlines, which are zones" in text
    assert 'layer "0" has several lines or outlines, which become the strata "0 1" and "0 2"' in text
    assert "not used: 1 × upright LINE on layer Side" in text


def test_a_line_that_is_drawn_twice_is_one(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for way in (1, -1):
            space.add_lwpolyline(SAND[:4][::way], dxfattribs={"layer": "Ground"})
            space.add_lwpolyline([(0, 2), (100, 2)][::way], dxfattribs={"layer": "Sand"})
        space.add_line((0, -6), (100, -6), dxfattribs={"layer": "Clay"})

    made, messages = section(drawn(tmp_path, draw))
    assert areas(made) == {"Sand": pytest.approx(600.0), "Clay": pytest.approx(800.0)}
    assert "not used: 1 × LWPOLYLINE on layer Ground that lies on another one" in messages


def test_an_outline_of_groundwater_is_its_table(tmp_path: Path) -> None:
    """Drawn round all that is wet, it would be ground above the ground."""
    wet = [(0, 9), (52.5, 7), (100, 7), (100, -6), (0, -6)]
    made, _ = section(drawn(tmp_path, lambda s: outlines(s, Groundwater=wet)))
    assert sum(areas(made).values()) == pytest.approx(1400.0)
    assert np.allclose(made.water_points(), wet[:3])


def test_an_outline_of_water_is_no_ground(tmp_path: Path) -> None:
    pond = [(52, 7), (100, 7), (100, 4), (60, 4)]
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Pond=pond)))
    assert areas(made) == {"Sand": pytest.approx(231.25), "Sand, below water": pytest.approx(368.75),
                           "Clay": pytest.approx(800.0)}  # fmt: skip
    assert np.allclose(made.water_points(), [[0, 7], [100, 7]])
    assert 'the outline on layer "Pond", x = 52 to 100 m, is water: its upper edge is a water table' in messages


@pytest.mark.parametrize("name", ["GROUNDWATER", "Piezometric line", "W.T.", "Nivel freático", "水位線"])
def test_what_water_is_called(name: str, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        outlines(space)
        space.add_line((0, 6), (100, 3), dxfattribs={"layer": name})

    assert np.allclose(section(drawn(tmp_path, draw))[0].water_points(), [[0, 6], [100, 3]])


def test_outlines_of_which_one_ends_a_little_short_of_a_side(tmp_path: Path) -> None:
    """Else the ground would fall by 10 m in a slit of 2 cm."""
    short = [(max(x, 0.02), z) for x, z in SAND]
    made, messages = section(drawn(tmp_path, lambda s: outlines(s, Sand=short)))
    assert np.allclose(made.surface[0], [0.02, 12.0])
    assert "outlines end at different x at one side, 0 and 0.02 m" in messages


def test_a_lens_in_the_hole_of_a_hatch(tmp_path: Path) -> None:
    lens = [(30, -1), (50, 0), (70, -1), (50, -2)]

    def draw(space: Any) -> None:
        for layer, rings in {"Sand": [SAND], "Clay": [CLAY, lens], "Lens": [lens]}.items():
            hatch = space.add_hatch(dxfattribs={"layer": layer})
            for ring in rings:
                hatch.paths.add_polyline_path(ring)

    made, messages = section(drawn(tmp_path, draw))
    assert areas(made)["Lens"] == pytest.approx(40.0)
    assert 'the HATCH on layer "Clay" has a hole' in messages


def test_outlines_that_are_doubted(tmp_path: Path) -> None:
    frame = [(-20, -30), (130, -30), (130, 40), (-20, 40)]
    assert (
        '"Frame" surrounds all others: if it is the frame'
        in section(drawn(tmp_path, lambda s: outlines(s, Frame=frame)))[1]
    )
    bow = [(0, 12), (100, 2), (100, 12), (0, 2)]
    assert 'the outline on layer "Sand" crosses itself' in section(drawn(tmp_path, lambda s: outlines(s, Sand=bow)))[1]


def test_corners_a_little_beside_a_side_stand_on_it(tmp_path: Path) -> None:
    """Else a stratum would reach up along the side in a slit of half a millimetre."""
    neighbour = [(0.0004, 2), (100.0006, 2), (99.9995, -6), (0, -6)]
    made, messages = section(drawn(tmp_path, lambda space: outlines(space, Clay=neighbour)))
    assert messages == ""
    assert [stratum.bottom is None for stratum in made.strata] == [False, True]
    assert np.allclose(made.layering.x[[0, -1]], [0.0, 100.0])
    assert areas(made) == {"Sand": pytest.approx(600.0), "Clay": pytest.approx(800.0)}


def test_a_frame_with_a_title_block_on_its_layer_is_doubted(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        outlines(space, **{"0": [(-20, -30), (130, -30), (130, 40), (-20, 40)]})
        space.add_lwpolyline([(90, -30), (130, -30), (130, -25), (90, -25)], close=True)

    assert 'the outline on layer "0" surrounds all others' in section(drawn(tmp_path, draw))[1]


def test_a_section_on_a_sheet_is_told(tmp_path: Path) -> None:
    document = ezdxf.new(units=6)
    outlines(document.layout("Layout1"))
    document.saveas(tmp_path / "sheet.dxf")
    with pytest.raises(InputError) as caught:
        read_dxf(tmp_path / "sheet.dxf", "made")
    assert 'not used: 2 entities on the sheet "Layout1": expected the section in model space' in caught.value.problems
