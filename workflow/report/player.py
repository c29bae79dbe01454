"""Makes the animations of the report: every slide as its discs in time, and the equilibrium path under
rising Kh with the stored fields.

A film is a small table and an array of integers. Positions are in units of ``quantum`` metres, and only their changes
from frame to frame are stored. `player.js` draws the film; without scripts the page has still pictures.
"""

import base64
import json
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from dem.slides.surface import topmost
from workflow.figures.colours import soil_colours
from workflow.figures.discs import DISPLACEMENT_COLOURS
from workflow.figures.fem import MOBILISED, MOBILISED_COLOURS, nice_number
from workflow.figures.slides import Frame, name_of
from workflow.results.disc_grids import case_name, frames
from workflow.results.fem_states import COLLECTION, FemResults
from workflow.results.history import FILE, SlideHistory, read_histories
from workflow.results.results import Results

QUANTA = 20_000  # quanta across a section: a centimetre of 200 m
MOST_POSITIONS = 400_000  # places in one film; of a longer one every second picture is left out, or more
MOST_CELLS = 20_000  # of a mesh that is drawn in a page
HISTORY_POINTS = 300  # points of a curve in time
SHADES = 9
MARGIN_SHARE = 0.1  # of the extent of the discs at the start, which a film shows beyond that extent at most


@dataclass(frozen=True)
class Film:
    """Holds an animation of the page. ``kind`` is "slides" or "path"; ``text`` is JSON that may stand in a script."""

    kind: str
    title: str
    text: str

    @classmethod
    def of(cls, kind: str, title: str, table: dict[str, Any], numbers: Sequence[np.ndarray]) -> "Film":
        """Return a film of a ``kind`` with a ``title``, made of a ``table`` and of arrays of whole ``numbers``, one
        after the other."""
        flat = np.concatenate([np.asarray(array, np.int64).ravel() for array in numbers]).astype("<i4")
        packed = base64.b64encode(zlib.compress(flat.tobytes(), 9)).decode()
        text = json.dumps({"title": title, **table, "packed": packed}, ensure_ascii=False, allow_nan=False)
        return cls(kind, title, text.replace("<", "\\u003c"))


def films(results: Results) -> list[Film]:
    """Return the films of the slides, calibrated discs first, and of the equilibrium path."""
    return [*_path(results), *_slides(results)]


def _slides(results: Results) -> Iterator[Film]:
    if results.cases is None or not results.store.has(FILE):
        return
    histories = {(history.springs, history.case): history for history in read_histories(results.store)}
    for springs, number, _ in results.cases.each():
        files = list(frames(results.store, case_name(springs, number)).values())
        if len(files) > 1:
            states = [Frame.read(results.store.folder / file) for file in _thinned_files(files, results)]
            title = name_of(results.config, springs, number).removeprefix(f"{results.config.section.heading}: ")
            yield _slide(results, title, states, histories.get((springs, number)))


def _thinned_files(files: list[str], results: Results) -> list[str]:
    """Return a subset of the files, including the last one, so that the size of a film is limited."""
    discs = len(Frame.read(results.store.folder / files[0]).x)
    every = max(1, -(-discs * len(files) // MOST_POSITIONS))
    return [*files[:-1][::every], files[-1]]


def _slide(results: Results, title: str, states: list[Frame], history: SlideHistory | None) -> Film:
    """Return a film of one slide: radius, stratum and position of every disc, then its displacement from frame to
    frame."""
    first, last = states[0], states[-1]
    left, right = _extent([state.x for state in states], first.radius.max())
    bottom, top = _extent([state.z for state in states], first.radius.max())
    quantum = (right - left) / QUANTA
    places = np.array([np.rint(np.column_stack([state.x - left, state.z - bottom]) / quantum) for state in states])
    rows = history.rows if history is not None else ()
    rows = (*rows[:-1][:: max(1, len(rows) // HISTORY_POINTS)], *rows[-1:])
    table = {
        "discs": len(first.x),
        "quantum": quantum,
        "left": left,
        "size": [right - left, top - bottom],
        "times": [round(state.seconds, 3) for state in states],
        "surface": _surface(first).tolist(),
        "far": float(last.scale().vmax or 1.0),
        "shades": [to_hex(colour) for colour in colormaps[DISPLACEMENT_COLOURS](np.linspace(0.0, 1.0, SHADES))],
        "soils": soil_colours([stratum.name for stratum in results.config.section.strata]),
        "history": [
            [round(row.time_s, 2), round(row.slide_max_m, 6), round(row.settlement_uphill_m, 6)] for row in rows
        ],
    }
    return Film.of(
        "slides", title, table, [np.rint(first.radius / quantum), first.stratum, places[0], np.diff(places, axis=0)]
    )


def _extent(places: list[np.ndarray], reach: float) -> tuple[float, float]:
    """Return the ends (m) along one axis of discs of radius ``reach`` in all states, from their places (n,) in each.

    Ground that slides out of the section stays in the picture; single discs that fly away do not reduce its scale.
    """
    low, high = float(places[0].min() - reach), float(places[0].max() + reach)
    beyond = MARGIN_SHARE * (high - low)
    return (
        max(low - beyond, min(float(place.min()) - reach for place in places)),
        min(high + beyond, max(float(place.max()) + reach for place in places)),
    )


def _surface(frame: Frame) -> np.ndarray:
    """Return the topmost disc of every column of discs, from left to right."""
    free = np.flatnonzero(frame.free)
    return free[topmost(frame.x[free], frame.z[free], 2.0 * float(frame.radius.mean()))]


def _path(results: Results) -> Iterator[Film]:
    """Yield a film of the equilibrium path under rising Kh: the mesh, and displacement and mobilised strength of every
    state in equilibrium."""
    if results.kc is None or not results.store.has(COLLECTION):
        return
    fields_of_fem = FemResults.load(results.config.section, results.store)
    states = [state for state in fields_of_fem.states if not state.past_equilibrium]
    path = [step for step in fields_of_fem.answer.curve if not step.at_rest]
    if not states or not path or len(fields_of_fem.mesh.cells) > MOST_CELLS:
        return
    points = fields_of_fem.mesh.points
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    quantum = float(right - left) / QUANTA
    largest = max(float(np.hypot(*state.displacement.T).max()) for state in states)
    fine = max(largest, 1e-9) / QUANTA
    table = {
        "nodes": len(points),
        "cells": len(fields_of_fem.mesh.cells),
        "quantum": quantum,
        "fine": fine,
        "left": float(left),
        "size": [float(right - left), float(top - bottom)],
        "stretch": nice_number(0.06 * float(right - left) / max(largest, 1e-9)),
        "states": [{"step": _step(path, state.kh, state.label), "label": state.label} for state in states],
        "kh": [round(step.factor, 5) for step in path],
        "displacement": [float(f"{step.displacement:.5g}") for step in path],
        "kc": fields_of_fem.answer.kc,
        "bounds": [float(bound) for bound in MOBILISED],
        "shades": list(MOBILISED_COLOURS),
    }
    fields = [part for fem_state in states for part in (fem_state.displacement / fine, 1000.0 * fem_state.mobilised)]
    places = np.column_stack([points[:, 0] - left, points[:, 1] - bottom]) / quantum
    numbers = [np.rint(places), fields_of_fem.mesh.cells, *(np.rint(field) for field in fields)]
    yield Film.of("path", "the equilibrium path under rising Kh", table, numbers)


def _step(path: Sequence[Any], kh: float, label: str) -> int:
    """Return the step of the path at which a state was stored: the step that reached the Kh of the state, or the last
    step."""
    if not label.startswith("Kh = "):
        return len(path) - 1
    return next((place for place, step in enumerate(path) if step.factor >= kh - 1e-4), len(path) - 1)
