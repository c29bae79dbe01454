"""File of the state of a slide of material points, from which a stopped slide continues with the same bits."""

import zipfile
from pathlib import Path

import numpy as np

from fem.mpm.engine import MaterialPointEngine
from fem.mpm.slide_record import PointSlide
from meshes.files import whole

ENGINE, SLIDE = "engine_", "slide_"
LISTS = ("times", "slide", "settlement")


def keep(path: Path, engine: MaterialPointEngine, slide: PointSlide, **more: np.ndarray) -> None:
    """Write the engine, the slide so far, and ``more`` arrays to a file. Raises OSError if it cannot be written."""
    data = {ENGINE + name: array for name, array in engine.as_it_is().items()}
    data |= {SLIDE + name: np.array(getattr(slide, name)) for name in (*LISTS, "before")}
    data |= {SLIDE + "ended": np.array([slide.reason, slide.stopped_by or "", "rest" if slide.settled else ""])}
    with whole(path) as beside, beside.open("wb") as file:
        np.savez(file, **data, **more)


def resume(path: Path, engine: MaterialPointEngine, slide: PointSlide) -> dict[str, np.ndarray] | None:
    """Restore engine and slide from a file; returns the other arrays of the file, or None if it does not exist."""
    if not path.exists():
        return None
    try:
        with np.load(path, allow_pickle=False) as file:
            data = dict(file)
    except (OSError, ValueError, zipfile.BadZipFile):
        return None
    engine.go_on_from({name.removeprefix(ENGINE): data.pop(name) for name in list(data) if name.startswith(ENGINE)})
    slide.times = [float(time) for time in data.pop(SLIDE + "times")]
    slide.slide, slide.settlement = list(data.pop(SLIDE + "slide")), list(data.pop(SLIDE + "settlement"))
    slide.before = data.pop(SLIDE + "before")
    slide.reason, side, rest = (str(word) for word in data.pop(SLIDE + "ended"))
    slide.stopped_by, slide.settled = side or None, bool(rest)
    return data
