"""When the search for bounds goes on, how far the next mesh goes, and why it ends."""

import itertools
import time

import numpy as np
import pytest

from fem.limit.bounds import kh_bounds
from fem.limit.bracket import Bracket, Limits, MeshBounds
from fem.limit.safety_bounds import safety_bounds
from fem.settings import LEAST_KH, BoundsSettings, FemSettings
from meshes.section.section import Section
from tests.support import SECTIONS


class FixedBracket(Bracket):
    """A bracket of bounds alone."""

    def __init__(self, *bounds: tuple[float | None, float | None]) -> None:
        meshes = [MeshBounds(100 * 2**k, low, high, (), 2.0**k) for k, (low, high) in enumerate(bounds)]
        super().__init__(None, None, meshes, None)

    @property
    def lower(self) -> float:
        return max((m.lower for m in self.meshes if m.lower is not None), default=-np.inf)

    @property
    def upper(self) -> float:
        return min((m.upper for m in self.meshes if m.upper is not None), default=np.inf)

    @property
    def gap(self) -> float:
        return 2.0 * (self.upper - self.lower) / (self.upper + self.lower) if np.isfinite(self.upper) else np.inf


CLOSING = FixedBracket((0.2, 0.4), (0.25, 0.35), (0.28, 0.32))


@pytest.mark.parametrize(
    ("limits", "ended"),
    [
        (Limits(0.02, 10_000), None),
        (Limits(0.15, 10_000), "gap"),
        (Limits(0.02, 10_000, sufficient_upper=0.33), "enough"),
        (Limits(0.02, 470), "triangles"),
        (Limits(0.02, 10_000, seconds=15.0), "time"),  # 1 + 2 + 4 s, and 2^1.2 times 4 s for the next one
        (Limits(0.02, 10_000, seconds=17.0), None),
    ],
)
def test_each_limit_ends_the_search(limits, ended):
    assert limits.reached(CLOSING, 400) == ended


def test_a_search_that_makes_no_progress_ends():
    """As on the river bank before its shallow failure was known: 0.1231 to 0.1402 on every mesh."""
    same = (0.1231, 0.1402)
    limits = Limits(0.02, 100_000)
    assert limits.reached(FixedBracket((0.1, 0.2), same, same, same), 1000) is None
    assert limits.reached(FixedBracket((0.1, 0.2), (0.11, 0.2), same, same, same), 1000) == "stalled"
    assert limits.reached(FixedBracket(*[(None, 0.2)] * 5), 1000) == "stalled"
    assert limits.reached(FixedBracket(*[(None, 0.2)] * 4, (0.1, 0.2)), 1000) is None


def test_the_last_mesh_is_as_large_as_it_needs_to_be():
    limits = Limits(0.06, 2000)
    assert limits.growth(CLOSING, 400) == pytest.approx(1.15 * CLOSING.gap / 0.06)
    assert limits.growth(FixedBracket((0.2, 0.4)), 100) == 2.0
    assert limits.growth(CLOSING, 1500) == pytest.approx(2000 / 1500)


def test_bounds_of_a_small_kh_are_close_enough_at_the_same_difference_in_kh():
    """1 %, or 0.002 in Kh where Kh is below 0.2; a factor of safety to half of that share."""
    limits = Limits(0.01, 10_000, smallest_mean=LEAST_KH)
    assert limits.reached(FixedBracket((0.015, 0.0169)), 100) == "gap"
    assert limits.reached(FixedBracket((0.015, 0.0171)), 100) is None
    assert limits.reached(FixedBracket((0.398, 0.4019)), 100) == "gap"
    assert limits.reached(FixedBracket((0.398, 0.4021)), 100) is None
    assert BoundsSettings().of_factors.gap == 0.5 * BoundsSettings().gap == 0.005


@pytest.mark.parametrize("seconds", [0.5, pytest.param(2.0, marks=pytest.mark.slow)])
def test_the_allowed_work_is_a_limit(seconds):
    """All programs of both directions, Davis's estimate and the trials of a factor; the bounds found by then count."""
    section = Section.read(SECTIONS / "slope_2to1.toml")
    limits = BoundsSettings(gap=1e-4, seconds=seconds, davis=True)
    answer = kh_bounds(section, FemSettings(), limits)
    every = [*answer.directions, *(answer.substitute.directions if answer.substitute else ())]
    assert sum(mesh.work for direction in every for mesh in direction.meshes) <= 1.01 * seconds
    assert answer.end_reason == "time"
    assert answer.lower < answer.upper < 2.0 * answer.lower
    factor = safety_bounds(section, FemSettings(), limits, smooth_sides=True)
    assert sum(trial.work for trial in factor.trials) <= 1.01 * seconds
    assert factor.end_reason == "time"
    assert 0.0 < factor.lower < factor.upper < 2.0 * factor.lower


def test_a_slow_clock_changes_nothing(monkeypatch):
    """Every look at any clock finds an hour gone: the meshes, and both bounds to the bit, are the same."""
    section = Section.read(SECTIONS / "slope_2to1.toml")
    bounds_settings = BoundsSettings(gap=0.001, seconds=0.25, davis=False)
    quiet = kh_bounds(section, FemSettings(), bounds_settings)
    hours = itertools.count(0.0, 3600.0)
    for clock in ("time", "monotonic", "perf_counter", "process_time"):
        monkeypatch.setattr(time, clock, lambda: next(hours))
    loaded = kh_bounds(section, FemSettings(), bounds_settings)
    assert quiet.end_reason == loaded.end_reason == "time"
    assert quiet.meshes == loaded.meshes
