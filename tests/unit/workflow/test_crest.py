"""Crests of the ground, their settlement and their freeboard, by hand numbers."""

import numpy as np
import pytest

from workflow.estimates.crest import (
    Crest,
    crest_between,
    crest_level,
    crest_settlement,
    embankments,
    freeboard,
    reconsolidation_settlement,
)
from workflow.estimates.structures import CrestedStructure
from workflow.report.crests import crest_sentences, crests_in_short
from workflow.results.verdicts import CrestPart
from workflow.texts.report_texts import Texts

# The levee of tests/support/levee: crest at 15 m from x = 66 to 72 m, a berm, low-water bank at 40 to 48 m.
LEVEE = np.array(
    [[0, 6], [40, 6], [48, 10], [56, 10], [66, 15], [72, 15], [77, 12.5], [81, 12.5], [86, 10], [140, 10]], float
)


def test_a_levee_is_found_and_its_bank_is_not() -> None:
    assert embankments(LEVEE) == (Crest(56.0, 86.0, 66.0, 72.0, 15.0),)
    mirrored = np.column_stack([-LEVEE[::-1, 0], LEVEE[::-1, 1]])
    assert embankments(mirrored) == (Crest(-86.0, -56.0, -72.0, -66.0, 15.0),)


def test_a_foot_in_a_channel_is_where_the_other_foot_is_high() -> None:
    ground = np.array([[0, 5], [10, 5], [30, 15], [36, 15], [46, 10], [90, 10]], float)
    assert embankments(ground) == (Crest(20.0, 46.0, 30.0, 36.0, 15.0),)


@pytest.mark.parametrize(
    "ground",
    [
        [[0, 0], [100, 0]],
        [[0, 10], [40, 10], [60, 0], [100, 0]],  # a slope has one face
        [[0, 0], [100, 5], [200, 0]],  # a hill, 1 in 20
        [[0, 0], [50, 0], [51, 0.8], [52, 0], [100, 0]],  # a kerb
    ],
)
def test_ground_without_embankments(ground: list[list[float]]) -> None:
    assert embankments(np.array(ground, float)) == ()


def test_two_levees_of_a_river_and_a_ridge() -> None:
    ground = np.array([[0, 0], [10, 4], [20, 0], [50, 0], [60, 3], [64, 3], [74, 0], [100, 0]], float)
    first, second = embankments(ground)
    assert (first.left, first.right, first.width) == (10.0, 10.0, 0.0)
    assert (second.left, second.right) == (60.0, 64.0)


def test_the_crest_of_a_structure_that_is_given() -> None:
    assert crest_between(LEVEE, 56.0, 86.0) == Crest(56.0, 86.0, 66.0, 72.0, 15.0)
    bank = crest_between(LEVEE, 40.0, 56.0)
    assert (bank.left, bank.right, bank.elevation) == (48.0, 56.0, 10.0)
    yard = crest_between(LEVEE, 100.0, 120.0)
    assert (yard.left, yard.right) == (100.0, 120.0)


CREST = Crest(56.0, 86.0, 66.0, 72.0, 15.0)


def test_a_crest_that_sinks_and_one_that_moves_aside() -> None:
    assert crest_level(LEVEE, CREST) == pytest.approx(15.0)
    assert crest_settlement(LEVEE, LEVEE - [0.0, 0.4], CREST) == pytest.approx(0.4)
    assert crest_settlement(LEVEE, LEVEE - [2.0, 0.0], CREST) == pytest.approx(0.0, abs=1e-6)
    tilted = LEVEE.copy()
    tilted[4, 1] -= 1.0  # its left shoulder: the highest 6 m lie s = 1.5 m further right, (1 - s/6)²/2 + s²/24 lower
    assert crest_settlement(LEVEE, tilted, CREST) == pytest.approx(0.375, abs=0.001)


def test_rough_surfaces_and_a_surface_that_ends_before_the_crest() -> None:
    x = np.arange(50.0, 90.0, 0.25)
    rough = np.column_stack([x, np.interp(x, *LEVEE.T) + 0.1 * np.cos(np.arange(len(x)) * np.pi)])
    assert crest_level(rough, CREST) == pytest.approx(15.0, abs=0.01)
    assert crest_level(LEVEE[:5], CREST) is None
    assert crest_settlement(LEVEE, LEVEE[:5], CREST) is None
    ridge = Crest(0.0, 20.0, 10.0, 10.0, 4.0)
    assert crest_level(np.array([[0, 0], [10, 4], [20, 0]], float), ridge) == pytest.approx(4.0)


def test_reconsolidation_by_hand() -> None:
    """5 m of sand at 3.83 % (Idriss & Boulanger 2008 at the levee's blow counts): 0.19 m, as by hand."""
    assert reconsolidation_settlement([5.0], [0.0383]) == pytest.approx(0.1915)
    assert reconsolidation_settlement([2.0, 3.0], [0.04, 0.01]) == pytest.approx(0.11)
    assert reconsolidation_settlement([], []) == 0.0


def test_freeboard() -> None:
    assert freeboard(15.0, 0.5, 9.8) == pytest.approx(4.7)
    assert freeboard(15.0, 0.5, 14.8) == pytest.approx(-0.3)


QUAY = np.array([[0, 3], [50, 3], [50, -9], [90, -10]], float)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_wall_at_the_foot_is_the_face_of_a_quay(mirrored: bool) -> None:
    """The crest of a quay towards the right was its landward foot alone, so that no slip circle had a crest above."""
    ground = np.column_stack([90.0 - QUAY[::-1, 0], QUAY[::-1, 1]]) if mirrored else QUAY
    quay = crest_between(ground, 40.0, 70.0) if mirrored else crest_between(ground, 20.0, 50.0)
    assert (quay.left, quay.right, quay.elevation) == ((40.0, 70.0, 3.0) if mirrored else (20.0, 50.0, 3.0))
    before = crest_between(ground, 5.0, 40.0) if mirrored else crest_between(ground, 50.0, 85.0)
    assert before.elevation == -9.0  # the wall rises away from what stands on the sea bed
    inside = crest_between(ground, 35.0, 70.0) if mirrored else crest_between(ground, 20.0, 55.0)
    assert (inside.left, inside.right) == ((40.0, 70.0) if mirrored else (20.0, 50.0))


def test_the_freeboard_of_the_first_page_is_that_of_all_packings() -> None:
    """One of three packings settled 3.9 m, to 0.9 m below the water: the first page said "freeboard 0.27 to 1.8 m"."""
    slid = {"structure": "dam", "reconsolidation_m": None, "water_m": 7.0, "at_rest": True}
    parts = [
        CrestPart(method="discs, case 1", settlement_m=1.2, settlement_low_m=0.7, settlement_high_m=1.7,
                  freeboard_m=1.8, freeboard_low_m=1.3, freeboard_high_m=2.3, **slid),
        CrestPart(method="discs, case 2", settlement_m=2.73, settlement_low_m=2.2, settlement_high_m=3.9,
                  freeboard_m=0.27, freeboard_low_m=-0.9, freeboard_high_m=0.8, **slid),
    ]  # fmt: skip
    (sentence,) = crests_in_short(parts, Texts("en"))
    assert sentence.endswith("settles 0.70 to 3.9 m; the remaining freeboard is -0.90 to 2.3 m.")
    second = list(crest_sentences(iter(parts)))[1]
    assert "the remaining freeboard is 0.27 m (-0.90 m to 0.80 m)" in second


def test_a_failure_that_ends_between_its_last_column_and_the_next_one_at_the_crest_is_of_the_crest() -> None:
    """The upstream face of a dam slid along a band that reached the ground at x = 60.3 m, on the crest from 60 to 66 m.
    Columns of 1.3 m found it up to 59.15 m, 1.3 m below the ground: the face had 0.157, in place of 0.148."""
    dam = CrestedStructure("dam", "dam", Crest(start=40.0, end=90.0, left=60.0, right=66.0, elevation=10.0))
    points = [(38.35 + 1.3 * k, -0.5 + 0.04 * k**2) for k in range(17)]
    assert points[-1][0] == pytest.approx(59.15)
    assert dam.slides_with(points)
    assert not dam.slides_with(points[:-1])
