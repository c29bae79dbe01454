"""The continuum that discs are calibrated to is no stronger than the section with ψ = φ."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.support import answers
from tests.support.sections import analysed, slope
from workflow.run.store import Store
from workflow.stages import dem_counterpart


@pytest.mark.parametrize(
    ("path_kc", "at_sides", "kc"), [(0.161, (), 0.127), (0.161, ("left",), 0.161), (0.12, (), 0.12)]
)
def test_a_path_on_a_coarse_mesh_does_not_count_above_the_critical_kh_with_full_dilation(
    path_kc: float, at_sides: tuple[str, ...], kc: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bank failed at 0.127 with ψ = φ, on the first mesh at 0.165 and with ψ = 0 at 0.161: discs got the strength of
    the latter. Fixed sides may hold ground that moves at a side."""
    config = analysed({**slope(), "fem": {"sides": "smooth"}})
    fem = answers.fem(config, 0.127).model_copy(update={"flow": "associated", "at_sides": at_sides, "kc_upper": 0.127})
    fem.write(Store(tmp_path))
    path = SimpleNamespace(kc=path_kc, upper=path_kc, verdict="plateau", reason="it is flat", steps=())
    monkeypatch.setattr(dem_counterpart, "_in_the_box_of_discs", lambda *_: None)
    monkeypatch.setattr(dem_counterpart, "stored_mesh", lambda *_: None)
    monkeypatch.setattr(dem_counterpart, "sides_of_discs", lambda _: "fixed")
    monkeypatch.setattr(dem_counterpart, "displacement_at", lambda *_: 0.01)
    monkeypatch.setattr(dem_counterpart, "_with_own_psi", lambda *_: (path, np.zeros((0, 2))))
    known = dem_counterpart.DemCounterpart.taken(
        fem, sides="fixed", instead="", yielding_m=0.01, slip_surface=(), deeper_than_m=None
    )
    monkeypatch.setattr(dem_counterpart.DemCounterpart, "of", lambda _: known)
    answer = dem_counterpart.find_dem_counterpart(config, Store(tmp_path), lambda _: None)
    assert (answer.kc, answer.kc_upper) == (kc, kc)
    assert ("finer meshes" in answer.reason) == (kc < path_kc)
