"""Displacements by all methods in one picture: other methods, the discs, and what was observed on S-13."""

from matplotlib.lines import Line2D

from workflow.estimates.comparison import estimates
from workflow.figures.canvas import CONTINUUM, CRITICAL, DISCS, INK, Sheet
from workflow.figures.ground import foot
from workflow.results.results import Results

SMALLEST = 0.005  # m: what is less is drawn here
ROW = 0.024  # height of a row over the width of the picture
PAPER = (("paper, case 2", 3.3), ("paper, case 3", 4.9))  # m, Sec. 4(3)
FIELD = 3.0  # m, Sec. 3(1)


def displacements(results: Results, name: str) -> bool:
    """A point for each method, discs and estimates, on a logarithmic axis; false where there are less than two."""
    rows = [(one.method, one.displacement_m, CONTINUUM) for one in estimates(results.given, results.kc)
            if one.displacement_m is not None]  # fmt: skip
    _, cases = results.case_set()
    rows += [(f"discs, case {number}", case.slide_max_m, DISCS) for number, case in sorted(cases.items())]
    observed = results.given.name == "s13"
    if observed:
        rows += [(words, value, INK) for words, value in PAPER]
    if len(rows) < 2:
        return False
    title = f"{results.given.title or results.given.name}: displacement by all methods"
    sheet = Sheet(title, [ROW * len(rows) + 0.06], foot(results.given), legend_rows=1)
    axes = sheet.plot(0, "displacement (m)", "")
    for number, (_, value, colour) in enumerate(rows):
        axes.plot(max(value, SMALLEST), -number, "o", color=colour, markersize=5)
    axes.set_xscale("log")
    axes.set_yticks([-number for number in range(len(rows))], [words for words, _, _ in rows], fontsize=6.5)
    box = axes.get_position()
    axes.set_position((0.34, box.y0, box.x1 - 0.34, box.height))
    handles = [
        Line2D([], [], color=CONTINUUM, marker="o", linestyle="", label="by other methods"),
        Line2D([], [], color=DISCS, marker="o", linestyle="", label="discs"),
    ]
    if observed:
        axes.axvline(FIELD, color=CRITICAL, linewidth=1.2)
        handles.append(Line2D([], [], color=INK, marker="o", linestyle="", label="the paper"))
        handles.append(Line2D([], [], color=CRITICAL, label="measured in the field, about 3 m"))
    sheet.legend(handles, 4)
    with results.store.writing(name) as path:
        sheet.save(path)
    return True
