"""Provides a small section with a record, which runs in seconds."""

import json
from pathlib import Path
from typing import Any

import tomli_w

from tests.support.sections import slope

RECORD = "time (s), acceleration (g)\n" + "\n".join(
    f"{0.1 * i:.1f}, {value}" for i, value in enumerate([0, 0.6, 0.6, -0.7, -0.7, -0.7, 0.2, 0])
)


# Without the discs, which have tests of their own.
CONTINUUM = ("--only", "mesh", "--only", "fem", "--only", "report")
# Discs for seconds: a few, only roughly at rest, not calibrated, and pushed for a moment by a Kh that is held. Without
# one the cycles of an earthquake are assumed, which last 16 s.
FEW_DISCS = {"elements": 60, "parameter": "none", "kh": [0.2], "resolution": 0.1, "unbalanced": 1e-2}
SHORT_SLIDE = {
    "methods": ["discs"], "seeds": [], "kh": 0.1, "duration": 0.5, "frames": 2,
    "cases": [{"stiffness": k} for k in (0.1, 0.02, 0.01)],
}  # fmt: skip


def written(folder: Path, **more: Any) -> Path:
    """Write a small section with a record, coarse enough for a run of a second."""
    data = {
        **slope(),
        "title": "A <small> slope & more",
        "mesh": {"size": 3.0},
        "bounds": {"max_cells": 200, "gap": 0.3},
    }
    data |= {
        "fem": {"element": "bilinear", "kh": [0.2, 0.9], "accuracy": 0.0, "tolerance": 1e-4},
        "sliding_block": {"accelerogram": "quake.csv"},
        "variants": {"which": ["step"]},
        "dem": FEW_DISCS,
        "slide": SHORT_SLIDE,
        **more,
    }
    data["strata"][0]["liquefies_in"] = [number + 1 for number in range(len(data["slide"]["cases"]))]
    (folder / "quake.csv").write_text(RECORD)
    path = folder / "slope.toml"
    path.write_text(tomli_w.dumps(data))
    return path


def numbers(folder: Path) -> dict[str, Any]:
    """Return the summary without the values that differ from run to run."""
    data: dict[str, Any] = json.loads((folder / "summary.json").read_text())
    return {key: value for key, value in data.items() if key not in ("seconds", "made_with")}
