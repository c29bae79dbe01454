"""Pictures of the ground."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import ArrowStyle
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

from meshes.section.surcharge import Surcharge
from tests.support.sections import slope
from workflow.config import Config
from workflow.figures.canvas import Sheet
from workflow.figures.fem import conditions
from workflow.figures.ground import WALL, WATER, Overlay, crack_bottoms, pressure_of, section_sheet
from workflow.figures.marks import Towards, draw_water, sides_of_slide
from workflow.report.tables import parameter_rows


def test_a_cut_off_wall_is_drawn_from_the_ground_to_its_foot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only a jump of the water table told where the wall of a dike stands."""
    data = {**slope(), "water": {"flow": True, "table": [[0, 12], [100, 6]], "cutoffs": [{"x": 40.0, "bottom": 5.0}]}}
    data["strata"] = [stratum | {"permeability": "1e-6 m/s"} for stratum in data["strata"]]
    section = Config.parse(data).section
    drawn, plot = [], Axes.plot
    monkeypatch.setattr(
        Axes, "plot", lambda axes, *args, **how: (drawn.append((args, how)), plot(axes, *args, **how))[1]
    )
    section_sheet(section).save(tmp_path / "section.png")
    [(x, z)] = [args for args, how in drawn if how.get("color") == WALL]
    top = section.ground[:, 1].max()
    assert x == [40.0, 40.0]
    assert z[1] == 5.0 < z[0] <= top


@pytest.mark.parametrize(("force", "style"), [("right", "-|>"), ("left", "-|>"), ("both", "<|-|>")])
def test_the_direction_of_the_seismic_force_stands_above_the_frame(force: Towards, style: str) -> None:
    """Clear of the ground and within the picture; only the picture of the first page had an arrow."""
    sheet = section_sheet(Config.parse(slope()).section, force=force)
    axes = sheet.views[0]
    sheet.figure.canvas.draw()
    (arrow,) = [
        text
        for text in axes.texts
        if isinstance(text, Annotation)
        and text.arrow_patch is not None
        and text.arrow_patch.get_arrowstyle().__class__ is ArrowStyle(style).__class__
        and not text.get_text()
    ]
    assert arrow.arrow_patch is not None
    tail, tip = arrow.arrow_patch.get_path().vertices[[0, 2]]  # type: ignore[index]
    assert (tip[0] < tail[0]) == (force == "left")
    (label,) = [text for text in axes.texts if text.get_text() == "Kh"]
    for box in (label.get_window_extent(), arrow.arrow_patch.get_window_extent()):
        assert box.y0 > axes.get_window_extent().y1
        assert box.x1 <= sheet.figure.bbox.x1


def test_without_a_seismic_force_there_is_no_arrow() -> None:
    texts = section_sheet(Config.parse(slope()).section).views[0].texts
    assert not [text for text in texts if text.get_text() == "Kh"]


def test_the_arrow_of_a_slide_is_that_of_its_shaking() -> None:
    """A constant Kh acts downslope or to the given side, cycles and records in both directions."""
    cyclic = {"kh": 0.1, "kh_cycles": 10, "kh_period": 0.7}
    to_left = {"kh": 0.1, "kh_towards": "left"}
    for slide, towards in (({"kh": 0.1}, "right"), (to_left, "left"), ({"kh": 0.0}, None), (cyclic, "both")):
        assert sides_of_slide(Config.parse({**slope(), "slide": slide})) == towards


def test_water_beside_ground_that_has_moved_is_that_before_the_slide() -> None:
    """Its table hung over a levee that had slid, and free water covered the ground that lay in the river."""
    section = Config.parse({**slope(), "water": {"table": [[0, 12], [100, 12]]}}).section
    for moved, label, fills in ((False, "water table", 1), (True, "water table before the slide", 0)):
        axes = Figure().add_subplot()
        (line,) = draw_water(axes, section, moved)
        assert (line.get_label(), len(axes.collections)) == (label, fills)


def test_free_water_after_a_drawdown_stands_up_to_the_lower_table() -> None:
    """The picture had the water that was removed on the ground."""
    data = {**slope(), "water": {"table": [[0, 14], [100, 14]], "after_drawdown": [[0, 12], [100, 12]]}}
    for stratum in data["strata"]:
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
        stratum.pop("density_ordinary", None)
        stratum.pop("density_seismic", None)
    axes = Figure().add_subplot()
    draw_water(axes, Config.parse(data).section)
    (water,) = axes.collections
    assert max(path.vertices[:, 1].max() for path in water.get_paths()) == pytest.approx(12.0)


def test_both_water_tables_of_a_drawdown_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The picture had the water table before the drawdown alone, called "water table"."""
    before, after = [[0, 12], [100, 12]], [[0, 12], [100, 6]]
    drawn, plot = [], Axes.plot
    monkeypatch.setattr(
        Axes, "plot", lambda axes, *args, **how: (drawn.append((args, how)), plot(axes, *args, **how))[1]
    )

    def lines_and_labels(water: dict[str, Any]) -> tuple[list[list[list[float]]], set[str]]:
        drawn.clear()
        data = slope()
        for stratum in data["strata"]:
            stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
            stratum.pop("density_ordinary", None)
            stratum.pop("density_seismic", None)
        sheet = section_sheet(Config.parse({**data, "water": water}).section)
        labels = {text.get_text() for legend in sheet.figure.legends for text in legend.get_texts()}
        lines = [np.column_stack(args).tolist() for args, how in drawn if how.get("color") == WATER]
        return lines, {label for label in labels if label.startswith("water table")}

    assert lines_and_labels({"table": before}) == ([before], {"water table"})
    assert lines_and_labels({"table": before, "after_drawdown": after}) == (
        [before, after], {"water table before the drawdown", "water table after the drawdown"},
    )  # fmt: skip


def test_the_foot_of_a_picture_names_the_seismic_force_once() -> None:
    """It said "seismic force seismic force downslope"."""
    words = conditions(Config.parse(slope()), "reduced")
    assert words.count("seismic force") == 1
    assert "seismic force downslope and upslope; the smaller Kh counts" in words


def test_the_table_of_parameters_has_both_water_tables_of_a_drawdown() -> None:
    """It had the water table before the drawdown alone."""
    data = slope()
    for stratum in data["strata"]:
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
        stratum.pop("density_ordinary", None)
        stratum.pop("density_seismic", None)
    water = {"table": [[0, 12], [100, 12]], "after_drawdown": [[0, 12], [100, 6]]}
    rows = [row[:2] for row in parameter_rows(Config.parse({**data, "water": water}))]
    assert rows[:2] == [
        ("water table before the drawdown", "elevation 12 m"),
        ("water table after the drawdown", "elevation 6 to 12 m"),
    ]


def test_the_bottom_of_tension_cracks_is_named_in_the_picture_of_a_section() -> None:
    """A line without a name ran through the ground, three metres below its surface."""
    data = {**slope(), "tension_crack": {"bottom": {"depth": 2.0}}}
    section = Config.parse(data).section
    sheet = section_sheet(section)
    labels = {text.get_text() for legend in sheet.figure.legends for text in legend.get_texts()}
    assert "bottom of the tension cracks" in labels
    line = np.vstack(crack_bottoms(section))
    assert np.ptp(line[:, 0]) == pytest.approx(np.ptp(section.ground[:, 0]))
    assert line[:, 1] == pytest.approx(np.interp(line[:, 0], *section.ground.T) - 2.0)
    bare = section_sheet(Config.parse(slope()).section)
    assert "tension" not in " ".join(t.get_text() for legend in bare.figure.legends for t in legend.get_texts())


def test_a_pressure_in_psf_is_shown_with_the_digits_that_it_has() -> None:
    """250 psf were "surcharge 11.9701 kPa"."""
    load = Surcharge.model_validate({"from": 0.0, "to": 9.0, "pressure": "250 psf"})
    assert pressure_of(load) == "11.97 kPa"


def test_the_slip_surface_of_a_few_cells_is_drawn_as_a_dot() -> None:
    """A dam failed at its toe: the legend named a slip surface that no picture showed."""
    place = Overlay(np.array([[91.7, -0.2], [91.7, -0.2]]), "red", (0, ()), "slip surface")
    assert place.marker(130.0) == "o"
    assert place._replace(points=np.array([[30.0, 0.0], [42.0, -4.0]])).marker(130.0) == ""
    sheet = section_sheet(Config.parse(slope()).section, lines=[place])
    (legend,) = sheet.figure.legends
    shown = {text.get_text(): handle for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True)}
    assert shown["slip surface"].get_marker() == "o"


def texts_in_picture(sheet: Sheet, words: set[str]) -> dict[str, Bbox]:
    """Return the boxes of texts of the first view, relative to its frame: from 0 to 1 inside of it."""
    sheet.figure.canvas.draw()
    axes = sheet.figure.axes[0]
    frame = axes.transAxes.inverted()
    return {text.get_text(): frame.transform_bbox(text.get_window_extent())
            for text in axes.texts if text.get_text() in words}  # fmt: skip


def test_names_of_borings_on_flat_ground_are_inside_the_picture() -> None:
    """The name of a boring lay on the upper edge of the picture of a section 260 m long and 20 m high."""
    section = Config.parse({**slope(), "surface": [[0, 20], [400, 18]]}).section
    [box] = texts_in_picture(section_sheet(section, borings=[("C1", 10.0, 8.0)]), {"C1"}).values()
    assert box.y1 < 1.0


def test_a_thin_seam_has_its_number() -> None:
    """A seam of 0.3 m, along which a slope slid, had no number in the picture."""
    data = slope()
    seam = {**data["strata"][0], "name": "seam", "bottom": {"elevation": [[0, 9.7], [100, 4.7]]}}
    data["strata"] = [
        {**data["strata"][0], "bottom": {"elevation": [[0, 10], [100, 5]]}}, seam, data["strata"][1]
    ]  # fmt: skip
    assert texts_in_picture(section_sheet(Config.parse(data).section), {"1", "2", "3"}).keys() == {"1", "2", "3"}


def test_the_number_of_a_stratum_stands_clear_of_a_boring_and_of_a_slip_surface(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The number of a levee's fill stood on a boring and on a slip surface."""
    section, text = Config.parse(slope()).section, Axes.text
    written: dict[str, tuple[float, float]] = {}
    monkeypatch.setattr(
        Axes, "text", lambda axes, x, z, s, **how: (written.update({s: (x, z)}), text(axes, x, z, s, **how))[1]
    )
    section_sheet(section)
    x, z = written["1"]
    section_sheet(section, borings=[("B-1", x, 8.0)])
    assert abs(written["1"][0] - x) > 0.5
    line = np.array([[x - 1.0, z - 1.0], [x + 1.0, z + 1.0]])
    section_sheet(section, lines=[Overlay(line, "red", (0, ()), "slip surface")])
    assert abs(written["1"][0] - x) > 0.5
