"""Draws pictures that need the results of several stages: both load curves, both slip surfaces, calibration, the
sliding block."""

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from dem.settings import FACTORS
from meshes.section.quantity import GRAVITY
from workflow.estimates.sliding_block import newmark
from workflow.figures.canvas import CONTINUUM, CRITICAL, DISCS, INK, Sheet
from workflow.figures.displacements import displacements
from workflow.figures.front import FRONT, front
from workflow.figures.ground import Overlay, foot, section_sheet
from workflow.results.calibration import CalibrationAnswer
from workflow.results.discs import DiscsAnswer, DiscSearch
from workflow.results.governing import governing_kh
from workflow.results.results import Results

CURVES, SURFACES = "figures/curves.png", "figures/slip_surfaces.png"
CALIBRATION, BLOCK = "figures/calibration.png", "figures/sliding_block.png"
DISPLACEMENTS = "figures/displacements.png"
PICTURES = (FRONT, CURVES, SURFACES, CALIBRATION, BLOCK, DISPLACEMENTS)
SOLID, DASHED, DOTTED = (0, ()), (0, (5, 2)), (0, (1, 2))
PALE = "#7d8890"
LEGEND_ROWS = 8  # of the load curves: every entry in a row of its own, since some labels are half as wide as the sheet


def draw_all(results: Results) -> list[str]:
    """Draw the pictures that the results allow, and remove outdated pictures.

    Parameters
    ----------
    results : results of all stages of the run

    Returns
    -------
    Names of the pictures drawn, relative to the folder of the run.
    """
    drawn = []
    for name, draw in (
        (FRONT, front), (CURVES, _curves), (SURFACES, _surfaces), (CALIBRATION, _calibration), (BLOCK, _block),
        (DISPLACEMENTS, displacements),
    ):  # fmt: skip
        sheet = draw(results)
        if sheet is None:
            results.store.remove([name])
            continue
        results.store.save(name, sheet)
        drawn.append(name)
    return drawn


def _title(results: Results) -> str:
    return results.config.section.heading


def _curves(results: Results) -> Sheet | None:
    """Draw Kh against displacement, of the continuum and of the discs, on one sheet."""
    answer, discs = results.fem, results.dem
    if answer is None:
        return None
    title, note = f"{_title(results)}: Kh and displacement", foot(results.config.section)
    sheet = Sheet(title, [0.45], note, legend_rows=LEGEND_ROWS)
    axes = sheet.plot(0, "mean displacement in the direction of Kh (m)", "seismic coefficient Kh (-)")
    path = [step for step in answer.curve if not step.at_rest]
    x = [0.0, *(step.displacement for step in path)]
    axes.plot(x, [0.0, *(step.factor for step in path)], color=CONTINUUM, marker="o", markersize=2.5, linewidth=1.3)
    handles: list[Artist] = [_handle(CONTINUUM, "o", f"FEM, {answer.settings.sides} sides")]
    widest = x[-1]
    counterpart = results.dem_counterpart
    if counterpart is not None and discs is not None:
        curve = [(0.0, 0.0), *((step.displacement, step.factor) for step in counterpart.curve if not step.at_rest)]
        axes.plot(*np.array(curve).T, color=CONTINUUM, linestyle=DASHED, linewidth=1.1)
        widest = max(widest, curve[-1][0])
        handles.append(Line2D([], [], color=CONTINUUM, linestyle=DASHED, label=f"FEM, {counterpart.terms}"))
        rest = [(step.displacement, step.factor) for step in counterpart.curve if step.at_rest and step.balanced]
        if rest:  # the path itself carries overstress
            look: dict[str, Any] = {"color": CONTINUUM, "marker": "o", "markerfacecolor": "white", "linestyle": ""}
            label = "in equilibrium without overstress"
            handles += axes.plot(*np.array(rest).T, **look, markersize=4, label=label)
    if answer.by_limit_analysis:
        handles.append(
            axes.axhline(answer.kc, color=CONTINUUM, linewidth=0.9, alpha=0.6, label="limit load of the FEM")
        )
    elif results.kc is not None:
        axes.axhspan(answer.kc_lower, answer.kc_upper, color=CONTINUUM, alpha=0.15, linewidth=0)
    if discs is not None:
        farthest, of_discs = _disc_curves(axes, discs)
        widest, handles = max(widest, farthest), handles + of_discs
        if discs.model.discs == "soil" and counterpart is not None:
            largest_displacement = results.config.dem.ductility * counterpart.yielding_m
            widest = max(widest, largest_displacement)
            label = (
                f"{results.config.dem.ductility:g} times the yield displacement of the FEM (dashed): largest "
                "displacement for the critical Kh"
            )
            handles.append(
                axes.axvline(largest_displacement, color=CRITICAL, linestyle=DASHED, linewidth=0.9, label=label)
            )
    axes.set_xlim(0.0, 1.05 * widest)
    axes.set_ylim(bottom=0.0)
    axes.set_title(_brackets(results), fontsize=9, loc="left", color=INK, pad=4)
    sheet.legend(handles, 1)
    return sheet


def _disc_curves(axes: Axes, discs: DiscsAnswer) -> tuple[float, list[Artist]]:
    """Draw the curves of the discs before and after calibration, and the bracket of their critical Kh. Return the
    largest displacement drawn (m), and the entries of the legend."""
    farthest = 0.0
    handles: list[Artist] = []
    for key, search, look in (
        ("before", discs.before, {"color": PALE, "marker": "x", "linestyle": DOTTED}),
        ("after", discs.after, {"color": DISCS, "marker": "D", "linestyle": SOLID}),
    ):
        if key == "before" and search.curve == discs.after.curve:
            continue  # calibration changed nothing, and the other curve would cover it
        farthest = max(farthest, _discs(axes, search, look, discs.model.discs == "soil"))
        handles.append(Line2D([], [], **look, markersize=4, linewidth=1.2, label=f"discs, {key} calibration"))
    after = discs.after
    if after.kc is not None and after.kc_upper is not None:
        label = "bracket of the critical Kh of the discs"
        band = axes.axhspan(after.kc_lower, after.kc_upper, color=DISCS, alpha=0.15, linewidth=0, label=label)
        handles.append(band)
    return farthest, handles


def _discs(axes: Any, search: DiscSearch, look: dict[str, Any], soil: bool) -> float:
    """Draw Kh against the displacement of the discs. Return the largest displacement drawn (m).

    For discs with the law "soil" the displacement is prescribed, and every measured Kh is drawn. For discs with the law
    "paper" Kh is prescribed, and only states at rest are drawn.
    """
    points = [(trial.kh, trial.displacement_m) for trial in search.trials] if soil else search.curve
    curve = np.array(sorted(points, key=lambda point: point[1])).reshape(-1, 2)
    axes.plot(curve[:, 1], curve[:, 0], **look, markersize=3.5, linewidth=1.0)
    stood = [trial.displacement_m for trial in search.trials if soil or trial.verdict == "stands"]
    return max(stood, default=0.0)


def _brackets(results: Results) -> str:
    phrases = []
    if results.fem is not None and results.kc is not None:
        least, most = f"{results.kc:.3f}", f"{results.fem.kc_upper:.3f}"
        phrases.append(f"FEM {least}" + (f", at most {most}" if most != least else ""))
    after = results.dem.after if results.dem is not None else None
    if after is not None and after.kc is not None:
        alike = results.dem_counterpart
        ends = dict.fromkeys(f"{end:.3f}" for end in ((alike.kc, alike.kc_upper) if alike is not None else ()))
        target_words = f" for {' to '.join(ends)} of the FEM (dashed)" if ends else ""
        phrases.append(f"discs {after.kc:.3f} ({after.kc_lower:.3f} to {after.kc_upper:.3f}){target_words}")
    return f"critical Kh: {'; '.join(phrases)}" if phrases else ""


def _handle(colour: str, marker: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, marker=marker, markersize=3, linewidth=1.2, label=label)


def _surfaces(results: Results) -> Sheet | None:
    """Draw the slip surfaces of the continuum and of the discs on the section; return None without any slip
    surface."""
    lines = []
    surfaces = results.dem.slip_surface if results.dem is not None else None
    if surfaces is not None and surfaces.fem:
        terms = f", {results.dem_counterpart.terms}" if results.dem_counterpart is not None else ""
        label = f"FEM{terms}: slip surface"
        lines.append(Overlay(np.array(surfaces.fem), CONTINUUM, SOLID, label))
    elif results.fem is not None:
        end = results.fem.last_in_equilibrium()
        if end is not None and end.slip_surface:
            label = f"FEM: slip surface, {end.label}"
            lines.append(Overlay(np.array(end.slip_surface), CONTINUUM, SOLID, label))
    if surfaces is not None and surfaces.dem:
        label = "discs: slip surface at failure"
        lines.append(Overlay(np.array(surfaces.dem), DISCS, DASHED, label))
    if not lines:
        return None
    title = "slip surfaces"
    if surfaces is not None and surfaces.mean_distance_m is not None and surfaces.same_stratum_share is not None:
        title += (
            f", discs and FEM {surfaces.mean_distance_m:.1f} m apart vertically on average, in the same layer along "
            f"{100 * surfaces.same_stratum_share:.0f} % of their common extent"
        )
    force = None if results.fem is None else results.fem.towards
    return section_sheet(results.config.section, title, lines, force=force)


def _one_at_a_time(sheet: Sheet, answer: CalibrationAnswer, parameters: list[str]) -> list[Line2D]:
    """Draw the critical Kh against the factor on each parameter in the first view of the sheet, and return the entries
    of the legend."""
    axes = sheet.plot(0, "factor on the parameter (-)", "critical Kh (-)", "one parameter at a time")
    shades = (DISCS, CONTINUUM, "#2c7a3f", "#c77d11", INK, PALE)
    handles = []
    for k, parameter in enumerate(parameters):
        rows = sorted((r.value, r.kc) for r in answer.sensitivity if r.parameter == parameter if r.kc)
        colour, marker = shades[k % len(shades)], "osD^v<>p"[k % 8]
        axes.plot(*np.array(rows).reshape(-1, 2).T, color=colour, marker=marker, markersize=4, linewidth=1.1)
        handles.append(_handle(colour, marker, parameter.replace("_", " ")))
    axes.set_ylim(0.0, 1.1 * max((row.kc for row in answer.sensitivity if row.kc), default=1.0))
    _factors(axes)
    return handles


def _calibration(results: Results) -> Sheet | None:
    """Draw the influence of each parameter on the critical Kh of the discs, and the trials of the calibrated
    parameter.
    """
    answer = results.calibration
    if answer is None or answer.target_kc is None:
        return None
    parameters = list(dict.fromkeys(row.parameter for row in answer.sensitivity))  # soil discs have no choice of them
    heights = [0.34] * (2 if parameters else 1)
    sheet = Sheet(f"{_title(results)}: calibration of the discs", heights, foot(results.config.section), legend_rows=1)
    handles = _one_at_a_time(sheet, answer, parameters) if parameters else []
    across = f"factor on {answer.parameter.replace('_', ' ')} (-)"
    axes = sheet.plot(len(heights) - 1, across, "critical Kh (-)", f"{answer.verdict}: {answer.reason}")
    for trial in answer.trials:
        if trial.kc is not None and trial.kc_upper is not None:
            low, high = trial.kc - trial.kc_lower, trial.kc_upper - trial.kc
            axes.errorbar(trial.value, trial.kc, [[low], [high]], color=DISCS, marker="D", markersize=4, capsize=2)
    if answer.trials:
        handles.append(_handle(DISCS, "D", "critical Kh of the discs, and its bracket"))
    _factors(axes)
    shown = [*FACTORS["soil"], *(trial.value for trial in answer.trials)]
    axes.set_xlim(0.9 * min(shown), 1.1 * max(shown))
    target, within = answer.target_kc, answer.tolerance
    axes.axhspan(target - within, target + within, color=CRITICAL, alpha=0.15, linewidth=0)
    aim = axes.axhline(target, color=CRITICAL, linewidth=1.0, label="target critical Kh, and tolerance")
    if answer.value is not None:
        taken = f"factor taken, {answer.value:.3g}"
        handles.append(axes.axvline(answer.value, color=DISCS, linewidth=0.8, linestyle=DASHED, label=taken))
    handles.append(aim)
    sheet.legend(handles, 5)
    return sheet


def _factors(axes: Axes) -> None:
    """Give an axis of factors a logarithmic scale."""
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 8.0, 9.0)))
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _block(results: Results) -> Sheet | None:
    """Draw the accelerogram, and the slide of the rigid block under it in both directions."""
    governing = governing_kh(results)
    if not results.config.sliding_block.accelerogram or governing is None:
        return None
    kc = governing.value
    record = results.config.sliding_block.in_use()
    sheet = Sheet(
        f"{_title(results)}: rigid block under {record.name}",
        [0.2, 0.2, 0.2],
        foot(results.config.section),
        legend_rows=1,
    )
    first = sheet.plot(0, "time (s)", "acceleration (m/s²)", f"{record.kind}, peak {record.peak:.2f} m/s²")
    first.plot(record.time, record.acceleration, color=INK, linewidth=0.6)
    resistance = kc * GRAVITY
    for sign, colour in ((1.0, CONTINUUM), (-1.0, DISCS)):
        first.axhline(sign * resistance, color=colour, linewidth=0.9, linestyle=DOTTED)
    speed = sheet.plot(1, "time (s)", "velocity (m/s)")
    path = sheet.plot(2, "time (s)", "displacement (m)")
    handles = []
    for sign, colour, sense, line in ((1.0, CONTINUUM, "positive", SOLID), (-1.0, DISCS, "negative", DASHED)):
        slide = newmark(record.time, sign * record.acceleration, kc)
        speed.plot(slide.time, slide.velocity, color=colour, linewidth=1.0, linestyle=line)
        label = f"{sense}: {slide.permanent:.3f} m"
        handles += path.plot(slide.time, slide.displacement, color=colour, linewidth=1.3, linestyle=line, label=label)
    handles.append(Line2D([], [], color=INK, linewidth=0.9, linestyle=DOTTED, label=f"resistance kc g, kc = {kc:.3f}"))
    for axes in (first, speed, path):
        axes.set_xlim(record.time[0], record.time[-1])
    sheet.legend(handles, 3)
    return sheet
