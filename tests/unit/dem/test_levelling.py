"""The surface of discs brought to the section's: what stands out goes, hollows are filled, nothing overlaps."""

from pathlib import Path

import numpy as np
import pytest

from dem.assembly import DiscMaterials
from dem.model import DiscModel
from dem.packing import Packing
from dem.search.deposit import deposit
from dem.search.levelling import INSERTION_OVERLAP, LARGEST_PROTRUSION, levelled, misfit
from dem.settings import DemSettings
from meshes.section.section import Section
from tests.support.dem_cases import SOIL_SPRINGS
from tests.support.sections import layer

RADIUS = 0.5
SPREAD = 0.2
TOP = 6.0
FACE = [[0.0, TOP + 6.0], [18.0, TOP], [36.0, TOP]]  # 1:3, and a level bank
LEVEL = [[0.0, TOP], [36.0, TOP]]
QUAY = [[0.0, TOP + 6.0], [18.0, TOP + 6.0], [18.1, TOP], [36.0, TOP]]


def section(surface: list[list[float]]) -> Section:
    return Section.parse({
        "name": "bank", "surface": surface, "base": {"elevation": 0.0},
        "strata": [layer("sand", cohesion="0 kPa", friction_angle="33 deg")],
    })  # fmt: skip


def rows(inputs: Section, shift: float = 0.0) -> Packing:
    """Rows of equal discs whose tops touch the surface, with discs held on either side."""
    x = np.arange(-0.5, 37.0, 2.0 * RADIUS)
    depth = RADIUS + 2.0 * RADIUS * np.arange(4)
    xs, down = (grid.ravel() for grid in np.meshgrid(x, depth))
    z = np.interp(xs, *np.array(inputs.surface, float).T) - down + shift
    layer_of = np.where((xs < 0.0) | (xs > 36.0), -1, 0).astype(np.int32)
    return Packing(xs, z, np.full(len(xs), RADIUS), layer_of, np.zeros((0, 6)))


def without(packing: Packing, gone: np.ndarray) -> Packing:
    return Packing(packing.x[~gone], packing.z[~gone], packing.radius[~gone], packing.layer[~gone], packing.lines)


def off(inputs: Section, packing: Packing) -> np.ndarray:
    return misfit(inputs, packing.discs(DiscMaterials([SOIL_SPRINGS], law="soil")), RADIUS)


@pytest.mark.parametrize("surface", [LEVEL, FACE])
def test_rows_that_touch_the_surface_are_level(surface: list[list[float]]) -> None:
    """On a face, too, where the surface falls by two thirds of a metre across one column."""
    ground = section(surface)
    assert off(ground, rows(ground)) == pytest.approx(0.0, abs=1e-9)


def test_a_hollow_is_filled() -> None:
    ground = section(LEVEL)
    packing = rows(ground)
    hollow = (np.abs(packing.x - 18.0) < 1.8) & (packing.z > TOP - 2.0 * RADIUS)
    before, after = without(packing, hollow), levelled(ground, without(packing, hollow), RADIUS, SPREAD)
    assert off(ground, before).min() < -1.9 * RADIUS
    assert np.abs(off(ground, after)).max() <= LARGEST_PROTRUSION * RADIUS
    assert (after.radius >= (1.0 - SPREAD) * RADIUS - 1e-9).all()
    assert (after.radius <= (1.0 + SPREAD) * RADIUS + 1e-9).all()


def test_what_stands_out_goes() -> None:
    """And nothing that does is laid in."""
    ground = section(LEVEL)
    packing = rows(ground)
    packing.z[(np.abs(packing.x - 18.0) < 1.8) & packing.free] += 0.5 * RADIUS
    after = levelled(ground, packing, RADIUS, SPREAD)
    assert (after.z + after.radius)[after.free].max() <= TOP + LARGEST_PROTRUSION * RADIUS + 1e-9


@pytest.mark.parametrize("surface", [LEVEL, FACE])
def test_new_discs_overlap_none_and_rest_on_two(surface: list[list[float]]) -> None:
    ground = section(surface)
    packing = rows(ground)
    rng = np.random.default_rng(1)
    before = without(packing, packing.free & (rng.uniform(size=len(packing.x)) < 0.15))
    after = levelled(ground, before, RADIUS, SPREAD)
    known = {(x, z) for x, z in zip(before.x, before.z, strict=True)}
    new = np.array([(x, z) not in known for x, z in zip(after.x, after.z, strict=True)])
    assert new.sum() >= 3
    gap = np.hypot(after.x[new, None] - after.x, after.z[new, None] - after.z) - after.radius[new, None] - after.radius
    gap[gap == -2.0 * after.radius[new, None]] = np.inf  # itself
    assert gap.min() >= -INSERTION_OVERLAP * RADIUS - 1e-9
    assert ((gap < 1e-9).sum(axis=1) >= 2).all()


def test_new_discs_at_the_toe_of_a_quay_overlap_none_behind_it() -> None:
    """The first of these lies six metres below the surface above it, and beside the place on the other two."""
    x, z = np.array([[17.9, 5.6], [18.3, 4.4], [19.3, 4.6]]).T
    before = Packing(x, z, np.full(3, RADIUS), np.zeros(3, np.int32), np.zeros((0, 6)))
    after = levelled(section(QUAY), before, RADIUS, SPREAD)
    assert len(after.x) > 3
    apart = np.hypot(after.x[:, None] - after.x, after.z[:, None] - after.z) - after.radius[:, None] - after.radius
    assert apart[np.triu_indices(len(after.x), 1)].min() >= -INSERTION_OVERLAP * RADIUS - 1e-9


def test_the_same_discs_give_the_same_surface() -> None:
    ground = section(FACE)
    packing = rows(ground)
    before = without(packing, packing.free & (np.arange(len(packing.x)) % 7 == 0))
    item, two = (levelled(ground, before, RADIUS, SPREAD) for _ in range(2))
    assert np.array_equal(item.x, two.x)
    assert np.array_equal(item.radius, two.radius)


def test_a_vertical_face_of_the_ground_is_deposited() -> None:
    """Discs in front of the vertical face of a quay "passed rigid line 2"; with a face 0.1 m wide they did not."""
    sand = layer("Sand", cohesion="5 kPa", friction_angle="35 deg")
    surface = [[0, 0], [10, 0], [10, -4], [20, -4]]
    ground = Section.parse({"name": "face", "surface": surface, "base": {"elevation": -8}, "strata": [sand]})
    box = deposit(ground, DemSettings(elements=120))
    x, z = box.ground.to_section(box.settled.x, box.settled.z)
    free = ~box.settled.fixed
    assert (free & (x > 12.0) & (z < -4.0)).any()
    assert not (free & (x > 12.0) & (z > -3.0)).any()


class Checkpoints:
    """Stores the discs before every round in files of a folder, and yields those before one of the rounds."""

    def __init__(self, folder: Path, resumed_at: int | None = None) -> None:
        self.folder, self.resumed_at = folder, resumed_at
        self.numbers: list[int] = []

    def latest(self) -> tuple[int, DiscModel] | None:
        if self.resumed_at is None:
            return None
        return self.resumed_at, DiscModel.load(self.folder / f"{self.resumed_at}.npz")

    def add(self, number: int, settled: DiscModel) -> None:
        self.numbers.append(number)
        if self.resumed_at is None:
            settled.save(self.folder / f"{number}.npz")


def test_a_deposit_that_was_stopped_continues_at_its_round_with_the_same_bits(tmp_path: Path) -> None:
    """Ctrl-C in the packings of a study of slides left nothing of the first minute."""
    sand = layer("Sand", cohesion="5 kPa", friction_angle="35 deg")
    clay = layer("Clay", cohesion="20 kPa", friction_angle="0 deg") | {"bottom": {"elevation": -3.0}}
    surface = [[0, 0], [10, 0], [16, -2], [24, -2]]
    ground = Section.parse({"name": "bank", "surface": surface, "base": {"elevation": -8}, "strata": [clay, sand]})
    settings = DemSettings(elements=120)
    first = Checkpoints(tmp_path)
    whole = deposit(ground, settings, rounds=first)
    assert first.numbers[:2] == [0, 1]
    for number in first.numbers:
        again = Checkpoints(tmp_path, resumed_at=number)
        resumed = deposit(ground, settings, rounds=again)
        assert again.numbers[0] == number
        for name in ("x", "z", "radius", "vx", "vz"):
            np.testing.assert_array_equal(getattr(resumed.settled, name), getattr(whole.settled, name), name)
        np.testing.assert_array_equal(resumed.ground.packing.x, whole.ground.packing.x)
