"""Cohesionless ground that stands comes to rest as material points, on steep faces and beside free-field sides."""

import numpy as np
import pytest

from fem.continuum.face_reinforcement import STRIP_SUFFIX, strengthened
from fem.kernels import point_stress as law
from fem.mpm.faces import LEAST_KH, with_firm_faces
from fem.mpm.ground import PointGround, ground_of
from fem.mpm.slide import PointSlider
from workflow.config import Config

HEIGHT = 8.0  # m
DENSITY = 2000.0  # kg/m³


def config(run: float, friction: float, cohesion: float = 0.0) -> Config:
    """Return a face of 8 m that rises over the length ``run`` (m), on ground of the same soil."""
    soil = {
        "name": "gravel",
        "density_ordinary": DENSITY,
        "density_seismic": DENSITY,
        "youngs_modulus": 4e7,
        "poissons_ratio": 0.3,
        "cohesion": cohesion,
        "friction_angle": float(np.radians(friction)),
    }
    surface = [[0.0, 0.0], [14.0, 0.0], [14.0 + run, HEIGHT], [32.0 + run, HEIGHT + 1.0]]
    return Config.parse({"name": "face", "surface": surface, "base": {"elevation": -4.0}, "strata": [soil]})


def at_rest(config: Config) -> PointSlider:
    """Return the ground at rest between free-field sides; it crept for longer than 30 s without firm faces."""
    ground = ground_of(config.section, 800, "free-field")
    slider = PointSlider(with_firm_faces(ground, config.fem), -1)
    assert slider.settle() < 0.05
    return slider


@pytest.mark.parametrize(("run", "friction"), [(8.0, 46.0), (8.0, 45.0), (8.0, 42.0), (16.0, 27.5), (16.0, 25.0)])
def test_a_face_near_its_friction_angle_comes_to_rest(run: float, friction: float) -> None:
    """Faces of 45 and 26.6 degrees, at 0.88 to 1.04 times their friction angle."""
    slider = at_rest(config(run, friction))
    assert slider.engine.time < 10.0
    assert [(face.start, face.end) for face in slider.ground.firm_faces] == [(14.0, 14.0 + run)]


def test_free_field_sides_press_at_least_actively_on_the_ground() -> None:
    """Rankine's pressure of cohesionless ground: tan²(45 deg - φ/2) of the vertical stress, on each row of points."""
    friction = 27.5
    slider = at_rest(config(16.0, friction))
    ground, original = slider.ground, slider.engine.original
    side, places = original(ground.points.side), original(ground.points.start) + ground.offset
    height = original(ground.points.state[:, law.VOLUME]) / (0.5 * ground.grid.cell)
    right = side < 0.0
    active = np.tan(np.radians(45.0 - 0.5 * friction)) ** 2
    stress = DENSITY * 9.80665 * (HEIGHT + 1.0 - places[right, 1])
    assert right.sum() > 20
    assert (-side[right] >= 0.97 * active * stress * height[right]).all()


def strengths(ground: PointGround) -> np.ndarray:
    return ground.points.properties[:, law.STRENGTH].copy()


def test_only_the_ground_next_to_a_face_that_creeps_is_strengthened() -> None:
    steep = config(8.0, 45.0)
    ground = ground_of(steep.section, 800)
    before = strengths(ground)
    changed = np.flatnonzero(strengths(with_firm_faces(ground, steep.fem)) != before)
    places = ground.points.x[changed] + ground.offset
    depth = np.clip(places[:, 0] - 14.0, 0.0, HEIGHT) - places[:, 1]
    assert len(changed) > 20
    assert ((places[:, 0] > 14.0) & (places[:, 0] < 22.0) & (depth < steep.fem.least_depth)).all()
    for flat_or_cohesive in (config(16.0, 45.0), config(8.0, 45.0, cohesion=5e3)):
        ground = ground_of(flat_or_cohesive.section, 800)
        before = strengths(ground)
        assert not with_firm_faces(ground, flat_or_cohesive.fem).firm_faces
        np.testing.assert_array_equal(strengths(ground), before)
    assert np.tan(np.radians(45.0) - np.arctan(0.5)) > LEAST_KH


def test_ground_below_water_has_the_cohesion_of_the_limit_analysis() -> None:
    """A face whose strengthened depth reaches below water: one cohesion, with the unit weight of the face."""
    data = config(8.0, 45.0).section.model_dump(mode="python", exclude_none=True, by_alias=True)
    [soil] = data["strata"]
    data["strata"] = [soil | {"density_saturated": 2200.0}]
    data["water"] = {"table": [[0.0, -0.2], [14.0, -0.2], [22.0, 7.8], [40.0, 8.8]]}
    wet = Config.parse(data)
    ground = with_firm_faces(ground_of(wet.section, 3200), wet.fem)
    [face] = ground.firm_faces
    expected = {
        stratum.cohesion
        for stratum in strengthened(wet.section, [face], wet.fem).strata
        if STRIP_SUFFIX in stratum.name
    }
    number, friction = ground.points.stratum, np.radians(45.0)
    at_face = (strengths(ground) > 0.0) & (number >= 0)
    assert len(np.unique(number[at_face])) == 2, "above and below water"
    assert len(expected) == 1
    np.testing.assert_allclose(strengths(ground)[at_face], expected.pop() * np.cos(friction))
