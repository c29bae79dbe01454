"""Ends layers that thin out to nothing earlier, in a vertical step, so that no cell has to fill a wedge.

A quadrilateral in the tip of a wedge of a few degrees has an angle of a few degrees, and cells behind it are as thin as
the wedge. The tip that is cut off gets the soil of the layer below it (or of the layer above if there is none below, or
if both are parts of one soil; where the whole section thins out, the section ends there). A thin layer that is
weaker than the soil below it keeps a tip at the ground, which is made thicker instead: ground slides out along a weak
seam that comes out of the ground. The area that changes its soil is reported.
"""

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from meshes.section.cutting import BELOW_WATER, shown_name, whole_soil
from meshes.section.dense_lines import needed_x
from meshes.section.layering import Layering
from meshes.section.sentences import coordinate
from meshes.tip_changes import TipChange, sentences_on_tips

# Wedges blunter than this (deg) are left as they are.
SHARP = 20.0
# If a tip has more than this share of the area of its stratum, the thickness of the step is one of these smaller
# shares of the requested thickness, or the tip is kept.
LARGEST_TIP_SHARE, STEP_SHARES = 0.5, (1.0, 0.5, 0.25)
# Distance of a breakpoint at which the step is placed, over the requested thickness (by default, a quarter of a cell).
BREAKPOINT_DISTANCE = 0.75
# A stretch of a stratum thinner than this share of the thickness wished for is a neck, if it is not longer than so many
# of these.
NECK, LONGEST_NECK = 0.6, 20.0
# A piece of a stratum that thins out is left out if it holds no more than the first share of its stratum, and is
# nowhere thicker and not longer than so many of the thickness wished for.
CRUMB, THICKEST_CRUMB, LONGEST_CRUMB = 0.1, 1.5, 12.0
# Largest number of steps made in the strata.
MOST_STEPS = 50
# Effective unit weight (N/m³) for comparing strengths at the depth of a tip.
UNIT_WEIGHT = 1e4
# A layer thinner than this multiple of the requested thickness (two cells) is weakened by its tip at the ground.
THIN_LAYER_RATIO = 6.0
# A layer below a tip that is made thicker keeps at least this share of its area.
LEFT_SHARE = 0.5
# A breakpoint near others is left out where lines bend by no more than this share of a cell; ground and base, by that
# divided by this.
BEND, OUTLINE = 1.0 / 20.0, 5.0


def stepped(
    layers: Layering, least: float, names: list[str], strengths: np.ndarray | None = None
) -> tuple[Layering, list[str]]:
    """Cut off the sharp tips of strata where they are ``least`` (m) thick. Return the layers, and a sentence for the
    tips of each soil.

    Tips are cut nearer to their ends if they contain too much of their stratum, or if the stratum is nowhere as thick
    as ``least``. ``names``: names of the strata, for the sentences; ``strengths``: cohesion (Pa) of every stratum, and
    the growth of its strength with effective stress (-), (strata, 2); without them no tip is made thicker.
    """
    all_notices: list[TipChange | str] = []
    while len(all_notices) < MOST_STEPS:  # what is cut off one stratum may be a tip of its neighbour
        layers, notices = _stepped_once(layers, least, names, strengths)
        all_notices += notices
        if not notices:
            break
    return _without_empty_ends(layers), sentences_on_tips(list(dict.fromkeys(all_notices)))


def _part(names: list[str], k: int) -> str:
    """Return the name of a stratum in words; if water divided it, the words name the part."""
    return f"stratum {shown_name(names[k])}{' above water' if names[k] + BELOW_WATER in names else ''}"


def _stepped_once(
    layers: Layering, least: float, names: list[str], strengths: np.ndarray | None
) -> tuple[Layering, list[TipChange | str]]:
    """End the tips of every stratum in a vertical step once, from the top down. Return the layers and notices."""
    notices: list[TipChange | str] = []
    soils = [whole_soil(name) for name in names]

    def longest(k: int) -> float:
        same = names[k] + BELOW_WATER in names or names[k].endswith(BELOW_WATER)
        return least * LONGEST_NECK * (3.0 if same else 1.0)  # the same soil lies beside what water cut off

    for k in (None, *range(layers.strata)):
        for tip in _tips(layers, k):
            step = _step_of(layers, k, *tip, least)
            if step is None:
                continue
            x_tip, (thick, at, area) = tip[0], step
            if (near := _near_breakpoint(layers, k, *tip, at, thick)) is not None:
                at, (thick, area) = near, _step_at(layers, k, *tip, near)
            layers = _with_breakpoint(layers, at)
            joined = _of_soil_above(layers, k, min(at, x_tip), max(at, x_tip), soils)
            if joined:  # no farther than the part above reaches
                at = float(layers.x[joined[0]] if tip[1] < 0 else layers.x[joined[-1] + 1])
                thick, area = _step_at(layers, k, *tip, at)
            stretch = min(at, x_tip), max(at, x_tip)
            subject, soil = ("the section", "") if k is None else (_part(names, k), shown_name(soils[k]))
            if (
                k is not None
                and _is_outcrop(layers, k, x_tip, soils, least)
                and (thicker := _thickened(layers, k, *stretch, thick, soils, strengths)) is not None
            ):
                more = thicker.areas()[k] - layers.areas()[k]
                layers = thicker
                notices.append(TipChange(subject, soil, x_tip, thick, x_tip, more))
                continue
            layers = _without(layers, k, *stretch, joined)
            notices.append(TipChange(subject, soil, x_tip, thick, at, -area))
        for start, end in [] if k is None else _crumbs(layers, k, least):
            area = layers.areas()[k]
            layers = _without(layers, k, start, end, _of_soil_above(layers, k, start, end, soils))
            notices.append(
                f"mesh: {_part(names, k)} is a wedge thinner than {THICKEST_CRUMB * least:.2g} m from "
                f"x = {coordinate(start)} to {coordinate(end)} m; the mesh is without its "
                f"{area - layers.areas()[k]:.2g} m²"
            )
        for start, end in [] if k is None else _necks(layers, k, least, longest(k)):
            left_out = _without(_with_breakpoint(_with_breakpoint(layers, start), end), k, start, end)
            lost = layers.areas()[k] - left_out.areas()[k]
            if lost <= 0.0:  # its ends are one breakpoint
                continue
            layers = left_out
            notices.append(
                f"mesh: stratum {shown_name(names[k])} thins out to nearly nothing from x = {coordinate(start)} to "
                f"{coordinate(end)} m; in the mesh it ends there in steps, without {lost:.2g} m²"
            )
    return layers, notices


def _thickness(layers: Layering, k: int | None) -> np.ndarray:
    """Return the thickness (m) at both ends of the intervals, (intervals, 2), of stratum k, or of the whole section if
    k is None."""
    top, bottom = (0, layers.strata) if k is None else (k, k + 1)
    return np.stack([side[:, top] - side[:, bottom] for side in (layers.left, layers.right)], axis=1)


def _tips(layers: Layering, k: int | None) -> list[tuple[float, int]]:
    """Return the sharp tips of a stratum: the x (m) of the tip, and +1 or -1, the direction in which the stratum grows
    from there."""
    thick = _thickness(layers, k)
    width = layers.width
    tips = []
    for i, (left, right) in enumerate(thick):
        sharp = max(left, right) < width[i] * math.tan(math.radians(SHARP))
        if left <= 0.0 < right and sharp:
            tips.append((float(layers.x[i]), 1))
        if right <= 0.0 < left and sharp:
            tips.append((float(layers.x[i + 1]), -1))
    return tips


def _crumbs(layers: Layering, k: int, least: float) -> list[tuple[float, float]]:
    """Return the pieces of a stratum (from and to, m) that end in a sharp tip, are a short and small part of the
    stratum, and are thinner than ``least`` (m).
    """
    thick = _thickness(layers, k)
    area = 0.5 * layers.width * thick.sum(axis=1)
    runs: list[list[int]] = []
    for i in np.flatnonzero(thick.max(axis=1) > 0.0):
        if runs and runs[-1][1] == i and min(thick[i - 1, 1], thick[i, 0]) > 0.0:
            runs[-1][1] = int(i) + 1
        else:
            runs.append([int(i), int(i) + 1])
    ends = [(float(layers.x[first]), float(layers.x[last])) for first, last in runs]
    tips = [x for x, _ in _tips(layers, k)]
    return [
        (start, end)
        for (first, last), (start, end) in zip(runs, ends, strict=True)
        if thick[first:last].max() < THICKEST_CRUMB * least and end - start <= LONGEST_CRUMB * least
        and area[first:last].sum() <= CRUMB * area.sum() and (start in tips or end in tips)
    ]  # fmt: skip


def _necks(layers: Layering, k: int, least: float, longest: float) -> list[tuple[float, float]]:
    """Return stretches, up to the ``longest`` (m), where a stratum is thinner than ``least`` (m), and somewhere much
    thinner.

    The stratum is thick on one side of the stretch at least; the other side may be the end of the section. A stratum
    that is thin everywhere is unchanged.
    """
    thick = _thickness(layers, k)
    necks: list[list[float]] = []  # from, to, and the smallest thickness there
    for i, (left, right) in enumerate(thick):
        if min(left, right) >= least:
            continue
        at = [float(layers.x[i]), float(layers.x[i + 1])]
        if max(left, right) >= least:
            root = at[0] + (at[1] - at[0]) * (least - left) / (right - left)
            at[0 if left > right else 1] = root
        if necks and abs(necks[-1][1] - at[0]) <= layers.tolerance:
            necks[-1][1:] = [at[1], min(necks[-1][2], left, right)]
        else:
            necks.append([*at, float(min(left, right))])
    sides = (layers.x[0], layers.x[-1])
    return [
        (start, end)
        for start, end, thinnest in necks
        if 0.0 < thinnest <= NECK * least and end - start <= longest and (start, end) != sides
        and layers.areas()[k] > 2.0 * least * (end - start)
    ]  # fmt: skip


def _step_of(layers: Layering, k: int | None, tip: float, way: int, least: float) -> tuple[float, float, float] | None:
    """Return the thickness (m) of the step in which a stratum ends, the x (m) of the step, and the area (m²) cut off;
    None without a step."""
    whole = layers.areas().sum() if k is None else layers.areas()[k]
    for thick in (share * least for share in STEP_SHARES):
        removed = _cut_of(layers, k, tip, way, thick)
        if removed is not None and removed[1] <= LARGEST_TIP_SHARE * whole:
            return thick, *removed
    return None


def _near_breakpoint(layers: Layering, k: int | None, tip: float, way: int, at: float, least: float) -> float | None:
    """Return a breakpoint (m) near the place where a stratum becomes ``least`` (m) thick, at which it can end in a step
    as well."""
    inside = layers.x[way * (layers.x - tip) > layers.tolerance]
    near = inside[np.abs(inside - at) <= BREAKPOINT_DISTANCE * least]
    near = near[[_step_at(layers, k, tip, way, float(x))[0] >= 0.5 * least for x in near]] if len(near) else near
    return float(near[np.abs(near - at).argmin()]) if len(near) else None


def _step_at(layers: Layering, k: int | None, tip: float, way: int, at: float) -> tuple[float, float]:
    """Return the thickness (m) of a stratum at a breakpoint (m), on the side of its tip, and its area (m²) from the tip
    to there."""
    thick = _thickness(layers, k)
    first, last = sorted((int(np.argmin(np.abs(layers.x - tip))), int(np.argmin(np.abs(layers.x - at)))))
    area = 0.5 * float((layers.width[first:last, None] * thick[first:last]).sum())
    return float(thick[last - 1, 1] if way > 0 else thick[first, 0]), area


def _cut_of(layers: Layering, k: int | None, tip: float, way: int, least: float) -> tuple[float, float] | None:
    """Return the x (m) at which a stratum that grows from its tip (m) in one ``way`` first becomes ``least`` thick, and
    its area (m²) up to this place.

    The result is None if the stratum ends, or begins to thin, before it is as thick as ``least``.
    """
    thick = _thickness(layers, k)[:, ::way]
    start = int(np.argmin(np.abs(layers.x - tip)))
    area, i = 0.0, start if way > 0 else start - 1
    while 0 <= i < len(thick):
        near, far = thick[i]
        if near >= least:  # it jumps: the step is there already
            return float(layers.x[i if way > 0 else i + 1]), area
        if far < near or (near <= 0.0 and area > 0.0):
            return None
        if far >= least:
            share = (least - near) / (far - near)
            area += 0.5 * (near + least) * share * layers.width[i]
            return float(layers.x[i if way > 0 else i + 1]) + way * share * layers.width[i], area
        area += 0.5 * (near + far) * layers.width[i]
        i += way
    return None


def _with_breakpoint(layers: Layering, at: float) -> Layering:
    """Return the layers with a breakpoint at x (m)."""
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


def _is_outcrop(layers: Layering, k: int, tip: float, soils: list[str], least: float) -> bool:
    """Return whether a tip (m) of stratum k is at the ground, and its soil is nowhere thick."""
    same = np.array(soils) == soils[k]
    thick = max(float((-np.diff(side, axis=1))[:, same].sum(axis=1).max()) for side in (layers.left, layers.right))
    at = int(np.argmin(np.abs(layers.x - tip)))
    ends = [side[i, 0] - side[i, k] for side, i in ((layers.right, at - 1), (layers.left, at)) if 0 <= i < len(side)]
    return thick <= THIN_LAYER_RATIO * least and min(ends) <= layers.tolerance


def _thickened(
    layers: Layering, k: int, start: float, end: float, thick: float, soils: list[str], strengths: np.ndarray | None
) -> Layering | None:
    """Return the layers in which stratum k is at least ``thick`` between two breakpoints (m), at the cost of the layers
    below; None if no other and stronger soil lies below it there, or if too little of a layer would be left."""
    inside = _intervals_between(layers, start, end)
    present = layers.present()[inside, k + 1 :].any(axis=0)
    if strengths is None or not present.any():
        return None
    below = k + 1 + int(np.argmax(present))
    ends = np.concatenate([layers.left[inside], layers.right[inside]])
    stress = UNIT_WEIGHT * (float((ends[:, 0] - ends[:, k]).mean()) + thick)
    weaker = strengths[k] @ (1.0, stress) < strengths[below] @ (1.0, stress)
    if not weaker or soils[k] in (soils[below], _soil_above(layers, k, inside, soils)):
        return None
    left, right = layers.left.copy(), layers.right.copy()
    left_over = np.minimum(ends[:, k + 1], ends[:, k] - thick) - ends[:, below + 1]
    for side in (left, right):
        bottom = np.maximum(np.minimum(side[inside, k + 1], side[inside, k] - thick), side[inside, -1])
        bottom = np.where(side[inside, k + 1] - bottom <= layers.tolerance, side[inside, k + 1], bottom)
        if left_over.max() < thick:  # no film of it stays
            bottom = np.minimum(bottom, side[inside, below + 1])
        side[inside, k + 1 :] = np.minimum(side[inside, k + 1 :], bottom[:, None])
    thicker = replace(layers, left=left, right=right)
    same = np.array(soils)[:, None] == np.array(soils)
    few = same @ thicker.areas() < LEFT_SHARE * (same @ layers.areas())
    return None if few.any() or (thicker.areas() <= 0.0).any() else thicker


def _intervals_between(layers: Layering, start: float, end: float) -> np.ndarray:
    """Return the numbers of the intervals between two breakpoints (m)."""
    middles = 0.5 * (layers.x[1:] + layers.x[:-1])
    return np.flatnonzero((middles > start) & (middles < end))


def _soil_above(layers: Layering, k: int, inside: np.ndarray, soils: list[str]) -> str:
    """Return the soil of the layer just above stratum k in intervals; empty if there is none."""
    above = np.flatnonzero(layers.present()[inside, :k].any(axis=0))
    return soils[above[-1]] if len(above) else ""


def _of_soil_above(layers: Layering, k: int | None, start: float, end: float, soils: list[str]) -> list[int]:
    """Return the intervals between two breakpoints (m) in which stratum k and the layer just above it are parts of one
    soil, which water or a crack divides. The tip keeps its soil if the part above takes it."""
    if k is None:
        return []
    return [
        int(i)
        for i in _intervals_between(layers, start, end)
        if _soil_above(layers, k, np.array([i]), soils) == soils[k]
    ]


def _without(layers: Layering, k: int | None, start: float, end: float, upward: Collection[int] = ()) -> Layering:
    """Return the layers in which stratum k, or all strata if k is None, are left out between two breakpoints (m).

    Its ground is that of the layer below, or of the layer above if there is none below, and in the intervals
    ``upward``.
    """
    left, right = layers.left.copy(), layers.right.copy()
    for i in _intervals_between(layers, start, end):
        ends = left[i], right[i]
        if k is None:
            for side in ends:
                side[:] = side[-1]
            continue
        present = np.flatnonzero(np.maximum(-np.diff(left[i]), -np.diff(right[i])) > 0.0)
        below, above = present[present > k], present[present < k]
        for side in ends:
            if len(below) and i not in upward:  # interfaces between are those of strata that are absent
                side[k + 1 : below[0] + 1] = side[k]
            elif len(above):
                side[above[-1] + 1 : k + 1] = side[k + 1]
    return replace(layers, left=left, right=right)


def _without_empty_ends(layers: Layering) -> Layering:
    """Return the layers without intervals of no height at either end of the section."""
    high = np.flatnonzero(_thickness(layers, None).max(axis=1) > 0.0)
    first, last = int(high[0]), int(high[-1])
    return replace(
        layers,
        x=layers.x[first : last + 2],
        left=layers.left[first : last + 1],
        right=layers.right[first : last + 1],
    )


def without_needless(layers: Layering, cell: float) -> Layering:
    """Return the layers without breakpoints at which lines bend very little and which are near others, compared with
    the size of cells (m).

    Surface and base are kept within a fifth of the tolerance of other lines. Breakpoints at which strata begin, end or
    step stay.
    """
    near = 0.5 * cell
    gaps = np.diff(layers.x)
    before, after = layers.right[:-1], layers.left[1:]
    present = layers.present()
    fixed = np.ones(len(layers.x), dtype=bool)
    fixed[1:-1] = (gaps[:-1] >= near) & (gaps[1:] >= near)
    fixed[1:-1] |= (present[:-1] != present[1:]).any(axis=1) | (np.abs(before - after) > layers.tolerance).any(axis=1)
    weights = np.ones(layers.strata + 1)
    weights[[0, -1]] = OUTLINE
    left = np.vstack([layers.left[:1], before, layers.right[-1:]]) * weights
    right = np.vstack([layers.left[:1], after, layers.right[-1:]]) * weights
    keep = needed_x(layers.x, [(left[:, k], right[:, k]) for k in range(layers.strata + 1)], fixed, BEND * cell)
    ends = np.flatnonzero(keep)
    return replace(layers, x=layers.x[keep], left=layers.left[ends[:-1]], right=layers.right[ends[1:] - 1])
