"""A deposit that was stopped continues from the discs that it stored before its last round."""

from pathlib import Path

import numpy as np

from dem.model import DiscModel
from dem.search.deposit import deposit
from dem.settings import DemSettings
from tests.support.sections import analysed, slope
from workflow.run.store import Store
from workflow.stages.discs_at_rest import StoredRounds, discs_at_rest

FILE = "dem/slide_seed3_settled.npz"


def test_discs_before_a_round_are_stored_until_the_deposit_has_ended(tmp_path: Path) -> None:
    store, run = Store(tmp_path), analysed(slope())
    dem = DemSettings(elements=80)
    rounds = StoredRounds(store, FILE)
    assert rounds.latest() is None
    discs_at_rest(run, store, dem, FILE, lambda _: None)
    assert store.has(FILE)
    assert store.matching(["dem/*_round*.npz"]) == []
    settled = DiscModel.load(tmp_path / FILE)
    rounds.add(0, settled)
    rounds.add(1, settled)
    assert store.matching(["dem/*_round*.npz"]) == ["dem/slide_seed3_settled_round1.npz"]
    latest = rounds.latest()
    assert latest is not None
    assert latest[0] == 1
    np.testing.assert_array_equal(latest[1].x, settled.x)


def test_a_deposit_that_was_stopped_continues_in_its_folder(tmp_path: Path) -> None:
    """Ctrl-C in the packings of a slide left nothing of the first minute."""

    class Stopped(StoredRounds):
        def add(self, number: int, settled: DiscModel) -> None:
            super().add(number, settled)
            if number == 1:
                raise KeyboardInterrupt

    store, run = Store(tmp_path), analysed(slope())
    dem = DemSettings(elements=80)
    try:
        deposit(run.section, dem, rounds=Stopped(store, FILE))
    except KeyboardInterrupt:
        assert store.matching(["dem/*_round*.npz"]) == ["dem/slide_seed3_settled_round1.npz"]
    else:
        raise AssertionError("the deposit was not stopped")
    resumed = discs_at_rest(run, store, dem, FILE, lambda _: None)
    whole = deposit(run.section, dem)
    np.testing.assert_array_equal(resumed.settled.x, whole.settled.x)
    assert store.matching(["dem/*"]) == [FILE]
