"""The page of the known slides: a table of all cases, what was left out, and why."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from workflow.run.store import Store
from workflow.verify.page import PAGE, PICTURES, with_remarks
from workflow.verify.slides.case import SlideCase
from workflow.verify.slides.record import SlideAnswer
from workflow.verify.slides.verdict import CLOSE, FAR, SlideVerdict, bias, judge, judge_points, right

GROUPS = ("theory", "experiment", "field")

HEAD = f"""# Known slides

Slides whose run-out is known by theory, experiment or the field, with what the soil discs predict: nothing is tuned to
them, strengths are those given, or what a triggering relation leaves. Every case is a file with a table `[known]`; one
of the field is a section as users write it. Made by `noshiro verify --slides --page`; `noshiro verify --slides column`
runs those whose names begin so.

The ratio is the mean prediction of the packings over the (geometric) middle of what was measured, in brackets that of
the least and of the largest prediction. **Within the band** is a mean between the least and the largest number that was
measured or derived; else the word says whether the ratio is within a factor of {CLOSE:g}, within {FAR:g}, or beyond.
Where nothing moved in nature, **stands** is right and **moved** is wrong. An endless slope **flows** where its weight
asks for more than the strength that is left.

Slides of the field are run as a user without a record of the site runs them: flows and dams by their weight alone,
spreads under the cycles of Kh, both ways, that the program takes from the earthquake. Gently sloping ground is an
endless slope: of each earthquake in the data base of Youd et al. the row in the middle of what was measured, and of the
two largest the quartiles. Behind a free face the ground is level and its water falls to the toe; quays have a caisson
and the sea. Predictions of others for the same ground are given for comparison.

Behind a face in level ground the two models contradict each other: material points drift towards the face with every
cycle, as a rigid block does that slides both ways and is pulled one way, by about a third of what was measured and with
less scatter; discs move near the face only, though they do drift on shaken slopes. Why is not known."""


def write_page(folder: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> Path:
    """Write the page and the pictures it shows into a folder of cases; returns where the page is."""
    from workflow.verify.slides.picture import draw  # it brings a renderer, which the text does without

    pictures = folder / PICTURES
    pictures.mkdir(exist_ok=True)
    for case in cases:
        if case.name in answers and answers[case.name].values:
            draw(case, answers[case.name], pictures / f"{case.name}.png")
    return Store(folder).write_text(PAGE, text(folder, cases, answers))


def text(folder: Path, cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> str:
    """The page."""
    verdicts = {case.name: judge(case, answers.get(case.name)) for case in cases}
    parts = [HEAD, _summary(cases, answers, verdicts)]
    for group in GROUPS:
        chosen = [case for case in cases if case.known.group == group]
        if chosen:
            parts += [f"## {group.capitalize()}", _table(chosen, answers, verdicts)]
    return with_remarks(parts, {case.name: list(_remarks(case, answers.get(case.name))) for case in cases}, folder)


def told(verdict: SlideVerdict) -> str:
    """Ratio and its spread, in the digits that these allow."""
    if verdict.ratio is None or verdict.spread is None:
        return ""
    low, high = verdict.spread
    return f"{verdict.ratio:.2f}" if low == high else f"{verdict.ratio:.2f} ({low:.2f} to {high:.2f})"


def predicted(answer: SlideAnswer, verdict: SlideVerdict) -> str:
    """The numbers of all packings; of ground that flows there are none."""
    return "no end" if verdict.word == "flows" else ", ".join(number(value) for value in answer.values)


def number(value: float) -> str:
    """A measured or a predicted number."""
    return f"{value:.3g}"


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
                cells = [name, len(chosen), len(judged), right(judged, CLOSE), right(judged, FAR)]
                rows.append(f"| {' | '.join(map(str, cells))} | {'-' if middle is None else f'{middle:.2f}'} |")
    return "\n".join(rows)


def counts(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer]) -> dict[str, float | int | str]:
    """The numbers that the documentation quotes: how many of each group were run, and how many are how near."""
    numbers: dict[str, float | int | str] = {}
    for group in GROUPS:
        chosen = [judge(case, answers.get(case.name)) for case in cases if case.known.group == group]
        run = [verdict for verdict in chosen if verdict.word not in ("not run", "failed")]
        numbers |= {f"{group}_cases": len(chosen), f"{group}_run": len(run)}
        numbers |= {f"{group}_within_1_5": right(run, CLOSE), f"{group}_within_3": right(run, FAR)}
    return numbers


def _table(cases: Sequence[SlideCase], answers: Mapping[str, SlideAnswer], verdicts: Mapping[str, SlideVerdict]) -> str:
    rows = [
        "| | case | measured | predicted, by packing | predicted over measured | loose | |",
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
            told(verdict) + _of_points(case, answer),
            f"{100.0 * max(answer.loose):.1f} %" if answer.loose else "",
            verdict.word,
        ]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _of_points(case: SlideCase, answer: SlideAnswer) -> str:
    """The ratio of material points, on a line of its own."""
    verdict = judge_points(case, answer)
    return "" if verdict is None else f"<br>{told(verdict)} ({verdict.word})"


def _remarks(case: SlideCase, answer: SlideAnswer | None) -> Iterator[str]:
    yield f"source: {case.known.source}"
    if case.known.assumed:
        yield f"assumed: {case.known.assumed}"
    if answer is not None and answer.failure:
        yield f"no prediction: {answer.failure}"
    if answer is not None and answer.rested and not all(answer.rested):
        yield "it had not come to rest in every packing"
