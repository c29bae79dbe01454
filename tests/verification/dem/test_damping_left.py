"""Softened contacts are damped as the stiff ones were: their dashpots follow the root of the stiffness that is left."""

import numpy as np
import pytest

from dem.assembly import DiscGeometry, DiscMaterials
from dem.case import Case
from dem.engine.engine import Engine
from dem.engine.time_step import largest_step
from dem.model import DiscModel
from dem.slides.liquefied_strength import liquefied
from dem.springs import LayerSprings, Strength, soil_discs
from tests.support import SECTIONS
from workflow.config import Config

SAND = soil_discs("sand", 1e7, Strength(0.3), 2000.0, 2000.0, 0.5, 0.25)


def rebound(layer: LayerSprings) -> float:
    """Speed after over speed before, of two equal discs that meet head on at 1 m/s each."""
    model = DiscModel.create(
        DiscGeometry([0.0, 1.001], [0.0, 0.0], 0.5), DiscMaterials([layer], law="soil", turns=False)
    )
    model.set_velocity(np.array([1.0, -1.0]), 0.0)
    Engine(dt=0.002 * largest_step(model).seconds, energies=False).run(model, 0.5)
    return float(-model.vx[0])


@pytest.mark.parametrize("stiffness", [1.0, 0.1, 0.02])
def test_restitution_is_that_of_the_layer_before(stiffness: float) -> None:
    """Contacts that do not pull have e = exp(-z a / s) with s = sqrt(1 - z^2), a = pi - atan2(2 z s, 1 - 2 z^2)
    (Schwager & Poeschel 2007) and z = c / (2 sqrt(m K)), here of two masses m on one contact: c = 0.1 sqrt(m K) makes
    z = 0.1 / sqrt(2), e = 0.81. With a tenth of the dashpots, the rule of the paper, e = 0.98, 0.93 and 0.85."""
    softened = liquefied([SAND], [0], Case(stiffness=stiffness))[0]
    ratio = 0.1 / np.sqrt(2.0)
    root = np.sqrt(1.0 - ratio**2)
    angle = np.pi - np.arctan2(2.0 * ratio * root, 1.0 - 2.0 * ratio**2)
    assert rebound(softened) == pytest.approx(np.exp(-ratio * angle / root), abs=0.01)


def test_a_damping_that_is_given_is_taken_and_the_papers_cases_give_theirs() -> None:
    assert liquefied([SAND], [0], Case(stiffness=0.02, damping=0.1))[0].cn == pytest.approx(0.1 * SAND.cn)
    assert liquefied([SAND], [0], Case(stiffness=0.04))[0].cn == pytest.approx(0.2 * SAND.cn)
    assert {case.damping for case in Config.load(SECTIONS / "s13.toml").slide.cases} == {0.1}
