"""Generates the page of known slides, a table of all cases and of the omitted ones with reasons: python -m
docs.known_slides."""

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from docs.numbers_file import keep_numbers
from docs.published_slopes import DPI, PAGE, PICTURES, save_in_few_colours, with_remarks
from docs.verify.record import FILE, read_answers
from docs.verify.slides.case import FOLDER, Column, Ground, SlideCase, read_cases
from docs.verify.slides.command import number, predicted, sentence
from docs.verify.slides.record import SlideAnswer
from docs.verify.slides.verdict import CLOSE_FACTOR, FAR_FACTOR, SlideVerdict, bias, judge, judge_points, right
from workflow.estimates import slide_error
from workflow.estimates.slide_error import TABLE
from workflow.figures.canvas import INK
from workflow.run.store import Store

SIZE = (3.2, 1.25)
BEFORE, AFTER, MEASURED = "#9a9a9a", "#c0392b", "#1f6fb2"
GROUPS = ("theory", "experiment", "field")
QUAY = "kobe_lp_tank_w57"  # whose packings the page compares

HEAD = f"""# Known slides

Slides whose run-out is known from theory, experiments or the field, compared with the predictions of soil discs and of
material points. Nothing is fitted to these slides: strengths are the published ones, or follow from a triggering
relation. Every case is a file with a table `[known]`; a field case is a section as users write it. Made by
`python -m docs.known_slides`. `python -m docs.verify --slides column` runs the cases whose names begin with "column".

The ratio is the mean prediction over the packings, divided by the geometric mean of the smallest and the largest
measured value. The brackets have the ratios of the smallest and the largest prediction. A mean prediction between the
smallest and the largest measured or derived value is **within the band**; otherwise the last column says whether the
ratio is within a factor of {CLOSE_FACTOR:g}, within {FAR_FACTOR:g}, or beyond. Where nothing moved in nature,
**stands** is right and **moved** is wrong. An infinite slope **flows** if its weight requires more than the residual
strength. Loose mass is the share of the mass that left the connected ground.

Field slides are computed as by a user who has no record of the site. Flow failures and dams slide by their weight
alone. Lateral spreads slide under cycles of Kh in both directions, which the program derives from the earthquake.
Gently sloping ground is an infinite slope. Of each earthquake in the data base of Youd et al. the row with the median
displacement is computed, and of the two largest earthquakes also the quartiles. Behind a free face the ground is level,
and the water table falls to the toe of the face; quays have a caisson and the sea. Predictions of others for the same
ground are given for comparison.

Lateral spreads move by the strain potential of the sand, which follows from blow counts. Behind a face the crust is two
to three discs thick. The crust sinks and drifts with the liquefied ground below it, mainly because of the random
packing. Level ground of discs drifts as well, in either direction, by up to a fifth of the diameter of a disc (0.5 m
for discs of 1.26 m radius). If the discs are as thick as the crust, the ground far behind a bank hardly moves. Material
points have neither error. They move gently sloping ground as the discs do, and as the strain potential does in closed
form, layer by layer. Material points slide too far where a bank flows by its weight with the residual strength, but
moved by less than a metre in the field: most of all at Wildlife, whose sand lies below 2.5 m of silt and reaches below
the bed of the river. Level ground ends at smooth sides for points and at the walls of a box for discs. Both support the
ground farthest behind a face, and the measured places are 25 to 180 m from there. Behind quays the rubble governs.
Sand of discs hardly has a peak strength, and resists a wall that moves into it as ground of ψ = 0 does
(`tests/verification/dem/test_passive_wall.py`); so do material points. Rubble of six discs is stronger in one packing
than in another. {{quay}}
In nature the caissons of Kobe stood on sand in the place of dredged clay, whose pore pressure rose as well (Proc. JSCE
596, 1998, 131); these sections, which know the ground behind the quay only, have rubble down to the dense sand.
After liquefaction the factor of safety of the quay is 1.10 (Davis's estimate for ψ = 0) to 1.3 (ψ = φ), so that it
stands without shaking by points, too. Neither method has converged at every quay: with a smaller share of dilation
(0.3), two packings of 7500 discs moved by 1.0 and 0.9 m, of 10000 by 1.4 and 1.4 m. By material points
`kobe_port_e_w15` moves by 0.2, 0.4, 1.0 and 0.9 m with 600, 1200, 2500 and 5000 cells, `kobe_lp_tank_w10` by 1.3 and
3.9 m with 1500 and 3000 cells: shear bands in the rubble depend on the size of discs and cells.
Columns of dry sand and of clay that are released at once run farther with material points than with discs, because the
grid hardly damps the motion that it resolves."""


def write_page(folder: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> Path:
    """Write the page and its pictures into a folder of cases; return the path of the page."""
    pictures = folder / PICTURES
    pictures.mkdir(exist_ok=True)
    for case in cases:
        if case.name in answers and answers[case.name].values:
            draw(case, answers[case.name], pictures / f"{case.name}.png")
    return Store(folder).write_text(PAGE, text(folder, cases, answers))


def text(folder: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> str:
    """Return the text of the page."""
    verdicts = {case.name: judge(case, answers.get(case.name)) for case in cases}
    parts = [HEAD.replace("{quay}", _packings_of_quay(answers)), _summary(cases, answers, verdicts)]
    for group in GROUPS:
        chosen = [case for case in cases if case.known.group == group]
        if chosen:
            parts += [f"## {group.capitalize()}", _table(chosen, answers, verdicts)]
    return with_remarks(parts, {case.name: list(_remarks(case, answers.get(case.name))) for case in cases}, folder)


def _packings_of_quay(answers: Mapping[str, SlideAnswer]) -> str:
    """Return a sentence on the slides of the two packings behind a quay; empty without an answer."""
    values = answers[QUAY].values if QUAY in answers else ()
    if not values:
        return ""
    return (
        f"With discs it depends on the packing: at the LP gas tank yard the ground behind the quay slides by\n"
        f"{max(values):.1f} m in one packing, and by {min(values):.1f} m in the other."
    )


def _summary(
    cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer], verdicts: Mapping[str, SlideVerdict]
) -> str:
    rows = [
        "| | cases | run | within 1.5 | within 3 | median of predicted over measured |",
        "|---|---|---|---|---|---|",
    ]
    for group in GROUPS:
        chosen = [case for case in cases if case.known.group == group]
        run = [each for each in (verdicts[case.name] for case in chosen) if each.word not in ("not run", "failed")]
        points = [each for case in chosen if (each := judge_points(case, answers.get(case.name))) is not None]
        for name, judged in ((group, run), (f"{group}, by material points", points)):
            if chosen and (judged or name == group):
                middle = bias(judged)
                cells = [name, len(chosen), len(judged), right(judged, CLOSE_FACTOR), right(judged, FAR_FACTOR)]
                rows.append(f"| {' | '.join(map(str, cells))} | {'-' if middle is None else f'{middle:.2f}'} |")
    return "\n".join(rows)


def counts(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> dict[str, float | int | str]:
    """Return the numbers quoted in the documentation: how many cases of each group were run, and how many are within
    each factor."""
    numbers: dict[str, float | int | str] = {}
    for group in GROUPS:
        chosen = [judge(case, answers.get(case.name)) for case in cases if case.known.group == group]
        run = [verdict for verdict in chosen if verdict.word not in ("not run", "failed")]
        numbers |= {f"{group}_cases": len(chosen), f"{group}_run": len(run)}
        numbers |= {f"{group}_within_1_5": right(run, CLOSE_FACTOR), f"{group}_within_3": right(run, FAR_FACTOR)}
    return numbers


def _table(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer], verdicts: Mapping[str, SlideVerdict]) -> str:
    rows = [
        "| | case | measured | predicted, by packing | predicted over measured | loose mass | |",
        "|---|---|---|---|---|---|---|",
    ]
    for case in cases:
        answer, verdict = answers.get(case.name, SlideAnswer(case.name)), verdicts[case.name]
        measured = "<br>".join(
            " to ".join(dict.fromkeys(number(end) for end in value.ends))
            + f" {value.author}" + ("" if value.counts else " (for comparison)")
            for value in case.known.values
        )  # fmt: skip
        cells = [
            f"![]({PICTURES}/{case.name}.png)" if answer.values else "",
            f"[{case.name}]({case.name}.toml)<br>{case.title}<br>{case.known.quantity}"
            + (f" ({case.known.unit})" if case.known.unit else ""),
            measured,
            predicted(answer, verdict)
            + ("" if answer.points is None else f"<br>material points {number(answer.points)}"),
            sentence(verdict) + _of_points(case, answer),
            f"{100.0 * max(answer.loose):.1f} %" if answer.loose else "",
            verdict.word,
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _of_points(case: SlideCase, answer: SlideAnswer) -> str:
    """Return the ratio of the prediction by material points on a new line."""
    verdict = judge_points(case, answer)
    return "" if verdict is None else f"<br>{sentence(verdict)} ({verdict.word})"


def _remarks(case: SlideCase, answer: SlideAnswer | None) -> Iterator[str]:
    yield f"source: {case.known.source}"
    if case.known.assumed:
        yield f"assumed: {case.known.assumed}"
    if answer is not None and answer.failure:
        yield f"no prediction: {answer.failure}"
    if answer is not None and answer.rested and not all(answer.rested):
        yield "the slide had not come to rest in every packing"


def draw(case: SlideCase, answer: SlideAnswer, path: Path) -> None:
    """Write the picture as a PNG of few colours: grey before, red after the slide, a blue bar at the measured front."""
    figure = Figure(figsize=SIZE, dpi=DPI)
    axes = figure.add_axes((0.02, 0.04, 0.96, 0.92))
    before, after = np.array(answer.before).reshape(-1, 2), np.array(answer.after).reshape(-1, 2)
    low = min((float(line[:, 1].min()) for line in (before, after) if len(line)), default=0.0)
    if isinstance(case.known.problem, Column):
        low = 0.0
    for line, colour in ((before, BEFORE), (after, AFTER)):
        if len(line):
            axes.fill_between(line[:, 0], low, line[:, 1], color=colour, alpha=0.25, linewidth=0)
            axes.plot(*line.T, color=colour, linewidth=1.0)
    if isinstance(case.known.problem, Column):
        problem = case.known.problem
        size = problem.height if problem.weight_over_strength > 0.0 else problem.width
        ends = [problem.width + size * end for end in case.measured]
        axes.axvspan(ends[0] - 0.2 * problem.radius, ends[1] + 0.2 * problem.radius, color=MEASURED, alpha=0.6)
    elif case.measured[1] > 0.0 and len(after):
        start = float(after[len(after) // 2, 0])
        top = float(np.max(before[:, 1])) if len(before) else 1.0
        axes.plot([start, start + case.measured[1]], [top, top], color=MEASURED, linewidth=2.0)
    axes.axhline(low, color=INK, linewidth=0.6)
    axes.set_aspect("equal", adjustable="datalim")
    axes.axis("off")
    save_in_few_colours(figure, path)


def errors(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> str:
    """Return the errors on known slides for the report: every case that was run, as CSV."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["name", "group", "kind", "method", "ratio"])
    for case in cases:
        answer = answers.get(case.name)
        verdicts = {"discs": judge(case, answer), "mpm": judge_points(case, answer)}
        problem = case.known.problem
        kind: str = problem.kind
        if case.known.group == "field":
            kind = "flow" if isinstance(problem, Ground) and problem.flow else "spread"
        for source, verdict in verdicts.items():
            if verdict is not None and verdict.ratio is not None:
                table.writerow([case.name, case.known.group, kind, source, f"{verdict.ratio:.3g}"])
    return text.getvalue()


def write_errors(package: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> Path:
    """Write this table into the package, where reports read it."""
    return Store(package).write_text(TABLE, errors(cases, answers))


def main() -> None:
    """Write the page, the numbers quoted in the documentation, and the errors for reports."""
    cases, answers = read_cases(FOLDER), read_answers(FOLDER / FILE, SlideAnswer)
    commits = [answer.commit for answer in answers.values()]
    command = "python -m docs.verify --slides; python -m docs.known_slides"
    keep_numbers(Path("docs"), "slides", command, counts(cases, answers), commits)
    print(write_page(FOLDER, cases, answers))
    print(write_errors(Path(slide_error.__file__).parent, cases, answers))


if __name__ == "__main__":
    main()
