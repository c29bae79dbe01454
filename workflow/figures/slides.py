"""Draws pictures of the slides: final positions of the discs, an animation, settlement and slide in time."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.artist import Artist
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from PIL import Image, ImageDraw, ImageFont

from dem.case import Case
from meshes.section.cutting import soil_of
from workflow.config import Config
from workflow.figures import fonts
from workflow.figures.canvas import (
    CONTINUUM,
    CRITICAL,
    DISCS,
    INK,
    Renderer,
    Sheet,
    Window,
    legend_columns,
    render,
)
from workflow.figures.colours import soil_colours
from workflow.figures.discs import BOUNDARY, NO_LINE, displacement_scale, draw_strata, draw_values, round_up, window_of
from workflow.figures.marks import draw_water, mark_force, sides_of_slide
from workflow.results.cases import CaseAnswer, Profile, equal_cases, smoothed
from workflow.results.history import SlideHistory
from workflow.results.lengths import metres
from workflow.results.material_points import PointCase, PointSlidesAnswer

ROOM = 0.3  # of the height of the ground, above and below its surface in the picture
SPRINGS = {"calibrated": "calibrated discs", "table2": "springs of Table 2", "mpm": "material points"}
FRAME_WIDTH = 1000  # px
FRAME_MS = 120
HOLD_MS = 2000  # the last frame
QUALITY = 55  # of WebP
# Of case 1 and those that follow; marks tell them apart on paper without colours.
COLOURS, MARKS = (CONTINUUM, DISCS, CRITICAL, "#2c7a3f", "#c77d11"), ("o", "s", "^", "x", "D", "v", "*", "P")


@dataclass(frozen=True)
class Frame:
    """Holds one state of a slide, read from its .vtp file.

    Attributes
    ----------
    x, z (n,) : places of the discs or material points (m)
    radius (n,) : radii (m)
    stratum (n,) : index of the stratum of each; -1 at the boundary
    moved (n,) : displacement since the start (m)
    seconds : time of the state (s)
    """

    x: np.ndarray
    z: np.ndarray
    radius: np.ndarray
    stratum: np.ndarray
    moved: np.ndarray
    seconds: float

    @classmethod
    def read(cls, path: Path) -> "Frame":
        """Read the state from a .vtp file."""
        grid = pv.read(path)
        moved = np.hypot(*np.asarray(grid.point_data["displacement_m"])[:, :2].T)
        x, z, _ = np.asarray(grid.points, float).T
        radius, stratum = np.asarray(grid.point_data["radius_m"]), np.asarray(grid.point_data["stratum"])
        return cls(x, z, radius, stratum, moved, float(grid.field_data["seconds"][0]))

    @property
    def free(self) -> np.ndarray:
        """Return the mask of the discs that can move."""
        return self.stratum >= 0

    def scale(self) -> Normalize:
        """Return a colour scale whose range is not stretched by a few discs that roll away."""
        return Normalize(0.0, round_up(float(np.percentile(self.moved[self.free], 99.0))))


def shown_window(states: Sequence[Frame], springs: str, line: np.ndarray = NO_LINE) -> Window:
    """Return the part of the plane that the pictures of a slide show. For discs it contains the first state with the
    box; for material points it contains the ground of all states with the base below it, since the base of their grid
    continues beyond the section.
    """
    if springs != "mpm":
        return window_of(states[0], line)
    free = {name: [getattr(state, name)[state.free] for state in states] for name in ("x", "z", "radius")}
    window = window_of(replace(states[0], **{name: np.concatenate(parts) for name, parts in free.items()}), line)
    below = ~states[0].free & (states[0].x > window.left) & (states[0].x < window.right)
    lowest = (states[0].z - states[0].radius)[below].min(initial=window.bottom)
    return replace(window, bottom=float(lowest))


def name_of(config: Config, springs: str, case: int) -> str:
    """Return the title of the pictures of a case.

    Parameters
    ----------
    config : section, and names of the cases
    springs : set of springs of the discs, "calibrated" or "table2", or "mpm" for material points
    case : number of the case, from 1

    Returns
    -------
    Section, case, and model or set of springs, in words.
    """
    return f"{config.section.heading}: {config.called(case)}, {SPRINGS.get(springs, springs)}"


def left_by(case: Case) -> str:
    """Return stiffness and strength of a layer after liquefaction, in words."""
    shares = {"stiffness": case.stiffness, "friction": case.friction, "cohesion": case.cohesion}
    phrases = [
        f"their {name}" if share == 1.0 else f"{share:g} of their {name}" for name, share in shares.items() if share
    ]
    if isinstance(case.residual, dict) or isinstance(case.residual_strength, dict):
        phrases.append("a residual strength of their own")
    elif case.residual_strength:
        phrases.append(f"a strength of {case.residual_strength / 1e3:.3g} kPa")
    elif case.residual:
        phrases.append(f"{case.residual:g} of their vertical effective stress as strength")
    return ", ".join(phrases[:-1]) + " and " * (len(phrases) > 1) + phrases[-1]


def end(config: Config, path: Path, case: CaseAnswer | PointCase, springs: str, number: int) -> Sheet:
    """Draw two views of the final state, as in Figs 14 to 16 of the paper.

    The views are the displacement with the surface before and after, and the layers.

    Parameters
    ----------
    config : section and cases
    path : .vtp file of the last state
    case : answer of the case
    springs : set of springs of the discs, "calibrated" or "table2", or "mpm" for material points
    number : number of the case, from 1

    Returns
    -------
    The picture, with stiffness and strength after liquefaction at its foot.
    """
    frame = Frame.read(path)
    before, after = case.surfaces
    window, norm = shown_window([frame], springs, before), frame.scale()

    colours = soil_colours([stratum.name for stratum in config.section.strata])
    strata = partial(draw_strata, model=frame, stratum=frame.stratum, colours=colours)
    title = f"{name_of(config, springs, number)}: largest slide {metres(case.slide_max_m)}"
    left = config.cases[number - 1]
    if isinstance(case, CaseAnswer) and not (config.dem.model == "soil" and springs == "calibrated"):
        left = Case(stiffness=case.stiffness)
    text = left_by(left)
    rest = case.reason if " after " in case.reason else f"after {frame.seconds:.1f} s: {case.reason}"
    foot = f"{rest[0].upper()}{rest[1:]}. Liquefied layers keep {text}."
    soils = {
        soil_of(stratum.name): colours[k]
        for k, stratum in enumerate(config.section.strata)
        if np.any(frame.stratum == k)
    }
    handles: list[Artist] = [Patch(color=colour, label=soil) for soil, colour in soils.items()]
    if not frame.free.all():
        handles.append(Patch(color=BOUNDARY, label="boundary"))
    columns = legend_columns(handles, most=6)
    sheet = Sheet(title, [window.proportion] * 2, foot, legend_rows=3 - (-len(handles) // columns))
    axes = sheet.show(
        0,
        render(window, partial(draw_frame, frame=frame, norm=norm)),
        window,
        "displacement, and the surface before and after",
    )
    size = 2.0 * float(frame.radius[frame.free].mean())
    axes.plot(*smoothed(before, size).T, color=INK, linewidth=1.1, linestyle=(0, (4, 2)), label="surface before")
    axes.plot(*smoothed(after, size).T, color=CONTINUUM, linewidth=1.3, label="surface after")
    mark_force(axes, sides_of_slide(config))
    wet = draw_water(sheet.show(1, render(window, strata), window, "layers"), config.section, moved=True)
    displacement_scale(sheet, norm)
    sheet.legend(handles, columns, below=2.6)
    draw_line_legend(sheet, [*axes.lines, *wet])
    return sheet


def draw_line_legend(sheet: Sheet, lines: Sequence[Artist]) -> None:
    """Draw the legend of the ``lines`` of a ``sheet`` right of its colour bar: three in a row, four in two columns."""
    sheet.figure.legend(
        handles=lines, loc="upper right", bbox_to_anchor=(0.985, sheet.legend_at[1]), ncols=3 if len(lines) < 4 else 2,
        fontsize=7.5, frameon=False, borderaxespad=0.0, labelcolor=INK,
    )  # fmt: skip


def animate(config: Config, paths: Sequence[Path], springs: str, out: Mapping[int, Path]) -> None:
    """Write an animated WebP of all states of a case, coloured by displacement; a GIF would be three times as large.

    Parameters
    ----------
    config : section, and names of the cases
    paths : .vtp files of the states, in the order of time
    springs : set of springs of the discs, "calibrated" or "table2", or "mpm" for material points
    out : the files to write, by the numbers of the cases with these states
    """
    last = Frame.read(paths[-1])
    norm, window = last.scale(), shown_window([Frame.read(paths[0]), last], springs)
    states = [Frame.read(path) for path in paths]
    with Renderer() as renderer:
        pictures = [
            renderer.image(window, partial(draw_frame, frame=frame, norm=norm), FRAME_WIDTH) for frame in states
        ]
    durations = [FRAME_MS] * (len(states) - 1) + [HOLD_MS]
    for number, file in out.items():
        name = name_of(config, springs, number)
        font = ImageFont.truetype(fonts.file_for(name), size=17)
        images = []
        for frame, picture in zip(states, pictures, strict=True):
            image = Image.new("RGB", (FRAME_WIDTH, picture.shape[0] + 34), "white")
            image.paste(Image.fromarray(picture), (0, 34))
            text = f"{name}, {frame.seconds:5.1f} s; colour: displacement, 0 to {norm.vmax:g} m"
            ImageDraw.Draw(image).text((8, 7), text, fill=INK, font=font)
            images.append(image)
        images[0].save(
            file, format="WEBP", save_all=True, append_images=images[1:], duration=durations, loop=0, quality=QUALITY,
            method=0,
        )  # fmt: skip


def draw_frame(plotter: pv.Plotter, frame: Frame, norm: Normalize) -> None:
    """Draw the discs of a frame, coloured by displacement."""
    draw_values(plotter, frame, frame.moved, norm, ~frame.free)


def history(config: Config, slides: Sequence[SlideHistory]) -> Sheet:
    """Draw settlement uphill and largest slide against time, a line for each case.

    Parameters
    ----------
    config : config of the run, for the names of the cases
    slides : rows of the slides in time; equal slides share a line

    Returns
    -------
    The picture.
    """
    sheet = Sheet(f"{config.section.heading}: slides in time", [0.26, 0.26], "", 2)
    largest = sheet.plot(0, "time since the onset (s)", "largest slide of the surface (m)")
    settlement = sheet.plot(1, "time since the onset (s)", "settlement, upslope third (m)")
    handles = []
    same: dict[Hashable, list[SlideHistory]] = {}
    for slide in sorted(slides, key=lambda shown: (shown.springs, shown.case)):
        moved = tuple((row.time_s, row.slide_max_m, row.settlement_uphill_m) for row in slide.rows)
        same.setdefault((slide.springs, moved), []).append(slide)
    for slide, *others in same.values():
        style: dict[str, Any] = {
            "color": _colour(slide.case),
            "linestyle": "-" if slide.springs == "calibrated" else (0, (4, 2)),
            "linewidth": 1.2,
            "marker": MARKS[(slide.case - 1) % len(MARKS)] if slide.case else "",
            "markersize": 4,
            "markevery": max(1, len(slide.rows) // 8),
        }
        time = [row.time_s for row in slide.rows]
        largest.plot(time, [row.slide_max_m for row in slide.rows], **style)
        settlement.plot(time, [row.settlement_uphill_m for row in slide.rows], **style)
        what = config.called(*(shown.case for shown in (slide, *others))) if slide.case else "Kh alone"
        handles.append(Line2D([], [], label=f"{what}, {SPRINGS.get(slide.springs, slide.springs)}", **style))
    for axes in (largest, settlement):
        axes.set_xlim(left=0.0)
    sheet.legend(handles, 4)
    return sheet


def _colour(case: int) -> str:
    return COLOURS[(case - 1) % len(COLOURS)] if case else INK


def profiles(config: Config, cases: Mapping[int, Profile], seeds: int) -> Sheet:
    """Draw the surface of every case over all packings: its median, and the range of the packings.

    Lines are as smooth as discs resolve them.

    Parameters
    ----------
    config : config of the run
    cases : profiles by number of the case
    seeds : number of packings

    Returns
    -------
    The picture.
    """
    groups, size = equal_cases(cases), 2.0 * config.dem.mean_radius(config.section)
    sheet = Sheet(
        f"{config.section.heading}: the surface on {seeds} random packings",
        [0.16] * len(groups),
        "",
        1,
    )
    for view, (numbers, profile) in enumerate(groups.items()):
        last = view == len(groups) - 1
        axes = sheet.plot(view, "distance x (m)" if last else "", "elevation (m)", config.called(*numbers))
        colour = _colour(numbers[0])
        before, after, low, high = (
            smoothed(np.column_stack([profile.x, line]), size)
            for line in (profile.before, profile.after, profile.after_low, profile.after_high)
        )
        axes.fill_between(low[:, 0], low[:, 1], high[:, 1], color=colour, alpha=0.25, linewidth=0)
        axes.plot(*after.T, color=colour, linewidth=1.2)
        axes.plot(*before.T, color=INK, linewidth=0.8, linestyle=(0, (4, 2)))
        axes.set_xlim(profile.x[0], profile.x[-1])
        sheet.state_exaggeration(view)
    handles = [
        Line2D([], [], color=INK, linewidth=0.8, linestyle=(0, (4, 2)), label="before"),
        Line2D([], [], color=CONTINUUM, linewidth=1.2, label="after, median"),
        Line2D([], [], color=CONTINUUM, linewidth=6.0, alpha=0.25, label="after, range of the packings"),
    ]
    sheet.legend(handles, 3)
    return sheet


def seen_from_above(surface: np.ndarray, cell: float) -> np.ndarray:
    """Return the surface (n, 2) of material points: the highest point in every half a ``cell`` (m) along x."""
    _, place = np.unique(np.floor(2.0 * surface[:, 0] / cell), return_inverse=True)
    order = np.lexsort((surface[:, 1], place.ravel()))
    return surface[order][np.append(np.diff(place.ravel()[order]) > 0, True)]


def point_profiles(config: Config, answer: PointSlidesAnswer) -> Sheet:
    """Draw the surface of every case before and after its slide by the material point method.

    The slide along the surface is drawn, too: the surface of a slope that slides as a whole hardly changes.

    Parameters
    ----------
    config : section, and names of the cases
    answer : surfaces (m) of the cases, and the size of the cells

    Returns
    -------
    The picture, with a view for each group of equal cases, and one of the slides along the surface.
    """
    title = f"{config.section.heading}: slides by the material point method, cells of {answer.cell_m:.2g} m"
    groups = equal_cases(answer.cases)
    sheet = Sheet(title, [0.16] * len(groups) + [0.12], "", 1)
    heights = np.concatenate([case.surfaces[0][:, 1] for case in answer.cases.values()])
    margin = ROOM * (heights.max() - heights.min()) + answer.cell_m
    dashes = (0, (4, 2))
    lines = [Line2D([], [], color=INK, linewidth=0.9, linestyle=dashes, label="surface before")]
    along = sheet.plot(len(groups), "distance x (m)", "slide (m)", "slide of the surface, downslope")
    for view, (numbers, case) in enumerate(groups.items()):
        name, colour = config.called(*numbers), _colour(numbers[0])
        words = f"{name}: largest slide {metres(case.slide_max_m)}; {case.reason}"
        axes = sheet.plot(view, "", "elevation (m)", words)
        before, after = case.surfaces[0], seen_from_above(case.surfaces[1], answer.cell_m)
        lines += axes.plot(*after.T, color=colour, linewidth=1.3, label=f"after, {name}")
        axes.plot(*before.T, color=INK, linewidth=0.9, linestyle=dashes)
        axes.set_xlim(before[0, 0], before[-1, 0])
        axes.set_ylim(heights.min() - margin, heights.max() + margin)  # alike in all cases
        sheet.state_exaggeration(view)
        along.plot(*np.array(case.slide_along).reshape(-1, 2).T, color=colour, linewidth=1.3)
        along.set_xlim(axes.get_xlim())
    low, high = along.get_ylim()
    along.set_ylim(min(0.0, low), 1.05 * high)
    mark_force(sheet.views[0], sides_of_slide(config))
    sheet.legend(lines, 4)
    return sheet
