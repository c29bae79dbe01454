"""Provides small hand-made answers of the stages of the continuum, for tests of the code that reads them."""

from typing import Any

from fem.continuum.loads import Direction
from fem.continuum.strength import flow_of
from tests.support.sections import analysed, slope
from workflow.config import Config
from workflow.report.first_page import conclusions, headlines
from workflow.report.summary_text import findings
from workflow.report.warnings import warnings
from workflow.results.answer import SectionLabel
from workflow.results.bounds import BoundsAnswer, DirectionPart, Residuals
from workflow.results.continuum import FemAnswer, Gravity, MeshCount, PathVerdict, StoredState, Variant
from workflow.results.results import Results
from workflow.run.store import Store
from workflow.texts.report_texts import Texts


def state(run: Config, kh: float, past: bool, failed: float) -> StoredState:
    return StoredState(
        label=f"Kh = {kh}", kh=kh, past_equilibrium=past, largest_displacement_m=0.1,
        failed_share_by_stratum={stratum.name: failed for stratum in run.section.strata},
        slip_surface=tuple((float(x), 9.08 - 0.0454 * x - 6.0) for x in range(5, 200, 10)),  # in layers 4 and 5
    )  # fmt: skip


def fem(run: Config, kc: float = 0.24, verdict: PathVerdict = "plateau") -> FemAnswer:
    return FemAnswer(
        section=SectionLabel.of(run.section), kc=kc, kc_lower=kc, kc_upper=kc + 0.004, verdict=verdict,
        reason="it is flat", remedy="", judgement="sound", warnings=(), direction="downhill", towards="right",
        opposite=None, associated=None, shallow_failures=(),
        flow=flow_of(run.section.strata, run.fem.flow), element="quadratic",
        settings=run.fem, dilation_deg={},
        meshes=(), meshes_ended="", kc_limit=None,
        mesh=MeshCount(quadrilaterals=611, nodes=672, method="mapped"),
        gravity=Gravity(iterations=8, plastic_share=0.0), linear_solves=200, curve=(), safety_factors=(),
        states=(state(run, 0.2, kc < 0.2, 0.4), state(run, kc, False, 0.5), state(run, 0.3, kc < 0.3, 0.5)),
    )  # fmt: skip


def bounds(run: Config, lower: float, upper: float, direction: Direction = "downhill") -> BoundsAnswer:
    part = DirectionPart(direction=direction, towards="right", lower=lower, upper=upper, leaves=(), history=())
    return BoundsAnswer(
        section=SectionLabel.of(run.section), lower=lower, upper=upper, directions=(part,), gap=0.1,
        verdict="bracketed", reason="", description="so much", flow="associated, ψ = φ", substitute=None,
        shallow_failures=(), least_depth=0.5, sides="free-field", direction=direction, vertical=0.0,
        cells=100, seconds=1.0, residuals=Residuals(lower=None, upper=None), history=(), settings=run.bounds,
    )  # fmt: skip


def results(run: Config, **answers: Any) -> Results:
    """Return results as if the stages had written these answers."""
    return Results(run, Store("nowhere"), {}, {}, **answers)


def variant(name: str, change: str, kc: float | None) -> Variant:
    """Return the critical Kh with one changed assumption."""
    return Variant(
        name=name,
        change=change,
        kc=kc,
        kc_upper=kc,
        verdict="plateau" if kc else "undecided",
        reason="slow",
        seconds=1.0,
    )


def warned(result: Results) -> list[str]:
    """Return the warnings of a run with their remedies, the most important first."""
    return [f"{warning.observation} {warning.remedy}".strip() for warning in warnings(result)]


def liquefying_config() -> Config:
    """Return the config of a slope whose upper stratum liquefies in three cases."""
    data = slope()
    data["strata"][0]["liquefies_in"] = [1, 2, 3]
    return analysed(data)


def report_text(outcome: Results) -> str:
    """Return the conclusions and paragraphs of a report, one per line."""
    numbers = [headline.conclusion for headline in headlines(outcome, Texts())]
    return "\n".join([*numbers, *conclusions(outcome, Texts()), *findings(outcome)])
