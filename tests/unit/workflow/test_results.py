"""What a folder holds for one input: results of other inputs are not looked at."""

from dataclasses import replace
from pathlib import Path

import pytest

from tests.support import dem_fixture
from tests.support.answers import bounds
from tests.support.sections import slope
from tests.support.toy_stages import Toys
from workflow.config import Config
from workflow.results.bounds import BoundsAnswer, SafetyPart
from workflow.results.cases import CasesAnswer
from workflow.results.results import Results
from workflow.run.plan import Choice, changes, made_from, plan
from workflow.run.record import Entry, Outcome, Record, sizes
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages.declared import STAGES

SLIDE = next(stage for stage in STAGES if stage.name == "slide")


def job(folder: Path, kh: float = 0.1) -> Job:
    return Job(Config.parse({**slope(), "slide": {"kh": kh}}), Store(folder), STAGES)


def slid(folder: Path, outcome: Outcome) -> None:
    """As if the stage slide had run on the folder, or on some of its cases."""
    own_part = job(folder)
    CasesAnswer(sets={"calibrated": {1: dem_fixture.CASES[1]}}, random=None).write(own_part.store)
    record = Record(own_part.store)
    files = sizes(own_part.store, [CasesAnswer.FILE])
    record.put("slide", Entry(made_from(SLIDE, own_part, record), outcome, files=files))


@pytest.mark.parametrize("outcome", ["done", "part"])
def test_results_are_those_of_the_same_input(outcome: Outcome, tmp_path: Path) -> None:
    slid(tmp_path, outcome)
    values = Results.of(job(tmp_path))
    assert values.cases is not None
    assert values.case_set() == ("calibrated", {1: dem_fixture.CASES[1]})
    other = Results.of(job(tmp_path, kh=0.2))
    assert other.cases is None
    assert other.missing["slide"] == "inputs changed: [slide]"


def test_a_file_of_another_version_is_computed_anew(tmp_path: Path) -> None:
    slid(tmp_path, "done")
    own_part = job(tmp_path)
    plans = [step for step in plan(own_part, Record(own_part.store), Choice(())) if step.stage is SLIDE]
    assert [step.action for step in plans] == ["reuse"]
    text = (tmp_path / CasesAnswer.FILE).read_text()
    own_part.store.write_text(CasesAnswer.FILE, text.replace('"escaped"', '"got_out"'))  # of the same size
    values = Results.of(own_part)
    assert values.cases is None
    assert values.missing["slide"] == "computed by another version of noshiro"
    record = Record(own_part.store)
    assert changes(SLIDE, made_from(SLIDE, own_part, record), record) == "computed by another version of noshiro"


def test_answers_of_another_version_of_the_program_are_told_as_such(
    toys: Toys, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are of the same input; what is computed anew, or of another input, leaves what hangs on it untold."""
    toys.go(tmp_path)
    monkeypatch.setattr("workflow.run.fingerprint.program", lambda: "another")
    values = Results.of(toys.job(tmp_path))
    assert (sorted(values.ends), values.older) == (["fem", "mesh", "slide"], ("mesh", "fem", "slide"))
    other = Results.of(toys.job(tmp_path, fem={"sides": "fixed"}))
    assert (sorted(other.ends), other.older) == (["mesh"], ("mesh",))
    record = Record(Store(tmp_path))
    mesh = record["mesh"]
    assert mesh is not None
    record.put("mesh", replace(mesh, ended="9999-01-01 00:00:00"))  # computed again since
    assert sorted(Results.of(toys.job(tmp_path)).ends) == ["mesh"]


def test_answers_of_a_command_that_asked_for_more_of_them_hold_for_others(tmp_path: Path) -> None:
    """`noshiro slices` after `noshiro fem --safety-factor` did not heed its bounds of the factor of safety."""

    def with_settings(**settings: dict[str, object]) -> Job:
        return Job(Config.parse({**slope(), **settings}), Store(tmp_path), STAGES)

    requested = with_settings(fem={"safety_factor_at": [0.0, 0.1]}, bounds={"safety_factor": True})
    stage = next(item for item in STAGES if item.name == "bounds")
    part = SafetyPart(kh=0.0, lower=1.2, upper=1.21, cells=100)
    bounds(requested.config, 0.19, 0.2).model_copy(update={"safety": (part,)}).write(requested.store)
    record = Record(requested.store)
    files = sizes(requested.store, [BoundsAnswer.FILE])
    record.put("bounds", Entry(made_from(stage, requested, record), "done", files=files))
    plain = Results.of(with_settings())
    assert plain.bounds is not None
    assert plain.bounds.safety == (part,)
    assert plain.older == ()
    [step] = [step for step in plan(with_settings(), record, Choice(())) if step.stage is stage]
    assert step.reason == "inputs changed: [bounds], fem.safety_factor_at"
    assert Results.of(with_settings(fem={"sides": "fixed"})).bounds is None
