"""Computes fingerprints of the inputs of a stage: its result is valid while none of them changes."""

import hashlib
import json
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from workflow.config import Config
from workflow.run.stage import Job, Stage

PROGRAM = "the program"
# Of a section: what the report says, and nothing is computed from but the circles of structures.
NAMES = {"name", "title", "structures"}
PACKAGES = ("meshes", "fem", "dem", "workflow")
SOURCES = (".py", ".csv", ".jinja", ".js")  # the files that results are made by; sections are the user's


def inputs(stage: Stage, job: Job, ignored: frozenset[str] = frozenset()) -> dict[str, str]:
    """Return the fingerprints of all inputs of a stage.

    Parameters
    ----------
    stage : the stage
    job : section, settings, and all stages of the run, among them those that the stage needs
    ignored : settings "table.key", or names of `Stage.takes`, without effect on the results of the stage, in addition
        to `Stage.ignores`

    Returns
    -------
    Fingerprints by names for messages: "section" (without its title and structures, which only a stage of all reads),
    "the program", each "[table]" or "table.key", each name of `Stage.takes` and `Stage.files`, and each stage that is
    needed, with all of its inputs.
    """
    ignored = ignored.union(stage.ignores(job.config))
    prints = {"section": fingerprint_of(job.config.section.model_dump(mode="json", exclude=NAMES)), PROGRAM: program()}
    for name in stage.reads:
        if name not in ignored:
            prints[name if "." in name else f"[{name}]"] = fingerprint_of(_settings(name, job.config, ignored))
    if stage.of_all:
        names = job.config.section.model_dump(mode="json", include=NAMES)
        structures = names.pop("structures")
        prints |= {"title": fingerprint_of(names), "structures": fingerprint_of(structures)}
    taken = stage.takes(job.config)
    prints |= {name: fingerprint_of(value) for name, value in taken.items() if name not in ignored}
    for name, path in stage.files(job).items():
        prints[name] = fingerprint_of_file(path)
    for other in job.stages:
        if other.name in stage.needs:
            prints[other.name] = fingerprint_of(inputs(other, job, ignored))
    return prints


def title(config: Config) -> str:
    """Return a fingerprint of the title and the language of pictures."""
    heading, language = config.section.heading, config.report.language
    return fingerprint_of(heading if language == "en" else [heading, language])


@cache
def program() -> str:
    """Return the fingerprint of all sources of the program: after any change of them no result is valid.

    Returns
    -------
    SHA-256 of names and bytes of the files of the four packages that end in `SOURCES`, in 64 hexadecimal digits. It is
    computed once in a process.
    """
    total = hashlib.sha256()
    for package in PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        assert spec.origin is not None
        folder = Path(spec.origin).parent
        for path in sorted(path for path in folder.rglob("*") if path.suffix in SOURCES):
            total.update(f"{package}/{path.relative_to(folder).as_posix()}\n".encode() + path.read_bytes())
    return total.hexdigest()


def _settings(name: str, config: Config, ignored: frozenset[str]) -> dict[str, Any]:
    """Return the settings of a "table", or one "table.key", without those that are ignored."""
    table, _, key = name.partition(".")
    data: dict[str, Any] = getattr(config, table).model_dump(mode="json", include={key} if key else None)
    return {key: value for key, value in data.items() if f"{table}.{key}" not in ignored}


def fingerprint_of(data: Any) -> str:
    """Return a fingerprint of anything that JSON can hold.

    Parameters
    ----------
    data : data whose order of keys does not matter

    Returns
    -------
    SHA-256 of the JSON text, in 64 hexadecimal digits.
    """
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def fingerprint_of_file(path: Path) -> str:
    """Return a fingerprint of the content of a file.

    Parameters
    ----------
    path : an existing file

    Returns
    -------
    SHA-256 of its bytes, in 64 hexadecimal digits.
    """
    return hashlib.sha256(path.read_bytes()).hexdigest()
