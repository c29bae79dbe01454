"""Defines the tables of settings in the input file of a run, one settings object for each."""

from pathlib import Path
from typing import Literal

from pydantic import Field, StrictBool

from dem.settings import DemSettings, SlideSettings
from fem.settings import BoundsSettings, FemSettings
from meshes.section.model import Model
from meshes.section.motion_units import RecordComponent, RecordScale, RecordUnit
from meshes.section.quantity import Coordinate, Length
from meshes.section.tension_crack import TensionCrack
from meshes.settings import MeshSettings
from workflow.criteria.settings import CriteriaSettings
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.accelerogram import read as read_record
from workflow.earthquake.settings import EarthquakeSettings, SiteResponseSettings
from workflow.earthquake.triggering.settings import FreeFaceSettings, TriggeringSettings
from workflow.uncertain.settings import StudySettings, UncertainSettings

Language = Literal["en", "ja"]


class FigureSettings(Model):
    """Holds the settings of the pictures and of the report, the table [figures] of the input file."""

    report_width: int = Field(
        default=1280, ge=400, le=1600, description="width of the pictures in the report in pixels, from 400 to 1600"
    )
    report_animations: StrictBool = Field(
        default=True,
        description="true to include animations of the slides, and of the equilibrium path under rising Kh, in the "
        "report",
    )


class Observed(Model):
    """Holds a displacement that was measured, one table [[report.observed]] of the input file."""

    name: str = Field(min_length=1, description="place or method of the measurement, such as inclinometer SI-5")
    displacement: Length = Field(description='measured displacement of the ground, such as "0.26 m"')
    x: Coordinate | None = Field(
        default=None, description="position of the measurement along the section, where the discs are compared with it"
    )
    source: str = Field(default="", description="publication of the measurement")


class ReportSettings(Model):
    """Holds the title block of the report, the table [report] of the input file. Empty entries are left out."""

    project: str = Field(default="", description="name of the project")
    client: str = Field(default="", description="client for whom the report is written")
    author: str = Field(default="", description="engineer who is responsible for the report")
    number: str = Field(default="", description="number of the report, or its revision")
    standard: str = Field(default="", description="standard that the report follows")
    logo: str = Field(default="", description="file of a logo, .png, .jpg or .svg, in the folder of the section file")
    language: Language = Field(default="en", description='language of the report: "en" (English) or "ja" (Japanese)')
    appendix: bool = Field(
        default=False, description="true to add the appendices: comparison with the paper, input and provenance"
    )
    observed: tuple[Observed, ...] = Field(
        default=(),
        description="measured displacements, one table [[report.observed]] for each, drawn beside those of all methods",
    )


Variant = Literal["mesh", "element", "step", "dilation", "sides", "tension"]


class VariantSettings(Model):
    """Holds the settings of variants, the table [variants] of the input file. A variant is the critical Kh with one
    assumption changed."""

    which: tuple[Variant, ...] = Field(
        default=("element", "step", "dilation", "sides", "tension"),
        description="assumptions that are changed, one at a time, to show their influence on the critical Kh: "
        '"mesh" (four times the cells), "element", "step", "dilation", "sides", "tension" (no tensile strength, as '
        "with open cracks)",
    )


class FaceSettings(Model):
    """Holds the settings for the faces of structures, the table [faces] of the input file. The critical Kh and the
    factor of safety of each face are computed by finite elements and by strict bounds."""

    run: StrictBool | Literal["auto"] = Field(
        default="auto",
        description=(
            'true if `noshiro run` computes the faces of structures, false if not; "auto" is true for up '
            "to two structures"
        ),
    )
    bounds: StrictBool = Field(
        default=True,
        description=(
            "true to find strict bounds of the critical Kh also for faces that do not fail first, and of "
            "their factor of safety if bounds.safety_factor is true"
        ),
    )


class SlidingBlockSettings(Model):
    """Holds the settings of the sliding block, the table [sliding_block] of the input file. The slides of discs are
    compared with the slide of the block."""

    accelerogram: str = Field(
        default="", description="file with a record of the ground motion: PEER, K-NET, COSMOS, CSMIP, ESM or .csv"
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: RecordScale = 1.0
    kh: float | None = Field(
        default=None,
        ge=0.0,
        le=2.0,
        description="constant seismic coefficient under which the block slides; by default that of the slides",
    )
    seconds: float | None = Field(
        default=None,
        gt=0.0,
        le=3600.0,
        description="duration of the constant seismic coefficient (s); by default that of the slides",
    )

    def in_use(self) -> Accelerogram:
        """Return the named record, scaled. Raises InputError if it cannot be read."""
        return read_record(Path(self.accelerogram), self.unit, self.component).scaled(self.scale)


class Tables(Model):
    """Holds the settings of all stages, one TOML table for each stage."""

    mesh: MeshSettings = Field(default=MeshSettings(), description="a table [mesh] of the settings of the mesh")
    fem: FemSettings = Field(default=FemSettings(), description="a table [fem] of the finite element analysis")
    bounds: BoundsSettings = Field(default=BoundsSettings(), description="a table [bounds] of the limit analysis")
    dem: DemSettings = Field(default=DemSettings(), description="a table [dem] of the discs and their calibration")
    slide: SlideSettings = Field(default=SlideSettings(), description="a table [slide] of slides after liquefaction")
    variants: VariantSettings = Field(
        default=VariantSettings(), description="a table [variants] of assumptions that are changed one at a time"
    )
    faces: FaceSettings = Field(
        default=FaceSettings(), description="a table [faces] of the analyses of every face of structures"
    )
    sliding_block: SlidingBlockSettings = Field(
        default=SlidingBlockSettings(),
        description="a table [sliding_block] of the rigid blocks that slides are compared with",
    )
    earthquake: EarthquakeSettings = Field(
        default=EarthquakeSettings(), description="a table [earthquake] of magnitude, distance, acceleration or record"
    )
    site_response: SiteResponseSettings = Field(
        default=SiteResponseSettings(), description="a table [site_response] of the layers under a record of the rock"
    )
    triggering: TriggeringSettings = Field(
        default=TriggeringSettings(),
        description="a table [triggering] of borings, and of the method of triggering analysis",
    )
    free_face: FreeFaceSettings = Field(
        default=FreeFaceSettings(), description="a table [free_face] of the bank towards which liquefied ground spreads"
    )
    criteria: CriteriaSettings = Field(
        default=CriteriaSettings(), description="a table [criteria] of the limits that the answers are compared with"
    )
    tension_crack: TensionCrack = Field(
        default=TensionCrack(),
        description="a table [tension_crack] of vertical cracks and the water in them",
    )
    uncertain: UncertainSettings = Field(
        default=UncertainSettings(),
        description="a table [uncertain] of the distributions of uncertain numbers, by the paths of these numbers",
    )
    study: StudySettings = Field(
        default=StudySettings(), description="a table [study] of the samples of `noshiro study`"
    )
    figures: FigureSettings = Field(
        default=FigureSettings(), description="a table [figures] of pictures and animations of the report"
    )
    report: ReportSettings = Field(
        default=ReportSettings(), description="a table [report] of the title block, language, observations and appendix"
    )
