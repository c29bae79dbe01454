"""Collects the results of a folder for one input: the answers of the stages, and the outcome of each."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from fem.search.result_warnings import ComparedKh, ResultWarning, of_bounds, of_others
from workflow.config import Config
from workflow.results.answer import FORCE, Answer
from workflow.results.bounds import BoundsAnswer
from workflow.results.calibration import CalibrationAnswer
from workflow.results.cases import CaseAnswer, CasesAnswer
from workflow.results.continuum import FailureAnswer, FemAnswer, VariantsAnswer
from workflow.results.dem_counterpart import DemCounterpart
from workflow.results.discs import DiscsAnswer
from workflow.results.faces import FacesAnswer
from workflow.results.material_points import PointSlidesAnswer
from workflow.results.site_response import SiteResponseAnswer
from workflow.results.slices import SlicesAnswer
from workflow.results.stability import LiquefiedAnswer, ResidualAnswer
from workflow.results.triggering import TriggeringAnswer
from workflow.run.plan import changes, has_answers_of, is_of_this_input, made_from
from workflow.run.record import Entry, Record
from workflow.run.stage import Job, Stage
from workflow.run.store import Store

AnswerOf = TypeVar("AnswerOf", bound=Answer)
FACTOR_ROUNDING = 5e-4  # below 1: half of the last digit of a factor of safety
# What is judged by bounds: what it is, its value, lower and upper bound, whether these are of its own flow rule, and
# the error of its mesh.
Judged = tuple[str, float, float | None, float | None, bool, float]
# Error of a sequence of meshes over the distance to its limit, which is extrapolated from two meshes.
MESH_ERROR_RATIO = 2.0


def _hold_for(bounds: BoundsAnswer, fem: FemAnswer) -> bool:
    """Return whether upper ``bounds`` hold for the sides of the finite elements: a mechanism that does not move at
    fixed sides does no work there, whatever the sides are."""
    sides = fem.settings.sides
    return bounds.sides == sides or (bounds.sides == "fixed" and sides != "periodic")


@dataclass(frozen=True)
class Results:
    """Holds the results of a run: the answers in its folder that are of this input.

    Attributes
    ----------
    config : input of the run
    store : the folder of the run
    ends : outcomes of the stages with results, by name
    missing : reasons why other stages have no result, by name
    fem, failure : answers of the stage `fem`: critical Kh, or factor of safety of ground that fails without a seismic
        force. All answers are None if their stage has none.
    variants : critical Kh with other assumptions
    bounds : strict bounds; None, too, unless both bounds of a quantity were found, or an upper bound that proves
        failure without a seismic force
    dem, calibration, dem_counterpart : answers of the stage `calibrate`: critical Kh of the discs, their calibration,
        and the FEM model that they are calibrated to
    cases : slides of discs
    triggering : factors against liquefaction
    slices : slip circles
    faces : faces of structures by finite elements
    liquefied, residual : stability after liquefaction, and with residual strength
    response : response of the layers to the record
    mpm : slides of material points
    stages : stages of the report
    older : stages that another version of the program computed, by name
    """

    config: Config
    store: Store
    ends: dict[str, Entry]
    missing: dict[str, str]
    fem: FemAnswer | None = None
    failure: FailureAnswer | None = None
    variants: VariantsAnswer | None = None
    bounds: BoundsAnswer | None = None
    dem: DiscsAnswer | None = None
    calibration: CalibrationAnswer | None = None
    dem_counterpart: DemCounterpart | None = None
    cases: CasesAnswer | None = None
    triggering: TriggeringAnswer | None = None
    slices: SlicesAnswer | None = None
    faces: FacesAnswer | None = None
    liquefied: LiquefiedAnswer | None = None
    residual: ResidualAnswer | None = None
    response: SiteResponseAnswer | None = None
    mpm: PointSlidesAnswer | None = None
    stages: tuple[Stage, ...] = ()
    older: tuple[str, ...] = ()

    @classmethod
    def of(cls, job: Job) -> "Results":
        """Read the results of the stages for this input; results of other inputs are ignored."""
        record, ends, missing, older = Record(job.store), {}, {}, []
        stages = tuple(stage for stage in job.stages if not stage.of_all)
        for stage in stages:
            prints = made_from(stage, job, record)
            entry, change_words = record[stage.name], changes(stage, prints, record)
            same = entry is not None and (not change_words or (entry.outcome == "part" and entry.inputs == prints))
            if entry is not None and (same or has_answers_of(stage, prints, record)):
                ends[stage.name] = entry
            elif entry is not None and is_of_this_input(stage, job, record):
                ends[stage.name] = entry
                older.append(stage.name)
            else:
                missing[stage.name] = change_words

        def left(stage: str, kind: type[AnswerOf]) -> AnswerOf | None:
            """Return the stored answer of a stage, if it ran for this input."""
            written = stage in ends and kind.FILE in ends[stage].files
            return kind.read(job.store) if written else None

        bounds = left("bounds", BoundsAnswer)
        return cls(
            job.config,
            job.store,
            ends,
            missing,
            fem=left("fem", FemAnswer),
            failure=left("fem", FailureAnswer),
            variants=left("variants", VariantsAnswer),
            bounds=bounds if bounds is not None and (bounds.has_interval or bounds.fails_at_rest) else None,
            dem=left("calibrate", DiscsAnswer),
            calibration=left("calibrate", CalibrationAnswer),
            dem_counterpart=left("calibrate", DemCounterpart),
            cases=left("slide", CasesAnswer),
            triggering=left("triggering", TriggeringAnswer),
            slices=left("slices", SlicesAnswer),
            faces=left("faces", FacesAnswer),
            liquefied=left("liquefied", LiquefiedAnswer),
            residual=left("residual", ResidualAnswer),
            response=left("response", SiteResponseAnswer),
            mpm=left("mpm", PointSlidesAnswer),
            stages=stages,
            older=tuple(older),
        )

    def no_answer(self, stage: str) -> Entry | None:
        """Return the outcome of a stage that ended without an answer; else None."""
        entry = self.ends.get(stage)
        return entry if entry is not None and entry.outcome == "no answer" else None

    @property
    def kc(self) -> float | None:
        """Return the critical Kh of the FEM, if it has one: none if strict bounds prove that the section fails without
        a seismic force."""
        if self.fem is None or self.no_answer("fem") or not self.fem.has_kc or self.fails_at_rest:
            return None
        return self.fem.kc

    @property
    def fails_at_rest(self) -> bool:
        """Return whether a strict bound proves that the section fails without a seismic force: an upper bound of Kh
        below 0, or of the factor of safety at Kh = 0 below 1. If excess pore pressure acts with Kh, the factor of
        safety is the one after shaking.

        This is the one rule for all answers on the same ground. Elements whose cells are too coarse for a small
        mechanism may have a critical Kh or a factor above 1 all the same.
        """
        fem, bounds = self.fem, self.bounds
        if bounds is None or (fem is not None and not _hold_for(bounds, fem)):
            return False
        upper = self.upper_factor_at_rest
        return bounds.fails_at_rest or (upper is not None and upper < 1.0 - FACTOR_ROUNDING)

    @property
    def upper_factor_at_rest(self) -> float | None:
        """Return the smallest strict upper bound of the factor of safety without a seismic force of the ground that has
        the critical Kh, after shaking if excess pore pressure acts with Kh; None without one."""
        if self.bounds is None:
            return None
        rises = self.config.section.water_pressure.rises_by_shaking
        at_rest = (part for part in self.bounds.factors if part.kh == 0.0 and part.after_shaking == rises)
        return min((part.upper for part in at_rest if part.upper is not None), default=None)

    @property
    def slip_surface(self) -> np.ndarray:
        """Return points (n, 2) in m of the slip surface of the FEM; none without a mechanism."""
        end = self.fem.last_in_equilibrium() if self.fem is not None else None
        return np.array(end.slip_surface if end is not None else []).reshape(-1, 2)

    @property
    def warnings(self) -> list[ResultWarning]:
        """Return warnings on the critical Kh of the FEM: contradictions, and notes."""
        of_fem = list(self.fem.warnings) if self.fem is not None else []
        looked_at = ("mesh",) if self._bracketed else ("mesh", "element")
        others = [
            ComparedKh(variant.change, variant.kc, decisive=variant.name == "mesh", kc_without=variant.kc_without)
            for variant in (self.variants.variants if self.variants is not None else ())
            if self.kc and variant.kc is not None and variant.name in looked_at
        ]
        contradictions = of_others(self.kc, others) if self.kc else ()
        return [*of_fem, *contradictions, *self.warnings_by_bounds()]

    @property
    def _bracketed(self) -> bool:
        """Return whether the strict bounds with the same sides and flow rule are close enough to check the finite
        elements."""
        fem, bounds = self.fem, self.bounds
        if fem is None or bounds is None or bounds.sides != fem.settings.sides:
            return False
        return fem.flow == "associated" and bounds.verdict == "bracketed"

    def warnings_by_bounds(self) -> list[ResultWarning]:
        """Return warnings if strict bounds contradict the FEM. Upper bounds with ψ = φ hold for every smaller ψ, and
        those with fixed sides hold for other sides, since a mechanism that does not move at the sides does no work
        there.
        """
        fem, bounds = self.fem, self.bounds
        if fem is None or bounds is None or self.kc is None:
            return []
        same_sides = bounds.sides == fem.settings.sides
        if not _hold_for(bounds, fem):
            return []
        judged = [*self._judged_by(bounds), *(self._safety_judged_by(bounds) if same_sides else ())]
        return [
            warning
            for quantity, value, low, high, same_flow, error in judged
            for warning in of_bounds(value, low if same_sides else None, high, same_flow, quantity, error)
        ]

    def _judged_by(self, bounds: BoundsAnswer) -> Iterator[Judged]:
        """Yield the critical Kh of every direction and flow rule with strict bounds, and these bounds."""
        fem = self.fem
        assert fem is not None
        for part in bounds.directions:
            other = fem.opposite if part.direction != fem.direction else None
            if other is not None and other.verdict in ("plateau", "peak"):
                name = f"critical Kh {FORCE[part.direction]}"
                yield name, other.kc, part.lower, part.upper, fem.flow == "associated", 0.0
        full = bounds.towards(fem.direction)
        if full is None:
            return
        error = 0.0 if fem.kc_limit is None else MESH_ERROR_RATIO * abs(fem.kc - fem.kc_limit)
        yield "critical Kh", fem.kc, full.lower, full.upper, fem.flow == "associated", error
        if fem.associated is not None:
            yield "critical Kh with ψ = φ", fem.associated.kc, full.lower, full.upper, True, 0.0
        low = fem.kc if fem.flow == "davis" else fem.davis.kc if fem.davis is not None else None
        substitute = bounds.substitute.towards(fem.direction) if bounds.substitute is not None else None
        if substitute is not None and low is not None:
            yield f"critical Kh by {fem.estimate}", low, substitute.lower, substitute.upper, True, 0.0

    def _safety_judged_by(self, bounds: BoundsAnswer) -> Iterator[Judged]:
        """Yield the factors of safety with ψ = φ for which there are bounds."""
        strict = {(part.kh, part.after_shaking): part for part in bounds.factors}
        for factor in self.fem.factors if self.fem is not None else ():
            full = factor.factor if self.fem is not None and self.fem.flow == "associated" else factor.associated
            if full is not None and (part := strict.get((factor.kh, factor.after_shaking))) is not None:
                when = "after shaking" if factor.after_shaking else f"at Kh = {factor.kh:g}"
                error = MESH_ERROR_RATIO * (factor.remaining_error or 0.0) * full
                yield f"factor of safety {when} with ψ = φ", full, part.lower, part.upper, True, error

    def case_set(self) -> tuple[str, dict[int, CaseAnswer]]:
        """Return the governing set of cases (the calibrated one if there is one), and its cases by number."""
        if self.cases is None:
            return "", {}
        name = self.cases.first_set
        return name, self.cases.sets.get(name, {})

    @property
    def printed_cases(self) -> dict[int, CaseAnswer]:
        """Return the cases with the springs printed in the paper, by number, if they were computed beside others."""
        return self.cases.sets.get("table2", {}) if self.cases is not None and self.case_set()[0] != "table2" else {}

    def slides_at(self, x: float | None) -> dict[int, float] | None:
        """Return the slide of the discs in each case at the place x (m) of the surface, to either side, as it is
        measured; None if it is not known."""
        _, cases = self.case_set()
        if x is None or not cases:
            return None
        slides = {number: abs(slide) for number, case in cases.items() if (slide := case.slide_at(x)) is not None}
        return slides if len(slides) == len(cases) else None
