"""Contacts of undisturbed ground: which have the smaller friction, until when, and the same bits after a restart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.kernels.contact import MU, MU_OTHER
from dem.laboratory.soil_contacts import DILATION_SHARE, soil_contacts
from dem.model import DiscModel
from dem.pair_table import pair_table
from dem.search.calibrator import changed
from dem.springs import ROLLING, LayerSprings, Strength, soil_discs
from dem.undisturbed_contacts import DISTURBING_ROTATION, mark_undisturbed

RADIUS, FRICTION = 0.5, 0.4
SMALLER = FRICTION * (1.0 - DILATION_SHARE * FRICTION)
G = 9.81


def sand(friction: float = FRICTION) -> LayerSprings:
    discs = soil_discs("sand", 1e7, Strength(friction, 0.0, ROLLING), 2000.0, 2000.0, RADIUS, 0.25)
    return replace(discs, undisturbed_friction=friction * (1.0 - DILATION_SHARE * FRICTION))


def two_discs(angle: float, gap: float = -0.01) -> DiscModel:
    """The second disc lies at an angle (rad) from the first."""
    distance = 2.0 * RADIUS + gap
    return DiscModel.create(
        DiscGeometry(
            np.array([0.0, distance * np.cos(angle)]),
            np.array([0.0, distance * np.sin(angle)]),
            np.full(2, RADIUS),
            np.zeros(2, int),
        ),
        DiscMaterials([sand()], law="soil"),
    )


def place(model: DiscModel, angle: float, gap: float = -0.01) -> None:
    distance = 2.0 * RADIUS + gap
    model.x[1], model.z[1] = model.x[0] + distance * np.cos(angle), model.z[0] + distance * np.sin(angle)
    model.make_list()


def friction_of_contact(model: DiscModel) -> list[float]:
    return model.springs.pairs[MU, model.pair_kind].tolist()


def test_sand_has_a_smaller_friction_in_undisturbed_ground_and_clay_has_not() -> None:
    sandy, silty, clay = (
        soil_contacts(c, np.radians(phi), 1e5).discs("soil", 2e3, RADIUS, 0.25)
        for c, phi in ((0, 33), (2e3, 33), (2e4, 0))
    )
    assert sandy.undisturbed_friction == pytest.approx(sandy.friction * (1.0 - DILATION_SHARE * sandy.friction))
    assert silty.undisturbed_friction is not None
    assert sandy.undisturbed_friction / sandy.friction < silty.undisturbed_friction / silty.friction < 1.0
    assert clay.undisturbed_friction is None
    weaker, *_ = changed([sandy], "strength", 0.8)
    assert weaker.undisturbed_friction == pytest.approx(0.8 * sandy.undisturbed_friction)


def test_the_table_has_the_friction_of_both_materials_in_both_states() -> None:
    table = pair_table([sand(0.2), sand(0.6)], law="soil")
    n = table.size
    for block, of_layer in ((0, lambda s: s.friction), (1, lambda s: s.undisturbed_friction)):
        pairs = table.pairs[:, block * n * n : (block + 1) * n * n].reshape(-1, n, n)
        weak, strong = map(of_layer, table.layers)
        assert (pairs[MU, 0, 1], pairs[MU_OTHER, 0, 1]) == (weak, strong)
        assert (pairs[MU, 1, 2], pairs[MU_OTHER, 1, 2], pairs[MU, 2, 1]) == (strong, strong, strong)
        assert np.array_equal(pairs[:MU], table.pairs[:MU, : n * n].reshape(-1, n, n))


def test_a_contact_is_undisturbed_until_it_opens_or_turns() -> None:
    model = two_discs(0.3)
    assert friction_of_contact(model) == [FRICTION]
    mark_undisturbed(model)
    assert friction_of_contact(model) == [SMALLER]
    place(model, 0.3 + 0.9 * DISTURBING_ROTATION)
    assert friction_of_contact(model) == [SMALLER]
    place(model, 0.3 - 1.1 * DISTURBING_ROTATION)
    assert friction_of_contact(model) == [FRICTION]
    place(model, 0.3)
    assert friction_of_contact(model) == [FRICTION]

    model = two_discs(0.3)
    mark_undisturbed(model)
    place(model, 0.3, gap=0.01)
    place(model, 0.3)
    assert friction_of_contact(model) == [FRICTION]


def test_a_contact_that_came_later_is_not_of_undisturbed_ground() -> None:
    model = two_discs(0.3, gap=0.01)
    mark_undisturbed(model)
    place(model, 0.3)
    assert friction_of_contact(model) == [FRICTION]


def heap(threads: int, restart: Path | None = None) -> DiscModel:
    """Six rows of discs on a floor, which spread on an incline, with a checkpoint on the way."""
    i, j = np.meshgrid(np.arange(30), np.arange(6))
    x, z = (i + 0.5 * (j % 2)).ravel() * 2.0 * RADIUS, (0.5 + 0.866 * j).ravel() * 2.0 * RADIUS
    model = DiscModel.create(
        DiscGeometry(x, z, RADIUS * (1.0 + 0.02 * np.sin(np.arange(180.0))), np.zeros(180, int)),
        DiscMaterials([sand()], law="soil"),
        DiscBoundary(np.array([[0.0, 0.0, 0.0, 1.0, -1e3, 1e3]])),
        gravity=(0.5 * G, -G),
    )
    mark_undisturbed(model)
    assert model.undisturbed.any()
    engine = Engine(dt=0.4 * largest_step(model).seconds, threads=threads)
    engine.run(model, 0.5)
    if restart is not None:
        model.save(restart)
        model = DiscModel.load(restart)
    engine.run(model, 0.5)
    return model


def test_same_bits_with_two_threads_and_after_a_restart(tmp_path: Path) -> None:
    serial = heap(1)
    for other in (heap(2), heap(1, tmp_path / "checkpoint.npz")):
        for name in ("x", "z", "vx", "vz", "undisturbed", "pair_i", "shear"):
            assert np.array_equal(getattr(serial, name), getattr(other, name)), name
    assert 0 < serial.undisturbed.sum() < len(serial.undisturbed)
    unmarked = replace(serial, undisturbed=np.zeros(0, bool))
    assert np.array_equal(unmarked.pair_kind, serial.kind(serial.pair_i, serial.pair_j))
