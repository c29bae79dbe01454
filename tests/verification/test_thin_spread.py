"""Spread behind a bank, integrated over its depth, against closed forms; what it says of known field slides."""

import numpy as np
import pytest

from docs.verify.slides.case import FOLDER, read_cases
from meshes.section.strain_potential import soft_range
from tests.support import TOP
from tests.support.thin_spread import ThinGround, spread_of

WEIGHT, EFFECTIVE, HEIGHT = 19e3, 6e4, 6.0  # N/m3, Pa, m
AUTHOR = "heavy liquid under a crust, integrated over its depth, the same strengths"
BANKS = {
    case.name: case
    for case in read_cases(TOP / FOLDER)
    if any(value.author == AUTHOR for value in case.known.values)
}  # fmt: skip
QUIET = np.array([0.0, 1.0]), np.zeros(2)  # no shaking


def liquid(layer: np.ndarray, step: float, strength: float, potential: float) -> ThinGround:
    """Ground without a crust."""
    weight = np.full(len(layer), WEIGHT)
    return ThinGround(
        step, np.zeros(len(layer)), layer, weight, weight, np.full(len(layer), EFFECTIVE), strength, potential
    )


def test_ground_follows_a_small_step_by_the_exponential_of_its_distance() -> None:
    """λ² = w H²/(2 k), k = τ/(γ H): a step of thickness δ moves by δ λ/H, ground at a distance of λ by 1/e of that.

    By equilibrium w H²/2 u'' = k u, and by the jump of w H²/2 u' across the step, which is w H δ.
    """
    step, drop, potential, strength = 2.0, 0.03, 0.45, 6e3
    x = np.arange(-200.0 + 0.5 * step, 200.0, step)
    way = liquid(np.where(x < 0.0, HEIGHT, HEIGHT - drop), step, strength, potential).spread(*QUIET, 90.0, 0.01)
    [end], [knee] = soft_range(potential, np.array([EFFECTIVE]), np.array([strength]))
    length = np.sqrt(0.5 * WEIGHT * HEIGHT**2 / (knee / end / HEIGHT))
    assert 30.0 < length < 36.0
    assert way.max() == pytest.approx(drop * length / HEIGHT, rel=0.03)
    assert np.interp(-length, x, way) == pytest.approx(way.max() / np.e, rel=0.05)
    assert way == pytest.approx(way[::-1], rel=0.03, abs=1e-3)


@pytest.mark.parametrize(
    ("share", "moves"), [pytest.param(0.9, False, marks=pytest.mark.slow), (1.4, False), (1.7, True)]
)
def test_liquid_stands_while_its_thickness_changes_by_less_than_its_strength(share: float, moves: bool) -> None:
    """A wedge of 30 m between two level layers, at shares of what its base holds alone: w (h1² - h2²)/2 = share s 30 m.

    Its ends hold π s/2 (h1 + h2) besides, above and below: it stands up to a share of 1 + π (h1 + h2)/60 = 1.5.
    """
    strength, step = 5e3, 1.0
    x = np.arange(0.5, 60.0, step)
    layer = np.sqrt(HEIGHT**2 - 2.0 * share * strength / WEIGHT * np.clip(x - 15.0, 0.0, 30.0))
    way = liquid(layer, step, strength, 0.0).spread(*QUIET, 40.0)
    assert (way.max() > 0.15 * HEIGHT) == moves
    assert way.max() < HEIGHT


@pytest.mark.slow
def test_banks_of_the_field_spread_as_it_is_told_beside_them() -> None:
    """River Park at 25.6 m from its bank: 3.9 m, where material points move 1.5 m and 3.2 to 4.25 m were measured."""
    case = BANKS["imperial_valley_1979_w9"]
    moved = spread_of(case)
    assert moved == pytest.approx(3.9, abs=0.1)
    assert spread_of(case, step=2.0) == pytest.approx(moved, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", BANKS)
def test_every_bank_spreads_as_it_is_told_beside_it(name: str) -> None:
    [messages] = [value.ends[0] for value in BANKS[name].known.values if value.author == AUTHOR]
    assert spread_of(BANKS[name]) == pytest.approx(messages, rel=0.03, abs=0.01)
