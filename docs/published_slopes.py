"""Generates the page of published slopes, a table of all cases and of the omitted ones with reasons: python -m
docs.published_slopes."""

import io
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from statistics import median

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from docs.numbers_file import keep_numbers
from docs.verify.case import FOLDER, Case, Value, read_cases
from docs.verify.record import FILE, Answer, read_answers
from docs.verify.slopes import numbers
from docs.verify.verdict import TOLERANCE, TOLERANCE_ABOVE, TOLERANCE_BELOW, CaseVerdict, judge
from meshes.section.section import Section
from workflow.figures.canvas import INK
from workflow.figures.colours import soil_colours
from workflow.run.store import Store

PAGE, PICTURES, LEFT_OUT = "README.md", "pictures", "left_out.md"

# Small enough that a hundred and fifty of them weigh less than half a megabyte.
WIDTH, DPI, COLOURS = 220, 72, 16
TALLEST, FLATTEST = 0.6, 0.22

HEAD = """# Published slopes

Slopes with numbers published by others, compared with the results of this program: strict bounds by limit analysis
(ψ = φ), finite elements with ψ = φ, which is the answer of `noshiro fem`, and Davis's estimate. Davis's estimate is for
ψ = 0 unless a file gives ψ, and is no bound. Every case is a section as users write it, with a table `[published]`.
Made by `make verify`; `python -m docs.verify acads` runs the cases whose names begin with "acads".

A published number may be wrong: where the bounds exclude it, the remarks say so. A case is **right** if its finite
elements agree with its bounds (at most {below:g} % below, {above:g} % above), and if the median of each kind of
published value differs from both results by at most: {tolerances}. A case is **explained** if it does not agree for a
reason that its file gives.

Davis's estimate is in form B. For one soil without dilation and with little cohesion its factor of safety is
√(F² - tan² φ), with the factor of safety F for ψ = φ (Tschuchnigg, Schweiger & Sloan 2015). If this factor is below 1,
the search increases the strength, and with it the friction angle, which Davis's factor then reduces more. For large
friction angles the estimate is therefore far below F, such as 0.57 instead of 1.01 for spencer_1969 with φ = 40°. Such
a slope fails with Davis's strength; its factor says by how much the strength would have to be larger. Form A gives
about F cos φ, which is 0.76 for this slope.
"""


def write_page(folder: Path, cases: Sequence[Case], answers: Mapping[str, Answer]) -> Path:
    """Write the page and its pictures into a folder of cases; return the path of the page."""
    pictures = folder / PICTURES
    pictures.mkdir(exist_ok=True)
    for case in cases:
        draw(case.section, pictures / f"{case.name}.png")
    return Store(folder).write_text(PAGE, text(folder, cases, answers))


def text(folder: Path, cases: Sequence[Case], answers: Mapping[str, Answer]) -> str:
    """Return the text of the page."""
    verdicts = {case.name: judge(case, answers.get(case.name)) for case in cases}
    parts = [_page_head(), _summary(verdicts, answers), "## Cases", _table(cases, answers, verdicts)]
    remarks = {
        case.name: [*verdicts[case.name].remarks, *([case.published.note] if case.published.note else [])]
        for case in cases
    }
    return with_remarks(parts, remarks, folder)


def with_remarks(parts: Sequence[str], remarks: Mapping[str, Sequence[str]], folder: Path) -> str:
    """Return a page of these parts, followed by the remarks on each case and the list of omitted cases of the
    folder."""
    lines = [
        f"- **{name}**: " + " ".join(f"{remark.rstrip('.')}." for remark in texts)
        for name, texts in remarks.items()
        if texts
    ]
    left_out = folder / LEFT_OUT
    last = ["## Left out", left_out.read_text(encoding="utf-8").strip()] if left_out.exists() else []
    return "\n\n".join([*parts, "## Remarks", "\n".join(lines), *last]) + "\n"


def _page_head() -> str:
    tolerances = ", ".join(f"{kind} {100 * share:g} %" for kind, share in TOLERANCE.items())
    return HEAD.format(below=100 * TOLERANCE_BELOW, above=100 * TOLERANCE_ABOVE, tolerances=tolerances).strip()


def _summary(verdicts: Mapping[str, CaseVerdict], answers: Mapping[str, Answer]) -> str:
    counted = Counter(verdict.word for verdict in verdicts.values())
    bounded = sum(answer.lower is not None and answer.upper is not None for answer in answers.values())
    meshed = sum(answer.associated is not None for answer in answers.values())
    words = ", ".join(f"{count} {word}" for word, count in counted.most_common())
    counts = f"{words}. Bounds were found for {bounded}, elements were run on {meshed}."
    return " ".join(text for text in (counts, _speed(answers.values()), _versions(answers.values())) if text)


def _versions(answers: Collection[Answer]) -> str:
    """Return a sentence on the version of the program that computed the numbers; empty if it is unknown."""
    versions = Counter(answer.commit or "an unknown one" for answer in answers)
    if set(versions) <= {"an unknown one"}:
        return ""
    if len(versions) == 1:
        return f"All numbers are of one version of the program, commit {next(iter(versions))}."
    versions_named = ", ".join(f"{name} ({count})" for name, count in versions.most_common())
    return f"The numbers are of several versions of the program, by their commits: {versions_named}."


def _speed(answers: Collection[Answer]) -> str:
    """Return a sentence on the medians of the gap of the bounds and of the computing time; empty unless all cases have
    been run."""
    middle = medians(answers)
    if not middle:
        return ""
    return (
        f"At the median the bounds are {middle['gap_percent']:.1f} % apart after {middle['bounds_seconds']:.1f} s; the "
        f"elements take {middle['associated_seconds']:.1f} s with ψ = φ and {middle['davis_seconds']:.1f} s by Davis's "
        "estimate, all of one core."
    )


def medians(answers: Collection[Answer]) -> dict[str, float]:
    """Return the medians of the gap of the bounds (%) and of the processor time (s); empty unless all cases have been
    run."""
    pairs = [(answer.lower, answer.upper) for answer in answers]
    gaps = [2.0 * (high - low) / (high + low) for low, high in pairs if low is not None and high is not None]
    spent = [
        [value for value in values if value]
        for values in zip(*((a.bounds_seconds, a.associated_seconds, a.davis_seconds) for a in answers), strict=True)
    ]
    if not gaps or not all(spent):
        return {}
    names = ("bounds_seconds", "associated_seconds", "davis_seconds")
    times = {name: round(median(values), 1) for name, values in zip(names, spent, strict=True)}
    return {"gap_percent": round(100.0 * median(gaps), 1), **times}


def counts(cases: Sequence[Case], answers: Mapping[str, Answer]) -> dict[str, float | int | str]:
    """Return the numbers quoted in the documentation: how many cases are right, and their computing time."""
    words = Counter(judge(case, answers.get(case.name)).word for case in cases)
    judged = {word: words.get(word, 0) for word in ("right", "explained", "wrong")}
    return {"cases": len(cases), **judged, **medians(answers.values())}


def _table(cases: Sequence[Case], answers: Mapping[str, Answer], verdicts: Mapping[str, CaseVerdict]) -> str:
    rows = [
        "| | case | published | bounds | elements, ψ = φ | elements, Davis | seconds | |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for case in cases:
        answer = answers.get(case.name, Answer(case.name))
        elements = [f"{value:.3f}" if value is not None else "" for value in (answer.associated, answer.davis)]
        wanted = "kc" if case.published.expected == "kc" else "FS"
        wanted += f", Kh = {case.published.kh:g}" if case.published.kh else ""
        cells = [
            f"![]({PICTURES}/{case.name}.png)",
            f"[{case.name}]({case.name}.toml)<br>{case.section.title}<br>{wanted}",
            _published(case.published.values),
            numbers(answer),
            *elements,
            seconds(answer),
            verdicts[case.name].word,
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def seconds(answer: Answer) -> str:
    """Return the processor time (s) of the bounds and both results of the finite elements."""
    spent = (answer.bounds_seconds, answer.associated_seconds, answer.davis_seconds)
    return " + ".join("-" if part is None else f"{part:.0f}" for part in spent)


def _published(values: Sequence[Value]) -> str:
    return "<br>".join(f"{_number(value)} {value.author}, {value.method}" for value in values)


def _number(value: Value) -> str:
    low, high = value.ends
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def draw(section: Section, path: Path) -> None:
    """Write the picture as a PNG of few colours."""
    outline = section.outline()
    wide, high = np.ptp(outline, axis=0)
    shape = float(np.clip(high / wide, FLATTEST, TALLEST))
    figure = Figure(figsize=(WIDTH / DPI, shape * WIDTH / DPI), dpi=DPI)
    axes = figure.add_axes((0.01, 0.02, 0.98, 0.96))
    for k, colour in enumerate(soil_colours([stratum.name for stratum in section.strata])):
        for polygon in section.layering.polygons(k):
            axes.fill(*np.transpose(polygon), facecolor=colour, edgecolor=INK, linewidth=0.5)
    axes.set_aspect("equal")
    axes.axis("off")
    save_in_few_colours(figure, path)


def save_in_few_colours(figure: Figure, path: Path) -> None:
    """Write a figure as a small PNG."""
    drawn = io.BytesIO()
    FigureCanvasAgg(figure).print_png(drawn)
    Image.open(drawn).convert("RGB").quantize(COLOURS).save(path, optimize=True)


def main() -> None:
    """Write the page, and the numbers quoted in the documentation."""
    cases, answers = read_cases(FOLDER), read_answers(FOLDER / FILE, Answer)
    commits = [answer.commit for answer in answers.values()]
    command = "python -m docs.verify; python -m docs.published_slopes"
    keep_numbers(Path("docs"), "published", command, counts(cases, answers), commits)
    print(write_page(FOLDER, cases, answers))


if __name__ == "__main__":
    main()
