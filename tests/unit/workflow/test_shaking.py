"""When strata liquefy under a record."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshes.errors import InputError
from tests.support.sections import analysed, assessment, problems, slope
from workflow.config import Config
from workflow.run.pipeline import leave_input
from workflow.run.store import Store
from workflow.stages.shaking import shaking_of


def with_shaking(tmp_path: Path, **settings: Any) -> Config:
    time = np.linspace(0.0, 10.0, 101)
    lines = "\n".join(f"{t:.2f}, {-0.3 * t / 10.0:.5f}" for t in time)
    (tmp_path / "record.csv").write_text(f"time (s), a (g)\n{lines}\n")
    return analysed({**slope(), "slide": {"accelerogram": str(tmp_path / "record.csv"), **settings}})


def test_at_a_time_or_at_the_peak_where_nothing_says_f_l(tmp_path: Path) -> None:
    at_once = shaking_of(with_shaking(tmp_path, liquefies_at=4.0), [0, 1])
    assert at_once is not None
    assert at_once.onsets == {0: 4.0, 1: 4.0}
    assert np.abs(at_once.acceleration).max() == pytest.approx(0.3 * 9.80665)
    peak = shaking_of(with_shaking(tmp_path), [1])
    assert peak is not None
    assert peak.onsets == {1: pytest.approx(10.0)}


def test_as_f_l_says(tmp_path: Path) -> None:
    """A record that grows evenly to its peak at 10 s reaches the share F_L of it after 10 F_L seconds."""
    spt = [{"depth": 2.0, "N": 4, "fines": 5}, {"depth": 6.0, "N": 8, "fines": 5}]
    config = with_shaking(tmp_path)
    data = config.to_data(set(Config.tables()) - {"uncertain", "study"})
    data["water"] = {"table": {"depth": 0.5}}
    for stratum in data["strata"]:
        for key in ("density_ordinary", "density_seismic"):
            stratum.pop(key, None)
        stratum |= {"density": "1.8 t/m^3", "density_saturated": "2.0 t/m^3"}
    data["earthquake"] = {"magnitude": 7.5, "peak_acceleration": "300 gal"}
    data["triggering"] = {"borings": [{"name": "B-1", "x": 50.0, "spt": spt}]}
    read = analysed(data)
    lowest = [item.lowest for item in assessment(read).strata]
    shaking = shaking_of(read, range(len(lowest)))  # the water table cuts the upper one in two
    assert shaking is not None
    assert any(factor is not None and factor < 0.9 for factor in lowest)
    for k, factor in enumerate(lowest):  # without a test a stratum waits for the peak
        assert shaking.onsets[k] == pytest.approx(10.0 * min(1.0, factor or 1.0), abs=0.1001)


def test_kh_that_is_held_has_no_record_and_a_missing_one_is_told(tmp_path: Path) -> None:
    assert shaking_of(analysed({**slope(), "slide": {"kh": 0.1}}), [0]) is None
    (tmp_path / "record.csv").unlink(missing_ok=True)
    config = with_shaking(tmp_path)
    (tmp_path / "record.csv").unlink()
    with pytest.raises(InputError, match="no such accelerogram"):
        shaking_of(config, [0])


def test_the_average_above_the_slip_surface_in_time(tmp_path: Path) -> None:
    """The discs feel what the layers make of a record of the rock: its peak is k_max."""
    time = np.arange(0.0, 8.0, 0.01)
    values = 0.1 * np.sin(2.0 * np.pi * 1.5 * time) * np.exp(-(((time - 4.0) / 1.5) ** 2))
    lines = "\n".join(f"{t:.3f}, {a:.7f}" for t, a in zip(time, values, strict=True))
    (tmp_path / "rock.csv").write_text(f"time (s), a (g)\n{lines}\n")
    response = {"record": str(tmp_path / "rock.csv"), "slip_depth": "6 m", "x": 10.0}
    data = {**slope(), "site_response": response}
    config = analysed({**data, "slide": {"accelerogram": "average", "liquefies_at": 3.0}})
    shaking = shaking_of(config, [0])
    assert shaking is not None
    largest = analysed({**data, "slide": {"kh": "k_max"}}).slide.kh
    assert np.abs(shaking.acceleration).max() / 9.80665 == pytest.approx(largest, abs=1e-4)
    assert len(shaking.acceleration) == len(time)
    assert shaking.onsets == {0: 3.0}
    assert config.files() == {"site_response, record": tmp_path / "rock.csv"}
    assert config.slide.shaking == "the average acceleration above the slip surface"
    twice = analysed({**data, "slide": {"accelerogram": "average", "scale": -2.0}})
    loaded = shaking_of(twice, [0])
    assert loaded is not None
    np.testing.assert_allclose(loaded.acceleration, -2.0 * shaking.acceleration)
    del response["slip_depth"]
    messages = problems({**data, "slide": {"accelerogram": "average"}}, Config)
    assert 'slide, accelerogram = "average": expected record and slip_depth in [site_response]' in "\n".join(messages)


def test_two_records_of_one_name_are_both_left_with_the_input(tmp_path: Path) -> None:
    for folder, size in (("rock", 0.1), ("ground", 0.2)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "record.csv").write_text(f"time (s), a (g)\n0.0, 0.0\n1.0, {size}\n2.0, 0.0\n")
    data = {**slope(), "site_response": {"record": str(tmp_path / "rock/record.csv")}}
    data["slide"] = {"accelerogram": str(tmp_path / "ground/record.csv")}
    leave_input(analysed(data), Store(tmp_path / "out"))
    again = Config.load(tmp_path / "out/section.toml")
    values = {name: path.read_text() for name, path in again.files().items()}
    assert "0.1" in values["site_response, record"]
    assert "0.2" in values["slide, accelerogram"]
