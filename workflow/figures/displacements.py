"""Draws displacements by all methods in one picture: other methods, discs, material points, and measurements."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from workflow.estimates.comparison import is_s13
from workflow.estimates.estimate import DOES_NOT_APPLY
from workflow.figures.canvas import CONTINUUM, CRITICAL, DISCS, INK, Sheet
from workflow.figures.ground import foot
from workflow.figures.symbols import in_mathtext
from workflow.results.cases import CaseAnswer, equal_cases
from workflow.results.governing import estimates_of
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase
from workflow.results.results import Results

SMALLEST_SLIDE = 0.005  # m: what is less is drawn here
ROW = 0.024  # height of a row over the width of the picture
PAPER = (("the paper, case 2", 3.3), ("the paper, case 3", 4.9))  # m, Sec. 4(3)
# Colours, and marks that tell them apart on paper without colours.
OTHER_METHODS, SLIDES, POINTS = (CONTINUUM, "o"), (DISCS, "D"), ("#2c7a3f", "^")
PRINTED, PAPERS = (DISCS, "s"), (INK, "x")
GREY = "#6b757c"
BLANK = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}


@dataclass(frozen=True)
class MethodRow:
    """Holds a method, its marker, and its displacement.

    Attributes
    ----------
    description : the method, in words
    look : colour and marker
    displacement : displacement (m); None if the method gives none
    reason : why the method gives no displacement; else empty
    """

    description: str
    look: tuple[str, str]
    displacement: float | None
    reason: str = ""


def displacements(results: Results) -> Sheet | None:
    """Draw a point for each method, discs and estimates, on a logarithmic axis; return None if there are fewer than
    two."""
    rows = [*_others(results), *slides(results)]
    known = [row for row in rows if row.displacement is not None]
    if len(known) < 2:
        return None
    title = f"{results.config.section.heading}: displacement by all methods"
    sheet = Sheet(title, [ROW * len(rows) + 0.06], foot(results.config.section), legend_rows=2)
    axes = sheet.plot(0, "displacement (m)", "")
    for number, row in enumerate(rows):
        _draw(axes, row, -number)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.set_yticks(
        [-number for number in range(len(rows))], [in_mathtext(row.description) for row in rows], fontsize=6.5
    )
    axes.set_ylim(-len(rows) + 0.4, 0.6)  # so that the numbers of the first and the last point stand in the frame
    observed = results.config.report.observed
    most = max(
        [
            SMALLEST_SLIDE,
            *(row.displacement or 0.0 for row in known),
            *(observation.displacement for observation in observed),
        ]
    )
    axes.set_xlim(0.8 * SMALLEST_SLIDE, 2.5 * most)  # so that the number beside the last point stands in the frame
    box = axes.get_position()
    axes.set_position((0.34, box.y0, box.x1 - 0.34, box.height))
    for observation in observed:
        axes.axvline(observation.displacement, color=CRITICAL, linewidth=1.2)
    sheet.legend([*_handles(known), *_measured(results)], 4)
    return sheet


def _draw(axes: Axes, row: MethodRow, at: int) -> None:
    """Draw a point with its number, an arrow if the point lies off the axis, or the reason why there is no point."""
    if row.displacement is None:
        axes.annotate(
            row.reason,
            (SMALLEST_SLIDE, at),
            (-2, -2),
            textcoords="offset points",
            fontsize=6.5,
            color=GREY,
            bbox=BLANK,
        )
        return
    colour, marker = row.look
    place = max(row.displacement, SMALLEST_SLIDE)
    axes.plot(place, at, marker if row.displacement >= SMALLEST_SLIDE else "<", color=colour, markersize=5)
    phrase = metres(row.displacement)
    axes.annotate(phrase, (place, at), (6, -2), textcoords="offset points", fontsize=6.5, color=colour, bbox=BLANK)


def _others(results: Results) -> Iterator[MethodRow]:
    """Yield the displacement (m) by each method that is compared with the slide of the discs; none by a method that
    does not apply to this ground."""
    for estimate in estimates_of(results):
        if estimate.displacement_m is not None and estimate.applies:
            yield MethodRow(estimate.method, OTHER_METHODS, estimate.displacement_m)
        elif estimate.kind != "smooth block":  # which never gives one
            yield MethodRow(estimate.method, OTHER_METHODS, None, _why_not(estimate.description))


def slides(results: Results) -> Iterator[MethodRow]:
    """Yield the slides by discs and by material points, case by case.

    Parameters
    ----------
    results : results of the run

    Returns
    -------
    Rows by discs, by material points, by discs with the law "paper", and as the paper printed them (section S-13 only).
    Cases with equal slides have one row; where a displacement was measured, there is a row for its place, too.
    """
    _, cases = results.case_set()
    yield from _of_cases(results, cases, "discs", SLIDES)
    yield from _of_cases(results, results.mpm.cases if results.mpm is not None else {}, "material points", POINTS)
    for numbers, case in equal_cases(results.printed_cases).items():
        yield MethodRow(f"the paper's discs, {results.config.called(*numbers)}", PRINTED, case.slide_max_m)
    if is_s13(results.config.section):
        for words, value in PAPER:
            yield MethodRow(words, PAPERS, value)


def _why_not(words: str) -> str:
    """Return the reason why an estimate gives no displacement, taken from its text."""
    for sign in ("outside its range: ", "not computed: ", DOES_NOT_APPLY):
        _, separator, reason = words.partition(sign)
        if separator:
            return f"{sign}{reason.partition(', so that ')[0] if sign == DOES_NOT_APPLY else reason}"
    return words


def _of_cases(
    results: Results, cases: Mapping[int, CaseAnswer | PointCase], method: str, look: tuple[str, str]
) -> Iterator[MethodRow]:
    """Yield the slides of each case by one method: the slide at every place of a measurement, and the largest slide."""
    observed = dict.fromkeys(row.x for row in results.config.report.observed if row.x is not None)
    places = [x for x in observed if all(case.slide_at(x) is not None for case in cases.values())]
    for numbers, case in equal_cases(cases).items():
        name = f"{method}, {results.config.called(*numbers)}"
        for x in places:
            yield MethodRow(f"{name}, at x = {x:g} m", look, abs(case.slide_at(x) or 0.0))
        yield MethodRow(f"{name}, at most" if places else name, look, case.slide_max_m)


def _handles(rows: list[MethodRow]) -> Iterator[Line2D]:
    named = {
        OTHER_METHODS: "by other methods", SLIDES: "discs", POINTS: "material points",
        PRINTED: "the paper's discs, here", PAPERS: "the paper",
    }  # fmt: skip
    for look, label in named.items():
        if any(row.look == look for row in rows):
            yield Line2D([], [], color=look[0], marker=look[1], linestyle="", label=label)
    if any(row.displacement is not None and row.displacement < SMALLEST_SLIDE for row in rows):
        yield Line2D([], [], color=CONTINUUM, marker="<", linestyle="", label="less than 5 mm, or nothing")


def _measured(results: Results) -> Iterator[Line2D]:
    observed = results.config.report.observed
    if observed:
        words = ", ".join(f"{observation.name}: {observation.displacement:.3g} m" for observation in observed)
        yield Line2D([], [], color=CRITICAL, label=words)
