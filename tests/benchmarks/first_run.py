"""How long a newcomer waits: `python -m tests.benchmarks.first_run [--json FILE]`.

A new clone of this checkout, with an empty home folder, does what the README says: `make run`, then `noshiro run` on
the section of the README, without any settings. Packages come from PyPI; those of Debian are there already.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.support import TOP
from tests.support.docs import blocks

STEP = 300.0  # s: times are rounded up to a multiple
SLOWER = 2.0  # times as long as here a run may take elsewhere, since machines differ so much
UNSET = {"PYTHONPATH", "NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "VIRTUAL_ENV", "PYTHONDONTWRITEBYTECODE"}

Row = dict[str, Any]


def timed(command: list[str], folder: Path, home: Path) -> tuple[float, float]:
    """Seconds to the first picture and to the end of a command in a folder."""
    environment = {name: value for name, value in os.environ.items() if name not in UNSET} | {"HOME": str(home)}
    begin, first = time.perf_counter(), math.nan
    with subprocess.Popen(command, cwd=folder, env=environment) as process:
        while process.poll() is None:
            if math.isnan(first) and any(folder.glob("runs/*/figures/*.png")):
                first = time.perf_counter() - begin
            time.sleep(0.2)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return first, time.perf_counter() - begin


def measured() -> Row:
    """The seconds of both runs."""
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        clone, home = Path(folder) / "noshiro", Path(folder) / "home"
        home.mkdir()
        subprocess.run(["git", "clone", "--quiet", str(TOP), str(clone)], check=True)
        first, whole = timed(["make", "run"], clone, home)
        section, _ = blocks("toml", (TOP / "README.md").read_text(encoding="utf-8"))
        (clone / "my_slope.toml").write_text(section, encoding="utf-8")
        _, section_run = timed([".venv/bin/noshiro", "run", "my_slope.toml"], clone, home)
    return {
        "cores": os.cpu_count(), "load": round(os.getloadavg()[2], 1), "first_picture_seconds": first,
        "seconds": whole, "section_seconds": section_run,
    }  # fmt: skip


def quoted(rows: list[Row]) -> Row:
    """What README and tutorial show: minutes on slower machines, rounded up."""
    row = {name: round(value, 1) for name, value in rows[0].items()}
    minutes = int(STEP / 60.0 * math.ceil(SLOWER * rows[0]["seconds"] / STEP))
    return {**row, "minutes": minutes, "section_minutes": math.ceil(SLOWER * rows[0]["section_seconds"] / 60.0)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    options = parser.parse_args()
    rows = [measured()]
    print(quoted(rows))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
