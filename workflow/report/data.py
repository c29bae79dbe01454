"""Converts answers to data: the output of commands with ``--json``."""

import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from meshes.section.section import Stratum
from meshes.section.seepage import Seepage
from workflow.config import Config
from workflow.results.stored_mesh import stored_mesh
from workflow.run.plan import Decision
from workflow.run.record import Record
from workflow.run.stage import Job


def as_json(data: Any, only_ascii: bool = False) -> str:
    """Format data as JSON text.

    Parameters
    ----------
    data : what JSON can hold; no NaN and no infinity
    only_ascii : whether characters beyond ASCII are escaped

    Returns
    -------
    The text.
    """
    return json.dumps(data, indent=1, ensure_ascii=only_ascii, allow_nan=False)


def of_section(config: Config, picture: Path) -> dict[str, Any]:
    """Return a checked section as data for JSON.

    Parameters
    ----------
    config : section and settings
    picture : file of the picture of the section

    Returns
    -------
    Name, title and SHA-256 of the section, its strata in SI units with their areas (m²), seepage (discharge in m²/s) or
    None, and notices.
    """
    strata = [
        {"name": stratum.name, "area_m2": float(area), **_parameters(stratum)}
        for stratum, area in zip(config.section.strata, config.section.layering.areas(), strict=True)
    ]
    return {
        "section": {"name": config.section.name, "title": config.section.title, "sha256": config.section.sha256()},
        "reconstruction": config.section.reconstruction_note if config.section.reconstruction else None,
        "strata": strata,
        "seepage": None if (flow := config.section.water_pressure.flow) is None else _seepage(flow),
        "notices": config.notices,
        "picture": str(picture),
    }


def _seepage(flow: Seepage) -> dict[str, Any]:
    """Return the flow of water as data."""
    gradient, x = flow.exit_gradient
    return {
        "discharge_m2_per_s": flow.discharge,
        "seepage_faces_m": flow.seepage_faces,
        "largest_upward_gradient": gradient,
        "largest_upward_gradient_x_m": x,
    }


def _parameters(stratum: Stratum) -> dict[str, Any]:
    """Return the parameters of a stratum without its position; quantities as plain SI numbers."""
    values = {key: value for key, value in stratum if key not in ("name", "bottom")}
    return {key: float(value) if isinstance(value, float) else value for key, value in values.items()}


def of_plan(decisions: Iterable[Decision]) -> list[dict[str, str]]:
    """Return the decision about every stage, with its reason.

    Parameters
    ----------
    decisions : decisions of the plan of a run

    Returns
    -------
    A dictionary a stage: its name, what would be done, and why.
    """
    return [
        {"stage": decision.stage.name, "would": decision.action, "because": decision.reason} for decision in decisions
    ]


def of_stages(job: Job, names: Iterable[str], warnings: Iterable[str] = ()) -> dict[str, Any]:
    """Return the outcome and answers of stages as data for JSON.

    Parameters
    ----------
    job : stages, config and folder
    names : names of the stages
    warnings : warnings of the command; those of the section follow

    Returns
    -------
    Folder, options of the mesh, warnings and stages: every answer file by its name, and the quality of the mesh.
    """
    record = Record(job.store)
    stages: dict[str, Any] = {}
    for stage in job.stages:
        entry = record[stage.name]
        if stage.name not in names or entry is None:
            continue
        ended = {"outcome": entry.outcome, "seconds": entry.seconds, "reason": entry.reason, "remedy": entry.remedy}
        files = {name: job.store.read_json(name) for name in entry.files if name.endswith(".json")}
        stages[stage.name] = {key: value for key, value in ended.items() if value != ""} | {"answers": files}
        if stage.name == "mesh" and entry.outcome == "done":
            mesh = stored_mesh(job.config.section, job.store)
            stages[stage.name]["mesh"] = {"method": mesh.method, **asdict(mesh.quality())}
    return {
        "folder": str(job.store.folder),
        "mesh_options": dict(job.mesh_options or {}),
        "warnings": [*warnings, *job.config.notices],
        "stages": stages,
    }
