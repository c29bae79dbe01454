"""Discs are pushed to where the finite elements fail."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.sections import slope
from tests.unit.workflow.test_paper import fem
from workflow.config import Config
from workflow.run.store import Store
from workflow.stages import discs_at_rest


@dataclass
class Ground:
    """What matters here of the ground of the discs, whose packing takes a while."""

    downhill: int = 1
    fails_towards: int | None = None


@pytest.mark.parametrize(("towards", "sign"), [("left", -1), ("right", 1), (None, None)])
def test_discs_go_where_the_ground_fails(
    towards: str | None, sign: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In searches; slides are positive downslope whatever the finite elements give."""
    monkeypatch.setattr(discs_at_rest, "ground_of", lambda run, dem: Ground())
    run, store = Config.parse(slope()), Store(tmp_path)
    if towards is not None:
        fem(run).model_copy(update={"towards": towards}).write(store)
    ground = discs_at_rest.ground_for(run, store, run.dem.as_paper(), None)  # type: ignore[arg-type]
    assert (ground.fails_towards, ground.downhill) == (sign, 1)
