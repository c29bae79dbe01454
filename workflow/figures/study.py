"""Draws pictures of a study: distribution of the critical Kh, effects of the uncertain numbers, fragility, all
samples, and convergence.
"""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from workflow.figures.canvas import CONTINUUM, CRITICAL, DISCS, INK, Frames
from workflow.results.study import ProbabilityCurve, Result, Series

HEIGHT, LOW = 3.4, 2.2  # inches of a row of frames, and of one of series that converge
ACROSS = 4  # frames of a row, of single samples
FAMILIES = 3  # frames of a row, of curves
SHOWN = 12  # uncertain numbers at most in one picture, the strongest
PALE = "#d7dde2"


def failure_histogram(values: np.ndarray, curve: ProbabilityCurve, title: str) -> Frames:
    """Draw a histogram of the critical Kh, and the probability of failure against Kh with its interval.

    Parameters
    ----------
    values (samples,) : critical Kh of every sample (-)
    curve : probability of failure and its Kh
    title : title above the picture

    Returns
    -------
    The picture.
    """
    picture = Frames(HEIGHT, f"{title}: critical Kh of {len(values)} samples")
    left, right = picture.figure.subplots(1, 2)
    left.hist(values, bins=max(8, round(np.sqrt(len(values)))), color=CONTINUUM, edgecolor="white", linewidth=0.5)
    left.yaxis.set_major_locator(MaxNLocator(integer=True))
    _label(left, "critical Kh", "samples")
    _band(right, curve, CONTINUUM, "")
    _label(right, "Kh", "probability that the ground fails")
    right.set_ylim(0.0, 1.0)
    return picture


def effects(results: Sequence[Result], title: str) -> Frames:
    """Draw bars for every uncertain number: rank correlations, or total Sobol' indices with intervals if available.

    Parameters
    ----------
    results : results of a study, with the effects of the uncertain numbers
    title : title above the picture

    Returns
    -------
    The picture.
    """
    known = [result for result in results if any(effect.correlation is not None for effect in result.effects)]
    shown = [result for result in known if not result.is_detail][:ACROSS] or known[:ACROSS]
    picture = Frames(HEIGHT, f"{title}: influence of the uncertain numbers")
    for axes, result in zip(np.ravel([picture.figure.subplots(1, len(shown))]), shown, strict=True):
        bars = result.effects[:SHOWN]
        indices = all(effect.total_order is not None for effect in bars)
        lengths = [(effect.total_order if indices else effect.correlation) or 0.0 for effect in bars]
        places = -np.arange(len(bars))
        axes.barh(places, lengths, color=[CONTINUUM if length >= 0.0 else CRITICAL for length in lengths])
        if indices:
            ends = np.array([effect.total_order_ci95 for effect in bars], dtype=float).T
            axes.hlines(places, *ends, color=INK, linewidth=1.0)
        else:
            axes.axvspan(-result.by_chance, result.by_chance, color=PALE, alpha=0.6, linewidth=0, zorder=0)
            axes.set_xlim(-1.0, 1.0)
        axes.set_yticks(places, [_broken(effect.path) for effect in bars])
        axes.axvline(0.0, color=INK, linewidth=0.7)
        _label(axes, "total Sobol' index (-)" if indices else "rank correlation (-), grey: by chance", "")
        axes.set_title(result.title, fontsize=9, loc="left", color=INK, parse_math=False)
    return picture


def fragility(curves: Sequence[ProbabilityCurve], title: str) -> Frames:
    """Draw families of curves in adjacent frames.

    Parameters
    ----------
    curves : probabilities of exceeding a limit; the names of the curves of a family have the same beginning
    title : title above the picture

    Returns
    -------
    The picture.
    """
    families: dict[str, list[ProbabilityCurve]] = {}
    for curve in curves:
        families.setdefault(curve.name.split(": ")[0], []).append(curve)
    rows = -(-len(families) // FAMILIES)
    picture = Frames(HEIGHT * rows, f"{title}: fragility")
    frames = _frames(picture, len(families), min(len(families), FAMILIES))
    for axes, (name, family) in zip(frames, families.items(), strict=True):
        for curve, colour in zip(family, (CONTINUUM, DISCS, CRITICAL, INK, "#1f6fb2") * len(family), strict=False):
            _band(axes, curve, colour, curve.name.split(": ")[-1])
        across = "slide d (m)" if name.endswith("over d") else "Kh, or PGA / g (-)"
        _label(axes, across, "probability of a larger slide")
        axes.set_title(name, fontsize=9, loc="left", color=INK, parse_math=False)
        axes.set_ylim(0.0, 1.0)
        axes.legend(fontsize=7, frameon=False)
    return picture


def scatter(name: str, values: np.ndarray, drawn: Mapping[str, Sequence[Any]], title: str) -> Frames:
    """Draw a result against every uncertain number, with a point for each sample.

    Parameters
    ----------
    name : name of the result
    values (samples,) : values of the result
    drawn : values of the uncertain numbers by their paths; words are categories
    title : title above the picture

    Returns
    -------
    The picture.
    """
    shown = list(drawn)[:SHOWN]
    rows = -(-len(shown) // ACROSS)
    picture = Frames(HEIGHT * rows, f"{title}: {name} of every sample")
    frames = _frames(picture, len(shown), ACROSS, sharey=True)
    for axes, path_of in zip(frames, shown, strict=True):
        axes.plot(drawn[path_of], values, "o", color=CONTINUUM, markersize=2.0, alpha=0.6)
        _label(axes, _broken(path_of), "")
    for first in frames[::ACROSS]:
        first.set_ylabel(name, fontsize=8, color=INK, parse_math=False)
    return picture


def convergence(series: Sequence[Series], title: str) -> Frames:
    """Draw a frame for each series, with the limit on the axis; the limit is red if the series has not converged.

    Parameters
    ----------
    series : a number over ever smaller discs or time steps, with the 95 % intervals of its means
    title : name of the section

    Returns
    -------
    The picture, with four frames in a row.
    """
    rows = -(-len(series) // ACROSS)
    picture = Frames(LOW * rows + 0.4, f"{title}: convergence of the slides")
    for axes, row in zip(_frames(picture, len(series), ACROSS), series, strict=True):
        halves = [half or 0.0 for half in row.half_ci95]
        axes.errorbar(row.sizes, row.values, yerr=halves, fmt="o", color=CONTINUUM, markersize=3.5, linewidth=0.9)
        sizes = np.linspace(0.0, row.sizes[0], 60)
        ends = (row.sizes[-1], row.values[-1])
        power = row.order or 1.0
        rise = (ends[1] - row.limit) / ends[0] ** power
        axes.plot(sizes, row.limit + rise * sizes**power, color=CONTINUUM, linewidth=0.8, linestyle=(0, (4, 2)))
        axes.plot(0.0, row.limit, "D", color=CONTINUUM if row.converged else CRITICAL, markersize=4, clip_on=False)
        axes.set_title(
            f"{row.name}\n{row.verdict.split(':')[0]}", fontsize=6.5, loc="left", color=INK, parse_math=False
        )
        across = "radius (m)" if row.refined == "radius" else "time step over the stable step (-)"
        axes.set_xlabel(across, fontsize=7, color=INK)
        axes.set_xlim(left=0.0)
        axes.tick_params(labelsize=6.5, colors=INK)
        axes.grid(color="#dddddd", linewidth=0.5)
    return picture


def _frames(picture: Frames, count: int, across: int, sharey: bool = False) -> list[Axes]:
    """Return a number of frames of a picture, in rows of frames ``across``; the rest of the last row stays empty."""
    frames = np.ravel([picture.figure.subplots(-(-count // across), across, sharey=sharey, squeeze=False)])
    for axes in frames[count:]:
        axes.set_visible(False)
    return list(frames[:count])


def _broken(path: str) -> str:
    """Return a settings path in several lines, broken at its dots."""
    return "\n".join(textwrap.wrap(path.replace(".", ". "), 26, break_long_words=False)).replace(". ", ".")


def _band(axes: Axes, curve: ProbabilityCurve, colour: str, label: str) -> None:
    axes.fill_between(curve.coefficient, curve.low, curve.high, color=colour, alpha=0.18, linewidth=0)
    axes.plot(curve.coefficient, curve.probability, color=colour, linewidth=1.4, label=label)


def _label(axes: Axes, across: str, up: str) -> None:
    axes.set_xlabel(across, fontsize=8, color=INK, parse_math=False)
    axes.set_ylabel(up, fontsize=8, color=INK, parse_math=False)
    axes.tick_params(labelsize=7, colors=INK)
    axes.grid(color=PALE, linewidth=0.5)
    axes.set_axisbelow(True)
