"""Pictures of the discs: written, in true proportions, and showing what there is to show."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.image import imread
from matplotlib.lines import Line2D

from dem.case import Case
from dem.engine.engine import Engine
from dem.engine.forces import contact_forces
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import lattice_box
from dem.slides.slide import Row
from tests.support import SECTIONS
from tests.support.dem_cases import RADIUS, box
from workflow.config import Config
from workflow.figures import discs as dem_figures
from workflow.figures.canvas import Sheet, Window
from workflow.figures.colours import soil_colour
from workflow.figures.slides import Frame, draw_line_legend, history, left_by, profiles, shown_window
from workflow.results.cases import Profile
from workflow.results.history import SlideHistory


@pytest.fixture(scope="module")
def model() -> DiscModel:
    model = box(12, 6, tilt=0.3)
    model.set_pore_springs()
    model.set_velocity(np.where(model.fixed, 0.0, 0.3), 0.0)
    Engine(balance=1.0).run(model, 0.3)
    return model


def share_of(image: np.ndarray, colour: str) -> float:
    """Share of the pixels that are nearly of this colour."""
    wanted = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return float(np.mean(np.abs(image[..., :3] - wanted).max(axis=-1) < 0.06))


@pytest.mark.parametrize(
    ("draw", "colours"),
    [
        (dem_figures.layers, (dem_figures.BOUNDARY, *map(soil_colour, (0, 1)))),
        (dem_figures.pore_springs, (dem_figures.WHOLE, dem_figures.CRACKED, dem_figures.PALE)),
        (dem_figures.velocities, ("#ffffff", "#440154")),
        (dem_figures.force_chains, (dem_figures.INK, dem_figures.PALE)),
    ],
)
def test_picture(
    draw: Callable[[DiscModel], Sheet], colours: tuple[str, ...], model: DiscModel, tmp_path: Path
) -> None:
    assert np.any(model.pore_length < 0.0)
    draw(model).save(tmp_path / "picture.png")
    image = imread(tmp_path / "picture.png")
    window = dem_figures.window_of(model)
    assert image.shape[1] == pytest.approx(1600, abs=2)
    assert image.shape[0] > 1400 * window.proportion
    for colour in colours:
        assert share_of(image, colour) > 1e-3, colour


def test_a_picture_holds_the_surface_that_was_above_the_discs(model: DiscModel) -> None:
    """The crest of a bank that has slid: 9 m above all discs."""
    crest = float(model.z.max()) + 9.0
    assert dem_figures.window_of(model).top < crest
    assert dem_figures.window_of(model, np.array([[0.0, 0.0], [1.0, crest]])).top > crest


def test_discs_in_the_section_push_each_other_as_before(model: DiscModel) -> None:
    """The frame of a tilted box is turned; what the discs do to each other does not depend on it."""
    ground = Ground(lattice_box(12, 6, RADIUS), "box", RADIUS, 6, 0.3, (3.0, 5.0), 1)
    view = dem_figures.in_section(model, ground)
    assert np.hypot(view.vx, view.vz) == pytest.approx(np.hypot(model.vx, model.vz))
    assert not np.allclose(view.z, model.z)
    assert contact_forces(view).normal == pytest.approx(contact_forces(model).normal, rel=1e-6)


def test_profiles_are_drawn_for_any_number_of_cases(tmp_path: Path) -> None:
    flat = (0.0, 50.0, 100.0), (10.0, 9.0, 8.0)
    profile = Profile(x=flat[0], before=flat[1], after=flat[1], after_low=(9.0, 8.0, 7.0), after_high=(11.0, 10.0, 9.0))
    profiles(Config.load(SECTIONS / "s13.toml"), dict.fromkeys((1, 2, 12), profile), 36).save(tmp_path / "p.png")
    assert imread(tmp_path / "p.png").shape[1] > 1000


def test_slides_that_are_alike_are_one_line_of_the_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    legends: list[list[str]] = []
    monkeypatch.setattr(Sheet, "legend", lambda _, handles, *__: legends.append([h.get_label() for h in handles]))
    numbers = (0.0,) * 12

    def slide(case: int, far: float) -> SlideHistory:
        rows = (Row(0.0, *numbers, cracked=0, crack_opening_m=0.0, surface_speed_m_s=0.0),)
        return SlideHistory("calibrated", case, (replace(rows[0], slide_max_m=far),))

    history(Config.load(SECTIONS / "s13.toml"), [slide(1, 2.0), slide(2, 2.0), slide(3, 4.0)])
    assert [label.partition(", cal")[0] for label in legends[0]] == ["cases 1, 2", "case 3"]


def test_a_window_has_room_for_arrows_that_end_outside() -> None:
    window = Window(0.0, 100.0, -10.0, 10.0)
    assert window.with_room_for(np.array([[108.0, 0.0], [50.0, 12.0]])) == Window(0.0, 109.0, -10.0, 12.0)
    assert window.with_room_for(np.empty((0, 2))) == window


def test_the_foot_of_a_case_says_what_liquefaction_leaves() -> None:
    assert left_by(Case(stiffness=0.02)) == "0.02 of their stiffness"
    assert left_by(Case(stiffness=0.1, residual=0.2)).endswith("and 0.2 of their vertical effective stress as strength")
    assert left_by(Case(residual_strength=8e3)).endswith("and a strength of 8 kPa")
    assert left_by(Case(residual={"Sand": 0.2})).endswith("and a residual strength of their own")
    first_case = Case(stiffness=0.1, friction=0.15, residual=0.2)
    assert left_by(first_case).startswith("0.1 of their stiffness, 0.15 of their friction and 0.2 of their vertical")


def test_a_picture_of_material_points_shows_the_ground_and_not_the_base_beyond_the_section() -> None:
    """A levee of 140 m whose base reaches from -44 to 184 m; its toe ran to -2 m, which later states show."""
    x, item = np.array([-44.0, 0.0, 140.0, 184.0]), np.ones(4)
    stratum = np.array([-1, 0, 0, -1])
    first = Frame(x, 10.0 * item, 0.5 * item, stratum, 0.0 * item, 0.0)
    last = replace(first, x=np.array([-44.0, -2.0, 141.0, 184.0]))
    window = shown_window([first, last], "mpm")
    assert -5.5 < window.left < -2.5
    assert 141.5 < window.right < 144.5
    assert shown_window([first, last], "calibrated").left < -44.0
    deep = replace(first, x=np.array([-44.0, 0.0, 70.0, 184.0]), z=np.array([10.0, 10.0, 2.0, -9.0]))
    deep = replace(deep, stratum=np.array([-1, 0, -1, -1]))
    assert shown_window([deep, last], "mpm").bottom == 1.5  # the whole base below the ground, which was cut


def test_the_legend_with_both_water_tables_of_a_drawdown_lies_right_of_the_colour_bar() -> None:
    """Its first column lay on the colour bar of the displacements."""
    sheet = Sheet("slide", [0.2, 0.2], "", legend_rows=3)
    dem_figures.displacement_scale(sheet, Normalize(0.0, 10.0))
    bar = sheet.figure.axes[-1]
    names = ("surface before", "surface after", "water table before the drawdown", "water table after the drawdown")
    draw_line_legend(sheet, [Line2D([], [], label=name) for name in names])
    FigureCanvasAgg(sheet.figure).draw()
    [legend] = sheet.figure.legends
    assert legend.get_window_extent().x0 > bar.get_window_extent().x1
