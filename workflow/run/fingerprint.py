"""What a stage is made from, as fingerprints: when none of them has changed, neither has its result."""

import hashlib
import importlib.util
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from workflow.settings import Input
from workflow.stages import Job, Stage, stages

# A setting that says whether, not how.
WHETHER = {"run"}
SOURCES = (".py", ".csv", ".jinja", ".toml")


def inputs(stage: Stage, job: Job) -> dict[str, str]:
    """A fingerprint for all that matters to a stage, by names that people know."""
    prints = {"section": fingerprint_of(section_data(job.run)), "the program": code(stage.code)}
    for table in stage.tables:
        settings = getattr(job.run, table, None)
        if settings is not None:
            prints[f"[{table}]"] = fingerprint_of(settings.model_dump(mode="json", exclude=WHETHER))
    if stage.name == "mesh":
        prints["the mesh given"] = _of_file(job.mesh_file) if job.mesh_file else ""
    if "sliding_block" in stage.tables and job.run.sliding_block.accelerogram:
        prints["[sliding_block]"] = _of_record(job.run)
    for other in stages():
        if other.name in stage.needs:
            prints[other.name] = fingerprint_of(inputs(other, job))
    return prints


def section_data(run: Input) -> dict[str, Any]:
    """The section as it was written, without the settings."""
    return run.model_dump(mode="json", exclude=set(run.tables()))


def _of_record(run: Input) -> str:
    """Of the settings with a record: what the file holds counts, not where it lies."""
    settings = run.sliding_block.model_dump(mode="json", exclude={"accelerogram"})
    return fingerprint_of([settings, _of_file(Path(run.sliding_block.accelerogram))])


@cache
def code(names: tuple[str, ...]) -> str:
    """Of the text of some packages and modules."""
    total = hashlib.sha256()
    for name in names:
        for path in _files(name):
            total.update(f"{name}/{path.name}\n".encode() + path.read_bytes())
    return total.hexdigest()


def _files(name: str) -> Iterator[Path]:
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        return
    if spec.submodule_search_locations:
        yield from sorted(path for path in Path(spec.origin).parent.iterdir() if path.suffix in SOURCES)
    else:
        yield Path(spec.origin)


def fingerprint_of(data: Any) -> str:
    """A fingerprint of anything that JSON can hold."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def _of_file(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
