"""Defines the config of a run: a section, and the settings of mesh, analyses and pictures."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Self

import tomli_w
from pydantic import PrivateAttr, ValidationError, model_validator

from dem.case import Case, cases_of_loose_sand
from dem.disc_count import usual_disc_count
from dem.settings import AVERAGE, CASES, SlideSettings
from fem.settings import Sides, usual_sides, usual_sides_of_slides
from meshes.errors import InputError
from meshes.section.quantity import GRAVITY
from meshes.section.section import Section
from meshes.section.sentences import sentences
from meshes.section.toml_file import read_toml
from workflow.config.bare_faces import falling_faces
from workflow.config.contradictions import (
    FILES,
    contradictions,
    missing_files,
    sides_that_differ,
    strata_in,
    strata_of,
    valid_tables,
)
from workflow.config.one_way_kh import faces_without_kh
from workflow.config.renamed import current
from workflow.config.tables import Tables
from workflow.earthquake.records_in_use import other_peak, remarks, unreadable_records
from workflow.earthquake.settings import CYCLES, EARTHQUAKE
from workflow.earthquake.triggering.assessment import below_loads
from workflow.earthquake.triggering.settings import CASE_NAMES, left_to_borings
from workflow.uncertain.limits import AdmissibleRange, reach_of
from workflow.uncertain.path import changed, mutable_copy

# Options of the command line that take the place of other settings in the file.
REPLACES = {("mesh", "size"): ("columns", "rows"), ("mesh", "method"): ("columns", "rows")}

K_MAX = "k_max"  # setting of the Kh of the slides: peak of the average acceleration above the slip surface
# Settings of [slide] that can follow from other tables, and the words for these tables.
DECIDED_ELSEWHERE = {"kh": (K_MAX, EARTHQUAKE), **dict.fromkeys(CYCLES, (EARTHQUAKE,))}
PLACEHOLDER = 0.1  # of numbers that `config_after_triggering` computes; all of these keys allow it

# Tables of published slopes and known slides: what others found, for `noshiro verify`. A run does not need them.
FOUND_BY_OTHERS = ("published", "known")

# Notices of actions of the program that require nothing of the user.
ACTIONS_TAKEN = (
    "thins out to nothing at", "is a wedge thinner than", "discs have its mean throughout", " follows from "
    "[earthquake]: ",
    "ground, layers and water continue for",
)  # fmt: skip


def notice_lines(notices: Iterable[str]) -> list[str]:
    """Return notices as lines that commands print. Notes state what the program did; warnings may require an action of
    the user."""
    return [f"{'Note' if any(words in text for words in ACTIONS_TAKEN) else 'Warning'}: {text}." for text in notices]


class Config(Tables):
    """Holds the content of a run's input file: a section, and the settings of the stages."""

    section: Section

    _written: dict[str, Any] = PrivateAttr(default_factory=dict)  # the section as it stood in the file
    _left_open: dict[str, str] = PrivateAttr(default_factory=dict)  # keys of [slide] that follow from other tables
    _derived_cases: tuple[Case, ...] = PrivateAttr(default=())  # cases that follow from borings

    @model_validator(mode="after")
    def _settings_fit(self) -> Self:
        if problems := contradictions(self.section, strata_of(self.section), dict(self)):
            raise ValueError("\n".join(problems))
        return self

    def with_drawn(self, drawn: Mapping[str, Any], judged: bool = False) -> "Config":
        """Return the config with sampled values of the uncertain numbers, by their paths, and without [uncertain].

        Sampled values may be unusual for soils; with ``judged`` they are checked like the values of a section file.
        Raises ValueError for an unknown path, InputError for invalid values.
        """
        data = changed(self._before_the_cut(), drawn, self.uncertain.numbers)
        return Config.parse(data if judged else {**data, "unusual": True}, self.section.name)

    @cached_property
    def reach(self) -> dict[str, AdmissibleRange]:
        """Return the range of the distribution of each uncertain number, by its path."""
        return reach_of(self._before_the_cut(), self.uncertain.numbers, (Section, Tables))

    def _before_the_cut(self) -> dict[str, Any]:
        """Return the section as written in the file, before its strata were divided at the water table, together with
        the settings in use."""
        settings = set(self.tables()) - {"uncertain", "study"}
        used = self.model_dump(mode="python", exclude_none=True, by_alias=True, include=settings)
        unset = DECIDED_ELSEWHERE.keys() - self.slide.model_fields_set
        slide = {key: value for key, value in used["slide"].items() if key not in unset}
        left = {key: word for key, word in self._left_open.items() if f"slide.{key}" not in self.uncertain.numbers}
        return {**self._written, **used, "slide": {**slide, **left}}

    def to_data(self, tables: Collection[str] | None = None) -> dict[str, Any]:
        """Return the config as data for TOML or JSON: the section, and the named ``tables``, or all tables."""
        wanted = set(self.tables() if tables is None else tables)
        section = self.section.model_dump(mode="json", exclude_none=True, by_alias=True)
        return {**section, **self.model_dump(mode="json", exclude_none=True, by_alias=True, include=wanted)}

    def to_toml(self) -> str:
        """Return the config as TOML with all defaults filled in and quantities as they were written.

        If there are uncertain numbers, the strata are written as in the file, since the paths of these numbers refer to
        them.
        """
        if not self.uncertain.numbers:
            return tomli_w.dumps(self.to_data())
        sampled = self.model_dump(mode="python", exclude_none=True, by_alias=True, include={"uncertain", "study"})
        return tomli_w.dumps({**self._before_the_cut(), **sampled})

    @property
    def notices(self) -> list[str]:
        """Return notices on the section, its mesh and its records, one sentence each."""
        return [*self.notices_of_ground, *self.notices_of_slides]

    @property
    def notice_lines(self) -> list[str]:
        """Return the notices as commands print them, warnings first."""
        return sorted(notice_lines(self.notices), reverse=True, key=lambda line: line.startswith("Warning"))

    @property
    def notices_of_ground(self) -> list[str]:
        """Return notices on the section, its mesh and its uncertain numbers."""
        cut_off = [line for reach in self.reach.values() for line in reach.notice.splitlines()]
        cracks = self.tension_crack.notices(self.section)
        falling = falling_faces(self.section, self.fem)
        return [*self.section.notices, *falling, *self.mesh.notices(self.section), *cracks, *cut_off]

    @property
    def notices_of_slides(self) -> list[str]:
        """Return notices on the earthquake and its records, on their effect on the slides, and on assumed residual
        strengths.
        """
        slides = self.section.liquefies
        notices = [*remarks(self), *other_peak(self), *self.earthquake.notices(self.slide if slides else None)]
        notices += below_loads(self.section, self.triggering)
        notices += faces_without_kh(self.section.ground, self.slide) if slides else []
        if slides and self.slide.cases and self.slide.cases == cases_of_loose_sand(self.section):
            notices.append(
                "no residual strength of liquefied ground is given; loose sand with (N1)60 = 8, 3 "
                "and 12 is assumed (Olson & Stark 2002): give borings ([triggering]), or [[slide.cases]]"
            )
        return notices

    @classmethod
    def parse(cls, data: Mapping[str, Any], source: str = "section") -> Self:
        """Make the config from the content of a TOML file. The function `config_after_triggering` completes the config
        by analyses, after which cases from borings replace the default cases. Raises InputError with every problem.
        """
        data = {key: value for key, value in current(data).items() if key not in FOUND_BY_OTHERS}
        slide = data.get("slide", {})
        left_open: dict[str, str] = {}
        if isinstance(slide, Mapping):
            triggering = data.get("triggering")
            dem = data.get("dem")
            if "cases" in slide:
                pass
            elif isinstance(triggering, Mapping) and triggering.get("cases"):
                data = merged(data, {"slide": {"cases": []}})  # not the default ones beside them
            elif isinstance(dem, Mapping) and dem.get("model") == "paper":
                data = merged(data, {"slide": {"cases": [case.model_dump() for case in CASES["paper"]]}})
            elif left_to_borings(data):
                data = merged(data, {"slide": {"cases": []}, "triggering": {"cases": list(CASE_NAMES)}})
            left_open = {
                key: slide[key]
                for key in DECIDED_ELSEWHERE
                if isinstance(slide.get(key), str) and slide[key] in DECIDED_ELSEWHERE[key]
            }
            if left_open:
                data = merged(data, {"slide": dict.fromkeys(left_open, PLACEHOLDER)})
        config = cls._validated(data, source)
        config._left_open = left_open
        if config.uncertain.numbers:
            config._written = {key: mutable_copy(value) for key, value in data.items() if key not in cls.tables()}
            problems = config.uncertain.problems(partial(config.with_drawn, judged=True))
            problems += [line for reach in config.reach.values() for line in reach.problem.splitlines()]
            if problems:
                raise InputError(source, problems)
        return config

    def with_settings(self, table: str, **values: Any) -> Self:
        """Return the config with other values in one table of settings. Raises ValidationError for an invalid value."""
        return self.model_copy(update={table: getattr(self, table).changed(**values)})

    @property
    def left_open(self) -> dict[str, str]:
        """Return the keys of [slide] whose value another table determines, each with the value that refers to this
        table."""
        return self._left_open

    def analysed(self, section: Section, slide: SlideSettings, cases: Sequence[Case], keys: Sequence[str]) -> Self:
        """Return the config completed by analyses: ground, slides, and cases from borings; ``keys`` are the keys
        that the earthquake determines.

        ``section``: the section of the ground; ``slide``: settings of slides.
        """
        tables = {name: getattr(self, name) for name in self.tables()}
        config = type(self).model_construct(section=section, **{**tables, "slide": slide})
        config._written, config._derived_cases = self._written, tuple(cases)
        config._left_open = self._left_open | dict.fromkeys(keys, EARTHQUAKE)
        return config

    @classmethod
    def _validated(cls, data: Mapping[str, Any], source: str) -> Self:
        """Return the section and the tables, validated one by one, then together; raise InputError with every
        problem."""
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
            problems += sentences(error, tables, Tables, other_keys=list(Section.model_fields))
        if section is None or settings is None:
            valid = valid_tables(tables)
            problems += contradictions(section, strata_in(data), valid)
            problems += [] if section is None else sides_that_differ(section.thinned(), valid)
            raise InputError(source, problems)
        try:
            fem, slide = settings.fem, settings.slide
            if "sides" not in fem.model_fields_set:
                fem = fem.changed(sides=usual_sides(section))
                if slide.mpm_sides is None and (sides := usual_sides_of_slides(section)) is not None:
                    slide = slide.changed(mpm_sides=sides)
            dem = settings.dem
            if dem.model == "soil" and not dem.model_fields_set & {"elements", "radius"}:
                dem = dem.changed(elements=usual_disc_count(section))
            used = {
                **dict(settings),
                "dem": dem,
                "fem": fem,
                "slide": slide,
                "mesh": settings.mesh.at_most(settings.fem.max_cells),
                "criteria": settings.criteria.resolved(
                    _peak(settings), undrained=any(stratum.friction_angle == 0.0 for stratum in section.strata)
                ),
            }
            config = cls(section=section, **used)
        except ValidationError as error:
            differing = sides_that_differ(section.thinned(), used)
            raise InputError(source, [*sentences(error, data, cls), *differing]) from None
        try:
            ground = config.tension_crack.cut(section.thinned().cut_at_water())
        except InputError as error:  # such as heads from which no water flows
            raise error.of_file(section.name, Path(source)) from None
        return config.analysed(ground, config.slide, (), ())

    @property
    def cases(self) -> tuple[Case, ...]:
        """Return the cases of the slide: the cases of [slide], then the cases that follow from borings, by their
        names."""
        return (*self.slide.cases, *self._derived_cases)

    @property
    def sides_of_slides(self) -> Sides:
        """Return the boundary condition of the sides in slides: the sides of the finite elements, unless
        `slide.mpm_sides` is given."""
        return self.slide.mpm_sides or self.fem.sides

    def called(self, *numbers: int) -> str:
        """Return the name of a case, or of several cases with one answer, for pictures: its number, and its name if it
        has one."""
        names = {n: self.cases[n - 1].name if 0 < n <= len(self.cases) else "" for n in numbers}
        if len(names) == 1:
            return ", ".join(f"case {number}, {name}" if name else f"case {number}" for number, name in names.items())
        return "cases " + ", ".join(f"{number} ({name})" if name else str(number) for number, name in names.items())

    @classmethod
    def tables(cls) -> list[str]:
        """Return the names of the tables of settings."""
        return list(Tables.model_fields)

    @classmethod
    def load(cls, path: Path | str, overrides: Mapping[str, Mapping[str, Any]] | None = None) -> Self:
        """Read the input in a TOML file; settings of the command line replace those of the file.

        Relative paths of files refer to the folder of the TOML file; those of the command line to the working folder.
        Raises InputError with every problem found.
        """
        data = read_toml(path)
        _find_files(data, Path(path).parent)
        for table, values in (overrides or {}).items():
            set_values = {key: value for key, value in values.items() if value is not None}
            _find_files({table: set_values}, Path())
            if set_values and isinstance(data.get(table, {}), dict):
                replaced = {other for key in set_values for other in REPLACES.get((table, key), ())} - set_values.keys()
                unchanged = {key: value for key, value in data.get(table, {}).items() if key not in replaced}
                data[table] = merged(unchanged, set_values)
        missing = missing_files(data)
        try:
            read = cls.parse(data, str(path))
        except InputError as error:
            unreadable = unreadable_records(valid_tables(data))
            raise InputError(error.source, [*error.problems, *missing, *unreadable]) from None
        if missing:
            others = unreadable_records(dict(read)) + sides_that_differ(read.section, dict(read))
            raise InputError(str(path), [*missing, *others])
        return read

    def files(self, *tables: str) -> dict[str, Path]:
        """Return the files that the settings, or some tables of settings, name, by table and key."""
        wanted = tables or self.tables()
        return {f"{table}, {key}": path for (table, key), path in self.named_files().items() if table in wanted}

    def named_files(self) -> dict[tuple[str, str], Path]:
        """Return all files that the settings name, by table and key."""
        named = {(table, key): getattr(getattr(self, table), key) for table, key in FILES}
        return {place: Path(name) for place, name in named.items() if name not in ("", AVERAGE)}


def _peak(settings: Tables) -> float | None:
    """Return the peak acceleration of the ground over gravity; None if the earthquake does not determine it."""
    try:
        motion = settings.earthquake.motion()
    except InputError:
        return None
    return None if motion is None else motion.median / GRAVITY


def _is_unknown_table(key: str, value: Any) -> bool:
    """Return whether an unknown key is not a key of a section but a table, or a list of tables, so that names of tables
    are offered, too."""
    several = isinstance(value, list) and bool(value) and all(isinstance(entry, Mapping) for entry in value)
    return (isinstance(value, Mapping) or several) and key not in Section.model_fields


def _find_files(data: Mapping[str, Any], folder: Path) -> None:
    """Make the paths of files in the settings absolute."""
    for table, key in FILES:
        values = data.get(table)
        if isinstance(values, dict) and isinstance(name := values.get(key), str) and name not in ("", AVERAGE):
            values[key] = str((folder / name).absolute())


def merged(lower: Mapping[str, Any], upper: Mapping[str, Any]) -> dict[str, Any]:
    """Return two nested tables merged into one. Values of the upper table replace values of the lower table with the
    same key."""
    tables = {**lower, **upper}
    for key in lower.keys() & upper.keys():
        if isinstance(lower[key], Mapping) and isinstance(upper[key], Mapping):
            tables[key] = merged(lower[key], upper[key])
    return tables
