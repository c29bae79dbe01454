"""Stores the numbers of a run, with units in their names, in summary.json."""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from dem.laboratory.layer_check import LayerCheck
from fem.continuum.strength import Flow
from fem.settings import Element, PathVerdict, Sides
from meshes.section.structure import Kind
from workflow.results.answer import Answer, Part, SectionLabel
from workflow.results.cases import CaseNumbers, CaseSummary, RandomPackings
from workflow.results.continuum import MeshCount
from workflow.results.faces import FaceStrength
from workflow.results.material_points import PointCase
from workflow.results.slices import SlicesAnswer
from workflow.results.stability import LiquefiedCase, PeakAndResidual
from workflow.results.triggering import StratumPart
from workflow.results.verdicts import CrestPart, HeadlinePart, VerdictPart, WarningPart


class SafetySummary(Part):
    """Holds the factor of safety at one Kh, and by the other flow rule."""

    kh: float = Field(description="seismic coefficient")
    factor: float = Field(description="factor of safety by finite elements")
    governing: float = Field(description="factor of safety that counts: the factor, or the strict bound it lies beyond")
    davis: float | None = Field(description="Davis's estimate (low, no bound) if the factor is with ψ = φ")
    associated: float | None = Field(description="factor of safety with ψ = φ, if the factor is Davis's estimate")


class FemSummary(Part):
    """Holds the results of the continuum.

    Without a critical Kh there is only ``kc_lower``.
    """

    kc: float | None = Field(description="critical Kh by finite elements; null without one")
    kc_governing: float | None = Field(
        description="critical Kh that counts: kc, or the strict bound that kc lies beyond"
    )
    kc_lower: float = Field(description="largest Kh in equilibrium on the path")
    kc_upper: float | None = Field(
        description="upper end of the bracket on this mesh, no bound of the section; null without a critical Kh"
    )
    verdict: PathVerdict = Field(description='how the path ended: "plateau", "peak", "no failure", or "undecided"')
    reason: str = Field(description="reason of the verdict, in words")
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
    safety_factors: tuple[SafetySummary, ...] = Field(description="factors of safety at the Kh of fem.safety_factor_at")
    after_shaking: SafetySummary | None = Field(
        default=None, description="factor of safety at Kh = 0 with the excess pore pressure of shaking, if there is any"
    )
    sides: Sides = Field(description="boundary condition of the sides")
    element: Element = Field(description="finite element of the path")


class FailureSummary(Part):
    """Holds the factor of safety at Kh = 0 of ground that fails by its weight, and by the other flow rule."""

    factor: float = Field(description="factor of safety at Kh = 0, below 1")
    flow: Flow = Field(description='flow rule of the factor: "associated" is ψ = φ, "davis" is Davis\'s estimate')
    davis: float | None = Field(description="Davis's estimate (low, no bound) if the factor is with ψ = φ")
    associated: float | None = Field(description="factor of safety with ψ = φ, if the factor is Davis's estimate")


class VariantSummary(Part):
    """Holds the critical Kh of the continuum with one assumption changed."""

    change: str = Field(description="changed assumption, in words")
    kc: float | None = Field(description="critical Kh with the change; null without an answer")
    kc_upper: float | None = Field(description="upper end of the bracket on its mesh; null without an answer")
    kc_without: float | None = Field(
        description=(
            "critical Kh without the change, if both were computed on another mesh or with another element; else null"
        )
    )
    verdict: str = Field(description='how the path ended; there is a critical Kh for "plateau" and "peak" only')


class BoundsSummary(Part):
    """Holds the strict bounds of the critical Kh."""

    lower: float | None = Field(description="strict lower bound of the critical Kh with ψ = φ; null if it is missing")
    upper: float | None = Field(
        description="strict upper bound of the critical Kh, for every ψ ≤ φ; null if it is missing"
    )


class CircleSummary(Part):
    """Holds the factor of safety at one Kh, or the critical Kh, of slices on a critical slip circle."""

    kh: float | None = Field(description="Kh of the factor of safety; null if both numbers are critical Kh")
    towards: Literal["left", "right"] = Field(description="side of the section to which the circle slides")
    bishop: float = Field(description="value by Bishop's simplified method")
    spencer: float | None = Field(description="value by Spencer's method; null if forces and moments do not balance")

    @classmethod
    def of(cls, answer: SlicesAnswer) -> tuple[Self, ...]:
        """Return the summary of all circles."""
        groups = [(group.kh, group.circles) for group in answer.factors] + [(None, answer.critical)]
        return tuple(cls.taken(circle, kh=kh) for kh, circles in groups for circle in circles)


class FaceSummary(Part):
    """Holds one face of a structure by limit equilibrium of slices, and the slide of a rigid block."""

    structure: str = Field(description="name of the structure")
    kind: Kind = Field(description='kind of the structure, such as "levee"')
    towards: Literal["left", "right"] = Field(description="side to which the face slides")
    factors: dict[float, float] = Field(description="least factors of safety by Bishop's method, by Kh")
    kc: float | None = Field(description="least critical Kh by Bishop's method; null without a circle")
    block_slide_m: tuple[float, float] | None = Field(
        description=(
            "slide of a rigid block with the critical Kh of the face, by the circle or by finite elements if that is "
            "smaller: in both directions of the record, or under Kh"
        )
    )
    elements: FaceStrength | None = Field(
        default=None, description="results by finite elements and bounds, if they were computed"
    )


class Factor(Part):
    """Holds the parameter of the calibration, and its factor."""

    parameter: str = Field(description='constants of the discs that the factor multiplies, or "none"')
    value: float = Field(description="the factor")


class DemSummary(Part):
    """Holds the results of the discs."""

    model: str = Field(description='contact law of the discs: "soil" or "paper"')
    elements: int = Field(description="number of discs that can move")
    boundary_elements: int = Field(description="number of discs that cannot move")
    sides: str = Field(description="sides of the continuum that the discs are compared with")
    kc_uncalibrated: float | None = Field(description="soil discs: the uncalibrated critical Kh, which is a prediction")
    kc_target: float | None = Field(
        description="target of the calibration: the nearest value within the range of the critical Kh of the continuum"
    )
    strength_factor: float | None = Field(description="factor on both friction and cohesion of the contacts")
    slip_surface_distance_m: float | None = Field(
        description=(
            "mean vertical distance between the slip surfaces of calibrated discs and continuum; null without both"
        )
    )
    layers: tuple[LayerCheck, ...] = Field(description="soil discs: comparison of every stratum with its discs")
    kc_table2: float | None = Field(description="critical Kh with the springs of Table 2 of the paper as printed")
    kc: float | None = Field(description="critical Kh of the calibrated discs; null without a bracket")
    kc_lower: float = Field(description="lower end of the bracket, at which the discs stand")
    kc_upper: float | None = Field(
        description="upper end of the bracket, at which the discs do not stand; null if they stand at every Kh"
    )
    calibrated: Factor | None = Field(
        description="factor of the calibration; null without an answer of the calibration"
    )
    verdict: str = Field(description="verdict of the calibration or, without one, of the search for the critical Kh")


class EstimateSummary(Part):
    """Holds an estimate of the displacement (m) by a simple method, which is compared with the slide of the discs."""

    method: str = Field(description="name of the method")
    displacement_m: float | None = Field(description="displacement; null if the method gives none")
    description: str = Field(description="input and result in words, and why the method does not apply")
    source: str = Field(description="publication of the method")
    validity: str = Field(description="range of validity of the method")


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

    reason: str = Field(description="reason why there is no answer")
    remedy: str = Field(description="advice on what the user can change; empty if there is none")


class MadeWith(Part):
    """Holds the machine, and the versions of the program and its libraries."""

    versions: dict[str, str] = Field(description="versions of this program, of Python and of its libraries, by name")
    host: str = Field(description="name of the machine")
    system: str = Field(description="operating system of the machine")
    processor: str = Field(description="processor, and number of cores to use")


class PaperModel(Part):
    """Holds the results of the unchanged discs of the paper."""

    kc: float | None = Field(description="critical Kh with the springs of the paper; null without a bracket")
    cases: dict[int, CaseNumbers] = Field(description="slides of the cases, by number")


class Summary(Answer):
    """Holds the results of all stages. A stage without an answer is listed in ``no_answer``."""

    FILE: ClassVar[str] = "summary.json"

    headlines: tuple[HeadlinePart, ...] = Field(description="the numbers of the first page of the report")
    in_short: tuple[str, ...] = Field(description="the conclusions of the first page, one sentence each")
    findings: tuple[str, ...] = Field(description="the results in sentences, one paragraph each")
    warnings: tuple[WarningPart, ...] = Field(description="warnings, the most important first")
    section: SectionLabel = Field(description="section of the run")
    mesh: MeshCount | None = Field(
        description="size of the mesh of the critical Kh or, without one, of the mesh of the section"
    )
    fem: FemSummary | None = Field(description="critical Kh and factors of safety by finite elements")
    fails_at_rest: bool = Field(
        default=False, description="whether the section fails without a seismic force, so that it has no critical Kh"
    )
    failure: FailureSummary | None = Field(
        default=None, description="factor of safety of ground that fails by its weight, in place of fem"
    )
    fem_variants: dict[str, VariantSummary] | None = Field(
        default=None, description="critical Kh with other assumptions, by the name of the assumption"
    )
    bounds: BoundsSummary | None = Field(default=None, description="strict bounds of the critical Kh")
    slices: tuple[CircleSummary, ...] | None = Field(default=None, description="critical slip circles")
    structures: tuple[FaceSummary, ...] | None = Field(default=None, description="the faces of structures")
    crests: tuple[CrestPart, ...] | None = Field(default=None, description="crests of structures after every slide")
    criteria: tuple[VerdictPart, ...] | None = Field(
        default=None, description="verdicts on quantities that have a limit"
    )
    dem: DemSummary | None = Field(default=None, description="critical Kh by discs, and their calibration")
    cases: dict[int, CaseSummary] | None = Field(default=None, description="cases on the governing set of springs")
    cases_springs: str | None = Field(default=None, description="name of the governing set of springs")
    cases_table2: dict[int, CaseNumbers] | None = Field(
        default=None, description="cases with the springs printed in the paper, if they were computed beside others"
    )
    paper_model: PaperModel | None = Field(
        default=None, description="results of the discs of the paper, if they were requested"
    )
    cases_random: RandomPackings | None = Field(default=None, description="cases on random packings")
    cases_mpm: dict[int, PointCase] | None = Field(
        default=None, description="cases by the material point method, if it was requested"
    )
    comparison: tuple[EstimateSummary, ...] = Field(description="displacements by simple methods, for comparison")
    triggering: tuple[StratumPart, ...] | None = Field(default=None, description="strata that liquefy, by borings")
    residual: PeakAndResidual | None = Field(default=None, description="stability with residual strength")
    liquefied: tuple[LiquefiedCase, ...] | None = Field(default=None, description="stability after liquefaction")
    paper: tuple[PaperRow, ...] | None = Field(
        default=None, description="quantities of the paper beside the computed values; for S-13 only"
    )
    no_answer: dict[str, NoAnswer] = Field(description="stages that ended without an answer, by name")
    seconds: dict[str, float] = Field(description="computing time of every stage (s)")
    made_with: MadeWith = Field(description="machine and versions of the run")

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
