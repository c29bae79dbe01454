"""Moss Landing after liquefaction: `python -m tests.benchmarks.moss_landing [--json FILE]`."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from meshes.shipped import file_of

Row = dict[str, Any]
SAND = "Loose sand, below water"


def answer(command: str, file: str) -> Row:
    """What a command writes of the shipped section."""
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        words = [command, str(file_of("moss_landing")), "--quiet", "--out", folder]
        subprocess.run([sys.executable, "-m", "workflow.cli", *words], check=True)
        data: Row = json.loads((Path(folder) / file).read_text(encoding="utf-8"))
    return data


def quoted(rows: list[Row]) -> Row:
    """The numbers of the page, in its digits."""
    digits = {"strengths_kPa": 1, "just_stands_kPa": 1}
    return {key: [round(value, digits.get(key, 2)) for value in values] for key, values in rows[0].items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    result = answer("liquefaction", "triggering.json")["tests"]
    tests = [item for item in result if item["stratum"] == SAND and item["factor"] is not None]
    after = answer("liquefied", "fem/liquefied.json")
    factors = [test["factor"] for test in tests]
    row = {
        "depths_m": [entry["depth_m"] for entry in tests],
        "F_L": [min(factors), max(factors)],
        "strengths_kPa": [
            s["cohesion_kPa"] for element in after["cases"] for s in element["strata"] if s["name"] == SAND
        ],
        "safety": [case_entry[end] for case_entry in after["cases"] for end in ("factor_lower", "factor_upper")],
    }
    print(row)
    if options.json:
        options.json.write_text(json.dumps([row], indent=1) + "\n")


if __name__ == "__main__":
    main()
