"""Finds the water table among the lines of a drawing."""

import re
from collections.abc import Sequence

import numpy as np

from meshes.drawings.shapes import Shape
from meshes.section.columns import JOINED, columns_of

WATER = "WATER"
OF_WATER = re.compile(
    r"(?<![a-z])((ground[ _-]?)?water|gwl|gwt|(gw|wt|w\.t\.)(?![a-z])|phreatic|fr[eé][aá]ti[ck]o|pi[eé]zometri|"
    r"grundwasser|wasserspiegel|nappe|falda)|水位|地下水",
    re.IGNORECASE,
)
OF_POND = re.compile(
    r"((free|open|surface|pond|river|lake|sea|ground|grund)[ _-]?)?(water|pond|river|lake|reservoir|wasser|gwl|gwt|"
    r"水|池|川|地下水)([ _-]?(table|level|body|\d+))?",
    re.IGNORECASE,
)


def water_table(lines: Sequence[Shape], left: float, right: float) -> tuple[np.ndarray | None, list[str]]:
    """Return the longest line of water, extended from side to side, and notices on this line and on other lines of
    water.

    Parameters
    ----------
    lines : lines of water in the drawing
    left, right : x (m) of the sides of the section

    Returns
    -------
    points : ndarray (n, 2) of the table (m); None without one
    notices : notices on lines that were changed or are not used
    """
    candidates = sorted(lines, key=lambda line: -float(np.ptp(line.points[:, 0])))
    notices = [
        f'not used: a {line.kind} on layer "{line.layer}", {line.span}, beside the longer water table; it may be '
        "after_drawdown in [water], or the piezometric_level of a stratum"
        for line in candidates[1:]
    ]
    if not candidates:
        return None, notices
    points = candidates[0].points
    points = points if points[-1, 0] >= points[0, 0] else points[::-1]
    x = np.maximum.accumulate(points[:, 0])
    points = np.column_stack([x, points[:, 1]])
    inside = points[(x > left) & (x < right)]
    ends = [[side, float(np.interp(side, *points.T))] for side in (left, right)]  # the line is level beyond its ends
    short = [f"{side:.6g} m" for side, end in ((left, x[0]), (right, x[-1])) if abs(side - end) > JOINED
             and (end > left if side == left else end < right)]  # fmt: skip
    if short:
        notices.append(f"the water table is drawn from x = {x[0]:.6g} to {x[-1]:.6g} m, and continues level to "
                    f"x = {' and '.join(short)}")  # fmt: skip
    return np.vstack([ends[:1], inside, ends[1:]]), notices


def is_pond(outline: Shape) -> bool:
    """Return whether an outline is on a drawing layer whose whole name denotes free water."""
    return OF_POND.fullmatch(outline.layer.strip()) is not None


def upper_edge(outline: Shape) -> Shape:
    """Return the upper edge of an outline, as a line."""
    columns = columns_of([outline.layer], [outline.points])
    return Shape(outline.layer, columns.points(columns.interfaces()[0]), False, outline.kind)


def is_water(line: Shape) -> bool:
    """Return whether a line is on a drawing layer whose name denotes water."""
    return OF_WATER.search(line.layer) is not None
