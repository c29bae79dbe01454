"""A stage that was stopped continues from its finished parts."""

from pathlib import Path

import pytest

from meshes.executor import SERIAL, Tell
from tests.support.sections import slope
from workflow.config import Config
from workflow.results.continuum import Variant
from workflow.results.finished_parts import FinishedParts
from workflow.results.stability import LiquefiedCase
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages import liquefied
from workflow.stages.declared import STAGES


def variant(name: str, kc: float) -> Variant:
    return Variant(name=name, change=name, kc=kc, kc_upper=None, verdict="plateau", reason="", seconds=1.0)


def test_stored_parts_are_not_computed_again(tmp_path: Path) -> None:
    computed: list[str] = []
    stops_at = "c"

    def compute(name: str, tell: Tell) -> Variant:
        computed.append(name)
        tell("limit load")
        if name == stops_at:
            raise KeyboardInterrupt
        return variant(name, 0.1 / 3.0)

    parts: FinishedParts[Variant] = FinishedParts(Store(tmp_path), "fem/variants", Variant)
    with pytest.raises(KeyboardInterrupt):
        parts.compute(SERIAL, compute, ["a", "b", "c", "d"])
    stops_at, heard, done = "", list[int](), list[int]()
    results = parts.compute(
        SERIAL, compute, ["a", "b", "c", "d"], lambda place, _: heard.append(place), lambda place, _: done.append(place)
    )
    assert computed == ["a", "b", "c", "c", "d"]
    assert [each.name for each in results] == ["a", "b", "c", "d"]
    assert results[0] == variant("a", 0.1 / 3.0)
    assert heard == [2, 3]
    assert sorted(done) == [0, 1, 2, 3]
    parts.remove()
    assert Store(tmp_path).matching(["fem/*"]) == []


def test_a_part_of_another_version_is_computed_again(tmp_path: Path) -> None:
    store = Store(tmp_path)
    parts: FinishedParts[Variant] = FinishedParts(store, "fem/variants", Variant)
    with store.writing("fem/variants_part0.json") as path:
        path.write_text('{"title": "a"}', encoding="utf-8")
    assert parts.read(0) is None


@pytest.mark.parametrize("name", ["faces", "liquefied", "variants"])
def test_parts_are_removed_when_the_input_has_changed(name: str) -> None:
    stage = next(stage for stage in STAGES if stage.name == name)
    assert f"fem/{name}_part*.json" in stage.leftovers


def test_cases_after_liquefaction_are_stored_as_they_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in the second case began with the first one again."""
    data = slope()
    data["strata"][0] |= {"liquefies_in": [1, 2]}
    data["slide"] = {"cases": [{"residual": 0.1}, {"residual": 0.2}]}
    job = Job(Config.parse(data), Store(tmp_path), ())
    computed: list[int] = []
    stops = True

    def case(_config: object, _mesh: object, _remains: object, numbers: list[int]) -> LiquefiedCase:
        computed.extend(numbers)
        if stops and numbers == [2]:
            raise KeyboardInterrupt
        return LiquefiedCase(
            verdict="stands", reason="", kc=0.1, kc_lower=None, kc_upper=None, factor=1.2, factor_lower=None,
            factor_upper=None, notes=(), cases=tuple(numbers), names=(), strata=(), circles=None,
        )  # fmt: skip

    monkeypatch.setattr(liquefied, "_case", case)
    monkeypatch.setattr("workflow.results.stored_mesh.stored_mesh", lambda *_: None)
    with pytest.raises(KeyboardInterrupt):
        liquefied.work(job)
    stops = False
    liquefied.work(job)
    assert computed == [1, 2, 2]
    assert len(liquefied.LiquefiedAnswer.read(job.store).cases) == 2
    assert job.store.matching(["fem/*_part*"]) == []
