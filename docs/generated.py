"""Generates the pages that follow from the program: from its models, commands, docstrings and numbers."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import typer

from docs.section_keys import markdown as keys
from meshes.exports import homes
from workflow.cli import app

__all__ = ["closed_forms", "commands", "dates", "keys", "numbers", "python_interface", "s13", "speed"]

HERE = Path(__file__).resolve().parent
TOP = HERE.parent


def numbers() -> dict[str, dict[str, Any]]:
    """Return the numbers that README and pages quote, by table."""
    return tomllib.loads((HERE / "numbers.toml").read_text(encoding="utf-8"))


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(cell, line)) + " |" for line in lines)


def cell(value: object) -> str:
    """Return the text of a table cell, with the special characters of Markdown and HTML escaped."""
    return str(value).replace("|", "\\|").replace("<", "&lt;").replace("\n", " ")


def commands() -> str:
    """Return the page of all commands with their arguments and options."""
    group = typer.main.get_command(app)
    parts = [
        "# Commands",
        "Generated from the program. `noshiro COMMAND --help` prints the same.",
        "Exit codes: 0 done, 1 a fault of the program, 2 the input or the folder cannot be used, 3 a stage ended "
        "without an answer (the report says why and what to try), 130 stopped by Ctrl-C. The same command continues "
        "a stopped run.",
    ]
    panels = {
        entry.name or getattr(entry.callback, "__name__", ""): entry.rich_help_panel
        for entry in app.registered_commands
    }
    panel = None
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        if panels[name] != panel:
            parts.append(f"## {(panel := panels[name])}")
        rows = [
            (
                ", ".join(f"`{word}`" for word in (*parameter.opts, *parameter.secondary_opts)),
                getattr(parameter, "help", "") or "",
            )
            for parameter in command.params
            if parameter.name != "help"
        ]
        what = " ".join((command.help or "").split())
        parts += [f"### noshiro {name}", what, table(("argument or option", "what"), rows) if rows else ""]
    return "\n\n".join(part for part in parts if part) + "\n"


def python_interface() -> str:
    """Return the page of the public interface of the packages, from the docstrings."""
    parts = [
        "# Python interface",
        "What `meshes`, `fem` and `dem` offer at their top. Lengths in m, stresses in Pa, angles in radians unless a "
        "unit is written. Scripts that use them: [examples](../examples/README.md).",
    ]
    for package in ("meshes", "fem", "dem"):
        parts += [f"## {package}"]
        parts += [
            f"::: {module}.{name}\n    options:\n      heading_level: 3"
            for name, module in sorted(homes(str(TOP / package / "__init__.py")).items())
        ]
    return "\n\n".join(parts) + "\n"


def made(name: str) -> str:
    """Return a sentence on the date of a table of numbers and the command that computes it."""
    values = numbers()[name]
    by = f" by commit {values['commit']}" if values["commit"] else ""
    return f"Generated {values['date']}{by}. Again: `{values['command']}`."


def dates(text: str) -> str:
    """Return a line on each table of numbers that a page names at its end, with date and command; empty without any."""
    mark = re.search(r"<!-- numbers:(.*?)-->", text, flags=re.DOTALL)
    names = re.findall(r"([\w./#-]+) \(", mark[1]) if mark else []
    return "".join(f"\n- {made(name)}" for name in dict.fromkeys(names) if name in numbers())


def closed_forms() -> str:
    """Return the page that compares strict bounds and finite elements with closed forms and published brackets."""
    rows = [
        (
            row["problem"], row["answer"], row["source"], f"{row['lower']:g} to {row['upper']:g}",
            ", ".join(f"{row[key]:g}" for key in ("elements_4", "elements_8") if key in row),
        )
        for row in numbers()["closed_forms"]["rows"]
    ]  # fmt: skip
    head = ("problem", "answer", "source", "strict bounds", "reduced elements, 4 and 8 cells below half of the footing")
    words = "Every problem is also a test in `tests/verification`. Strict bounds must contain the answer."
    return "\n\n".join(["# Closed forms", made("closed_forms"), words, table(head, rows)]) + "\n"


def s13() -> str:
    """Return the page that compares S-13 with the paper."""
    values: Mapping[str, Any] = numbers()["s13"]
    slides = dict.fromkeys((values["slide_least_m"], values["slide_most_m"]))
    lines = [
        ("critical Kh, finite elements (free-field sides, Davis reduced strength, as its file asks)", values["kc"]),
        ("critical Kh for ψ = φ", values["kc_associated"]),
        ("strict bounds for ψ = φ", f"{values['lower']} to {values['upper']}"),
        (
            "critical Kh of finite elements with fixed sides and the given ψ, which the discs are compared with",
            f"{values['kc_box']} to {values['kc_box_upper']}",
        ),
        ("critical Kh of soil discs, uncalibrated, by packing", ", ".join(map(str, values["kc_discs_of_packings"]))),
        ("critical Kh of the paper's discs", values["kc_paper_discs"]),
        ("largest slide of discs, cases 1 to 3, mean of the packings (m)", " to ".join(map(str, slides))),
        ("largest slide of material points (m)", values["slide_points_m"]),
    ]
    agrees = {True: "yes", False: "no", "": "-"}
    rows = [(entry["quantity"], entry["paper"], entry["ours"], agrees[entry["agrees"]]) for entry in values["paper"]]
    parts = ["# S-13", made("s13"), table(("quantity", "here"), lines), "## Beside the paper"]
    parts += ["What the paper says: [the paper](../theory/paper.md)."]
    parts += [table(("quantity", "paper", "here", "agrees"), rows)]
    return "\n\n".join(parts) + "\n"


def speed() -> str:
    """Return the page of computing times: compared with LAMMPS for equal problems, and of `noshiro fem` on twenty
    sections."""
    values = numbers()
    slopes, discs, sections = values["published"], values["dem_throughput"], values["sections"]
    rows: list[Sequence[object]] = [
        ("published slopes: strict bounds, median", f"{slopes['bounds_seconds']} s"),
        ("published slopes: finite elements with ψ = φ, median", f"{slopes['associated_seconds']} s"),
        (f"`noshiro fem` with pictures, median of {len(sections['rows'])} sections", f"{sections['median_seconds']} s"),
        ("the slowest of these", f"{sections['slowest_seconds']} s"),
        (f"soil discs, {discs['elements']:g} of them, one core", f"{discs['soil_discs']} million disc-steps a second"),
    ]
    if "lammps" in discs:
        rows += [
            ("LAMMPS gran/hooke/history, same discs, same core", f"{discs['lammps']} million disc-steps a second"),
            ("discs with the same law as LAMMPS, over LAMMPS", f"{discs['times_lammps']} times"),
        ]
    dates = "\n".join(f"- {made(name)}" for name in ("published", "sections", "dem_throughput"))
    shown = (("kc", 3), ("factor", 2))
    each = [
        (row["section"], f"{row['seconds']:g} s", *(f"{row[key]:.{n}f}" if key in row else "none" for key, n in shown))
        for row in sections["rows"]
    ]
    answers = table(("section", "`noshiro fem`", "critical Kh", "factor of safety"), each)
    note = "A section that fails under its own weight has no critical Kh."
    words = "Seconds of processor time on one machine. All benchmarks: `python -m tests.benchmarks`."
    return "\n\n".join(["# Speed", words, table(("what", "speed"), rows), answers, note, dates]) + "\n"
