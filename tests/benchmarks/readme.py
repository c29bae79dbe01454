"""Section and script of the README, as a newcomer runs them: `python -m tests.benchmarks.readme [--json FILE]`."""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.support import TOP
from tests.support.docs import blocks

Row = dict[str, Any]
DIGITS = {"kc": 3, "factor": 3}
STAGES = ("mesh", "fem", "bounds", "report")


def rows_of(folder: Path) -> list[Row]:
    """What the command and the script find."""
    text = (TOP / "README.md").read_text(encoding="utf-8")
    (section, wet), (script,) = blocks("toml", text), blocks("python", text)
    (folder / "my_slope.toml").write_text(section, encoding="utf-8")
    (folder / "wet.toml").write_text(section + wet, encoding="utf-8")
    only = [word for stage in STAGES for word in ("--only", stage)]
    environment = {**os.environ, "PYTHONPATH": str(TOP)}
    command = [sys.executable, "-m", "workflow.cli", "run", "my_slope.toml", "--quiet", *only]
    subprocess.run(command, cwd=folder, check=True, env=environment)
    summary = json.loads((folder / "runs/my_slope/summary.json").read_text(encoding="utf-8"))
    judge = [sys.executable, "-m", "workflow.cli", "liquefaction", "wet.toml", "--out", "wet", "--quiet"]
    subprocess.run(judge, cwd=folder, check=True, env=environment)
    strata = json.loads((folder / "wet/triggering.json").read_text(encoding="utf-8"))["strata"]
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=folder, check=True, env=environment, capture_output=True, text=True
    )
    return [
        {
            "kc": summary["fem"]["kc"],
            "factor": summary["fem"]["safety_factors"][0]["factor"],
            "lower": summary["bounds"]["lower"],
            "upper": summary["bounds"]["upper"],
            "factor_of_liquefaction": min(
                item["lowest_factor"] for item in strata if item["lowest_factor"] is not None
            ),
            "script": re.findall(r"\d\.\d+", done.stdout),
        }
    ]


def quoted(rows: list[Row]) -> Row:
    """What the README shows, in its digits: rounded twice, 1.58849 would be 1.589."""
    return {name: value if name == "script" else round(value, DIGITS.get(name, 4)) for name, value in rows[0].items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        rows = rows_of(Path(folder))
    print(quoted(rows))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
