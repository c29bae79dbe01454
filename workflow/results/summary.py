"""Stores the numbers of a run, with units in their names, in summary.json."""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from dem.laboratory.layer_check import LayerCheck
from fem.continuum.strength import Flow
from fem.settings import Element, Sides
from meshes.section.structure import Kind
from workflow.results.answer import Answer, Part, SectionLabel
from workflow.results.cases import CaseNumbers, CaseSummary, RandomPackings
from workflow.results.continuum import MeshCount, PathVerdict
from workflow.results.faces import FaceStrength
from workflow.results.material_points import PointCase
from workflow.results.slices import SlicesAnswer
from workflow.results.stability import LiquefiedCase, PeakAndResidual
from workflow.results.triggering import StratumPart
from workflow.results.verdicts import CrestPart, HeadlinePart, VerdictPart, WarningPart


class SafetySummary(Part):
    """Holds the factor of safety at one Kh, and by the other flow rule."""

    kh: float
    factor: float
    governing: float = Field(description="factor of safety that counts: the factor, or the strict bound it lies beyond")
    davis: float | None = Field(description="Davis's estimate (low, no bound) if the factor is with ψ = φ")
    associated: float | None = Field(description="factor of safety with ψ = φ, if the factor is Davis's estimate")


class FemSummary(Part):
    """Holds the results of the continuum. Without a critical Kh there is only ``kc_lower``, the largest Kh in
    equilibrium."""

    kc: float | None
    kc_governing: float | None = Field(
        description="critical Kh that counts: kc, or the strict bound that kc lies beyond"
    )
    kc_lower: float
    kc_upper: float | None
    verdict: PathVerdict
    reason: str
    dilation: dict[str, float] | str = Field(description='"psi = phi", or the dilation angle by stratum (degrees)')
    flow: Flow = Field(
        description='flow rule of kc: "associated" is ψ = φ, "davis" is Davis\'s estimate, which is no bound'
    )
    kc_davis: float | None = Field(
        description=(
            "critical Kh by Davis's estimate, a low estimate and no bound, if kc is with ψ = φ; 0 if the ground with "
            "Davis reduced strength fails under its weight"
        )
    )
    kc_associated: float | None = Field(description="critical Kh with ψ = φ, if kc has another flow rule")
    safety_factors: tuple[SafetySummary, ...]
    after_shaking: SafetySummary | None = Field(
        default=None, description="factor of safety at Kh = 0 with the excess pore pressure of shaking, if there is any"
    )
    sides: Sides
    element: Element


class FailureSummary(Part):
    """Holds the factor of safety at Kh = 0 of ground that fails by its weight, and by the other flow rule."""

    factor: float
    flow: Flow
    davis: float | None = Field(description="Davis's estimate (low, no bound) if the factor is with ψ = φ")
    associated: float | None = Field(description="factor of safety with ψ = φ, if the factor is Davis's estimate")


class VariantSummary(Part):
    """Holds the critical Kh of the continuum with one assumption changed, and the critical Kh without the change if
    both were computed on another mesh.
    """

    change: str
    kc: float | None
    kc_upper: float | None
    kc_without: float | None
    verdict: str


class BoundsSummary(Part):
    """Holds the strict bounds of the critical Kh."""

    lower: float | None
    upper: float | None


class CircleSummary(Part):
    """Holds the result of limit equilibrium of slices on a critical slip circle: a factor of safety at ``kh``, or a
    critical Kh."""

    kh: float | None = Field(description="Kh of the factor of safety; null if both numbers are critical Kh")
    towards: Literal["left", "right"]
    bishop: float
    spencer: float | None

    @classmethod
    def of(cls, answer: SlicesAnswer) -> tuple[Self, ...]:
        """Return the summary of all circles."""
        groups = [(group.kh, group.circles) for group in answer.factors] + [(None, answer.critical)]
        return tuple(cls.taken(circle, kh=kh) for kh, circles in groups for circle in circles)


class FaceSummary(Part):
    """Holds one face of a structure by limit equilibrium of slices, and the slide of a rigid block with the critical Kh
    of the face."""

    structure: str
    kind: Kind
    towards: Literal["left", "right"]
    factors: dict[float, float] = Field(description="least factors of safety by Bishop's method, by Kh")
    kc: float | None = Field(description="least critical Kh by Bishop's method")
    block_slide_m: tuple[float, float] | None = Field(
        description=(
            "slide of a rigid block with the critical Kh of the face: in both directions of the record, or under Kh"
        )
    )
    elements: FaceStrength | None = Field(
        default=None, description="results by finite elements and bounds, if they were computed"
    )


class Factor(Part):
    """Holds the parameter of the calibration, and its factor."""

    parameter: str
    value: float


class DemSummary(Part):
    """Holds the results of the discs."""

    model: str = Field(description='contact law of the discs: "soil" or "paper"')
    elements: int
    boundary_elements: int
    sides: str = Field(description="sides of the continuum that the discs are compared with")
    kc_uncalibrated: float | None = Field(description="soil discs: the uncalibrated critical Kh, which is a prediction")
    kc_target: float | None = Field(
        description="target of the calibration: the nearest value within the range of the critical Kh of the continuum"
    )
    strength_factor: float | None = Field(description="factor on both friction and cohesion of the contacts")
    slip_surface_distance_m: float | None
    layers: tuple[LayerCheck, ...]
    kc_table2: float | None = Field(description="critical Kh with the springs of Table 2 of the paper as printed")
    kc: float | None
    kc_lower: float
    kc_upper: float | None
    calibrated: Factor | None
    verdict: str


class EstimateSummary(Part):
    """Holds an estimate of the displacement (m) by a simple method, which is compared with the slide of the discs."""

    method: str
    displacement_m: float | None
    description: str
    source: str
    validity: str


@dataclass(frozen=True)
class PaperRow:
    """Holds one quantity of the paper and the computed value.

    Attributes
    ----------
    quantity, paper, ours : the quantity, its value in the paper, and the computed value
    reference : figure, table or section of the paper
    agrees : whether both values agree; None if there is nothing to compare
    reason : reason of a difference; empty without one
    """

    quantity: str
    paper: str
    reference: str
    ours: str
    agrees: bool | None = None
    reason: str = ""


class NoAnswer(Part):
    """Holds the reason why a stage ended without an answer, and advice on what the user can change."""

    reason: str
    remedy: str


class MadeWith(Part):
    """Holds the machine, and the versions of the program and its libraries."""

    versions: dict[str, str]
    host: str
    system: str
    processor: str


class PaperModel(Part):
    """Holds the results of the unchanged discs of the paper."""

    kc: float | None
    cases: dict[int, CaseNumbers]


class Summary(Answer):
    """Holds the results of all stages. A stage without an answer is listed in ``no_answer``."""

    FILE: ClassVar[str] = "summary.json"

    headlines: tuple[HeadlinePart, ...] = Field(description="the numbers of the first page of the report")
    in_short: tuple[str, ...] = Field(description="the conclusions of the first page, one sentence each")
    findings: tuple[str, ...] = Field(description="the results in sentences, one paragraph each")
    warnings: tuple[WarningPart, ...] = Field(description="warnings, the most important first")
    section: SectionLabel
    mesh: MeshCount | None
    fem: FemSummary | None
    fails_at_rest: bool = Field(
        default=False, description="whether the section fails without a seismic force, so that it has no critical Kh"
    )
    failure: FailureSummary | None = Field(
        default=None, description="factor of safety of ground that fails by its weight, in place of fem"
    )
    fem_variants: dict[str, VariantSummary] | None = None
    bounds: BoundsSummary | None = None
    slices: tuple[CircleSummary, ...] | None = None
    structures: tuple[FaceSummary, ...] | None = Field(default=None, description="the faces of structures")
    crests: tuple[CrestPart, ...] | None = Field(default=None, description="crests of structures after every slide")
    criteria: tuple[VerdictPart, ...] | None = Field(
        default=None, description="verdicts on quantities that have a limit"
    )
    dem: DemSummary | None = None
    cases: dict[int, CaseSummary] | None = Field(default=None, description="cases on the governing set of springs")
    cases_springs: str | None = Field(default=None, description="name of the governing set of springs")
    cases_table2: dict[int, CaseNumbers] | None = None
    paper_model: PaperModel | None = Field(
        default=None, description="results of the discs of the paper, if they were requested"
    )
    cases_random: RandomPackings | None = None
    cases_mpm: dict[int, PointCase] | None = Field(
        default=None, description="cases by the material point method, if it was requested"
    )
    comparison: tuple[EstimateSummary, ...]
    triggering: tuple[StratumPart, ...] | None = Field(default=None, description="strata that liquefy, by borings")
    residual: PeakAndResidual | None = Field(default=None, description="stability with residual strength")
    liquefied: tuple[LiquefiedCase, ...] | None = Field(default=None, description="stability after liquefaction")
    paper: tuple[PaperRow, ...] | None = None
    no_answer: dict[str, NoAnswer]
    seconds: dict[str, float] = Field(description="computing time of every stage (s)")
    made_with: MadeWith

    @model_validator(mode="before")
    @classmethod
    def _with_old_key(cls, data: Any) -> Any:
        """Read the files of version 0.1, whose warnings were sentences under the key doubtful."""
        if not isinstance(data, dict) or "doubtful" not in data:
            return data
        sentences = data["doubtful"]
        answers = {key: value for key, value in data.items() if key != "doubtful"}
        warnings = [{"weight": 2, "observation": text, "remedy": ""} for text in sentences]
        return {"headlines": (), "findings": (), **answers, "warnings": warnings}
