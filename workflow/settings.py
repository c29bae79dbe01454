"""The whole input of a run: a section, and how to mesh it, compute with it and draw it."""

import hashlib
from collections.abc import Mapping
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Literal, Self

import tomli_w
from pydantic import Field, PrivateAttr, StrictBool, model_validator

from dem.settings import AVERAGE, Case, DemSettings, SlideSettings
from fem.settings import BoundsSettings, FemSettings
from meshes.errors import InputError
from meshes.section.cutting import in_file
from meshes.section.liquefies import Cases
from meshes.section.overburden import reaches_water
from meshes.section.quantity import Coordinate, Length
from meshes.section.record_of_motion import RecordComponent, RecordScale, RecordUnit
from meshes.section.section import Model, Section, read_toml
from meshes.settings import MeshSettings
from workflow.earthquake.accelerogram import Accelerogram
from workflow.earthquake.accelerogram import read as read_record
from workflow.earthquake.column import column_of
from workflow.earthquake.records_in_use import remarks
from workflow.earthquake.settings import EARTHQUAKE, EarthquakeSettings, SiteResponseSettings, push_of_slides
from workflow.triggering.assessment import Assessment, assess, off_the_section
from workflow.triggering.consequences import left, pore_pressures
from workflow.triggering.free_face import FreeFaceSettings
from workflow.triggering.plausibility import implausible_triggering
from workflow.triggering.settings import TriggeringSettings
from workflow.uncertain.limits import Reach, reach_of
from workflow.uncertain.path import changed, plain
from workflow.uncertain.settings import StudySettings, UncertainSettings

# Options of the command line that take the place of other settings in the file.
REPLACES = {("mesh", "size"): ("columns", "rows"), ("mesh", "method"): ("columns", "rows")}

# Settings that name a file, by table and key.
K_MAX = "k_max"  # in place of the Kh of the slides: what the record gives the ground above the slip surface
FILES = (
    ("sliding_block", "accelerogram"), ("slide", "accelerogram"), ("site_response", "record"), ("earthquake", "record"),
    ("report", "logo"),
)  # fmt: skip


class FigureSettings(Model):
    """Settings of the pictures and of the report, a table [figures]."""

    report_width: int = Field(
        default=1280, ge=400, le=1600, description="pixels across of the pictures in the report, from 400 to 1600"
    )
    report_animations: StrictBool = Field(
        default=True, description="true if the report shall play the slides, and the path of Kh"
    )


class Observed(Model):
    """A displacement that was measured, a table [[report.observed]]."""

    name: str = Field(min_length=1, description="where or how it was measured, such as inclinometer SI-5")
    displacement: Length = Field(description='how far the ground went, such as "0.26 m"')
    x: Coordinate | None = Field(default=None, description="where, along the section, beside the discs there")
    source: str = Field(default="", description="where that is told")


class ReportSettings(Model):
    """What stands at the head of the report, a table [report]; what is empty is left out."""

    project: str = Field(default="", description="the name of the project")
    client: str = Field(default="", description="for whom the report is")
    author: str = Field(default="", description="who answers for it")
    number: str = Field(default="", description="the number of the report, or its revision")
    standard: str = Field(default="", description="the standard that it follows")
    logo: str = Field(default="", description="a picture, .png, .jpg or .svg, beside this file")
    observed: tuple[Observed, ...] = Field(
        default=(), description="one table [[report.observed]] for each measured displacement, drawn beside all others"
    )


Variant = Literal["mesh", "element", "step", "dilation", "sides"]


class VariantSettings(Model):
    """On what the critical Kh hangs, a table [variants]."""

    which: tuple[Variant, ...] = Field(
        default=("element", "step", "dilation", "sides"),
        description='what is changed, one at a time, to see how much of the critical Kh hangs on it: "mesh" (four '
        'times the cells), "element", "step", "dilation", "sides"',
    )


class SlidingBlockSettings(Model):
    """What the slide of the discs is compared with, a table [sliding_block]."""

    accelerogram: str = Field(
        default="", description="a file with a record of the ground: PEER, K-NET, COSMOS, CSMIP, ESM or .csv"
    )
    unit: RecordUnit = ""
    component: RecordComponent = ""
    scale: RecordScale = 1.0
    kh: float | None = Field(
        default=None, ge=0.0, le=2.0, description="the constant seismic coefficient; by default that of the slides"
    )
    seconds: float | None = Field(
        default=None,
        gt=0.0,
        le=3600.0,
        description="how long the constant coefficient acts (s); by default as long as on the slides, else 10",
    )

    def in_use(self) -> Accelerogram:
        """The record that is named, scaled; raises InputError if it cannot be read."""
        return read_record(Path(self.accelerogram), self.unit, self.component).scaled(self.scale)


class Input(Section):
    """A section with the settings of the stages, one TOML table each."""

    mesh: MeshSettings = Field(default=MeshSettings(), description="a table [mesh] that says how to mesh")
    fem: FemSettings = Field(default=FemSettings(), description="a table [fem] of the finite element analysis")
    bounds: BoundsSettings = Field(default=BoundsSettings(), description="a table [bounds] of the limit analysis")
    dem: DemSettings = Field(default=DemSettings(), description="a table [dem] of the discs and their calibration")
    slide: SlideSettings = Field(default=SlideSettings(), description="a table [slide] of the liquefied slides")
    variants: VariantSettings = Field(
        default=VariantSettings(), description="a table [variants] of what is changed to see what it does"
    )
    sliding_block: SlidingBlockSettings = Field(
        default=SlidingBlockSettings(), description="a table [sliding_block] of the blocks to compare with"
    )
    earthquake: EarthquakeSettings = Field(
        default=EarthquakeSettings(), description="a table [earthquake] of magnitude and distance, or acceleration"
    )
    site_response: SiteResponseSettings = Field(
        default=SiteResponseSettings(), description="a table [site_response] of the layers under a record of the rock"
    )
    triggering: TriggeringSettings = Field(
        default=TriggeringSettings(), description="a table [triggering] of borings, and of how they are judged"
    )
    free_face: FreeFaceSettings = Field(
        default=FreeFaceSettings(), description="a table [free_face] of a bank that liquefied ground spreads towards"
    )
    uncertain: UncertainSettings = Field(
        default=UncertainSettings(),
        description="a table [uncertain] of numbers that have a distribution, by their paths",
    )
    study: StudySettings = Field(
        default=StudySettings(), description="a table [study] of how `noshiro study` samples what is uncertain"
    )
    figures: FigureSettings = Field(default=FigureSettings(), description="a table [figures] of pictures and report")
    report: ReportSettings = Field(default=ReportSettings(), description="a table [report] of the head of the report")

    _written: dict[str, Any] = PrivateAttr(default_factory=dict)  # the section as it stood in the file
    _left_to_the_sample: dict[str, Any] = PrivateAttr(default_factory=dict)  # settings that follow from the ground

    @model_validator(mode="after")
    def _settings_fit(self) -> Self:
        problems = self.mesh.problems(self) + self.dem.problems(self) + self.free_face.problems(self.ground)
        problems += self.earthquake.problems() + off_the_section(self, self.triggering)
        problems += implausible_triggering(self, self.earthquake, self.triggering)
        response = self.site_response
        if self.slide.accelerogram == AVERAGE and not (response.record and response.slip_depth):
            problems.append(f'slide, accelerogram = "{AVERAGE}": expected record and slip_depth in [site_response]')
        names = [stratum.name for stratum in self.strata]
        problems += self.slide.problems(names)
        count = len(self.slide.cases) + len(self.triggering.cases)
        if not count:
            problems.append("slide, cases = []: expected one at least, here or in [triggering]")
        problems += [
            f"{in_file(names, k)}, liquefies_in = {list(s.liquefies_in)}: expected cases from 1 to {count}, "
            "which there are in [slide] and [triggering]"
            for k, s in enumerate(self.strata)
            if not s.liquefies_in.triggered and any(number > count for number in s.liquefies_in)
        ]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def with_drawn(self, drawn: Mapping[str, Any], judged: bool = False) -> "Input":
        """The input with values in the place of uncertain numbers, by their paths; itself it has no [uncertain].

        What is drawn may be beyond what soils usually have, unless it is ``judged`` as what a person wrote. Raises
        ValueError for a path that leads nowhere, InputError for values that do not fit.
        """
        data = changed(self._before_the_cut(), drawn, self.uncertain.numbers)
        return Input.parse(data if judged else {**data, "unusual": True}, self.name)

    @cached_property
    def reach(self) -> dict[str, Reach]:
        """How far the distribution of each uncertain number reaches, by its path."""
        return reach_of(self._before_the_cut(), self.uncertain.numbers, Input)

    def _before_the_cut(self) -> dict[str, Any]:
        """The section as it was written, before water cut its strata, with the settings as they are used."""
        settings = set(self.tables()) - {"uncertain", "study"}
        used = self.model_dump(mode="python", exclude_none=True, by_alias=True, include=settings)
        return merged({**self._written, **used}, self._left_to_the_sample)

    def to_toml(self) -> str:
        """The input as TOML with all defaults filled in and quantities as they were written.

        Where numbers are uncertain the strata are those of the file, to which their paths lead.
        """
        if not self.uncertain.numbers:
            return super().to_toml()
        sampled = self.model_dump(mode="python", exclude_none=True, by_alias=True, include={"uncertain", "study"})
        return tomli_w.dumps({**self._before_the_cut(), **sampled})

    @property
    def disc_work(self) -> float:
        """How much discs cost, as a multiple of 2,500: so many discs, each with a step in proportion to its radius."""
        radius = self.dem.radius
        count = self.dem.elements if radius is None else float(self.layering.areas().sum()) / (3.46 * radius**2)
        return float(count / 2500.0) ** 1.5

    @property
    def notices(self) -> list[str]:
        """What a person has to know of the section, of its mesh and of its records, one sentence each."""
        cut_off = [line for one in self.reach.values() for line in one.notice.splitlines()]
        return [*super().notices, *self.mesh.notices(self), *cut_off, *self.notices_of_shaking]

    @property
    def notices_of_shaking(self) -> list[str]:
        """What a person has to know of the earthquake and its records, and of what it does to the slides."""
        slides = any(stratum.liquefies_in for stratum in self.strata)
        return [*remarks(self), *self.earthquake.notices(self.slide if slides else None)]

    @classmethod
    def parse(cls, data: Mapping[str, Any], source: str = "section") -> Self:
        """The input from what a TOML file holds; raises InputError with every problem found.

        Strata whose `liquefies_in` is left to the blow counts get all cases of the slide, or none; cases that follow
        from the blow counts take the place of the default ones.
        """
        slide = data.get("slide", {}) if isinstance(data.get("slide", {}), Mapping) else {}
        triggering = data.get("triggering")
        if isinstance(triggering, Mapping) and triggering.get("cases") and "cases" not in slide:
            return cls.parse(merged(data, {"slide": {"cases": []}}), source)  # not the paper's three beside them
        if slide.get("kh") == K_MAX:
            given = cls.parse(merged(data, {"slide": {"kh": cls._average_kh(data, source)}}), source)
            given._left_to_the_sample = {"slide": {"kh": K_MAX}}
            return given
        if push := push_of_slides(data.get("earthquake"), slide, source):
            given = cls.parse(merged(data, {"slide": push}), source)
            left = [key for key in push if f"slide.{key}" not in given.uncertain.numbers]
            given._left_to_the_sample = {"slide": dict.fromkeys(left, EARTHQUAKE)}
            return given
        given = super().parse(data, source)
        asked = given.triggering.cases or given.triggering.pore_pressure
        if asked or any(stratum.liquefies_in.triggered for stratum in given.strata):
            try:
                given = given._triggered(given.assessment())
            except InputError as error:
                raise InputError(source, error.problems) from None
        if given.uncertain.numbers:
            given._written = {key: plain(value) for key, value in data.items() if key not in cls.tables()}
            problems = given.uncertain.problems(partial(given.with_drawn, judged=True))
            problems += [line for one in given.reach.values() for line in one.problem.splitlines()]
            if problems:
                raise InputError(source, problems)
        return given

    @classmethod
    def _average_kh(cls, data: Mapping[str, Any], source: str) -> float:
        """k_max of all above the slip surface (Makdisi & Seed 1978), for slides whose Kh is left to it."""
        slide = {key: value for key, value in data["slide"].items() if key != "kh"}
        given = cls.parse({**data, "slide": slide}, source)
        response = given.site_response
        if not response.record or response.slip_depth is None:
            told = f'slide, kh = "{K_MAX}": expected record and slip_depth in [site_response], or a number'
            raise InputError(source, [told])
        return round(column_of(given, response).k_max(float(response.slip_depth)), 4)

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """The cases of the slide: those of [slide], then those that follow from the blow counts, by their names.

        Raises InputError where no relation of residual strength holds.
        """
        if not self.triggering.cases:
            return self.slide.cases
        remains = [one for one in left(self.assessment(), self.triggering) if self.strata[one.stratum].liquefies_in]
        found = []
        for name in self.triggering.cases:
            try:
                kept = {self.strata[one.stratum].name: (one.ratio(name), one.strength(name)) for one in remains}
            except ValueError as error:
                raise InputError(self.name, [f'triggering, cases, "{name}": {error}']) from None
            drained = min(0.2, max((one.volumetric_strain for one in remains), default=0.0))
            if self.triggering.residual == "ratio":
                ratios = {stratum: ratio for stratum, (ratio, _) in kept.items()}
                found.append(Case(name=name, residual=ratios, volumetric_strain=drained))
            else:
                strengths = {stratum: strength for stratum, (_, strength) in kept.items()}
                found.append(Case(name=name, residual_strength=strengths, volumetric_strain=drained))
        return (*self.slide.cases, *found)

    def called(self, case: int) -> str:
        """What a case is called in pictures: its number, and its name if it has one."""
        name = self.cases[case - 1].name if 0 < case <= len(self.cases) else ""
        return f"case {case}, {name}" if name else f"case {case}"

    def assessment(self) -> Assessment:
        """F_L at every blow count; raises InputError where borings or the earthquake do not allow it."""
        return assess(self, self.earthquake, self.triggering)

    def _triggered(self, found: Assessment) -> Self:
        pairs = list(zip(self.strata, found.strata, strict=True))
        names = [stratum.name for stratum in self.strata]
        untested = [
            in_file(names, k)
            for k, (own, its) in enumerate(pairs)
            if own.liquefies_in.triggered and its.share is None and reaches_water(self, k)
        ]
        if untested:
            told = 'liquefies_in = "triggered": no boring has a blow count in it; expected one, or cases, [] for none'
            raise InputError(self.name, [f"{where}, {told}" for where in untested])
        numbers = range(1, len(self.slide.cases) + len(self.triggering.cases) + 1)
        strata = [
            own.model_copy(update={"liquefies_in": Cases(numbers if its.liquefies else (), triggered=True)})
            if own.liquefies_in.triggered
            else own
            for own, its in pairs
        ]
        if self.triggering.pore_pressure:
            strata = [
                own.model_copy(update={"excess_pore_pressure_ratio": own.excess_pore_pressure_ratio or ratio})
                if not own.liquefies_in
                else own
                for own, ratio in zip(strata, pore_pressures(found, len(strata)), strict=True)
            ]
        changed = self.with_strata(strata)
        _ = changed.cases  # raises where no relation of residual strength holds
        return changed

    @classmethod
    def tables(cls) -> list[str]:
        """The names of the tables of settings."""
        return [name for name in cls.model_fields if name not in Section.model_fields]

    def sha256(self) -> str:
        """A fingerprint of the ground alone, without what it is called and the settings."""
        others = {"name", "title", *self.tables()}
        section = self.model_dump(mode="python", exclude_none=True, by_alias=True, exclude=others)
        return hashlib.sha256(tomli_w.dumps(section).encode()).hexdigest()

    @classmethod
    def load(cls, path: Path | str, overrides: Mapping[str, Mapping[str, Any]] | None = None) -> Self:
        """The input in a TOML file, with settings of the command line put over those of the file.

        Files that it names are looked for beside it, those of the command line where that is given. Raises InputError
        with every problem found.
        """
        data = read_toml(path)
        _find_beside(data, Path(path).parent)
        for table, values in (overrides or {}).items():
            given = {key: value for key, value in values.items() if value is not None}
            _find_beside({table: given}, Path())
            if given and isinstance(data.get(table, {}), dict):
                replaced = {other for key in given for other in REPLACES.get((table, key), ())} - given.keys()
                kept = {key: value for key, value in data.get(table, {}).items() if key not in replaced}
                data[table] = merged(kept, given)
        read = cls.parse(data, str(path))
        if missing := [
            f"{key} = {file}: there is no such file" for key, file in read.files().items() if not file.is_file()
        ]:
            raise InputError(str(path), missing)
        return read

    def files(self, *tables: str) -> dict[str, Path]:
        """The files that the settings, or some tables of them, name, by table and key."""
        wanted = tables or self.tables()
        return {f"{table}, {key}": path for (table, key), path in self.named_files().items() if table in wanted}

    def named_files(self) -> dict[tuple[str, str], Path]:
        """All files that the settings name, by table and key."""
        named = {(table, key): getattr(getattr(self, table), key) for table, key in FILES}
        return {place: Path(name) for place, name in named.items() if name not in ("", AVERAGE)}


def _find_beside(data: Mapping[str, Any], folder: Path) -> None:
    """Make the paths of the files that settings name absolute ones."""
    for table, key in FILES:
        values = data.get(table)
        if isinstance(values, dict) and isinstance(name := values.get(key), str) and name not in ("", AVERAGE):
            values[key] = str((folder / name).absolute())


def merged(lower: Mapping[str, Any], upper: Mapping[str, Any]) -> dict[str, Any]:
    """Two nested tables as one; where both say something the upper one counts."""
    both = {**lower, **upper}
    for key in lower.keys() & upper.keys():
        if isinstance(lower[key], Mapping) and isinstance(upper[key], Mapping):
            both[key] = merged(lower[key], upper[key])
    return both
