"""When strata liquefy under a record."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from tests.support.sections import slope
from workflow.settings import Input
from workflow.stages.shaking import shaking_of


def shaken(tmp_path: Path, **settings: Any) -> Input:
    time = np.linspace(0.0, 10.0, 101)
    lines = "\n".join(f"{t:.2f}, {-0.3 * t / 10.0:.5f}" for t in time)
    (tmp_path / "record.csv").write_text(f"time (s), a (g)\n{lines}\n")
    return Input.parse({**slope(), "slide": {"accelerogram": str(tmp_path / "record.csv"), **settings}})


def test_at_a_time_or_at_the_peak_where_nothing_says_f_l(tmp_path: Path) -> None:
    at_once = shaking_of(shaken(tmp_path, liquefies_at=4.0), [0, 1])
    assert at_once is not None
    assert at_once.onsets == {0: 4.0, 1: 4.0}
    assert np.abs(at_once.push).max() == pytest.approx(0.3 * 9.80665)
    peak = shaking_of(shaken(tmp_path), [1])
    assert peak is not None
    assert peak.onsets == {1: pytest.approx(10.0)}


def test_as_f_l_says(tmp_path: Path) -> None:
    """A record that grows evenly to its peak at 10 s reaches the share F_L of it after 10 F_L seconds."""
    spt = [{"depth": 2.0, "N": 4, "fines": 5}, {"depth": 6.0, "N": 8, "fines": 5}]
    given = shaken(tmp_path)
    data = given.model_dump(mode="python", by_alias=True, exclude_none=True, exclude={"uncertain", "study"})
    data["water"] = {"table": {"depth": 0.5}}
    for stratum in data["strata"]:
        for key in ("density_ordinary", "density_seismic"):
            stratum.pop(key, None)
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    data["earthquake"] = {"magnitude": 7.5, "peak_acceleration": "300 gal"}
    data["triggering"] = {"borings": [{"name": "B-1", "x": 50.0, "spt": spt}]}
    read = Input.parse(data)
    lowest = [one.lowest for one in read.assessment().strata]
    found = shaking_of(read, range(len(lowest)))  # the water table cuts the upper one in two
    assert found is not None
    assert any(factor is not None and factor < 0.9 for factor in lowest)
    for k, factor in enumerate(lowest):  # without a test a stratum waits for the peak
        assert found.onsets[k] == pytest.approx(10.0 * min(1.0, factor or 1.0), abs=0.1001)


def test_kh_that_is_held_has_no_record_and_a_missing_one_is_told(tmp_path: Path) -> None:
    assert shaking_of(Input.parse(slope()), [0]) is None
    (tmp_path / "record.csv").unlink(missing_ok=True)
    given = shaken(tmp_path)
    (tmp_path / "record.csv").unlink()
    with pytest.raises(InputError, match="no such accelerogram"):
        shaking_of(given, [0])
