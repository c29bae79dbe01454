"""Reading a config computes nothing: what it leaves to analyses is found by a function of its own."""

from pathlib import Path
from typing import Any

import pytest

from tests.support.borings import bored
from workflow.config import Config, after_triggering


def left_to_analyses(folder: Path) -> dict[str, Any]:
    """A section whose strata, cases and Kh are left to blow counts and a record of the rock."""
    (folder / "rock.csv").write_text("time (s), a (g)\n0.0, 0.0\n0.1, 0.1\n0.2, -0.1\n0.3, 0.0\n")
    data = bored()
    data["triggering"] |= {"share": 0.3, "cases": ["median"], "pore_pressure": True}
    return {
        **data,
        "slide": {"kh": "k_max"},
        "site_response": {"record": str(folder / "rock.csv"), "slip_depth": "6 m"},
        "uncertain": {"strata.loose.friction_angle": {"normal": ["30 deg", "1 deg"]}},
    }


def test_reading_a_config_calls_no_analysis(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = left_to_analyses(tmp_path)

    def refuse(*_: object) -> None:
        raise AssertionError("an analysis")

    with monkeypatch.context() as patched:
        for name in ("assess", "residual_strengths", "pore_pressures", "column_of", "loading_of_slides"):
            patched.setattr(after_triggering, name, refuse)
        for place in ("assessment.assess", "consequences.residual_strengths", "consequences.pore_pressures"):
            patched.setattr(f"workflow.earthquake.triggering.{place}", refuse)
        for place in ("column.column_of", "site_response.response", "equivalent_kh.equivalent_kh"):
            patched.setattr(f"workflow.earthquake.{place}", refuse)
        config = Config.parse(data)
        with pytest.raises(AssertionError, match="an analysis"):
            after_triggering.config_after_triggering(config)
    assert [tuple(stratum.liquefies_in) for stratum in config.section.strata] == [(), ()]
    assert (config.cases, config.left_open) == ((), {"kh": "k_max"})
    result = after_triggering.config_after_triggering(config)
    assert [tuple(stratum.liquefies_in) for stratum in result.section.strata] == [(1,), ()]
    assert [case.name for case in result.cases] == ["median"]
    assert 0.0 < result.slide.kh != 0.1
    assert after_triggering.config_after_triggering(result) == result
