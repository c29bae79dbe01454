"""Displacements by all methods in one picture: other methods, the discs, and what was measured."""

from collections.abc import Iterator

from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from workflow.estimates.comparison import estimates
from workflow.figures.canvas import CONTINUUM, CRITICAL, DISCS, INK, Sheet
from workflow.figures.ground import foot
from workflow.results.results import Results

SMALLEST = 0.005  # m: what is less is drawn here
ROW = 0.024  # height of a row over the width of the picture
PAPER = (("paper, case 2", 3.3), ("paper, case 3", 4.9))  # m, Sec. 4(3)
# Colours, and marks that tell them apart on paper without colours.
OTHERS, SLIDES, PAPERS = (CONTINUUM, "o"), (DISCS, "D"), (INK, "x")


def displacements(results: Results, name: str) -> bool:
    """A point for each method, discs and estimates, on a logarithmic axis; false where there are less than two."""
    others = estimates(results.given, results.kc, results.slip_surface)
    rows = [(one.method, one.displacement_m, OTHERS) for one in others if one.displacement_m is not None]
    rows += list(_slides(results))
    observed = results.given.report.observed
    is_s13 = results.given.name == "s13"
    if is_s13:
        rows += [(words, value, PAPERS) for words, value in PAPER]
    if len(rows) < 2:
        return False
    title = f"{results.given.title or results.given.name}: displacement by all methods"
    sheet = Sheet(title, [ROW * len(rows) + 0.06], foot(results.given), legend_rows=1)
    axes = sheet.plot(0, "displacement (m)", "")
    for number, (_, value, (colour, marker)) in enumerate(rows):
        # an arrow where the point lies off the axis
        axes.plot(max(value, SMALLEST), -number, marker if value >= SMALLEST else "<", color=colour, markersize=5)
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.set_yticks([-number for number in range(len(rows))], [words for words, _, _ in rows], fontsize=6.5)
    box = axes.get_position()
    axes.set_position((0.34, box.y0, box.x1 - 0.34, box.height))
    handles = [_handle(OTHERS, "by other methods")]
    if results.case_set()[1]:
        handles.append(_handle(SLIDES, "discs"))
    if any(value < SMALLEST for _, value, _ in rows):
        handles.append(Line2D([], [], color=CONTINUUM, marker="<", linestyle="", label="less than 5 mm, or nothing"))
    if is_s13:
        handles.append(_handle(PAPERS, "the paper"))
    for one in observed:
        axes.axvline(one.displacement, color=CRITICAL, linewidth=1.2)
    if observed:
        words = ", ".join(f"{one.name}: {one.displacement:.3g} m" for one in observed)
        handles.append(Line2D([], [], color=CRITICAL, label=words))
    sheet.legend(handles, 5)
    with results.store.writing(name) as path:
        sheet.save(path)
    return True


def _slides(results: Results) -> Iterator[tuple[str, float, tuple[str, str]]]:
    """The discs of each case: at every place where something was measured, and at most."""
    _, cases = results.case_set()
    places = dict.fromkeys(one.x for one in results.given.report.observed if results.slides_at(one.x) is not None)
    for number, case in sorted(cases.items()):
        name = f"discs, {results.given.called(number)}"
        for x in places:
            yield f"{name}, at x = {x:g} m", (results.slides_at(x) or {})[number], SLIDES
        yield f"{name}, at most" if places else name, case.slide_max_m, SLIDES


def _handle(look: tuple[str, str], label: str) -> Line2D:
    return Line2D([], [], color=look[0], marker=look[1], linestyle="", label=label)
