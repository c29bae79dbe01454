"""The config of a run: a section, and how to mesh it, compute with it and draw it."""

from collections.abc import Collection, Mapping
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Self

import tomli_w
from pydantic import PrivateAttr, ValidationError, model_validator

from dem.settings import AVERAGE, Case
from meshes.errors import InputError
from meshes.section.cutting import in_file
from meshes.section.liquefies import Cases
from meshes.section.overburden import reaches_water
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section, read_toml
from meshes.section.sentences import sentences
from workflow.earthquake.column import column_of
from workflow.earthquake.records_in_use import remarks
from workflow.earthquake.settings import EARTHQUAKE, push_of_slides
from workflow.renamed import current
from workflow.tables import Tables
from workflow.triggering.assessment import Assessment, assess, off_the_section
from workflow.triggering.consequences import left, pore_pressures
from workflow.triggering.plausibility import implausible_triggering
from workflow.uncertain.limits import Reach, reach_of
from workflow.uncertain.path import changed, plain

# Options of the command line that take the place of other settings in the file.
REPLACES = {("mesh", "size"): ("columns", "rows"), ("mesh", "method"): ("columns", "rows")}

# Settings that name a file, by table and key.
K_MAX = "k_max"  # in place of the Kh of the slides: what the record gives the ground above the slip surface
FILES = (
    ("sliding_block", "accelerogram"), ("slide", "accelerogram"), ("site_response", "record"), ("earthquake", "record"),
    ("report", "logo"),
)  # fmt: skip


class Config(Tables):
    """All that the file of a run says: a section, and the settings of the stages."""

    section: Section

    _written: dict[str, Any] = PrivateAttr(default_factory=dict)  # the section as it stood in the file
    _left_to_the_sample: dict[str, Any] = PrivateAttr(default_factory=dict)  # settings that follow from the ground

    @model_validator(mode="after")
    def _settings_fit(self) -> Self:
        section = self.section
        problems = self.mesh.problems(section) + self.dem.problems(section) + self.free_face.problems(section.ground)
        problems += self.earthquake.problems() + off_the_section(section, self.triggering)
        problems += implausible_triggering(section, self.earthquake, self.triggering)
        response = self.site_response
        if self.slide.accelerogram == AVERAGE and not (response.record and response.slip_depth):
            problems.append(f'slide, accelerogram = "{AVERAGE}": expected record and slip_depth in [site_response]')
        if self.criteria.lacks_peak:
            problems.append(
                f'criteria, preset = "{self.criteria.preset}": expected peak_acceleration, or magnitude and distance, '
                "in [earthquake]"
            )
        names = [stratum.name for stratum in section.strata]
        problems += self.slide.problems(names)
        count = len(self.slide.cases) + len(self.triggering.cases)
        if not count:
            problems.append("slide, cases = []: expected one at least, here or in [triggering]")
        problems += [
            f"{in_file(names, k)}, liquefies_in = {list(s.liquefies_in)}: expected cases from 1 to {count}, "
            "which there are in [slide] and [triggering]"
            for k, s in enumerate(section.strata)
            if not s.liquefies_in.triggered and any(number > count for number in s.liquefies_in)
        ]
        if problems:
            raise ValueError("\n".join(problems))
        return self

    def with_drawn(self, drawn: Mapping[str, Any], judged: bool = False) -> "Config":
        """The input with values in the place of uncertain numbers, by their paths; itself it has no [uncertain].

        What is drawn may be beyond what soils usually have, unless it is ``judged`` as what a person wrote. Raises
        ValueError for a path that leads nowhere, InputError for values that do not fit.
        """
        data = changed(self._before_the_cut(), drawn, self.uncertain.numbers)
        return Config.parse(data if judged else {**data, "unusual": True}, self.section.name)

    @cached_property
    def reach(self) -> dict[str, Reach]:
        """How far the distribution of each uncertain number reaches, by its path."""
        return reach_of(self._before_the_cut(), self.uncertain.numbers, (Section, Tables))

    def _before_the_cut(self) -> dict[str, Any]:
        """The section as it was written, before water cut its strata, with the settings as they are used."""
        settings = set(self.tables()) - {"uncertain", "study"}
        used = self.model_dump(mode="python", exclude_none=True, by_alias=True, include=settings)
        return merged({**self._written, **used}, self._left_to_the_sample)

    def to_data(self, tables: Collection[str] | None = None) -> dict[str, Any]:
        """The config as a TOML file or JSON holds it: the section, and the ``tables``, or all of them."""
        wanted = set(self.tables() if tables is None else tables)
        section = self.section.model_dump(mode="json", exclude_none=True, by_alias=True)
        return {**section, **self.model_dump(mode="json", exclude_none=True, by_alias=True, include=wanted)}

    def to_toml(self) -> str:
        """The config as TOML with all defaults filled in and quantities as they were written.

        Where numbers are uncertain the strata are those of the file, to which their paths lead.
        """
        if not self.uncertain.numbers:
            return tomli_w.dumps(self.to_data())
        sampled = self.model_dump(mode="python", exclude_none=True, by_alias=True, include={"uncertain", "study"})
        return tomli_w.dumps({**self._before_the_cut(), **sampled})

    @property
    def notices(self) -> list[str]:
        """What a person has to know of the section, of its mesh and of its records, one sentence each."""
        cut_off = [line for one in self.reach.values() for line in one.notice.splitlines()]
        return [*self.section.notices, *self.mesh.notices(self.section), *cut_off, *self.notices_of_shaking]

    @property
    def notices_of_shaking(self) -> list[str]:
        """What a person has to know of the earthquake and its records, and of what it does to the slides."""
        slides = self.section.liquefies
        return [*remarks(self), *self.earthquake.notices(self.slide if slides else None)]

    @classmethod
    def parse(cls, data: Mapping[str, Any], source: str = "section") -> Self:
        """The input from what a TOML file holds; raises InputError with every problem found.

        Strata whose `liquefies_in` is left to the blow counts get all cases of the slide, or none; cases that follow
        from the blow counts take the place of the default ones.
        """
        data = current(data)
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
        given = cls._validated(data, source)
        asked = given.triggering.cases or given.triggering.pore_pressure
        if asked or any(stratum.liquefies_in.triggered for stratum in given.section.strata):
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
    def _validated(cls, data: Mapping[str, Any], source: str) -> Self:
        """The section and every table on its own, then together; raises InputError with every problem found."""
        tables = {key: value for key, value in data.items() if key in cls.tables() or _is_unknown_table(key, value)}
        section, settings = None, None
        problems: list[str] = []
        try:
            section = Section.as_written({key: value for key, value in data.items() if key not in tables}, source)
        except InputError as error:
            problems += error.problems
        try:
            settings = Tables.model_validate(tables)
        except ValidationError as error:
            problems += sentences(error, tables, Tables, beside=list(Section.model_fields))
        if section is None or settings is None:
            raise InputError(source, problems)
        try:
            used = {**dict(settings), "criteria": settings.criteria.resolved(_peak(settings))}
            return cls(section=section, **used)._with_section(section.thinned().cut_at_water())
        except ValidationError as error:
            raise InputError(source, sentences(error, data, cls)) from None

    @classmethod
    def _average_kh(cls, data: Mapping[str, Any], source: str) -> float:
        """k_max of all above the slip surface (Makdisi & Seed 1978), for slides whose Kh is left to it."""
        slide = {key: value for key, value in data["slide"].items() if key != "kh"}
        given = cls.parse({**data, "slide": slide}, source)
        response = given.site_response
        if not response.record or response.slip_depth is None:
            told = f'slide, kh = "{K_MAX}": expected record and slip_depth in [site_response], or a number'
            raise InputError(source, [told])
        return round(column_of(given.section, response).k_max(float(response.slip_depth)), 4)

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """The cases of the slide: those of [slide], then those that follow from the blow counts, by their names.

        Raises InputError where no relation of residual strength holds.
        """
        if not self.triggering.cases:
            return self.slide.cases
        strata = self.section.strata
        remains = [one for one in left(self.assessment(), self.triggering) if strata[one.stratum].liquefies_in]
        found = []
        for name in self.triggering.cases:
            try:
                kept = {strata[one.stratum].name: (one.ratio(name), one.strength(name)) for one in remains}
            except ValueError as error:
                raise InputError(self.section.name, [f'triggering, cases, "{name}": {error}']) from None
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
        return assess(self.section, self.earthquake, self.triggering)

    def _triggered(self, found: Assessment) -> Self:
        pairs = list(zip(self.section.strata, found.strata, strict=True))
        names = [stratum.name for stratum in self.section.strata]
        untested = [
            in_file(names, k)
            for k, (own, its) in enumerate(pairs)
            if own.liquefies_in.triggered and its.share is None and reaches_water(self.section, k)
        ]
        if untested:
            told = 'liquefies_in = "triggered": no boring has a blow count in it; expected one, or cases, [] for none'
            raise InputError(self.section.name, [f"{where}, {told}" for where in untested])
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
        changed = self._with_section(self.section.with_strata(strata))
        _ = changed.cases  # raises where no relation of residual strength holds
        return changed

    def _with_section(self, section: Section) -> Self:
        changed = type(self).model_construct(section=section, **{name: getattr(self, name) for name in self.tables()})
        changed._written, changed._left_to_the_sample = self._written, self._left_to_the_sample
        return changed

    @classmethod
    def tables(cls) -> list[str]:
        """The names of the tables of settings."""
        return list(Tables.model_fields)

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


def _peak(settings: Tables) -> float | None:
    """Peak acceleration of the ground over gravity; None where the earthquake does not tell it."""
    try:
        motion = settings.earthquake.motion()
    except InputError:
        return None
    return None if motion is None else motion.median / GRAVITY


def _is_unknown_table(key: str, value: Any) -> bool:
    return isinstance(value, Mapping) and key not in Section.model_fields


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
