"""Reads the call of a command: section file, settings and options of the command line, and the folder for the
results."""

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from meshes.errors import InputError
from meshes.section.stratum import cases_of
from meshes.section.toml_file import read_toml
from workflow.cli.unread_settings import keys_of, unread
from workflow.config import Config, merged, renamed
from workflow.config.after_triggering import load_config
from workflow.config.contradictions import sides_that_differ
from workflow.earthquake.records_in_use import unreadable_records
from workflow.run.record import Record, stored_mesh_options
from workflow.run.stage import Job
from workflow.run.store import Store
from workflow.stages import declared
from workflow.stages.mesh import MESH_FILE

Tables = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Invocation:
    """Holds the config of a command, and the folder for the results.

    Attributes
    ----------
    config : the section with all settings
    store : the folder of the run
    mesh_options : settings of the mesh by the command line of this command or of an earlier command
    mesh_options_stored : whether these options of the mesh are from an earlier command
    section : path of the section file
    tables : settings and options of the command line
    """

    config: Config
    store: Store
    mesh_options: dict[str, Any]
    mesh_options_stored: bool
    section: Path
    tables: Tables

    @classmethod
    def of(
        cls, section: Path, folder: Path | None, options: Tables, settings: list[str] | None, afresh: bool = False
    ) -> "Invocation":
        """Read the section file, and replace its settings by settings and options of the command line. If the command
        line has no options of the mesh, the options stored in the folder are used, unless ``afresh``. Raises InputError
        with every problem.
        """
        options_given = {
            table: {key: value for key, value in values.items() if value is not None}
            for table, values in options.items()
        }
        tables = merged(dotted(settings or []), options_given)
        read = _config(section, tables)
        store = Store(folder or Path("runs") / read.section.name)
        if store.folder.exists() and not store.folder.is_dir():
            raise InputError(str(store.folder), ["is a file; expected a folder for the results"])
        mesh = dict(tables.get("mesh", {}))
        stored = {} if mesh or afresh else stored_mesh_options(store)
        if stored:
            read = _with_mesh_options(section, tables, stored, store)
        problems = sides_that_differ(read.section, dict(read)) + unreadable_records(dict(read))
        if problems:
            raise InputError(str(section), problems)
        if read.slide.accelerogram:
            from workflow.stages.shaking import shaking_of

            shaking_of(read, ())
        return cls(read, store, mesh or stored, bool(stored), section, tables)

    def refuse_without_subject(self, stage: str) -> None:
        """Raise InputError if the section has nothing that a stage computes: no structures, no liquefying
        strata, or no post-peak strength."""
        from workflow.estimates.structures import structures_of
        from workflow.stages.liquefaction import refuse_unless_liquefying

        if stage == "liquefied":
            refuse_unless_liquefying(self.config.section)
        if stage == "residual" and not any(stratum.softens for stratum in self.config.section.strata):
            wanted = "expected residual_cohesion and residual_friction_angle in at least one stratum"
            raise InputError(str(self.section), [f"no stratum has a post-peak strength; {wanted}"])
        if stage == "faces" and not structures_of(self.config.section):
            raise InputError(
                str(self.section), ["structures: missing; expected one table [[structures]] for each structure"]
            )

    def refuse_unknown(self, cases: Sequence[int]) -> None:
        """Raise InputError for numbers of cases without a liquefying stratum, or if no case has one."""
        if not self.config.section.liquefies:
            wanted = 'expected a stratum with liquefies_in = [1], or with liquefies_in = "triggered" and borings'
            raise InputError(str(self.section), [f"strata: no layer liquefies, so no slide can be computed; {wanted}"])
        possible = cases_of(self.config.section.strata)
        if unknown := sorted(set(cases) - set(possible)):
            message = f"expected cases in which a stratum liquefies, of {', '.join(map(str, possible))}"
            raise InputError("--case", [f"{', '.join(map(str, unknown))}: {message}"])

    def job(self, **more: Any) -> Job:
        """Return the job of all stages."""
        origin: dict[str, Any] = {"mesh_options": self.mesh_options, "section_file": self.section}
        return Job(self.config, self.store, declared.STAGES, **origin, **more)

    def with_safety_factors(self) -> "Invocation":
        """Return the invocation with factors of safety and their bounds, at Kh = 0 and at every Kh whose fields are
        stored."""
        factors_at = tuple(sorted({0.0, *self.config.fem.kh, *self.config.fem.safety_factor_at}))
        others = {key: value for key, value in self.tables.get("bounds", {}).items() if key != "run"}  # this reads it
        config = self.config.with_settings("fem", safety_factor_at=factors_at).with_settings(
            "bounds", safety_factor=True
        )
        return replace(self, config=config, tables={**self.tables, "bounds": others})

    def unread(self, chosen: Sequence[str]) -> list[str]:
        """Return the settings of the command line that none of the ``chosen`` stages reads."""

        def without(name: str) -> Job:
            rest = {
                table: {key: value for key, value in values.items() if f"{table}.{key}" != name}
                for table, values in self.tables.items()
            }
            return replace(self, config=load_config(self.section, rest)).job()

        return unread(keys_of(self.tables), self.job(), chosen, without)

    @property
    def notices(self) -> list[str]:
        """Return notices: old names of settings with the new ones, and options stored from an earlier command."""
        old_words = renamed.notices(merged(read_toml(self.section), self.tables))
        if not self.mesh_options_stored:
            return old_words
        message = ", ".join(f"{key} = {value}" for key, value in self.mesh_options.items())
        return [
            *old_words,
            f"The mesh has the options of an earlier command: {message} (noshiro mesh without options removes them).",
        ]


def _config(section: Path, tables: Tables) -> Config:
    """Return the config of a section file with settings of the command line. Problems of these settings alone have the
    command line as their source, since the file is valid without them."""
    try:
        return load_config(section, tables)
    except InputError as error:
        if not tables:
            raise
        try:
            load_config(section)
        except InputError:
            raise error from None
        raise InputError("settings of the command line", error.problems) from None


def stored_job(folder: Path) -> Job:
    """Return the job of the run in a folder; raise InputError if the folder contains no run."""
    path = folder / "section.toml"
    if not path.is_file():
        expected = "expected a folder that noshiro wrote, such as runs/my_slope"
        lacking = "is a file" if folder.is_file() else "holds no run: there is no section.toml"
        raise InputError(str(folder), [f"{lacking}; {expected}"])
    store = Store(folder)
    left = Record(store)["mesh"]
    has_own_mesh = left is not None and MESH_FILE in left.inputs
    mesh_file = folder / "mesh/section.msh" if has_own_mesh else None
    return Job(load_config(path), store, declared.STAGES, mesh_file=mesh_file)


def left_out_of_report(job: Job) -> list[str]:
    """Return a notice of stages whose stored results belong to other inputs, and so are not in a report of this job.

    Raises InputError if there are no others: an empty report would replace the one in the folder.
    """
    from workflow.results.results import Results

    results, record = Results.of(job), Record(job.store)
    stale = {name: reason for name, reason in results.missing.items() if record[name] is not None}
    if not stale:
        return []
    again = f"noshiro run {job.store.folder / 'section.toml'} --out {job.store.folder} computes them again"
    if not results.ends:
        first = next(iter(stale.values()))
        raise InputError(
            str(job.store.folder), [f"no result belongs to its section.toml and this program ({first}); {again}"]
        )
    return [f"Left out, since their inputs changed: {', '.join(stale)}; {again}."]


def _with_mesh_options(section: Path, tables: Tables, mesh: dict[str, Any], store: Store) -> Config:
    """Return the config with the mesh options of the folder. The message of an InputError names the folder."""
    try:
        return load_config(section, merged(tables, {"mesh": mesh}))
    except InputError as error:
        advice = "noshiro mesh without options removes them"
        message = f"{error.source}, with the mesh options stored in {store.folder} ({advice})"
        raise InputError(message, error.problems) from None


def mesh_options(
    refine: int | None, size: str | None, free: bool, columns: int | None = None, rows: int | None = None
) -> dict[str, Any]:
    """Return the options of `mesh` as settings; a plain number for the size is in metres.

    ``refine``, ``free``, ``columns``, ``rows``: options of the command line, None if not given.
    """
    try:
        wanted: str | float | None = size if size is None else float(size)
    except ValueError:
        wanted = size
    method = "free" if free else None
    return {"refine": refine, "size": wanted, "method": method, "columns": columns, "rows": rows}


def dotted(texts: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return settings of the command line, such as ``fem.sides=fixed``, as tables.

    A value is read as TOML; other values are text. Raises InputError with every setting that cannot be read.
    """
    tables: dict[str, Any] = {}
    problems = []
    for text in texts:
        setting = _setting(text)
        if setting is None:
            problems.append(f"{text!r}: expected table.key=value, such as fem.sides=fixed or mesh.size='2 m'")
        elif next(iter(setting)) not in Config.tables():
            problems.append(f"{text!r}: expected a setting of {', '.join(Config.tables())}")
        else:
            tables = merged(tables, setting)
    if problems:
        raise InputError("--set", problems)
    return tables


def _setting(text: str) -> dict[str, Any] | None:
    key, equals, value = text.partition("=")
    if not equals or "\n" in text:
        return None
    for written in (value, json.dumps(value, ensure_ascii=False)):
        try:
            setting = tomllib.loads(f"{key} = {written}")
        except tomllib.TOMLDecodeError:
            continue
        table, inside = next(iter(setting.items()))
        return setting if isinstance(inside, dict) or table not in Config.tables() else None
    return None
