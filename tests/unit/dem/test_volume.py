"""Ground that cannot drain keeps its volume while it slides."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.case import Case
from dem.disc_area import area_per_disc
from dem.ground import Ground
from dem.model import DiscModel
from dem.packing import lattice_box, random_packing
from dem.search.equilibrium import settle
from dem.settings import DemSettings, SlideSettings
from dem.slides.liquefaction import Slider
from dem.slides.volume import required_areas, undrained_strata
from dem.springs import Strength, soil_discs
from tests.support.dem_cases import RADIUS

SAND = soil_discs("sand", 3e7, Strength(0.35), 2000.0, 1000.0, RADIUS, 0.27)
LAYERS = [SAND, replace(SAND, name="loose")]
CASE = Case(stiffness=1.0, residual=0.2)
SETTINGS = SlideSettings(kh=0.15, onset=1.0, duration=8.0)
LOOSE = 0.26  # porosity; it shears at some 0.2


@pytest.fixture(scope="module")
def start() -> DiscModel:
    """20 columns and 8 rows, level; rows 3 and 4 from the bottom are a layer of their own."""
    packing = lattice_box(20, 8, RADIUS)
    row = np.round(packing.z / (np.sqrt(3.0) * RADIUS)).astype(int)
    packing.layer[packing.free & ((row == 2) | (row == 3))] = 1
    return Ground(packing, "lattice", RADIUS, 0, 0.0, (0.0, 0.0), 1).model(LAYERS, DemSettings())


@pytest.fixture(scope="module")
def wedge() -> tuple[DiscModel, Ground]:
    """30 m of loose ground that falls from 9 to 6 m; its lower 5 m liquefy."""
    outline = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 6.0], [0.0, 9.0]])
    packing = random_packing(
        outline, lambda x, z: np.where(z < 5.0, 1, 0).astype(np.int32), 0.5, porosity=LOOSE, seed=1
    )
    ground = Ground(packing, "random", 0.5, 0, 0.0, (0.0, 0.0), 1)
    return settle(ground, LAYERS, DemSettings()), ground


@pytest.fixture(scope="module")
def undrained_wedge(wedge: tuple[DiscModel, Ground]) -> tuple[DiscModel, Ground]:
    """The same, with weak clay in the place of what liquefies."""
    start = wedge[0].copy()
    clay = replace(LAYERS[1], friction=0.0, contact_cohesion=2e3, undrained_strength=2e3)
    start.set_springs([LAYERS[0], clay])
    return start, wedge[1]


def test_area_per_disc_is_that_of_a_lattice(start: DiscModel) -> None:
    """Equal discs that touch in a triangular lattice cover pi/(2 sqrt(3)) of the plane, eq. (6) of the paper."""
    assert area_per_disc(start, start) == pytest.approx(2.0 * np.sqrt(3.0) / np.pi, rel=1e-3)


def test_ground_that_cannot_drain_swells_by_what_is_missing(start: DiscModel) -> None:
    """Gently; not by what was to drain, not where springs have got softer, and not for what the measure cannot tell."""
    loose = start.copy()
    loose.set_radius(0.97 * start.radius)
    lower, hardly, soft = loose.copy(), loose.copy(), start.copy()
    lower.z *= 0.98
    hardly.z *= 0.998
    soft.z *= 0.98
    before = area_per_disc(loose, loose)
    assert required_areas(lower, loose, before, [1], [1.01], {}) == pytest.approx([1.01 * 1.002])
    assert required_areas(lower, loose, before, [1], [1.01], {1: 0.019}) == [1.01]
    assert required_areas(hardly, loose, before, [1], [1.0], {}) == [1.0]
    assert required_areas(soft, start, area_per_disc(start, start), [1], [1.0], {}) == [1.0]


def test_what_cannot_drain(start: DiscModel) -> None:
    """Soil discs that liquefy or have phi = 0; the paper's discs know nothing of it."""
    soil = start.copy()
    soil.law = "soil"
    assert undrained_strata(soil, []) == []
    assert undrained_strata(soil, [1]) == [1]
    soil.set_springs([replace(layer, undrained_strength=2e3) for layer in soil.springs.layers])
    assert undrained_strata(soil, [1]) == [0, 1]
    paper = soil.copy()
    paper.law = "paper"
    assert undrained_strata(paper, [1]) == []


def volume_lost(start: DiscModel, model: DiscModel) -> float:
    """Of the stratum that liquefies, in shares."""
    return float(1.0 - (area_per_disc(model, start) / area_per_disc(start, start))[1])


def test_loose_ground_that_liquefies_keeps_its_volume(wedge: tuple[DiscModel, Ground]) -> None:
    """In the slide, and before it as pressures replace contacts. It got denser by 6 % as long as contacts bore it, and
    by 1.5 % where pore water alone keeps it."""
    start, ground = wedge
    slider = Slider(start, ground, [1], CASE, SETTINGS.model_copy(update={"duration": 20.0}))
    slider.run()
    assert abs(volume_lost(start, slider.start)) < 0.001
    assert abs(volume_lost(slider.start, slider.model)) < 0.006


@pytest.mark.slow
def test_undrained_ground_that_shears_swells(
    undrained_wedge: tuple[DiscModel, Ground], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only discs of the stratum get larger, none heavier."""
    start, ground = undrained_wedge
    settings = SETTINGS.model_copy(update={"kh": 0.4, "duration": 20.0})
    slider = Slider(start, ground, [], None, settings)
    slider.run()
    monkeypatch.setattr("dem.slides.liquefaction.undrained_strata", lambda *_: [])
    drained = Slider(start, ground, [], None, settings)
    drained.run()
    assert volume_lost(start, drained.model) > 0.01
    assert abs(volume_lost(start, slider.model)) < 0.006
    other = start.layer != 1
    assert (slider.model.radius[other] == start.radius[other]).all()
    assert (slider.model.mass == start.mass).all()
    assert 1.01 < slider.swelling[-1][0] < 1.1


def test_what_swells_goes_on_with_the_same_bits(
    undrained_wedge: tuple[DiscModel, Ground], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped after the rows of a look were written, and before its checkpoint was."""
    monkeypatch.setattr("dem.slides.liquefaction.CHECKPOINT_INTERVAL", 0.0)
    whole = Slider(*undrained_wedge, [], None, SETTINGS)
    slide = whole.run()
    save: Callable[[DiscModel, Path], None] = DiscModel.save

    def stop(model: DiscModel, path: Path) -> None:
        if model.time - undrained_wedge[0].time > 5.0:
            raise KeyboardInterrupt
        save(model, path)

    monkeypatch.setattr(DiscModel, "save", stop)
    with pytest.raises(KeyboardInterrupt):
        Slider(*undrained_wedge, [], None, SETTINGS, tmp_path).run()
    monkeypatch.setattr(DiscModel, "save", save)
    resumed = Slider(*undrained_wedge, [], None, SETTINGS, tmp_path)
    assert 0 < len(resumed.slide.rows) < len(slide.rows)
    assert resumed.swelling == whole.swelling[: len(resumed.slide.rows)]
    assert resumed.run() == slide
    assert (resumed.model.x == whole.model.x).all()
