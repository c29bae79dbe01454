"""All that a folder holds for one input: what the stages found, and how each of them ended."""

from dataclasses import dataclass
from typing import Any

from workflow.run.plan import changes, made_from
from workflow.run.record import Entry, Record
from workflow.run.stage import Job, Stage
from workflow.run.store import Store
from workflow.settings import Input

FILES = {
    "fem": ("fem", "fem/critical.json"),
    "variants": ("variants", "fem/variants.json"),
    "bounds": ("bounds", "fem/bounds.json"),
    "dem": ("calibrate", "dem/critical.json"),
    "calibration": ("calibrate", "dem/calibration.json"),
    "cases": ("slide", "dem/cases.json"),
}


@dataclass(frozen=True)
class Results:
    """What belongs to the input: ``ends`` how stages ended, ``missing`` why others have nothing to show;
    ``stages`` are those that the report tells of.

    The answers are those of the files, None where there is none: ``fem`` of fem/critical.json, ``variants``,
    ``bounds``, ``dem`` of dem/critical.json, ``calibration`` and ``cases``.
    """

    run: Input
    store: Store
    ends: dict[str, Entry]
    missing: dict[str, str]
    fem: dict[str, Any] | None
    variants: dict[str, Any] | None
    bounds: dict[str, Any] | None
    dem: dict[str, Any] | None
    calibration: dict[str, Any] | None
    cases: dict[str, Any] | None
    stages: tuple[Stage, ...] = ()

    @classmethod
    def of(cls, job: Job) -> "Results":
        """Read what the stages left for this input; results of other inputs are not looked at."""
        record, ends, missing = Record(job.store), {}, {}
        told = tuple(stage for stage in job.stages if not stage.of_all)
        for stage in told:
            entry, why = record[stage.name], changes(stage, made_from(stage, job, record), record)
            if entry is not None and (not why or entry.outcome == "part"):
                ends[stage.name] = entry
            else:
                missing[stage.name] = why
        answers = {
            key: job.store.read_json(file) if stage in ends and file in ends[stage].files else None
            for key, (stage, file) in FILES.items()
        }
        if answers["bounds"] is not None and answers["bounds"]["verdict"] == "no bracket":
            answers["bounds"] = None
        return cls(job.given, job.store, ends, missing, **answers, stages=told)

    def no_answer(self, stage: str) -> Entry | None:
        """How a stage ended if it ended without an answer."""
        entry = self.ends.get(stage)
        return entry if entry is not None and entry.outcome == "no answer" else None

    @property
    def kc(self) -> float | None:
        """The critical Kh of the FEM, if it has one."""
        if self.fem is None or self.no_answer("fem") or self.fem["verdict"] not in ("plateau", "peak"):
            return None
        return float(self.fem["kc"])

    def case_set(self) -> tuple[str, dict[str, Any]]:
        """The name of the set of cases that counts, the calibrated one if there is one, and its cases."""
        sets = self.cases["sets"] if self.cases else {}
        for name in ("calibrated", *sets):
            if name in sets:
                return name, sets[name]
        return "", {}
