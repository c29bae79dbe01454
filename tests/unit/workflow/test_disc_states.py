"""States of the discs at the recorded Kh: sets that are the same are computed once and have files of their own."""

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from dem.ground import Ground
from dem.search.critical import Search
from dem.settings import DemSettings
from meshes.executor import SERIAL
from tests.support.dem_cases import SOIL_SPRINGS, box
from tests.support.sections import analysed, slope
from workflow.results.discs import RecordedDiscs
from workflow.run.store import Store
from workflow.stages import disc_states
from workflow.stages.disc_states import DiscsAtRest, StateAtKh, is_alike, keep_states


def discs(settings: DemSettings, friction: float = 0.7) -> DiscsAtRest:
    """A box of discs that fails at 0.3."""
    model = box(4, 3, replace(SOIL_SPRINGS, friction=friction))
    return DiscsAtRest(model, cast(Ground, None), Search(0.28, 0.3, "bracketed", flexibility_m=0.1), settings)


def test_the_same_discs_are_alike_and_weaker_ones_are_not() -> None:
    settings = DemSettings()
    assert is_alike(discs(settings), discs(settings))
    assert not is_alike(discs(settings), discs(settings, friction=0.6))
    moved = discs(settings)
    moved.settled.x[3] += 1e-9
    assert not is_alike(discs(settings), moved)
    assert not is_alike(discs(settings), replace(discs(settings), search=Search(0.28, 0.29, "bracketed")))


def test_a_state_of_the_same_discs_is_computed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Discs before and after a calibration by a factor of 1, and those of the paper, at two Kh and at failure."""
    run, store, computed = analysed(slope()), Store(tmp_path), []

    def reached(goal: StateAtKh, _: Any) -> RecordedDiscs:
        computed.append((goal.springs, goal.label))
        file = disc_states.state_file(goal.springs, goal.label)
        store.save(file, goal.start.settled)
        return RecordedDiscs.model_construct(set=goal.springs, file=file, kh=goal.kh, slip_surface=[[0.0, goal.kh]])

    monkeypatch.setattr(disc_states, "_reached", reached)
    run = run.with_settings("dem", kh=[0.1, 0.2])
    sets: disc_states.Sets = {"before": discs(run.dem), "after": discs(run.dem), "paper": discs(run.dem, friction=0.5)}
    stored = keep_states(run, store, sets, SERIAL)
    assert computed == [(which, label) for which in ("before", "paper") for label in ("0.1", "0.2", "failing")]
    assert [(state.set, state.kh) for state in stored.states] == [(s, kh) for s in sets for kh in (0.1, 0.2)]
    assert stored.states[2].file == "dem/state_after_0.1.npz"
    assert (tmp_path / stored.states[2].file).read_bytes() == (tmp_path / stored.states[0].file).read_bytes()
    assert [stored.surface(which).tolist() for which in sets] == [[[0.0, 0.3]]] * 3
