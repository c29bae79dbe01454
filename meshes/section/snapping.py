"""Moves points of a section that nearly coincide to one place."""

from collections.abc import Sequence

import numpy as np

# Points closer than this are one point: a centimetre, which no survey and no log of a boring resolves, or in a small
# model a two-thousandth of its height. Left apart they would make cells that are thousands of times as long as wide.
CENTIMETRE, SHARE_OF_HEIGHT = 0.01, 1.0 / 2000.0
# What differs by less than this share of the width is rounding.
ROUNDING = 1e-9


def snapping_length(surface: np.ndarray, base: np.ndarray, base_is_depth: bool) -> float:
    """Return the distance within which points of a section are merged.

    Parameters
    ----------
    surface, base (n, 2) : points of the ground surface and of the base (m)
    base_is_depth : whether the base is given as depths below the surface

    Returns
    -------
    `CENTIMETRE`, or `SHARE_OF_HEIGHT` times height or width of the section if that is less (m).
    """
    lowest = surface[:, 1].min() - base[:, 1].max() if base_is_depth else base[:, 1].min()
    height = max(float(surface[:, 1].max() - lowest), 0.0)
    width = float(surface[-1, 0] - surface[0, 0])
    return max(min(CENTIMETRE, SHARE_OF_HEIGHT * height, SHARE_OF_HEIGHT * width), ROUNDING * width)


def snapped_x(lines: list[np.ndarray], snap: float) -> list[np.ndarray]:
    """Return lines in which points whose x nearly coincide are moved to one x.

    Parameters
    ----------
    lines : points (n, 2) of each line from left to right (m)
    snap : largest difference of x (m)

    Returns
    -------
    The lines, with points at the first x of those that coincide, or at the end of the section.
    """
    values = np.unique(np.concatenate([points[:, 0] for points in lines]))
    first = values.copy()
    start = 0
    while start < len(values):  # not from neighbour to neighbour: a scan with a point every millimetre is one chain
        after = int(np.searchsorted(values, values[start] + snap, side="right"))
        first[start:after] = values[start] if after < len(values) or start == 0 else values[-1]
        start = after
    snapped = []
    for points in lines:
        points = points.copy()
        points[:, 0] = first[np.searchsorted(values, points[:, 0])]
        steps = np.concatenate([[False], np.diff(points[:, 0]) == 0.0])
        in_a_row = steps & np.concatenate([steps[1:], [False]])
        in_a_row |= (points[:, 0] == points[0, 0]) | (points[:, 0] == points[-1, 0])  # no step at an end
        in_a_row[[0, -1]] = False
        snapped.append(points[~in_a_row])
    return snapped


def snapped_z(stack: np.ndarray, snap: float) -> np.ndarray:
    """Make elevations of interfaces equal that nearly coincide.

    Both sides of a breakpoint are treated together, so that neighbours share their points exactly.

    Parameters
    ----------
    stack (intervals, 2, interfaces) : elevations at both ends of each interval (m), changed here
    snap : largest difference of elevations (m)

    Returns
    -------
    The array ``stack``.
    """
    intervals = stack.shape[0]
    for b in range(intervals + 1):
        sides = [(b - 1, 1)] if b == intervals else [(b, 0)] if b == 0 else [(b - 1, 1), (b, 0)]
        values = np.concatenate([stack[i, end] for i, end in sides])
        order = np.argsort(-values, kind="stable")
        group = np.concatenate([[0], np.cumsum(-np.diff(values[order]) > snap)])
        snapped = np.empty_like(values)
        snapped[order] = values[order][np.searchsorted(group, group)]
        for (i, end), part in zip(sides, np.split(snapped, len(sides)), strict=True):
            stack[i, end] = part
    return stack


def snapping_notices(
    exact: np.ndarray, stack: np.ndarray, x: np.ndarray, snap: float, names: Sequence[str]
) -> list[str]:
    """Report layers that were thinner somewhere than the smallest distance of points.

    Parameters
    ----------
    exact, stack (intervals, 2, interfaces) : elevations at both ends of each interval before and after `snapped_z` (m)
    x (intervals + 1,) : the breakpoints (m)
    snap : smallest distance of points (m)
    names : names of the layers in messages

    Returns
    -------
    One sentence for each such layer.
    """
    before, after = -np.diff(exact, axis=-1), -np.diff(stack, axis=-1)
    lost = np.where((after <= 0.0) & (before > ROUNDING * (x[-1] - x[0])), before, 0.0)
    notices = []
    for k in range(lost.shape[-1]):
        i, end = np.unravel_index(int(np.argmax(lost[..., k])), lost.shape[:2])
        if lost[i, end, k] > 0.0:
            notices.append(
                f"{names[k]} is {1000.0 * lost[i, end, k]:.2g} mm thick at x = {x[i + end]:g} m: less than "
                f"{1000.0 * snap:.3g} mm is neglected"
            )
    return notices
