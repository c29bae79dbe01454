"""Where a layer thins out to nothing: for a mesh it ends before, in a vertical step; no cell has to fill a wedge.

A quadrilateral in the tip of a wedge of a few degrees has an angle of a few degrees, and cells behind it are as thin as
the wedge. The soil of the tip that is cut off is taken to be that of the layer below it (of the one above, if there is
none below; and where the whole section thins out, the section ends there). How much that is is told.
"""

import math
from dataclasses import replace

import numpy as np

from meshes.section.cutting import BELOW_WATER, spoken
from meshes.section.dense_lines import kept
from meshes.section.layering import Layering

# Wedges blunter than this (deg) are left as they are.
SHARP = 20.0
# A tip that holds more than this share of its stratum is the stratum: the step then has a smaller one of these shares
# of the thickness wished for, or the tip stays.
MOST, SMALLER = 0.5, (1.0, 0.5, 0.25)
# A stretch of a stratum thinner than this share of the thickness wished for is a neck, if it is not longer than so many
# of these.
NECK, LONGEST_NECK = 0.6, 20.0
# A breakpoint near others is left out where lines bend by no more than this share of a cell; ground and base, by that
# divided by this.
BEND, OUTLINE = 1.0 / 20.0, 5.0


def stepped(layers: Layering, least: float, names: list[str]) -> tuple[Layering, list[str]]:
    """The layers with the sharp tips of strata cut off where they are ``least`` (m) thick, and a sentence for each.

    They are cut nearer to their ends where they would hold too much of their stratum, or it is nowhere as thick.
    """
    notices: list[str] = []

    def longest(k: int) -> float:
        same = names[k] + BELOW_WATER in names or names[k].endswith(BELOW_WATER)
        return least * LONGEST_NECK * (3.0 if same else 1.0)  # the same soil lies beside what water cut off

    for k in (None, *range(layers.strata)):
        for tip in _tips(layers, k):
            cut = _step_of(layers, k, *tip, least)
            if cut is None:
                continue
            x_tip, (thick, at, area) = tip[0], cut
            layers = _without(_with_breakpoint(layers, at), k, min(at, x_tip), max(at, x_tip))
            what = "the section" if k is None else "stratum " + spoken(names[k])
            notices.append(
                f"mesh: {what} thins out to nothing at x = {x_tip:g} m; in the mesh it ends in a step of "
                f"{thick:.2g} m at x = {at:.4g} m, without the last {area:.2g} m²"
            )
        for start, end in [] if k is None else _necks(layers, k, least, longest(k)):
            area = layers.areas()[k]
            layers = _without(_with_breakpoint(_with_breakpoint(layers, start), end), k, start, end)
            notices.append(
                f"mesh: stratum {spoken(names[k])} thins out to nearly nothing from x = {start:.4g} to {end:.4g} m; "
                f"in the mesh it ends there in steps, without {area - layers.areas()[k]:.2g} m²"
            )
    return _without_empty_ends(layers), notices


def _thickness(layers: Layering, k: int | None) -> np.ndarray:
    """Thickness (m) of stratum k, of the whole section if None, at both ends of the intervals, (intervals, 2)."""
    top, bottom = (0, layers.strata) if k is None else (k, k + 1)
    return np.stack([side[:, top] - side[:, bottom] for side in (layers.left, layers.right)], axis=1)


def _tips(layers: Layering, k: int | None) -> list[tuple[float, int]]:
    """Sharp tips of a stratum: the x (m) from which it grows, and +1 or -1, the way in which it does."""
    thick = _thickness(layers, k)
    width = layers.width
    found = []
    for i, (left, right) in enumerate(thick):
        sharp = max(left, right) < width[i] * math.tan(math.radians(SHARP))
        if left <= 0.0 < right and sharp:
            found.append((float(layers.x[i]), 1))
        if right <= 0.0 < left and sharp:
            found.append((float(layers.x[i + 1]), -1))
    return found


def _necks(layers: Layering, k: int, least: float, longest: float) -> list[tuple[float, float]]:
    """Stretches up to the ``longest`` (m) where a stratum is thinner than ``least`` (m), and somewhere much thinner.

    On one side at least it is thick; the other may be the section's. What is thin all over is left alone.
    """
    thick = _thickness(layers, k)
    found: list[list[float]] = []  # from, to, and the smallest thickness there
    for i, (left, right) in enumerate(thick):
        if min(left, right) >= least:
            continue
        at = [float(layers.x[i]), float(layers.x[i + 1])]
        if max(left, right) >= least:
            root = at[0] + (at[1] - at[0]) * (least - left) / (right - left)
            at[0 if left > right else 1] = root
        if found and abs(found[-1][1] - at[0]) <= layers.tolerance:
            found[-1][1:] = [at[1], min(found[-1][2], left, right)]
        else:
            found.append([*at, float(min(left, right))])
    sides = (layers.x[0], layers.x[-1])
    return [
        (start, end)
        for start, end, thinnest in found
        if 0.0 < thinnest <= NECK * least and end - start <= longest and (start, end) != sides
        and layers.areas()[k] > 2.0 * least * (end - start)
    ]  # fmt: skip


def _step_of(layers: Layering, k: int | None, tip: float, way: int, least: float) -> tuple[float, float, float] | None:
    """The thickness (m) of the step in which a stratum ends, its x (m), and the area (m²) cut off; None without one."""
    whole = layers.areas().sum() if k is None else layers.areas()[k]
    for thick in (share * least for share in SMALLER):
        cut = _cut_of(layers, k, tip, way, thick)
        if cut is not None and cut[1] <= MOST * whole:
            return thick, *cut
    return None


def _cut_of(layers: Layering, k: int | None, tip: float, way: int, least: float) -> tuple[float, float] | None:
    """Where (m) a stratum that grows from its tip (m) in one ``way`` is first ``least`` thick, and the area (m²) to it.

    None if it ends, or begins to fall, before it is as thick.
    """
    thick = _thickness(layers, k)[:, ::way]
    start = int(np.argmin(np.abs(layers.x - tip)))
    area, i = 0.0, start if way > 0 else start - 1
    while 0 <= i < len(thick):
        near, far = thick[i]
        if far < near or (near <= 0.0 and area > 0.0):
            return None
        if near >= least:  # it jumps: the step is there already
            return float(layers.x[i if way > 0 else i + 1]), area
        if far >= least:
            share = (least - near) / (far - near)
            area += 0.5 * (near + least) * share * layers.width[i]
            return float(layers.x[i if way > 0 else i + 1]) + way * share * layers.width[i], area
        area += 0.5 * (near + far) * layers.width[i]
        i += way
    return None


def _with_breakpoint(layers: Layering, at: float) -> Layering:
    """The same layers with one more breakpoint (m), unless there is one already."""
    if np.abs(layers.x - at).min() <= layers.tolerance:
        return layers
    i = int(np.searchsorted(layers.x, at)) - 1
    share = (at - layers.x[i]) / layers.width[i]
    middle = (1.0 - share) * layers.left[i] + share * layers.right[i]
    return replace(
        layers,
        x=np.insert(layers.x, i + 1, at),
        left=np.insert(layers.left, i + 1, middle, axis=0),
        right=np.insert(layers.right, i, middle, axis=0),
    )


def _without(layers: Layering, k: int | None, start: float, end: float) -> Layering:
    """The layers with stratum k, or everything if None, left out between two breakpoints (m)."""
    left, right = layers.left.copy(), layers.right.copy()
    middles = 0.5 * (layers.x[1:] + layers.x[:-1])
    for i in np.flatnonzero((middles > start) & (middles < end)):
        ends = left[i], right[i]
        if k is None:
            for side in ends:
                side[:] = side[-1]
            continue
        present = np.flatnonzero(np.maximum(-np.diff(left[i]), -np.diff(right[i])) > 0.0)
        below, above = present[present > k], present[present < k]
        for side in ends:
            if len(below):  # interfaces between are those of strata that are absent
                side[k + 1 : below[0] + 1] = side[k]
            elif len(above):
                side[above[-1] + 1 : k + 1] = side[k + 1]
    return replace(layers, left=left, right=right)


def _without_empty_ends(layers: Layering) -> Layering:
    """The layers without intervals of no height at either end of the section."""
    high = np.flatnonzero(_thickness(layers, None).max(axis=1) > 0.0)
    first, last = int(high[0]), int(high[-1])
    return replace(
        layers,
        x=layers.x[first : last + 2],
        left=layers.left[first : last + 1],
        right=layers.right[first : last + 1],
    )


def without_needless(layers: Layering, cell: float) -> Layering:
    """The layers without breakpoints near others, beside cells (m), at which lines bend by next to nothing.

    Ground and base keep within a fifth of what other lines do. Where strata begin, end or step, breakpoints stay.
    """
    near = 0.5 * cell
    gaps = np.diff(layers.x)
    before, after = layers.right[:-1], layers.left[1:]
    there = layers.present()
    fixed = np.ones(len(layers.x), dtype=bool)
    fixed[1:-1] = (gaps[:-1] >= near) & (gaps[1:] >= near)
    fixed[1:-1] |= (there[:-1] != there[1:]).any(axis=1) | (np.abs(before - after) > layers.tolerance).any(axis=1)
    weights = np.ones(layers.strata + 1)
    weights[[0, -1]] = OUTLINE
    left = np.vstack([layers.left[:1], before, layers.right[-1:]]) * weights
    right = np.vstack([layers.left[:1], after, layers.right[-1:]]) * weights
    keep = kept(layers.x, [(left[:, k], right[:, k]) for k in range(layers.strata + 1)], fixed, BEND * cell)
    ends = np.flatnonzero(keep)
    return replace(layers, x=layers.x[keep], left=layers.left[ends[:-1]], right=layers.right[ends[1:] - 1])
