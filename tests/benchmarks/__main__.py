"""All benchmarks, one after the other, into one file: `python -m tests.benchmarks [NAME ...] [--json FILE]`.

Whatever lies in this folder is a benchmark; names leave out the others. Each is a process of its own and prints as it
goes. The file has, for each, how it ended, its seconds, what it printed, and its own numbers where it writes any.
Benchmarks with a function `quoted` are quoted by README and documentation: what it returns goes to `docs/numbers.toml`.
"""

import argparse
import importlib
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from docs.numbers_file import keep_numbers
from tests.support import TOP

FOLDER = Path(__file__).parent


def names() -> list[str]:
    """Every benchmark there is."""
    return sorted(path.stem for path in FOLDER.glob("*.py") if not path.stem.startswith("_"))


def run(name: str) -> dict[str, Any]:
    """Runs one of them."""
    command = [sys.executable, "-m", f"tests.benchmarks.{name}"]
    begin, lines = time.perf_counter(), []
    with tempfile.TemporaryDirectory(prefix="noshiro-") as folder:
        numbers = Path(folder) / "numbers.json"
        if "--json" in (FOLDER / f"{name}.py").read_text():
            command += ["--json", str(numbers)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            for line in process.stdout or ():
                print(line, end="", flush=True)
                lines.append(line.rstrip())
        result = json.loads(numbers.read_text()) if numbers.exists() else None
    return {
        "benchmark": name, "exit": process.returncode, "seconds": round(time.perf_counter() - begin, 1),
        "numbers": result, "printed": lines,
    }  # fmt: skip


def quote(name: str, rows: Any) -> None:
    """Keeps the numbers of a benchmark that the documentation quotes."""
    quoted = getattr(importlib.import_module(f"tests.benchmarks.{name}"), "quoted", None)
    if quoted is not None:
        keep_numbers(TOP / "docs", name, f"python -m tests.benchmarks {name}", quoted(rows))


def main() -> int:
    """Runs them; 1 if one of them failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[[], *names()], metavar="NAME", help=", ".join(names()))
    parser.add_argument("--json", type=Path, default=Path("benchmarks.json"), help="where all numbers go")
    options = parser.parse_args()
    done: list[dict[str, Any]] = []
    for name in options.names or names():
        print(f"== {name}", flush=True)
        done.append(run(name))
        if done[-1]["numbers"] is not None:
            quote(name, done[-1]["numbers"])
        machine = {"machine": platform.machine(), "cores": os.cpu_count(), "python": platform.python_version()}
        options.json.write_text(json.dumps({"on": machine, "benchmarks": done}, indent=1) + "\n")
    failed = [row["benchmark"] for row in done if row["exit"]]
    print(f"{len(done)} benchmarks in {options.json}" + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
