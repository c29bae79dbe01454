"""Finds settings that contradict the section or settings of other tables, and files that are missing.

If a part of the input is invalid, the checks of all other parts are made nevertheless, so that a user sees all faults
of a file at once.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError

from dem.settings import AVERAGE
from fem.continuum.repetition import refuse_other_sides
from meshes.errors import InputError
from meshes.section.cutting import key_in_file
from meshes.section.section import Section
from workflow.config.tables import Tables
from workflow.earthquake.triggering.assessment import off_the_section
from workflow.earthquake.triggering.settings import implausible_triggering

# Settings that name a file, by table and key.
FILES = (
    ("sliding_block", "accelerogram"), ("slide", "accelerogram"), ("site_response", "record"), ("earthquake", "record"),
    ("report", "logo"),
)  # fmt: skip

ValidTables = Mapping[str, Any]  # the valid tables of settings, by name


def valid_tables(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of settings in the ``data`` of a file that are valid by themselves, by name."""
    tables: dict[str, Any] = {}
    for name, field in Tables.model_fields.items():
        kind = field.annotation
        assert isinstance(kind, type)
        assert issubclass(kind, BaseModel)
        try:
            tables[name] = kind.model_validate(data.get(name, {}))
        except ValidationError:
            continue
    return tables


class StratumInFile(NamedTuple):
    """Holds a stratum of a file: its key for messages, its name, and the numbers of the cases in which it liquefies."""

    key: str
    name: str
    cases: tuple[int, ...]


def contradictions(section: Section | None, strata: Sequence[StratumInFile], tables: ValidTables) -> list[str]:
    """Return settings that contradict the section or other tables, one sentence each.

    Parameters
    ----------
    section : the section; None if it is invalid, so that only tables and strata are compared
    strata : the strata of the file, see `strata_of` and `strata_in`
    tables : the valid tables of settings; checks that need another table are left out
    """
    return [*_with_section(section, tables), *_among_tables(tables), *_with_strata(strata, tables)]


def strata_of(section: Section) -> list[StratumInFile]:
    """Return the strata of a section as written in a file."""
    strata = section.strata
    cases = [() if stratum.liquefies_in.triggered else tuple(stratum.liquefies_in) for stratum in strata]
    return [StratumInFile(key_in_file(strata, k), strata[k].name, cases[k]) for k in range(len(strata))]


def strata_in(data: Mapping[str, Any]) -> list[StratumInFile]:
    """Return the strata in the ``data`` of a file, as far as they have names."""
    tables, strata = data.get("strata"), []
    for place, table in enumerate(tables if isinstance(tables, list) else [], start=1):
        if isinstance(table, Mapping):
            name, numbers = str(table.get("name", "")), table.get("liquefies_in")
            cases = tuple(n for n in numbers if isinstance(n, int)) if isinstance(numbers, list) else ()
            strata.append(StratumInFile(f'strata {place} "{name}"', name, cases))
    return strata


def _with_section(section: Section | None, tables: ValidTables) -> Iterator[str]:
    """Yield settings that do not fit the section."""
    if section is None:
        return
    for name in ("mesh", "dem"):
        if name in tables:
            yield from tables[name].problems(section)
    if "free_face" in tables:
        yield from tables["free_face"].problems(section.ground)
    if "triggering" in tables:
        yield from off_the_section(section, tables["triggering"])
    if {"earthquake", "triggering"} <= tables.keys():
        yield from implausible_triggering(section, tables["earthquake"], tables["triggering"])


def sides_that_differ(section: Section, tables: ValidTables) -> list[str]:
    """Return the reason why the sides of a section cannot be periodic, if the finite elements require it.

    Parameters
    ----------
    section : the ground
    tables : the valid tables of settings, by name

    Returns
    -------
    One sentence for every difference of the sides; empty if the sides are alike or not periodic.
    """
    if "fem" not in tables or tables["fem"].sides != "periodic":
        return []
    try:
        refuse_other_sides(section)
    except InputError as error:
        return list(error.problems)
    return []


def _among_tables(tables: ValidTables) -> Iterator[str]:
    """Yield settings of a table that contradict each other, or settings of another table."""
    if "earthquake" in tables:
        yield from tables["earthquake"].problems()
    if {"slide", "site_response"} <= tables.keys():
        response = tables["site_response"]
        if tables["slide"].accelerogram == AVERAGE and not (response.record and response.slip_depth):
            yield f'slide, accelerogram = "{AVERAGE}": expected record and slip_depth in [site_response]'
    # Where other tables are invalid, the criteria are not yet resolved with the peak of the earthquake.
    if {"criteria", "earthquake"} <= tables.keys() and tables["criteria"].lacks_peak:
        if tables["earthquake"].gives_peak:
            return
        yield (
            f'criteria, preset = "{tables["criteria"].preset}": expected peak_acceleration, or magnitude and distance, '
            "in [earthquake]"
        )


def _with_strata(strata: Sequence[StratumInFile], tables: ValidTables) -> Iterator[str]:
    """Yield settings that name an unknown stratum, and strata that liquefy in an unknown case."""
    names = [stratum.name for stratum in strata]
    if "mesh" in tables:
        yield from tables["mesh"].unknown_names(names)
    if "slide" in tables:
        yield from tables["slide"].problems(names)
    if not {"slide", "triggering"} <= tables.keys():
        return
    count = len(tables["slide"].cases) + len(tables["triggering"].cases)
    if not count:
        yield "slide, cases = []: expected one at least, here or in [triggering]"
    for stratum in strata:
        if any(number > count for number in stratum.cases):
            yield (
                f"{stratum.key}, liquefies_in = {list(stratum.cases)}: expected cases from 1 to {count}, those of "
                "[slide] and [triggering]"
            )


def missing_files(data: Mapping[str, Any]) -> list[str]:
    """Return a sentence on every file that the settings name and that does not exist; paths in the ``data`` are
    absolute."""
    problems = []
    for table, key in FILES:
        values = data.get(table)
        name = values.get(key) if isinstance(values, Mapping) else None
        if isinstance(name, str) and name not in ("", AVERAGE) and not Path(name).is_file():
            problems.append(f"{table}, {key} = {name}: there is no such file")
    return problems
